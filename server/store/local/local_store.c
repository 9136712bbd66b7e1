/* The store in a folder, with SQLite and files (local.h): see store.h.
 *
 * DESIGN of the recovery when a store opens. A readable manifest is correct, because it became
 * durable before its row, and is removed only after its row.
 *
 *     manifest     row                cause                             repair
 *     good         the same           none                              none
 *     good         none, other, bad   crash between the two, or a       write the row
 *                                     damaged database
 *     none         good               the manifest was lost             write it
 *     bad          good               the manifest is damaged           rename it, write it again
 *     bad or none  bad or none        both are damaged                  rename it: the surface is
 *                                                                       lost, and the log says so
 *
 * Crashes alone cause only the first two cases. If SQLite reports damage of the database, the
 * database is renamed, and a new one is made from the manifests. Objects are verified when they are
 * loaded. */
#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/log.h"
#include "server/base/names.h"
#include "server/base/thread.h"
#include "server/store/local/local.h"

struct finding { /* a finding of the recovery */
    char key[SERVER_KEY_TEXT];
    struct server_stored stored; /* if it has no record, the surface is lost */
    enum { SOUND, LACKS_ROW, LACKS_MANIFEST } defect;
};

struct local {
    struct server_store store; /* must be the first member */
    struct server_files files;
    /* NULL means that the database is unusable, and the store is read-only */
    struct server_database *database;
    pthread_mutex_t lock;           /* protects `quarantine` and `turn` */
    struct server_names quarantine; /* ids of damaged objects */
    uint64_t turn;                  /* increases when an object leaves the quarantine */
    /* freed after the first visit; findings with a row come first, sorted by key */
    struct finding *findings;
    uint32_t count, capacity;
    /* ids of the objects that the last change removed from a surface; empty means none */
    char left[SERVER_PARTS][SERVER_OBJECT];
    bool lacks_rows; /* true if a repair failed, so that the rows do not list all objects in use */
    atomic_bool is_read_only;
    char reason[512];        /* the reason for is_read_only; set once, before is_read_only */
    atomic_bool was_missing; /* true if the folder was missing at the last check of health */
};

/* --- health ----------------------------------------------------------------------------------- */

/* Makes the store read-only; the formatted text is the reason. Does nothing if the store is
 * read-only already. */
__attribute__((format(printf, 2, 3))) static void local_forbid(struct local *local,
                                                               const char *format, ...)
{
    va_list arguments;
    if (atomic_load(&local->is_read_only)) return;
    va_start(arguments, format);
    vsnprintf(local->reason, sizeof local->reason, format, arguments);
    va_end(arguments);
    atomic_store(&local->is_read_only, true);
    server_log_message(SERVER_LOG_ERROR, "store_read_only", "%s", local->reason);
}

static const char *local_health(struct server_store *store)
{
    static const char missing[] =
        "the data folder, or a part of it (objects, manifests, geodesicd.db), was removed or "
        "replaced under the daemon: put it back, or restart the daemon";
    struct local *local = (struct local *)store;
    if (atomic_load(&local->is_read_only)) return local->reason;
    bool is_missing = !server_files_are_there(&local->files);
    if (atomic_exchange(&local->was_missing, is_missing) != is_missing)
        server_log_message(SERVER_LOG_ERROR, "store_missing", "%s",
                           is_missing ? missing : "the data folder is back");
    return is_missing ? missing : NULL;
}

/* Logs a failed write. Makes the store read-only if another write could do harm. */
static enum server_outcome local_judge(struct local *local, enum server_outcome outcome,
                                       const char *what)
{
    if (outcome == SERVER_STORE_REFUSED)
        server_log_message(SERVER_LOG_ERROR, "store_refused",
                           "%s could not be written (%s): repair the folder", what,
                           strerror(errno));
    if (outcome != SERVER_STORE_READ_ONLY && outcome != SERVER_STORE_DAMAGED) return outcome;
    local_forbid(
        local, "%s could not be written and made durable (%s): repair the disk and restart", what,
        outcome == SERVER_STORE_DAMAGED ? server_database_error(local->database) : strerror(errno));
    return SERVER_STORE_READ_ONLY;
}

/* --- quarantine ------------------------------------------------------------------------------- */

/* Returns true if the object is in quarantine. A reader calls this function before reading the
 * object, and later passes `*turn` to quarantine_condemn. */
