/* See store.h: --check-store of a data folder. Reads the files that are named by their checksum,
 * each once; then manifests and rows, which name the files that there must be. */
#include <stdlib.h>
#include <string.h>

#include "server/store/local/database.h"
#include "server/store/local/files.h"
#include "server/store/sql.h"

#define HEX_DIGITS "0123456789abcdef"
#define HASH       (SERVER_SHA256_HEX - 1)

struct object { /* a file under objects/ */
    char id[SERVER_OBJECT];
    size_t size;
    bool is_sound, is_used;
};

struct check {
    FILE *out;
    struct server_files files;
    struct server_database *database;
    struct object *objects; /* sorted once all are there */
    size_t object_count, object_capacity;
    unsigned faults, rows, manifests, verified, fields, unfinished, leftovers, aside;
    unsigned long long bytes;
};

static void fault(struct check *check, const char *what, const char *name)
{
    fprintf(check->out, "fault: %s: %s\n", what, name);
    check->faults++;
}

static void fault_foreign(struct check *check, const char *path)
{
    fault(check, "the file is none of the store's", path);
}

static void check_folder(struct check *check, const char *folder,
                         void (*visit)(void *user, const char *path, const char *file))
{
    if (!server_files_each(&check->files, folder, visit, check))
        fault(check, "the folder can't be read",
              server_files_path(&check->files, "%s", folder).text);
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

static struct object *object_add(struct check *check)
{
    if (check->object_count == check->object_capacity) {
        size_t capacity = check->object_capacity ? 2 * check->object_capacity : 64;
        struct object *objects = realloc(check->objects, capacity * sizeof *objects);
        if (!objects) return NULL;
        check->objects = objects;
        check->object_capacity = capacity;
    }
    return &check->objects[check->object_count++];
}

static void on_object(void *user, const char *path, const char *file)
{
    struct check *check = user;
    const char *folder = path + strlen(path) - strlen(file) - 3;
    if (!server_files_object_check(file) || strncmp(folder, file, 2) != 0) {
        fault_foreign(check, path);
        return;
    }
    struct object *object = object_add(check);
    if (!object) {
        fault(check, "there is no memory to check the file", path);
        return;
    }
    memset(object, 0, sizeof *object);
    strcpy(object->id, file);
    object->is_sound = file_is_sound(path, file, &object->size);
}

static void on_object_folder(void *user, const char *path, const char *file)
{
    if (strlen(file) != 2 || !server_disk_each(path, on_object, user)) fault_foreign(user, path);
}

static void on_field(void *user, const char *path, const char *file)
{
    struct check *check = user;
    size_t size;
    if (strspn(file, HEX_DIGITS) != HASH)
        check->leftovers++;
    else if (file_is_sound(path, file, &size))
        check->fields++;
    else
        fault(check, "the stored field is damaged; it is computed again when it is wanted", path);
}

static void on_field_folder(void *user, const char *path, const char *file)
{
    (void)file;
    if (!server_disk_each(path, on_field, user)) fault_foreign(user, path);
}

static int by_id(const void *a, const void *b)
{
    return strcmp(((const struct object *)a)->id, ((const struct object *)b)->id);
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
    struct object *object = check->object_count ? bsearch(&sought, check->objects,
                                                          check->object_count, sizeof sought, by_id)
                                                : NULL;
    if (!object) {
        fault(check, missing[part], record->key);
        return;
    }
    if (!object->is_sound || object->size != wanted.size)
        fault(check, damaged[part], record->key);
    else if (!object->is_used)
        check->verified++, check->bytes += object->size;
    object->is_used = true;
}

static void check_objects(struct check *check, const struct server_record *record)
{
    for (int part = 0; part < SERVER_PARTS; part++) check_object(check, record, part);
}

static void check_unused_objects(struct check *check)
{
    for (size_t i = 0; i < check->object_count; i++) {
        const struct object *object = &check->objects[i];
        if (object->is_used) continue;
        check->leftovers++;
        if (!object->is_sound)
            fault(check, "the file, which no surface has, is damaged or can't be read", object->id);
    }
}

/* --- manifests, rows and batches -------------------------------------------------------------- */

static struct server_record *manifest_read(const struct check *check, const char *key)
{
    char checksum[SERVER_SHA256_HEX];
    struct server_record *record = NULL;
    (void)server_files_read_manifest(&check->files, key, &record, checksum);
    return record;
}

static void on_manifest(void *user, const char *path, const char *file)
{
    struct check *check = user;
    char key[SERVER_KEY_TEXT], objects[SERVER_PARTS][SERVER_OBJECT];
    if (!server_files_manifest_key(file, key)) {
        if (strstr(file, SERVER_DISK_ASIDE))
            check->aside++;
        else
            fault_foreign(check, path);
        return;
    }
    struct server_record *record = manifest_read(check, key);
    if (!record) {
        fault(check, "the manifest is damaged", key);
        return;
    }
    check->manifests++;
    check_objects(check, record);
    if (check->database &&
        server_database_find(check->database, key, objects) == SERVER_STORE_ABSENT)
        check->unfinished++;
    server_record_release(record);
}

static bool on_row(void *user, const struct server_row *row)
{
    struct check *check = user;
    struct server_record *record = NULL, *manifest = manifest_read(check, row->key);
    if (server_record_read(row->key, row->text, row->size, &record) == SERVER_RECORD_READ)
        check->rows++;
    else
        fault(check, "the row in the database is damaged", row->key);
    if (!manifest) {
        fault(check, "the row in the database has no manifest that can be read", row->key);
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
    if (!outcome) outcome = server_database_each(check->database, on_row, check);
    check_folder(check, "manifests", on_manifest);
    if (outcome == SERVER_STORE_ABSENT && check->manifests)
        fault(check, "the database is missing; the next start makes it again from the manifests",
              path.text);
    else if (outcome && outcome != SERVER_STORE_ABSENT)
        fault(check,
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
        fault(check,
              "the database of batches is damaged or can't be read; without it there are none",
              path.text);
    server_database_close(database, false);
}

/* --- the whole -------------------------------------------------------------------------------- */

static void on_temporary(void *user, const char *path, const char *file)
{
    (void)path, (void)file;
    ((struct check *)user)->leftovers++;
}

static void on_file(void *user, const char *path, const char *file)
{
    (void)path;
    ((struct check *)user)->aside += strstr(file, SERVER_DISK_ASIDE) != NULL;
}

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
    check_folder(&check, "objects", on_object_folder);
    if (check.object_count) qsort(check.objects, check.object_count, sizeof *check.objects, by_id);
    /* these two folders need not exist */
    (void)server_files_each(&check.files, "fields", on_field_folder, &check);
    (void)server_files_each(&check.files, "temporary", on_temporary, &check);
    check_database(&check);
    check_batches(&check);
    check_unused_objects(&check);
    check_folder(&check, "", on_file);
    print_sums(&check);
    server_database_close(check.database, false);
    server_files_close(&check.files);
    free(check.objects);
    return check.faults == 0;
}
