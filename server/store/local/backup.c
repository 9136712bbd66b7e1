/* See store_tools.h: --backup and --restore, which differ in how objects are brought over.
 *
 * The database is copied as it is at one moment; what its rows name is then brought over. A file
 * that a replacement or a delete took away meanwhile means that the moment was a bad one: then it
 * is done again. Batches are copied before.
 *
 * A marker stands in the copy's folder from before its first file until after its last one is
 * durable: no daemon starts on a copy that was interrupted, and the same command completes it. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/jobs/batch_queue.h"
#include "server/store/local/database.h"
#include "server/store/local/files.h"
#include "server/store/tools.h"

#define ATTEMPTS 20

struct backup {
    FILE *out;
    struct server_store_files from, to; /* `from` is only read, without its lock */
    enum server_disk_result (*bring)(const char *path, const char *second);
    enum server_store_outcome outcome;
    unsigned surfaces;
    unsigned long long bytes;
};

/* --- what a row names ------------------------------------------------------------------------- */

static bool give_up(struct backup *backup, enum server_store_outcome outcome, const char *what,
                    const char *name)
{
    backup->outcome = outcome;
    if (outcome != SERVER_STORE_ABSENT) fprintf(backup->out, "%s: %s\n", what, name);
    return false;
}

static struct server_record *read_row(const struct server_row *row)
{
    struct server_record *record = NULL;
    return server_record_read(row->text, row->size, &record) == SERVER_RECORD_READ ? record : NULL;
}

static enum server_store_outcome bring_object(struct backup *backup,
                                              const struct server_object *object)
{
    char from[SERVER_DISK_PATH], to[SERVER_DISK_PATH], folder[SERVER_DISK_PATH];
    void *bytes = NULL;
    server_files_object_path(&backup->from, from, object->id);
    server_files_object_path(&backup->to, to, object->id);
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(to, '/') - to), to);
    enum server_disk_result result = server_disk_make_folder(folder);
    if (result) return server_files_outcome(result);
    bool is_there = server_files_read_object(&backup->to, object, &bytes) == SERVER_STORE_DONE;
    free(bytes);
    bytes = NULL;
    /* a part of it, of an attempt that was interrupted */
    if (!is_there) (void)server_disk_remove(NULL, to);
    result = is_there ? server_disk_sync_file(to) : backup->bring(from, to);
    if (!result) result = server_disk_sync_folder(folder);
    if (result) return server_files_outcome(result);
    enum server_store_outcome outcome =
        is_there ? SERVER_STORE_DONE : server_files_read_object(&backup->to, object, &bytes);
    free(bytes);
    backup->bytes += object->size;
    return outcome;
}

static enum server_store_outcome bring_objects(struct backup *backup,
                                               const struct server_record *record)
{
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    struct server_object object;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (server_record_object(record, part, &object)) outcome = bring_object(backup, &object);
    return outcome;
}

static bool on_row_bring(void *user, const struct server_row *row)
{
    struct backup *backup = user;
    struct server_record *record = read_row(row);
    if (!record)
        return give_up(backup, SERVER_STORE_DAMAGED, "a row of the database is damaged", row->key);
    enum server_store_outcome outcome = bring_objects(backup, record);
    backup->surfaces++;
    server_record_release(record);
    return !outcome ||
           give_up(backup, outcome, "an uploaded file is damaged, or can't be copied", row->key);
}

static bool on_row_manifest(void *user, const struct server_row *row)
{
    struct backup *backup = user;
    struct server_record *record = read_row(row);
    if (!record)
        return give_up(backup, SERVER_STORE_DAMAGED, "a row of the database is damaged", row->key);
    enum server_store_outcome outcome = server_files_write_manifest(&backup->to, record);
    server_record_release(record);
    return !outcome || give_up(backup, outcome, "a manifest can't be written", row->key);
}

/* --- one moment ------------------------------------------------------------------------------- */

typedef enum server_store_outcome open_database(const char *path, struct server_database **out);