static bool quarantine_holds(struct local *local, const char *object, uint64_t *turn)
{
    SERVER_LOCK(&local->lock);
    *turn = local->turn;
    return server_names_has(&local->quarantine, object);
}

/* Puts an object into quarantine. Returns false if memory is short, or if any object, perhaps this
 * one, was rewritten since `turn`. In this case the next reader of the object checks it again. */
static bool quarantine_condemn(struct local *local, const char *object, uint64_t turn)
{
    SERVER_LOCK(&local->lock);
    if (local->turn == turn) server_names_add(&local->quarantine, object);
    return local->turn == turn && server_names_has(&local->quarantine, object);
}

/* Called when an object was rewritten, removed or found undamaged. */
static void quarantine_lift(struct local *local, const char *object)
{
    SERVER_LOCK(&local->lock);
    local->turn++;
    server_names_remove(&local->quarantine, object);
}

static uint32_t local_damaged(struct server_store *store)
{
    struct local *local = (struct local *)store;
    SERVER_LOCK(&local->lock);
    return (uint32_t)local->quarantine.count;
}

/* --- changes ---------------------------------------------------------------------------------- */

static enum server_outcome local_write_objects(struct local *local,
                                               const struct server_record *record,
                                               const struct server_content *content)
{
    enum server_outcome outcome = SERVER_STORE_DONE;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++) {
        const struct server_object *object = &record->objects[part];
        if (!object->id[0]) continue;
        outcome = server_files_write_object(&local->files, object, content->parts[part]);
        if (!outcome) quarantine_lift(local, object->id);
    }
    return local_judge(local, outcome, "a surface's file");
}

/* Removes the objects in local->left, unless a surface uses them. */
static void local_drop_left(struct local *local)
{
    bool knows_rows = !local->is_read_only && !local->lacks_rows;
    int64_t count;
    for (int part = 0; part < SERVER_PARTS; part++) {
        char *object = local->left[part];
        if (*object && knows_rows && !server_database_count(local->database, object, &count) &&
            !count) {
            server_files_remove_object(&local->files, object);
            quarantine_lift(local, object);
        }
        *object = '\0';
    }
}

/* Removes unused objects first, because the ballast may need their space. */
static void local_tidy(struct server_store *store)
{
    struct local *local = (struct local *)store;
    local_drop_left(local);
    if (local->is_read_only) return;
    if (!server_database_is_sound(local->database))
        (void)local_judge(local, SERVER_STORE_READ_ONLY, "the database's log");
    else
        (void)local_judge(local, server_files_load_ballast(&local->files), "the ballast");
}

static void local_leave(struct local *local, const struct server_record *record)
{
    for (int part = 0; part < SERVER_PARTS; part++)
        strcpy(local->left[part], record->objects[part].id);
}

/* Writes manifest and row. The objects are durable already. */
static enum server_outcome local_put_record(struct local *local, const struct server_record *record)
{
    enum server_outcome outcome =
        local_judge(local, server_files_write_manifest(&local->files, record), "a manifest");
    if (outcome) return outcome;
    outcome =
        local_judge(local, server_database_put(local->database, record), "a row of the database");
    if (outcome && outcome != SERVER_STORE_READ_ONLY)
        (void)local_judge(local, server_files_undo_manifest(&local->files, record->key),
                          "a manifest");
    if (!outcome) server_files_settle_manifest(&local->files);
    return outcome;
}

static enum server_outcome local_put(struct server_store *store, const struct server_record *record,
                                     const struct server_content *content, uint64_t *version)
{
    struct local *local = (struct local *)store;
    (void)version;
    struct server_sql_surface before;
    if (local->is_read_only) return SERVER_STORE_READ_ONLY;
    enum server_outcome outcome = local_judge(
        local, server_database_find(local->database, record->key, &before), "the database");
    if (outcome && outcome != SERVER_STORE_ABSENT) return outcome;
    outcome = content ? local_write_objects(local, record, content) : SERVER_STORE_DONE;
    if (!outcome) outcome = local_put_record(local, record);
    if (outcome) {
        local_leave(local, record);
        local_drop_left(local);
    } else {
        memcpy(local->left, before.objects, sizeof local->left);
    }
    return outcome;
}

/* Confirms the stored objects. A read-only store can't repair them; it verifies objects when they
 * are loaded. */
static enum server_outcome local_keep(struct server_store *store,
                                      const struct server_record *record,
                                      const struct server_content *content)
{
    struct local *local = (struct local *)store;
    return local->is_read_only ? SERVER_STORE_DONE : local_write_objects(local, record, content);
}

