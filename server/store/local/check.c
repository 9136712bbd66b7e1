/* See store.h: --check-store of a data folder. Reads the files that are named by their checksum,
 * each once; then manifests and rows, which name the files that there must be. */
#include <search.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/local/database.h"
#include "server/store/local/files.h"
#include "server/store/sql.h"

#define HEX_DIGITS "0123456789abcdef"
#define HASH       (SERVER_SHA256_HEX - 1)

struct object { /* a file under objects/; the tree's order is that of ids */
    char id[SERVER_OBJECT];
    size_t size;
    bool is_sound, is_used;
};

struct check {
    FILE *out;
    struct server_files files;
    struct server_database *database;
    void *objects; /* a tree */
    unsigned faults, rows, manifests, verified, fields, unfinished, leftovers, aside;
    unsigned long long bytes;
};

static void check_fault(struct check *check, const char *what, const char *name)
{
    fprintf(check->out, "fault: %s: %s\n", what, name);
    check->faults++;
}

static void check_foreign(struct check *check, const char *path)
{
    check_fault(check, "the file is none of the store's", path);
}

/* Lists a folder that must exist. */
static struct server_listing check_folder(struct check *check, const char *folder)
{
    struct server_listing listing = server_files_list(&check->files, folder);
    if (!listing.is_readable)
        check_fault(check, "the folder can't be read",
                    server_files_path(&check->files, "%s", folder).text);
    return listing;
}

/* --- files that are named by their checksum --------------------------------------------------- */

/* Reads a file; false: its SHA-256 is not the beginning of its name. */
static bool file_is_sound(const char *path, const char *file, size_t *size)
{
    char found[SERVER_SHA256_HEX];
    void *bytes;
    if (server_disk_read(path, &bytes, size) != SERVER_DISK_DONE) return false;
    server_sha256(bytes, *size, found);
    free(bytes);
    return strncmp(found, file, HASH) == 0;
}

static int by_id(const void *a, const void *b)
{
    return strcmp(((const struct object *)a)->id, ((const struct object *)b)->id);
}

static void object_read(struct check *check, const struct server_listing *file)
{
    const char *folder = file->name - 3; /* "ab/" */
    if (!server_files_object_check(file->name) || strncmp(folder, file->name, 2) != 0) {
        check_foreign(check, file->path);
        return;
    }
    struct object *object = calloc(1, sizeof *object);
    if (object) strcpy(object->id, file->name);
    if (!object || !tsearch(object, &check->objects, by_id)) {
        free(object);
        check_fault(check, "there is no memory to check the file", file->path);
        return;
    }
    object->is_sound = file_is_sound(file->path, file->name, &object->size);
}

static void check_object_files(struct check *check)
{
    struct server_listing folders = check_folder(check, "objects");
    while (server_listing_next(&folders)) {
        bool is_ours = strlen(folders.name) == 2;
        struct server_listing objects = server_disk_list(is_ours ? folders.path : "");
        if (!objects.is_readable) check_foreign(check, folders.path);
        while (server_listing_next(&objects)) object_read(check, &objects);
    }
}

static void check_fields(struct check *check)
{
    size_t size;
    struct server_listing folders = server_files_list(&check->files, "fields"); /* if any */
    while (server_listing_next(&folders)) {
        struct server_listing fields = server_disk_list(folders.path);
        if (!fields.is_readable) check_foreign(check, folders.path);
        while (server_listing_next(&fields))
            if (strspn(fields.name, HEX_DIGITS) != HASH)
                check->leftovers++;
            else if (file_is_sound(fields.path, fields.name, &size))
                check->fields++;
            else
                check_fault(check,
                            "the stored field is damaged; it is computed again when it is wanted",
                            fields.path);
    }
}

static void check_object(struct check *check, const struct server_record *record,
                         enum server_part part)
{
    static const char *const missing[SERVER_PARTS] = {"the surface's file is missing",
                                                      "the surface's attachment is missing"};
    static const char *const damaged[SERVER_PARTS] = {
        "the surface's file is damaged or can't be read",
        "the surface's attachment is damaged or can't be read"};
    struct server_object wanted;
    struct object sought;
    if (!server_record_object(record, part, &wanted)) return;
    strcpy(sought.id, wanted.id);
    struct object **found = tfind(&sought, &check->objects, by_id), *object = found ? *found : NULL;
    if (!object) {
        check_fault(check, missing[part], record->key);
        return;
    }
    if (!object->is_sound || object->size != wanted.size)
        check_fault(check, damaged[part], record->key);
    else if (!object->is_used)
        check->verified++, check->bytes += object->size;
    object->is_used = true;
}

static void check_objects(struct check *check, const struct server_record *record)
{
    for (int part = 0; part < SERVER_PARTS; part++) check_object(check, record, part);
}

static void check_unused(const void *node, VISIT visit, void *user)
{
    const struct object *object = *(const struct object *const *)node;
    struct check *check = user;
    if (object->is_used || visit == preorder || visit == endorder) return; /* once, in order */
    check->leftovers++;
    if (!object->is_sound)
        check_fault(check, "the file, which no surface has, is damaged or can't be read",
                    object->id);
}

