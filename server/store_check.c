/* See store_tools.h: --check-store. */
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/store_database.h"
#include "server/store_files.h"
#include "server/store_tools.h"

struct check {
    FILE *out;
    struct server_store_files files;
    struct server_database *database;
    unsigned faults, rows, manifests, objects, unfinished;
    unsigned long long bytes;
};

static void fault(struct check *check, const char *what, const char *name)
{
    fprintf(check->out, "fault: %s: %s\n", what, name);
    check->faults++;
}

/* --- objects ------------------------------------------------------------------------------------------------------ */

static void check_object(struct check *check, const struct server_record *record)
{
    void *bytes = NULL;
    enum server_store_outcome outcome =
        server_files_read_object(&check->files, record->sha256, (size_t)record->size, &bytes);
    free(bytes);
    if (outcome == SERVER_STORE_ABSENT)
        fault(check, "the uploaded file is missing", record->name);
    else if (outcome)
        fault(check, "the uploaded file is damaged or can't be read", record->name);
    else
        check->objects++, check->bytes += record->size;
}

/* --- manifests ---------------------------------------------------------------------------------------------------- */

static struct server_record *read_manifest(struct check *check, const char *name)
{
    char path[SERVER_DISK_PATH];
    struct server_record *record = NULL;
    void *text;
    size_t size;
    server_files_manifest_path(&check->files, path, name);
    if (server_disk_read(path, &text, &size) != SERVER_DISK_DONE) return NULL;
    enum server_record_reading reading = server_record_read(text, size, &record);
    free(text);
    if (reading == SERVER_RECORD_READ && strcmp(record->name, name) == 0) return record;
    server_record_release(record);
    return NULL;
}

static void check_manifest(struct check *check, const char *file)
{
    char name[PROTO_MESH_NAME + 1], sha256[SERVER_SHA256_HEX];
    if (!server_files_manifest_name(file, name)) return;
    struct server_record *record = read_manifest(check, name);
    if (!record) {
        fault(check, "the manifest is damaged", name);
        return;
    }
    check->manifests++;
    check_object(check, record);
    if (check->database && server_database_find(check->database, name, sha256) == SERVER_STORE_ABSENT)
        check->unfinished++; /* a crash between manifest and row */
    server_record_release(record);
}

static void check_manifests(struct check *check)
{
    char path[SERVER_DISK_PATH];
    server_files_path(&check->files, path, "manifests");
    DIR *directory = opendir(path);
    if (!directory) {
        fault(check, "the folder can't be read", path);
        return;
    }
    for (struct dirent *entry; (entry = readdir(directory));)
        if (entry->d_name[0] != '.') check_manifest(check, entry->d_name);
    closedir(directory);
}

/* --- rows --------------------------------------------------------------------------------------------------------- */

static bool on_row(void *user, const struct server_row *row)
{
    struct check *check = user;
    struct server_record *record = NULL;
    if (server_record_read(row->text, row->size, &record) == SERVER_RECORD_READ && strcmp(record->name, row->name) == 0)
        check->rows++;
    else
        fault(check, "the row in the database is damaged", row->name);
    struct server_record *manifest = read_manifest(check, row->name);
    if (!manifest) {
        fault(check, "the row in the database has no manifest that can be read", row->name);
        if (record) check_object(check, record);
    } else if (record && strcmp(manifest->etag, record->etag) != 0) {
        check->unfinished++;
    }
    server_record_release(manifest);
    server_record_release(record);
    return true;
}

static void check_database(struct check *check)
{
    char path[SERVER_DISK_PATH];
    server_files_path(&check->files, path, "geodesicd.db");
    enum server_store_outcome outcome = server_database_open_to_read(path, &check->database);
    if (!outcome) outcome = server_database_each(check->database, on_row, check);
    if (outcome && outcome != SERVER_STORE_ABSENT)
        fault(check, "the database is damaged or can't be read; the next start makes it again from the manifests",
              path);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static void print_sums(const struct check *check)
{
    if (check->unfinished)
        fprintf(check->out,
                "note: %u changes were cut short before they were acknowledged; the next start settles them\n",
                check->unfinished);
    fprintf(check->out, "%u manifests, %u rows, %u files (%llu bytes) verified: %u faults\n", check->manifests,
            check->rows, check->objects, check->bytes, check->faults);
}

bool server_store_check(const char *folder, FILE *out)
{
    struct check check = {.out = out};
    char error[512];
    if (access(folder, F_OK) != 0) {
        fprintf(out, "there is no folder '%s'\n", folder);
        return false;
    }
    if (!server_files_open(&check.files, folder, error, sizeof error)) {
        fprintf(out, "%s\n", error);
        return false;
    }
    check_database(&check);
    check_manifests(&check);
    print_sums(&check);
    server_database_close(check.database, false);
    server_files_close(&check.files);
    return check.faults == 0;
}