static enum server_outcome local_remove(struct server_store *store,
                                        const struct server_record *record, uint64_t *version)
{
    struct local *local = (struct local *)store;
    (void)version;
    if (local->is_read_only) return SERVER_STORE_READ_ONLY;
    enum server_outcome outcome = server_database_remove(local->database, record->key);
    /* deleting a row needs space for the database's log, so the ballast is dropped if the disk is
       full */
    if (outcome == SERVER_STORE_FULL && server_files_drop_ballast(&local->files))
        outcome = server_database_remove(local->database, record->key);
    outcome = local_judge(local, outcome, "a row of the database");
    if (outcome) return outcome;
    outcome =
        local_judge(local, server_files_remove_manifest(&local->files, record->key), "a manifest");
    if (outcome == SERVER_STORE_REFUSED)
        local_forbid(local, "a manifest could not be removed (%s): repair the folder and restart",
                     strerror(errno));
    if (outcome) return SERVER_STORE_READ_ONLY;
    local_leave(local, record);
    return SERVER_STORE_DONE;
}

static void local_note_uses(struct server_store *store, const struct server_record *const *records,
                            const struct server_store_uses *uses, uint32_t count)
{
    struct local *local = (struct local *)store;
    if (local->is_read_only) return;
    (void)local_judge(local, server_database_note_uses(local->database, records, uses, count),
                      "a row of the database");
}

/* --- reading ---------------------------------------------------------------------------------- */

static enum server_outcome local_fetch(struct server_store *store,
                                       const struct server_object *object, void **bytes)
{
    struct local *local = (struct local *)store;
    uint64_t turn;
    if (quarantine_holds(local, object->id, &turn)) return SERVER_STORE_DAMAGED;
    enum server_outcome outcome = server_files_read_object(&local->files, object, bytes);
    if (outcome == SERVER_STORE_DAMAGED) (void)quarantine_condemn(local, object->id, turn);
    return outcome;
}

/* Verifies an object, and lifts the quarantine of a repaired one. */
static enum server_outcome local_verify(struct server_store *store,
                                        const struct server_object *object, server_pace *pace,
                                        void *user)
{
    struct local *local = (struct local *)store;
    uint64_t turn;
    bool was_held = quarantine_holds(local, object->id, &turn);
    enum server_outcome outcome = server_files_verify_object(&local->files, object, pace, user);
    if (!outcome && was_held) quarantine_lift(local, object->id);
    if (outcome == SERVER_STORE_DAMAGED && !quarantine_condemn(local, object->id, turn))
        return SERVER_STORE_UNAVAILABLE;
    return outcome;
}

/* --- recovery: findings ----------------------------------------------------------------------- */

static void findings_forget(struct local *local)
{
    for (uint32_t i = 0; i < local->count; i++)
        server_record_release(local->findings[i].stored.record);
    free(local->findings);
    local->findings = NULL;
    local->count = local->capacity = 0;
}

static enum server_outcome local_each(struct server_store *store, server_stored_visit *visit,
                                      void *user)
{
    struct local *local = (struct local *)store;
    for (uint32_t i = 0; i < local->count; i++)
        if (local->findings[i].stored.record && !visit(user, &local->findings[i].stored)) break;
    findings_forget(local);
    return SERVER_STORE_DONE;
}

static int text_compare(const void *a, const void *b) /* a finding begins with its key */
{
    return strcmp(a, b);
}

struct recovery {
    struct local *local;
    uint32_t rows; /* number of findings with a row, which come first */
    bool is_newer, no_memory, is_damaged;
};

static void recovery_note(struct recovery *recovery, enum server_record_reading reading)
{
    recovery->is_newer |= reading == SERVER_RECORD_NEWER;
    recovery->no_memory |= reading == SERVER_RECORD_NO_MEMORY;
}

/* Compares a row with its manifest. A row without a record stands for a missing row. Returns false
 * if out of memory. */