/* --- manifests, rows and batches -------------------------------------------------------------- */

static struct server_record *manifest_read(const struct check *check, const char *key)
{
    char checksum[SERVER_SHA256_HEX];
    struct server_record *record = NULL;
    (void)server_files_read_manifest(&check->files, key, &record, checksum);
    return record;
}

static void check_manifest(struct check *check, const struct server_listing *file)
{
    char key[SERVER_KEY_TEXT], objects[SERVER_PARTS][SERVER_OBJECT];
    if (!server_files_manifest_key(file->name, key)) {
        if (strstr(file->name, SERVER_DISK_ASIDE))
            check->aside++;
        else
            check_foreign(check, file->path);
        return;
    }
    struct server_record *record = manifest_read(check, key);
    if (!record) {
        check_fault(check, "the manifest is damaged", key);
        return;
    }
    check->manifests++;
    check_objects(check, record);
    if (check->database &&
        server_database_find(check->database, key, objects) == SERVER_STORE_ABSENT)
        check->unfinished++;
    server_record_release(record);
}

static bool check_row(void *user, const struct server_row *row)
{
    struct check *check = user;
    struct server_record *record = NULL, *manifest = manifest_read(check, row->key);
    if (server_record_read(row->key, row->text, row->size, &record) == SERVER_RECORD_READ)
        check->rows++;
    else
        check_fault(check, "the row in the database is damaged", row->key);
    if (!manifest) {
        check_fault(check, "the row in the database has no manifest that can be read", row->key);
        if (record) check_objects(check, record);
    } else if (record && strcmp(manifest->etag, record->etag) != 0) {
        check->unfinished++;
    }
    server_record_release(manifest);
    server_record_release(record);
    return true;
}

static void check_database(struct check *check)
{
    const struct server_path path = server_files_path(&check->files, SERVER_STORE_DATABASE);
    enum server_store_outcome outcome =
        server_database_open(path.text, SERVER_DATABASE_READ, &check->database);
    if (!outcome) outcome = server_database_each(check->database, check_row, check);
    struct server_listing manifests = check_folder(check, "manifests");
    while (server_listing_next(&manifests)) check_manifest(check, &manifests);
    if (outcome == SERVER_STORE_ABSENT && check->manifests)
        check_fault(check,
                    "the database is missing; the next start makes it again from the manifests",
                    path.text);
    else if (outcome && outcome != SERVER_STORE_ABSENT)
        check_fault(
            check,
            "the database is damaged or can't be read; the next start makes it again from the "
            "manifests",
            path.text);
}

static void check_batches(struct check *check)
{
    struct server_database *database = NULL;
    const struct server_path path = server_files_path(&check->files, SERVER_SQL_BATCHES);
    enum server_store_outcome outcome =
        server_database_open(path.text, SERVER_DATABASE_COPY, &database);
    if (outcome && outcome != SERVER_STORE_ABSENT)
        check_fault(
            check, "the database of batches is damaged or can't be read; without it there are none",
            path.text);
    server_database_close(database, false);
}

/* --- the whole -------------------------------------------------------------------------------- */

static void print_sums(const struct check *check)
{
    if (check->unfinished)
        fprintf(check->out,
                "note: %u surfaces have no row in the database, or an older one: changes that were "
                "cut short before they were acknowledged, or rows that could not be written; the "
                "next start writes them\n",
                check->unfinished);
    if (check->leftovers)
        fprintf(check->out,
                "note: %u files that were not finished, or that no surface has; the next start "
                "deletes them\n",
                check->leftovers);
    if (check->aside)
        fprintf(check->out,
                "note: %u damaged files were put aside (*%s*); delete them when they have told you "
                "enough\n",
                check->aside, SERVER_DISK_ASIDE);
    fprintf(
        check->out, "%u manifests, %u rows, %u files (%llu bytes), %u fields verified: %u faults\n",
        check->manifests, check->rows, check->verified, check->bytes, check->fields, check->faults);
}

bool server_store_check(const char *folder, FILE *out)
{
    struct check check = {.out = out};
    if (!server_files_open_existing(&check.files, folder)) {
        fprintf(out, "%s\n", check.files.error);
        return false;
    }
    check_object_files(&check);
    check_fields(&check);
    check_database(&check);
    check_batches(&check);
    twalk_r(check.objects, check_unused, &check);
    struct server_listing temporary = server_files_list(&check.files, "temporary"), /* if any */
        all = check_folder(&check, "");
    while (server_listing_next(&temporary)) check.leftovers++;
    while (server_listing_next(&all)) check.aside += strstr(all.name, SERVER_DISK_ASIDE) != NULL;
    print_sums(&check);
    server_database_close(check.database, false);
    server_files_close(&check.files);
    tdestroy(check.objects, free);
    return check.faults == 0;
}
