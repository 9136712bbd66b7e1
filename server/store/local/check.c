/* --check-store of a data folder: checks manifests, rows and their objects, each once; then other
 * files. */
#include <stdlib.h>
#include <string.h>

#include "server/base/names.h"
#include "server/store/local/local.h"

struct check {
    FILE *out;
    struct server_files files;
    struct server_database *database;
    /* `named`: objects of surfaces; `sound`: undamaged objects among them */
    struct server_names named, sound;
    unsigned faults, rows, manifests, fields, unfinished, leftovers, aside;
    unsigned long long bytes;
};

static void check_fault(struct check *check, const char *what, const char *name)
{
    fprintf(check->out, "fault: %s: %s\n", what, name);
    check->faults++;
}

static void check_foreign(struct check *check, const char *path)
{
    check_fault(check, "the file does not belong to the store", path);
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

/* Reads a file. Returns false if the file's name does not begin with the SHA-256 of its bytes. */
static bool file_is_sound(const struct server_listing *file)
{
    char found[SERVER_SHA256_HEX];
    void *bytes;
    size_t size;
    if (server_disk_read(file->path, &bytes, &size) != SERVER_STORE_DONE) return false;
    server_sha256(bytes, size, found);
    free(bytes);
    return strncmp(found, file->name, strlen(found)) == 0;
}

/* Checks a file in `objects`, unless it is the object of a surface. */
static void check_unused(struct check *check, const struct server_listing *file)
{
    const char *folder = file->name - 3; /* "ab/" */
    if (!server_files_object_check(file->name) || strncmp(folder, file->name, 2) != 0) {
        check_foreign(check, file->path);
        return;
    }
    if (server_names_has(&check->named, file->name)) return;
    check->leftovers++;
    if (!file_is_sound(file))
        check_fault(check, "the file, which belongs to no surface, is damaged or can't be read",
                    file->name);
}

static void check_object_files(struct check *check)
{
    struct server_listing folders = check_folder(check, "objects");
    while (server_listing_next(&folders)) {
        bool is_ours = strlen(folders.name) == 2;
        struct server_listing objects = server_disk_list(is_ours ? folders.path : "");
        if (!objects.is_readable) check_foreign(check, folders.path);
        while (server_listing_next(&objects)) check_unused(check, &objects);
    }
}

static void check_fields(struct check *check)
{
    struct server_listing folders = server_files_list(&check->files, "fields"); /* if any */
    while (server_listing_next(&folders)) {
        struct server_listing fields = server_disk_list(folders.path);
        if (!fields.is_readable) check_foreign(check, folders.path);
        while (server_listing_next(&fields))
            if (!server_sha256_check(fields.name))
                check->leftovers++;
            else if (file_is_sound(&fields))
                check->fields++;
            else
                check_fault(check,
                            "the stored field is damaged; it is computed again when it is needed",
                            fields.path);
    }
}

static void check_objects(struct check *check, const struct server_record *record)
{
    static const char *const faults[SERVER_PARTS][2] = {
        {"the surface's file is missing", "the surface's file is damaged or can't be read"},
        {"the surface's attachment is missing",
         "the surface's attachment is damaged or can't be read"}};
    for (int part = 0; part < SERVER_PARTS; part++) {
        const struct server_object *object = &record->objects[part];
        void *bytes = NULL;
        if (!object->id[0] || server_names_has(&check->sound, object->id)) continue;
        server_names_add(&check->named, object->id);
        enum server_outcome outcome = server_files_read_object(&check->files, object, &bytes);
        free(bytes);
        if (outcome) {
            check_fault(check, faults[part][outcome != SERVER_STORE_ABSENT], record->key);
            continue;
        }
        server_names_add(&check->sound, object->id);
        check->bytes += object->size;
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

static void check_manifest(struct check *check, const struct server_listing *file)
{
    char key[SERVER_KEY_TEXT];
    struct server_sql_surface row;
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
    if (check->database && server_database_find(check->database, key, &row) == SERVER_STORE_ABSENT)
        check->unfinished++;
    server_record_release(record);
}

static bool check_row(void *user, const struct server_sql_value *row)
{
    struct check *check = user;
    const char *key = row[SERVER_ROW_KEY].bytes;
    const struct server_sql_value *text = &row[SERVER_ROW_RECORD];
    struct server_record *record = NULL, *manifest = manifest_read(check, key);
    if (server_record_read(key, text->bytes, text->size, &record) == SERVER_RECORD_READ)
        check->rows++;
    else
        check_fault(check, "the row in the database is damaged", key);
    if (!manifest) {
        check_fault(check, "the row in the database has no manifest that can be read", key);
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
    enum server_outcome outcome =
        server_database_open(path.text, SERVER_DATABASE_READ, &check->database);
    if (!outcome) outcome = server_database_each(check->database, check_row, check);
    struct server_listing manifests = check_folder(check, "manifests");
    while (server_listing_next(&manifests)) check_manifest(check, &manifests);
    bool is_missing = outcome == SERVER_STORE_ABSENT;
    if (is_missing ? check->manifests > 0 : outcome != SERVER_STORE_DONE)
        check_fault(
            check,
            is_missing ? "the database is missing; the next start makes it again from the manifests"
                       : "the database is damaged or can't be read; the next start makes it again "
                         "from the manifests",
            path.text);
}

static void check_batches(struct check *check)
{
    struct server_database *database = NULL;
    const struct server_path path = server_files_path(&check->files, SERVER_SQL_BATCHES);
    enum server_outcome outcome = server_database_open(path.text, SERVER_DATABASE_COPY, &database);
    if (outcome && outcome != SERVER_STORE_ABSENT)
        check_fault(check,
                    "the database of batches is damaged or can't be read; the next start renames "
                    "it, and the batches are lost",
                    path.text);
    server_database_close(database, false);
}

/* --- the whole -------------------------------------------------------------------------------- */

static void print_sums(const struct check *check)
{
    const struct {
        unsigned count;
        const char *text;
    } notes[] = {
        {check->unfinished,
         "surfaces have no row in the database, or an old one: a change was interrupted before it "
         "was acknowledged, or the row could not be written; the next start writes them"},
        {check->leftovers,
         "files are unfinished, or belong to no surface; the next start deletes them"},
        {check->aside,
         "damaged files were renamed (*" SERVER_DISK_ASIDE "*); delete them after the repair"}};
    for (size_t i = 0; i < sizeof notes / sizeof *notes; i++)
        if (notes[i].count) fprintf(check->out, "note: %u %s\n", notes[i].count, notes[i].text);
    fprintf(check->out,
            "%u manifests, %u rows, %zu files (%llu bytes), %u fields verified: %u faults\n",
            check->manifests, check->rows, check->sound.count, check->bytes, check->fields,
            check->faults);
}

bool server_store_check(const char *folder, FILE *out)
{
    struct check check = {.out = out};
    if (!server_files_open_existing(&check.files, folder)) {
        fprintf(out, "%s\n", check.files.error);
        return false;
    }
    check_database(&check);
    check_object_files(&check);
    check_fields(&check);
    check_batches(&check);
    if (check.named.is_incomplete || check.sound.is_incomplete)
        check_fault(&check, "memory is too short to check all files", folder);
    struct server_listing temporary = server_files_list(&check.files, "temporary"), /* if any */
        all = check_folder(&check, "");
    while (server_listing_next(&temporary)) check.leftovers++;
    while (server_listing_next(&all)) check.aside += strstr(all.name, SERVER_DISK_ASIDE) != NULL;
    print_sums(&check);
    server_database_close(check.database, false);
    server_files_close(&check.files);
    server_names_free(&check.named);
    server_names_free(&check.sound);
    return check.faults == 0;
}
