/* See store.h: --backup and --restore, which differ only in how they copy objects.
 *
 * The command copies the database in its state of one moment, and then the objects that its rows
 * name. If an object was deleted meanwhile, the copy starts again. The batches are copied first, so
 * that the copy has the surfaces that the batches query, unless these surfaces were removed later.
 *
 * The copy's folder has a marker until the last file is durable. No daemon starts on an interrupted
 * copy. Running the same command again completes the copy. */
#include <unistd.h>

#include "server/store/local/local.h"

#define ATTEMPTS 20

struct backup {
    FILE *out;
    struct server_files from, to; /* `from` is not locked */
    server_disk_copier *copy;
    enum server_outcome outcome;
    unsigned surfaces;
    unsigned long long bytes;
};

/* Ends the visit of rows. Does not print the outcome ABSENT, because it leads to another
 * attempt. */
static bool give_up(struct backup *backup, enum server_outcome outcome, const char *what,
                    const char *name)
{
    backup->outcome = outcome;
    if (outcome != SERVER_STORE_ABSENT) fprintf(backup->out, "%s: %s\n", what, name);
    return false;
}

static struct server_record *row_read(struct backup *backup, const struct server_sql_value *row)
{
    struct server_record *record = NULL;
    const struct server_sql_value *text = &row[SERVER_ROW_RECORD];
    if (server_record_read(NULL, text->bytes, text->size, &record) != SERVER_RECORD_READ)
        (void)give_up(backup, SERVER_STORE_DAMAGED, "a row of the database is damaged",
                      row[SERVER_ROW_KEY].bytes);
    return record;
}

static bool on_row_objects(void *user, const struct server_sql_value *row)
{
    struct backup *backup = user;
    struct server_record *record = row_read(backup, row);
    enum server_outcome outcome = SERVER_STORE_DONE;
    if (!record) return false;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++) {
        const struct server_object *object = &record->objects[part];
        if (object->id[0])
            outcome = server_files_copy_object(&backup->to, &backup->from, object, backup->copy);
        backup->bytes += object->size;
    }
    backup->surfaces++;
    server_record_release(record);
    return !outcome || give_up(backup, outcome, "an uploaded file is damaged, or can't be copied",
                               row[SERVER_ROW_KEY].bytes);
}

static bool on_row_manifest(void *user, const struct server_sql_value *row)
{
    struct backup *backup = user;
    struct server_record *record = row_read(backup, row);
    if (!record) return false;
    enum server_outcome outcome = server_files_write_manifest(&backup->to, record);
    server_record_release(record);
    return !outcome ||
           give_up(backup, outcome, "a manifest can't be written", row[SERVER_ROW_KEY].bytes);
}

static enum server_outcome database_copy(const struct backup *backup, const char *name,
                                         enum server_database_use use)
{
    struct server_database *database;
    const struct server_path from = server_files_path(&backup->from, "%s", name),
                             to = server_files_path(&backup->to, "%s", name);
    if (server_database_open(from.text, use, &database)) {
        fprintf(backup->out, "the database '%s' is damaged, or can't be read\n", from.text);
        return SERVER_STORE_REFUSED;
    }
    enum server_outcome outcome = server_database_copy(database, to.text);
    if (outcome) fprintf(backup->out, "the database can't be copied to '%s'\n", to.text);
    server_database_close(database, false);
    return outcome == SERVER_STORE_ABSENT ? SERVER_STORE_REFUSED : outcome;
}

/* Copies the state of the store at one moment. Returns ABSENT if an object was deleted
 * meanwhile. */
static enum server_outcome moment_copy(struct backup *backup)
{
    struct server_database *database;
    const struct server_path path = server_files_path(&backup->to, SERVER_STORE_DATABASE);
    unlink(path.text);
    backup->surfaces = 0;
    backup->bytes = 0;
    backup->outcome = SERVER_STORE_DONE;
    enum server_outcome outcome =
        database_copy(backup, SERVER_STORE_DATABASE, SERVER_DATABASE_READ);
    if (!outcome) outcome = server_database_open(path.text, SERVER_DATABASE_WRITE, &database);
    if (outcome) return outcome;
    outcome = server_database_each(database, on_row_objects, backup);
    if (!outcome && !backup->outcome)
        outcome = server_database_each(database, on_row_manifest, backup);
    server_database_close(database, true);
    return outcome ? outcome : backup->outcome;
}

static bool store_copy(struct backup *backup)
{
    enum server_outcome outcome = SERVER_STORE_ABSENT;
    bool has_batches =
        server_disk_exists(server_files_path(&backup->from, SERVER_SQL_BATCHES).text);
    if (has_batches && database_copy(backup, SERVER_SQL_BATCHES, SERVER_DATABASE_COPY))
        outcome = SERVER_STORE_REFUSED;
    for (int attempt = 0; outcome == SERVER_STORE_ABSENT && attempt < ATTEMPTS; attempt++)
        outcome = moment_copy(backup);
    if (outcome == SERVER_STORE_ABSENT)
        fprintf(backup->out,
                "an uploaded file is missing, or surfaces change too fast: see --check-store\n");
    if (!outcome && server_files_finish(&backup->to) == SERVER_STORE_DONE) return true;
    fprintf(backup->out,
            "no copy was made: '%s' is unfinished; repeat the command, or delete the folder\n",
            backup->to.folder);
    return false;
}

static bool folder_copy(struct backup *backup, const char *folder, const char *copy)
{
    bool is_found = server_files_find(&backup->from, folder);
    if (!is_found || !server_files_open_copy(&backup->to, copy)) {
        fprintf(backup->out, "%s\n", is_found ? backup->to.error : backup->from.error);
        return false;
    }
    bool is_copied = store_copy(backup);
    if (is_copied)
        fprintf(backup->out, "%u surfaces, %llu bytes, copied from '%s' to '%s'\n",
                backup->surfaces, backup->bytes, folder, copy);
    server_files_close(&backup->to);
    return is_copied;
}

bool server_store_backup(const char *folder, const char *copy, FILE *out)
{
    return folder_copy(&(struct backup){.out = out, .copy = server_disk_link}, folder, copy);
}

bool server_store_restore(const char *folder, const char *backup, FILE *out)
{
    struct server_files files;
    if (!server_files_open_existing(&files, backup)) {
        fprintf(out, "%s\n", files.error);
        return false;
    }
    bool is_restored =
        folder_copy(&(struct backup){.out = out, .copy = server_disk_copy}, backup, folder);
    server_files_close(&files);
    return is_restored;
}