static enum server_store_outcome copy_database(const struct backup *backup, const char *name,
                                               open_database *open)
{
    struct server_database *database;
    char path[SERVER_DISK_PATH], copy[SERVER_DISK_PATH];
    server_files_path(&backup->from, path, name);
    server_files_path(&backup->to, copy, name);
    enum server_store_outcome outcome = open(path, &database);
    if (outcome) {
        fprintf(backup->out, "the database '%s' is damaged, or can't be read\n", path);
        return SERVER_STORE_REFUSED;
    }
    outcome = server_database_copy(database, copy);
    if (outcome) fprintf(backup->out, "the database can't be copied to '%s'\n", copy);
    server_database_close(database, false);
    return outcome == SERVER_STORE_ABSENT ? SERVER_STORE_REFUSED : outcome;
}

/* ABSENT: the moment was a bad one. */
static enum server_store_outcome copy_moment(struct backup *backup)
{
    struct server_database *database;
    char path[SERVER_DISK_PATH];
    server_files_path(&backup->to, path, "geodesicd.db");
    unlink(path);
    backup->surfaces = 0;
    backup->bytes = 0;
    enum server_store_outcome outcome =
        copy_database(backup, "geodesicd.db", server_database_open_to_read);
    if (!outcome) outcome = server_database_open(path, &database);
    if (outcome) return outcome;
    backup->outcome = SERVER_STORE_DONE;
    outcome = server_database_each(database, on_row_bring, backup);
    if (!outcome && !backup->outcome)
        outcome = server_database_each(database, on_row_manifest, backup);
    server_database_close(database, true);
    return outcome ? outcome : backup->outcome;
}

/* --- the whole -------------------------------------------------------------------------------- */

static bool has_file(const struct server_store_files *files, const char *name)
{
    char path[SERVER_DISK_PATH];
    server_files_path(files, path, name);
    return server_disk_exists(path);
}

/* Before the surfaces: so those that the batches ask about are there, or were removed since. */
static enum server_store_outcome copy_batches(const struct backup *backup)
{
    if (!has_file(&backup->from, SERVER_BATCH_QUEUE_FILE)) return SERVER_STORE_DONE;
    return copy_database(backup, SERVER_BATCH_QUEUE_FILE, server_database_open_to_copy);
}

static bool copy_store(struct backup *backup)
{
    enum server_store_outcome outcome = copy_batches(backup);
    if (!outcome) outcome = SERVER_STORE_ABSENT;
    for (int attempt = 0; outcome == SERVER_STORE_ABSENT && attempt < ATTEMPTS; attempt++)
        outcome = copy_moment(backup);
    if (outcome == SERVER_STORE_ABSENT)
        fprintf(backup->out,
                "an uploaded file is missing, or surfaces change too fast: see --check-store\n");
    if (!outcome && server_files_finish(&backup->to) == SERVER_STORE_DONE) return true;
    fprintf(backup->out, "no copy was made: '%s' is unfinished; run the same again, or delete it\n",
            backup->to.folder);
    return false;
}

static bool copy_folder(struct backup backup, const char *folder, const char *copy)
{
    FILE *out = backup.out;
    char error[512];
    snprintf(backup.from.folder, sizeof backup.from.folder, "%s", folder);
    if (server_files_is_unfinished(folder, error, sizeof error) ||
        !server_files_open_copy(&backup.to, copy, error, sizeof error)) {
        fprintf(out, "%s\n", error);
        return false;
    }
    bool copied = copy_store(&backup);
    if (copied)
        fprintf(out, "%u surfaces, %llu bytes, copied from '%s' to '%s'\n", backup.surfaces,
                backup.bytes, folder, copy);
    server_files_close(&backup.to);
    return copied;
}

bool server_store_backup(const char *folder, const char *copy, FILE *out)
{
    return copy_folder((struct backup){.out = out, .bring = server_disk_link}, folder, copy);
}

bool server_store_restore(const char *folder, const char *backup, FILE *out)
{
    struct server_store_files files;
    char error[512];
    if (!server_files_open_existing(&files, backup, error, sizeof error)) {
        fprintf(out, "%s\n", error);
        return false;
    }
    bool restored =
        copy_folder((struct backup){.out = out, .bring = server_disk_copy}, backup, folder);
    server_files_close(&files);
    return restored;
}