static bool finding_add(void *user, const struct server_sql_value *row)
{
    struct recovery *recovery = user;
    struct local *local = recovery->local;
    struct server_record *of_row = NULL, *manifest = NULL;
    const struct server_sql_value *text = &row[SERVER_ROW_RECORD];
    char checksum[SERVER_SHA256_HEX] = "", of_text[SERVER_SHA256_HEX] = "";
    const char *key = row[SERVER_ROW_KEY].bytes;
    if (local->count == local->capacity) {
        uint32_t capacity = local->capacity ? 2 * local->capacity : 64;
        struct finding *findings = reallocarray(local->findings, capacity, sizeof *findings);
        recovery->no_memory |= !findings;
        if (!findings) return false;
        local->findings = findings;
        local->capacity = capacity;
    }
    recovery_note(recovery, server_files_read_manifest(&local->files, key, &manifest, of_text));
    if (text->bytes) {
        recovery_note(recovery, server_record_read(key, text->bytes, text->size, &of_row));
        server_sha256(text->bytes, text->size, checksum);
    }
    struct finding *finding = &local->findings[local->count++];
    *finding = (struct finding){
        .stored = {.record = manifest ? manifest : of_row,
                   .uses = {(uint64_t)row[SERVER_ROW_USES].integer, row[SERVER_ROW_USED].integer}},
        .defect = !manifest                        ? LACKS_MANIFEST
                  : strcmp(of_text, checksum) != 0 ? LACKS_ROW
                                                   : SOUND};
    snprintf(finding->key, sizeof finding->key, "%s", key);
    if (manifest) server_record_release(of_row);
    return true;
}

static enum server_outcome read_database(struct recovery *recovery, const char *path)
{
    struct local *local = recovery->local;
    enum server_outcome outcome =
        server_database_open(path, SERVER_DATABASE_WRITE, &local->database);
    return outcome ? outcome : server_database_each(local->database, finding_add, recovery);
}

/* Opens the database, or replaces a damaged one. If both fail, the store is read-only. */
static void open_database(struct recovery *recovery)
{
    struct local *local = recovery->local;
    const struct server_path path = server_files_path(&local->files, SERVER_STORE_DATABASE);
    enum server_outcome outcome = read_database(recovery, path.text);
    if (outcome == SERVER_STORE_FULL && server_files_drop_ballast(&local->files))
        outcome = read_database(recovery, path.text);
    if (outcome == SERVER_STORE_DAMAGED || outcome == SERVER_STORE_READ_ONLY) {
        char suffix[SERVER_DISK_ASIDE_SUFFIX];
        findings_forget(local);
        server_database_close(local->database, false);
        local->database = NULL;
        server_disk_set_aside(path.text, suffix);
        server_log_message(SERVER_LOG_ERROR, "store_database_damaged",
                           "the database is damaged: it was renamed to geodesicd.db%s, a new one "
                           "is made from the manifests",
                           suffix);
        outcome = read_database(recovery, path.text);
    }
    recovery->rows = local->count;
    if (!outcome) outcome = server_disk_sync_folder(local->files.folder);
    if (!outcome) return;
    server_database_close(local->database, false);
    local->database = NULL;
    local_forbid(local, "the database '%s' can't be opened or made (%s): repair that and restart",
                 path.text, outcome == SERVER_STORE_FULL ? "the disk is full" : strerror(errno));
}

/* --- recovery: repairs ------------------------------------------------------------------------ */

/* Logs a repair; `what` is the file or row that was written. */
static void log_repair(struct local *local, const struct finding *finding,
                       enum server_outcome outcome, const char *what, const char *message)
{
    struct server_log_line line;
    if (server_log_begin(&line, SERVER_LOG_WARN, "store_mended")) {
        server_log_text(&line, "key", finding->key);
        server_log_text(&line, "message", message);
        if (outcome)
            server_log_text(&line, "failure",
                            "it could not be written; the next start tries again");
        server_log_end(&line);
    }
    if (outcome == SERVER_STORE_READ_ONLY)
        local_forbid(local, "%s could not be made durable", what);
}

static void repair_row(struct local *local, const struct finding *finding)
{
    enum server_outcome outcome = local->database
                                      ? server_database_put(local->database, finding->stored.record)
                                      : SERVER_STORE_READ_ONLY;
    local->lacks_rows |= outcome != SERVER_STORE_DONE;
    log_repair(local, finding, outcome, "a row of the database",
               "its row in the database was written again from its manifest");
}

