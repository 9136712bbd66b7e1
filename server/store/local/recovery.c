/* Recovery: how a local store opens, whatever the last process left behind, and whatever happened
 * to the files since.
 *
 * DESIGN. A manifest that can be read tells the truth: it was durable before its row, and is
 * removed only after its row. manifest     row                  what it was what is done good the
 * same             nothing                            nothing good         none, other, bad     a
 * crash between the two, or a      the row is written damaged database none         good a manifest
 * was lost                it is written bad          good                 a damaged manifest it is
 * put aside and written again bad or none  bad or none          both are damaged put aside: that
 * name is lost, and said so Crashes alone lead only to the first two rows. A database that SQLite
 * can't vouch for is put aside, and a new one is made from the manifests. Objects are verified when
 * they are loaded. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/log.h"
#include "server/store/local/local_store.h"

struct finding {
    char key[SERVER_KEY_TEXT];
    struct server_record *row, *manifest; /* NULL: none, or damaged */
    bool has_row, has_manifest, differ;
    struct server_store_uses uses;
    char checksum[SERVER_SHA256_HEX]; /* of the row's text */
};

struct recovery {
    struct server_store_local *local;
    struct finding *findings;
    uint32_t count, sorted, capacity; /* the first `sorted` are in order of their keys */
    char (*used)[SERVER_OBJECT];      /* ids of the objects that a surface has, sorted */
    size_t used_count;
    bool is_newer, no_memory, lost_some;
};

/* --- findings --------------------------------------------------------------------------------- */

static int by_key(const void *a, const void *b)
{
    return strcmp(((const struct finding *)a)->key, ((const struct finding *)b)->key);
}

static struct finding *add_finding(struct recovery *recovery, const char *key)
{
    if (recovery->count == recovery->capacity) {
        uint32_t capacity = recovery->capacity ? 2 * recovery->capacity : 64;
        struct finding *findings = realloc(recovery->findings, capacity * sizeof *findings);
        recovery->no_memory |= !findings;
        if (!findings) return NULL;
        recovery->findings = findings;
        recovery->capacity = capacity;
    }
    struct finding *finding = &recovery->findings[recovery->count++];
    memset(finding, 0, sizeof *finding);
    snprintf(finding->key, sizeof finding->key, "%s", key);
    return finding;
}

static struct finding *find_or_add(struct recovery *recovery, const char *key)
{
    struct finding sought;
    snprintf(sought.key, sizeof sought.key, "%s", key);
    struct finding *found = recovery->sorted ? bsearch(&sought, recovery->findings,
                                                       recovery->sorted, sizeof sought, by_key)
                                             : NULL;
    return found ? found : add_finding(recovery, key);
}

/* What the reading of a record tells of the whole. */
static void note_reading(struct recovery *recovery, enum server_record_reading reading)
{
    recovery->is_newer |= reading == SERVER_RECORD_NEWER;
    recovery->no_memory |= reading == SERVER_RECORD_NO_MEMORY;
}

/* --- rows ------------------------------------------------------------------------------------- */

static bool on_row(void *user, const struct server_row *row)
{
    struct recovery *recovery = user;
    struct finding *finding = add_finding(recovery, row->key);
    if (!finding) return false;
    finding->has_row = true;
    finding->uses = row->uses;
    note_reading(recovery, server_record_read_named(row->key, row->text, row->size, &finding->row));
    server_sha256(row->text, row->size, finding->checksum);
    return true;
}

/* --- the database ----------------------------------------------------------------------------- */

static void move_database_aside(const char *path)
{
    char suffix[SERVER_DISK_ASIDE_SUFFIX];
    server_disk_set_aside(path, server_disk_database_parts, suffix);
    server_log_message(SERVER_LOG_ERROR, "store_database_damaged",
                       "the database is damaged: it was renamed to geodesicd.db%s, a new one is "
                       "made from the manifests",
                       suffix);
}

static enum server_store_outcome read_database(struct recovery *recovery, const char *path)
{
    struct server_store_local *local = recovery->local;
    enum server_store_outcome outcome = server_database_open(path, &local->database);
    if (!outcome) outcome = server_database_each(local->database, on_row, recovery);
    return outcome;
}

static void forget_findings(struct recovery *recovery)
{
    for (uint32_t i = 0; i < recovery->count; i++) {
        server_record_release(recovery->findings[i].row);
        server_record_release(recovery->findings[i].manifest);
    }
    recovery->count = 0;
}

/* Opens the database, or a new one in its place; without either the store is read-only. */
static void open_database(struct recovery *recovery)
{
    struct server_store_local *local = recovery->local;
    char path[SERVER_DISK_PATH];
    server_files_path(&local->files, path, "geodesicd.db");
    enum server_store_outcome outcome = read_database(recovery, path);
    if (outcome == SERVER_STORE_FULL && server_files_drop_ballast(&local->files))
        outcome = read_database(recovery, path);
    if (outcome == SERVER_STORE_DAMAGED || outcome == SERVER_STORE_READ_ONLY) {
        forget_findings(recovery);
        server_database_close(local->database, false);
        local->database = NULL;
        move_database_aside(path);
        outcome = read_database(recovery, path);
    }
    recovery->sorted = recovery->count;
    if (!outcome) outcome = server_files_outcome(server_disk_sync_folder(local->files.folder));
    if (!outcome) return;
    server_database_close(local->database, false);
    local->database = NULL;
    server_local_forbid(local,
                        "the database '%s' can't be opened or made (%s): mend that and restart",
                        path, outcome == SERVER_STORE_FULL ? "the disk is full" : strerror(errno));
}

/* --- manifests -------------------------------------------------------------------------------- */

static void on_manifest(void *user, const char *path, const char *file)
{
    struct recovery *recovery = user;
    char key[SERVER_KEY_TEXT], checksum[SERVER_SHA256_HEX] = "";
    (void)path;
    struct finding *finding =
        server_files_manifest_key(file, key) ? find_or_add(recovery, key) : NULL;
    if (!finding) return;
    finding->has_manifest = true;
    note_reading(recovery, server_files_read_manifest(&recovery->local->files, key,
                                                      &finding->manifest, checksum));
    finding->differ = strcmp(checksum, finding->checksum) != 0;
}

/* Visits what is in one of the store's folders. */
static void each_file(struct recovery *recovery, const char *folder,
                      void (*visit)(void *user, const char *path, const char *file))
{
    char path[SERVER_DISK_PATH];
    server_files_path(&recovery->local->files, path, folder);
    (void)server_disk_each(path, visit, recovery);
}

/* --- mending ---------------------------------------------------------------------------------- */

static void say(const struct finding *finding, enum server_store_outcome outcome, const char *what)
{
    struct server_log_line line;
    if (!server_log_begin(&line, SERVER_LOG_WARN, "store_mended")) return;
    server_log_text(&line, "key", finding->key);
    server_log_text(&line, "message", what);
    if (outcome)
        server_log_text(&line, "failure",
                        "it could not be written; it is tried again at the next start");
    server_log_end(&line);
}

/* A row that can't be mended leaves a database that doesn't know who has which bytes: so none are
 * thrown away. */
static void mend_row(struct server_store_local *local, const struct finding *finding)
{
    enum server_store_outcome outcome =
        local->database ? server_database_put(local->database, finding->manifest)
                        : SERVER_STORE_READ_ONLY;
    local->lacks_rows |= outcome != SERVER_STORE_DONE;
    say(finding, outcome, "its row in the database was written again from its manifest");
    if (outcome == SERVER_STORE_READ_ONLY)
        server_local_forbid(local, "a row of the database could not be made durable");
}

static void put_manifest_aside(struct recovery *recovery, const struct finding *finding)
{
    static const char *const parts[] = {"", NULL};
    char path[SERVER_DISK_PATH], suffix[SERVER_DISK_ASIDE_SUFFIX];
    server_files_manifest_path(&recovery->local->files, path, finding->key);
    server_disk_set_aside(path, parts, suffix);
    recovery->lost_some = true;
}

static void mend_manifest(struct recovery *recovery, const struct finding *finding)
{
    struct server_store_local *local = recovery->local;
    if (finding->has_manifest) put_manifest_aside(recovery, finding);
    enum server_store_outcome outcome = server_files_write_manifest(&local->files, finding->row);
    say(finding, outcome,
        "its manifest was missing or damaged, and was written again from its row in the database");
    if (outcome == SERVER_STORE_READ_ONLY)
        server_local_forbid(local, "a manifest could not be made durable");
}