static void repair_manifest(struct recovery *recovery, const struct finding *finding)
{
    struct local *local = recovery->local;
    const struct server_path path = server_files_manifest_path(&local->files, finding->key);
    char suffix[SERVER_DISK_ASIDE_SUFFIX];
    recovery->is_damaged |= !finding->stored.record || server_disk_exists(path.text);
    server_disk_set_aside(path.text, suffix);
    if (finding->stored.record) {
        log_repair(local, finding,
                   server_files_write_manifest(&local->files, finding->stored.record), "a manifest",
                   "its manifest was missing or damaged, and was written again from its row in the "
                   "database");
        return;
    }
    if (local->database) (void)server_database_remove(local->database, finding->key);
    server_log_message(SERVER_LOG_ERROR, "store_lost",
                       "the surface '%s' is lost: its manifest and its row in the database are "
                       "damaged; its bytes are kept",
                       finding->key);
}

/* Removes the objects that no surface has. */
static void collect_objects(const struct local *local)
{
    struct server_names used = {0};
    for (uint32_t i = 0; i < local->count; i++)
        for (int part = 0; part < SERVER_PARTS; part++)
            server_names_add(&used, local->findings[i].stored.record->objects[part].id);
    struct server_listing folders = server_files_list(&local->files, "objects");
    while (server_listing_next(&folders)) {
        struct server_listing objects = server_disk_list(folders.path);
        while (server_listing_next(&objects))
            if (!used.is_incomplete && server_files_object_check(objects.name) &&
                !server_names_has(&used, objects.name))
                server_files_remove_object(&local->files, objects.name);
    }
    server_names_free(&used);
}

/* Finds all surfaces of the folder and repairs manifests and rows. On failure, returns false with a
 * sentence. */
static bool recovery_run(struct local *local, char error[SERVER_ERROR])
{
    struct recovery recovery = {.local = local};
    char key[SERVER_KEY_TEXT] = "";
    struct server_listing temporary = server_files_list(&local->files, "temporary");
    while (server_listing_next(&temporary)) (void)unlink(temporary.path);
    open_database(&recovery);
    struct server_listing manifests = server_files_list(&local->files, "manifests");
    while (server_listing_next(&manifests)) {
        if (!server_files_manifest_key(manifests.name, key)) continue;
        const struct server_sql_value none[SERVER_SQL_VALUES] = {server_sql_text(key)};
        if (!recovery.rows ||
            !bsearch(key, local->findings, recovery.rows, sizeof *local->findings, text_compare))
            (void)finding_add(&recovery, none);
    }
    if (recovery.is_newer)
        snprintf(error, SERVER_ERROR, "a later version of geodesicd wrote into '%s': run that one",
                 local->files.folder);
    if (recovery.is_newer || recovery.no_memory) return false; /* the caller has set `error` */
    if (local->count) qsort(local->findings, local->count, sizeof *local->findings, text_compare);
    for (uint32_t i = 0; i < local->count; i++)
        if (local->findings[i].defect == LACKS_ROW)
            repair_row(local, &local->findings[i]);
        else if (local->findings[i].defect == LACKS_MANIFEST)
            repair_manifest(&recovery, &local->findings[i]);
    /* after damage all objects are kept, because an operator may repair the store */
    if (recovery.is_damaged || local->is_read_only) return true;
    collect_objects(local);
    if (server_files_load_ballast(&local->files) == SERVER_STORE_READ_ONLY)
        local_forbid(local, "the ballast could not be made durable");
    return true;
}

/* --- open and close --------------------------------------------------------------------------- */

static void local_close(struct server_store *store)
{
    struct local *local = (struct local *)store;
    findings_forget(local);
    server_database_close(local->database, !local->is_read_only);
    server_files_close(&local->files);
    server_names_free(&local->quarantine);
    pthread_mutex_destroy(&local->lock);
    free(local);
}

struct server_store *server_store_local_open(const char *folder, char error[SERVER_ERROR])
{
    struct local *local = calloc(1, sizeof *local);
    snprintf(error, SERVER_ERROR, "out of memory");
    if (!local) return NULL;
    local->store = (struct server_store){.each = local_each,
                                         .put = local_put,
                                         .keep = local_keep,
                                         .remove = local_remove,
                                         .tidy = local_tidy,
                                         .fetch = local_fetch,
                                         .verify = local_verify,
                                         .damaged = local_damaged,
                                         .note_uses = local_note_uses,
                                         .health = local_health,
                                         .close = local_close};
    pthread_mutex_init(&local->lock, NULL);
    if (!server_files_open(&local->files, folder))
        snprintf(error, SERVER_ERROR, "%s", local->files.error);
    else if (recovery_run(local, error))
        return &local->store;
    local_close(&local->store);
    return NULL;
}