static void give_up(struct recovery *recovery, const struct finding *finding)
{
    struct server_store_local *local = recovery->local;
    if (finding->has_manifest) put_manifest_aside(recovery, finding);
    if (finding->has_row && local->database)
        (void)server_database_remove(local->database, finding->key);
    recovery->lost_some = true;
    server_log_message(SERVER_LOG_ERROR, "store_lost",
                       "the surface '%s' is lost: its manifest and its row in the database are "
                       "damaged; its bytes are kept",
                       finding->key);
}

/* Mends what the table above tells; the record that counts, or NULL. */
static struct server_record *settle(struct recovery *recovery, const struct finding *finding)
{
    if (finding->manifest) {
        if (finding->differ) mend_row(recovery->local, finding);
        return finding->manifest;
    }
    if (finding->row)
        mend_manifest(recovery, finding);
    else
        give_up(recovery, finding);
    return finding->row;
}

static bool settle_all(struct recovery *recovery)
{
    struct server_store_local *local = recovery->local;
    if (recovery->count)
        qsort(recovery->findings, recovery->count, sizeof *recovery->findings, by_key);
    local->found = calloc(recovery->count + 1, sizeof *local->found);
    if (!local->found) return false;
    for (uint32_t i = 0; i < recovery->count; i++) {
        struct server_record *record = settle(recovery, &recovery->findings[i]);
        if (!record) continue;
        local->found[local->found_count++] = (struct server_stored){
            .record = server_record_retain(record), .uses = recovery->findings[i].uses};
    }
    return true;
}

/* --- what nothing refers to ------------------------------------------------------------------- */

static void on_temporary(void *user, const char *path, const char *file)
{
    (void)user, (void)file;
    (void)unlink(path);
}

static int by_text(const void *a, const void *b)
{
    return strcmp(a, b);
}

/* Finds the ids of the objects that the surfaces have. False without memory. */
static bool find_used_objects(struct recovery *recovery)
{
    const struct server_store_local *local = recovery->local;
    struct server_object object;
    recovery->used =
        malloc((SERVER_PARTS * (size_t)local->found_count + 1) * sizeof *recovery->used);
    if (!recovery->used) return false;
    for (uint32_t i = 0; i < local->found_count; i++)
        for (int part = 0; part < SERVER_PARTS; part++)
            if (server_record_object(local->found[i].record, part, &object))
                strcpy(recovery->used[recovery->used_count++], object.id);
    qsort(recovery->used, recovery->used_count, sizeof *recovery->used, by_text);
    return true;
}

static void on_object(void *user, const char *path, const char *file)
{
    const struct recovery *recovery = user;
    (void)path;
    if (server_files_object_check(file) &&
        !bsearch(file, recovery->used, recovery->used_count, sizeof *recovery->used, by_text))
        server_files_remove_object(&recovery->local->files, file);
}

static void on_object_folder(void *user, const char *path, const char *file)
{
    (void)file;
    (void)server_disk_each(path, on_object, user);
}

/* After damage nothing is thrown away: it may be what somebody can mend by hand. */
static void collect(struct recovery *recovery)
{
    if (recovery->lost_some || recovery->local->is_read_only) return;
    if (find_used_objects(recovery)) each_file(recovery, "objects", on_object_folder);
    free(recovery->used);
    if (server_files_load_ballast(&recovery->local->files) == SERVER_STORE_READ_ONLY)
        server_local_forbid(recovery->local, "the ballast could not be made durable");
}

/* --- the whole -------------------------------------------------------------------------------- */

static bool recover(struct recovery *recovery, char *error, size_t error_size)
{
    const struct server_store_files *files = &recovery->local->files;
    each_file(recovery, "temporary", on_temporary);
    open_database(recovery);
    each_file(recovery, "manifests", on_manifest);
    if (recovery->is_newer) {
        snprintf(error, error_size, "a later version of geodesicd wrote into '%s': run that one",
                 files->folder);
        return false;
    }
    if (recovery->no_memory || !settle_all(recovery)) return false; /* the caller has said why */
    collect(recovery);
    return true;
}

bool server_local_recover(struct server_store_local *local, char *error, size_t error_size)
{
    struct recovery recovery = {.local = local};
    bool recovered = recover(&recovery, error, error_size);
    forget_findings(&recovery);
    free(recovery.findings);
    return recovered;
}
