/* See store.h: the store in a folder, with SQLite and files (files.h).
 *
 * DESIGN of the recovery, when a store opens. A readable manifest is true: it was durable before
 * its row, and is removed only after its row.
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
 * Crashes alone lead to the first two rows only. A database that SQLite finds damaged is renamed,
 * and a new one is made from the manifests. Objects are verified when they are loaded. */
#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/log.h"
#include "server/store/local/database.h"
#include "server/store/local/files.h"

struct local {
    struct server_store store; /* first */
    struct server_files files;
    struct server_database *database; /* NULL: it can't be opened or made, and nothing is written */
    struct quarantine {
        pthread_mutex_t lock;
        struct condemned *first;
        uint32_t count;
        uint64_t turn; /* number of lifts */
    } quarantine;
    struct server_stored *found; /* by the recovery; freed after the first visit */
    uint32_t found_count;
    /* ids of objects that the last change took from a surface; empty: none */
    char left[SERVER_PARTS][SERVER_OBJECT];
    bool lacks_rows; /* a repair failed: the database does not know which objects are in use */
    atomic_bool is_read_only;
    char reason[512];        /* of is_read_only; set before it, once */
    atomic_bool was_missing; /* the folder, when its health was last checked */
};

/* --- health ----------------------------------------------------------------------------------- */

/* Ends all writing; the first reason stays. */
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
        "replaced under the daemon: put it back, or restart on what there is";
    struct local *local = (struct local *)store;
    if (atomic_load(&local->is_read_only)) return local->reason;
    bool is_missing = !server_files_are_there(&local->files);
    if (atomic_exchange(&local->was_missing, is_missing) != is_missing)
        server_log_message(SERVER_LOG_ERROR, "store_missing", "%s",
                           is_missing ? missing : "the data folder is back");
    return is_missing ? missing : NULL;
}

/* Logs a failed write, and ends all writing if more could do harm. */
static enum server_store_outcome local_judge(struct local *local, enum server_store_outcome outcome,
                                             const char *what)
{
    if (outcome == SERVER_STORE_REFUSED)
        server_log_message(SERVER_LOG_ERROR, "store_refused",
                           "%s could not be written (%s): mend the folder", what, strerror(errno));
    if (outcome != SERVER_STORE_READ_ONLY && outcome != SERVER_STORE_DAMAGED) return outcome;
    local_forbid(
        local, "%s could not be written and made durable (%s): mend the disk and restart", what,
        outcome == SERVER_STORE_DAMAGED ? server_database_error(local->database) : strerror(errno));
    return SERVER_STORE_READ_ONLY;
}

/* --- quarantine: ids of damaged objects, which are not read again ----------------------------- */

struct condemned {
    struct condemned *next;
    char object[SERVER_OBJECT];
};

/* Under the lock. The pointer to the object's entry, or to the end of the list. */
static struct condemned **quarantine_find(struct quarantine *quarantine, const char *object)
{
    struct condemned **place = &quarantine->first;
    while (*place && strcmp((*place)->object, object) != 0) place = &(*place)->next;
    return place;
}

/* Returns whether the object is in quarantine, and the turn, which a reader takes before it reads
 * and passes to quarantine_condemn. */
static bool quarantine_holds(struct local *local, const char *object, uint64_t *turn)
{
    struct quarantine *quarantine = &local->quarantine;
    pthread_mutex_lock(&quarantine->lock);
    bool is_held = *quarantine_find(quarantine, object) != NULL;
    *turn = quarantine->turn;
    pthread_mutex_unlock(&quarantine->lock);
    return is_held;
}

/* False: a file was written again since the turn, maybe this one, or there is no memory. The next
 * reader condemns the object. */
static bool quarantine_condemn(struct local *local, const char *object, uint64_t turn)
{
    struct quarantine *quarantine = &local->quarantine;
    pthread_mutex_lock(&quarantine->lock);
    struct condemned **place = quarantine_find(quarantine, object);
    if (quarantine->turn == turn && !*place && (*place = calloc(1, sizeof **place))) {
        strcpy((*place)->object, object);
        quarantine->count++;
    }
    bool is_held = quarantine->turn == turn && *place;
    pthread_mutex_unlock(&quarantine->lock);
    return is_held;
}

/* The object was written again, removed, or found sound. */
static void quarantine_lift(struct local *local, const char *object)
{
    struct quarantine *quarantine = &local->quarantine;
    pthread_mutex_lock(&quarantine->lock);
    struct condemned **place = quarantine_find(quarantine, object), *lifted = *place;
    quarantine->turn++;
    if (lifted) {
        *place = lifted->next;
        quarantine->count--;
    }
    pthread_mutex_unlock(&quarantine->lock);
    free(lifted);
}

static uint32_t local_damaged(struct server_store *store)
{
    struct quarantine *quarantine = &((struct local *)store)->quarantine;
    pthread_mutex_lock(&quarantine->lock);
    uint32_t count = quarantine->count;
    pthread_mutex_unlock(&quarantine->lock);
    return count;
}

/* --- changes ---------------------------------------------------------------------------------- */

static enum server_store_outcome local_write_objects(struct local *local,
                                                     const struct server_record *record,
                                                     const struct server_content *content)
{
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    struct server_object object;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++) {
        if (!server_record_object(record, part, &object)) continue;
        outcome = server_files_write_object(&local->files, &object, content->parts[part]);
        if (!outcome) quarantine_lift(local, object.id);
    }
    return local_judge(local, outcome, "a surface's file");
}

/* Removes an object that no surface has. */
static void local_drop(struct local *local, const char *object)
{
    int64_t count;
    if (local->is_read_only || local->lacks_rows ||
        server_database_count(local->database, object, &count) || count)
        return;
    server_files_remove_object(&local->files, object);
    quarantine_lift(local, object);
}

static void local_drop_left(struct local *local)
{
    for (int part = 0; part < SERVER_PARTS; part++) {
        if (local->left[part][0]) local_drop(local, local->left[part]);
        local->left[part][0] = '\0';
    }
}

/* After the bytes: the ballast may need their room. */
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
    struct server_object object;
    for (int part = 0; part < SERVER_PARTS; part++)
        strcpy(local->left[part], server_record_object(record, part, &object) ? object.id : "");
}

/* Writes manifest and row; the objects are durable. */
static enum server_store_outcome local_put_record(struct local *local,
                                                  const struct server_record *record)
{
    enum server_store_outcome outcome =
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

static enum server_store_outcome local_put(struct server_store *store,
                                           const struct server_record *record,
                                           const struct server_content *content, uint64_t *version)
{
    struct local *local = (struct local *)store;
    (void)version;
    char before[SERVER_PARTS][SERVER_OBJECT] = {""};
    if (local->is_read_only) return SERVER_STORE_READ_ONLY;
    enum server_store_outcome outcome = local_judge(
        local, server_database_find(local->database, record->key, before), "the database");
    if (outcome && outcome != SERVER_STORE_ABSENT) return outcome;
    outcome = local_write_objects(local, record, content);
    if (!outcome) outcome = local_put_record(local, record);
    if (outcome) {
        local_leave(local, record);
        local_drop_left(local);
    } else {
        memcpy(local->left, before, sizeof before);
    }
    return outcome;
}

/* A read-only store can't write: whether the objects are sound shows when they are loaded. */
static enum server_store_outcome local_keep(struct server_store *store,
                                            const struct server_record *record,
                                            const struct server_content *content)
{
    struct local *local = (struct local *)store;
    return local->is_read_only ? SERVER_STORE_DONE : local_write_objects(local, record, content);
}

static enum server_store_outcome local_remove(struct server_store *store,
                                              const struct server_record *record, uint64_t *version)
{
    struct local *local = (struct local *)store;
    (void)version;
    if (local->is_read_only) return SERVER_STORE_READ_ONLY;
    enum server_store_outcome outcome = server_database_remove(local->database, record->key);
    /* the database's log grows, if need be into the room of the ballast */
    if (outcome == SERVER_STORE_FULL && server_files_drop_ballast(&local->files))
        outcome = server_database_remove(local->database, record->key);
    outcome = local_judge(local, outcome, "a row of the database");
    if (outcome) return outcome;
    outcome =
        local_judge(local, server_files_remove_manifest(&local->files, record->key), "a manifest");
    if (outcome == SERVER_STORE_REFUSED)
        local_forbid(local, "a manifest could not be removed (%s): mend the folder and restart",
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

static enum server_store_outcome local_fetch(struct server_store *store,
                                             const struct server_record *record,
                                             enum server_part part, void **bytes)
{
    struct local *local = (struct local *)store;
    struct server_object object;
    uint64_t turn;
    if (!server_record_object(record, part, &object)) return SERVER_STORE_ABSENT;
    if (quarantine_holds(local, object.id, &turn)) return SERVER_STORE_DAMAGED;
    enum server_store_outcome outcome = server_files_read_object(&local->files, &object, bytes);
    if (outcome == SERVER_STORE_DAMAGED) (void)quarantine_condemn(local, object.id, turn);
    return outcome;
}

/* Lifts the quarantine of a file that somebody has repaired. */
static enum server_store_verdict local_verify(struct server_store *store,
                                              const struct server_record *record,
                                              enum server_part part, server_pace *pace, void *user)
{
    struct local *local = (struct local *)store;
    struct server_object object;
    uint64_t turn;
    if (!server_record_object(record, part, &object)) return SERVER_VERDICT_MISSING;
    bool was_held = quarantine_holds(local, object.id, &turn);
    enum server_store_verdict verdict =
        server_files_verify_object(&local->files, &object, pace, user);
    if (verdict == SERVER_VERDICT_SOUND && was_held) quarantine_lift(local, object.id);
    if (verdict == SERVER_VERDICT_DAMAGED && !quarantine_condemn(local, object.id, turn))
        return SERVER_VERDICT_NONE;
    return verdict;
}

static void local_forget_found(struct local *local)
{
    for (uint32_t i = 0; i < local->found_count; i++) server_record_release(local->found[i].record);
    free(local->found);
    local->found = NULL;
    local->found_count = 0;
}

static enum server_store_outcome local_each(struct server_store *store, server_stored_visit *visit,
                                            void *user)
{
    struct local *local = (struct local *)store;
    for (uint32_t i = 0; i < local->found_count; i++)
        if (!visit(user, &local->found[i])) break;
    local_forget_found(local);
    return SERVER_STORE_DONE;
}

/* --- recovery: what there is ------------------------------------------------------------------ */

struct finding {
    char key[SERVER_KEY_TEXT];
    struct server_record *row, *manifest; /* NULL: none, or damaged */
    bool has_row, has_manifest, differ;
    struct server_store_uses uses;
    char checksum[SERVER_SHA256_HEX]; /* of the row's text */
};

struct recovery {
    struct local *local;
    struct finding *findings;
    uint32_t count, sorted, capacity; /* the first `sorted` are sorted by key */
    bool is_newer, no_memory, lost_some;
};

static int text_compare(const void *a, const void *b) /* a finding begins with its key */
{
    return strcmp(a, b);
}

static struct finding *finding_add(struct recovery *recovery, const char *key)
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

/* Notes what the reading of one record means for the store. */
static void recovery_note(struct recovery *recovery, enum server_record_reading reading)
{
    recovery->is_newer |= reading == SERVER_RECORD_NEWER;
    recovery->no_memory |= reading == SERVER_RECORD_NO_MEMORY;
}

static bool recovery_row(void *user, const struct server_row *row)
{
    struct recovery *recovery = user;
    struct finding *finding = finding_add(recovery, row->key);
    if (!finding) return false;
    finding->has_row = true;
    finding->uses = row->uses;
    recovery_note(recovery, server_record_read(row->key, row->text, row->size, &finding->row));
    server_sha256(row->text, row->size, finding->checksum);
    return true;
}

static void read_manifest(struct recovery *recovery, const char *file)
{
    char key[SERVER_KEY_TEXT] = "", checksum[SERVER_SHA256_HEX] = "";
    if (!server_files_manifest_key(file, key)) return;
    struct finding *finding = recovery->sorted ? bsearch(key, recovery->findings, recovery->sorted,
                                                         sizeof *recovery->findings, text_compare)
                                               : NULL;
    if (!finding && !(finding = finding_add(recovery, key))) return;
    finding->has_manifest = true;
    recovery_note(recovery, server_files_read_manifest(&recovery->local->files, key,
                                                       &finding->manifest, checksum));
    finding->differ = strcmp(checksum, finding->checksum) != 0;
}

static void recovery_forget(struct recovery *recovery)
{
    for (uint32_t i = 0; i < recovery->count; i++) {
        server_record_release(recovery->findings[i].row);
        server_record_release(recovery->findings[i].manifest);
    }
    recovery->count = 0;
}

static enum server_store_outcome read_database(struct recovery *recovery, const char *path)
{
    struct local *local = recovery->local;
    enum server_store_outcome outcome =
        server_database_open(path, SERVER_DATABASE_WRITE, &local->database);
    return outcome ? outcome : server_database_each(local->database, recovery_row, recovery);
}

/* Opens the database, or a new one in its place; without either the store is read-only. */
static void open_database(struct recovery *recovery)
{
    struct local *local = recovery->local;
    const struct server_path path = server_files_path(&local->files, SERVER_STORE_DATABASE);
    enum server_store_outcome outcome = read_database(recovery, path.text);
    if (outcome == SERVER_STORE_FULL && server_files_drop_ballast(&local->files))
        outcome = read_database(recovery, path.text);
    if (outcome == SERVER_STORE_DAMAGED || outcome == SERVER_STORE_READ_ONLY) {
        char suffix[SERVER_DISK_ASIDE_SUFFIX];
        recovery_forget(recovery);
        server_database_close(local->database, false);
        local->database = NULL;
        server_disk_set_aside(path.text, server_disk_database_parts, suffix);
        server_log_message(SERVER_LOG_ERROR, "store_database_damaged",
                           "the database is damaged: it was renamed to geodesicd.db%s, a new one "
                           "is made from the manifests",
                           suffix);
        outcome = read_database(recovery, path.text);
    }
    recovery->sorted = recovery->count;
    if (!outcome) outcome = server_files_outcome(server_disk_sync_folder(local->files.folder));
    if (!outcome) return;
    server_database_close(local->database, false);
    local->database = NULL;
    local_forbid(local, "the database '%s' can't be opened or made (%s): mend that and restart",
                 path.text, outcome == SERVER_STORE_FULL ? "the disk is full" : strerror(errno));
}

/* --- recovery: repairs ------------------------------------------------------------------------ */

/* Logs a repair; `what`: the file or row that was written. */
static void log_repair(struct local *local, const struct finding *finding,
                       enum server_store_outcome outcome, const char *what, const char *message)
{
    struct server_log_line line;
    if (server_log_begin(&line, SERVER_LOG_WARN, "store_mended")) {
        server_log_text(&line, "key", finding->key);
        server_log_text(&line, "message", message);
        if (outcome)
            server_log_text(&line, "failure",
                            "it could not be written; it is tried again at the next start");
        server_log_end(&line);
    }
    if (outcome == SERVER_STORE_READ_ONLY)
        local_forbid(local, "%s could not be made durable", what);
}

static void repair_row(struct local *local, const struct finding *finding)
{
    enum server_store_outcome outcome =
        local->database ? server_database_put(local->database, finding->manifest)
                        : SERVER_STORE_READ_ONLY;
    local->lacks_rows |= outcome != SERVER_STORE_DONE;
    log_repair(local, finding, outcome, "a row of the database",
               "its row in the database was written again from its manifest");
}

/* Of a surface whose manifest is missing or damaged. */
static void repair_manifest(struct recovery *recovery, const struct finding *finding)
{
    static const char *const parts[] = {"", NULL};
    struct local *local = recovery->local;
    if (finding->has_manifest) {
        char suffix[SERVER_DISK_ASIDE_SUFFIX];
        server_disk_set_aside(
            server_files_path(&local->files, "manifests/%s" SERVER_MANIFEST, finding->key).text,
            parts, suffix);
        recovery->lost_some = true;
    }
    if (finding->row) {
        log_repair(local, finding, server_files_write_manifest(&local->files, finding->row),
                   "a manifest",
                   "its manifest was missing or damaged, and was written again from its row in the "
                   "database");
        return;
    }
    if (finding->has_row && local->database)
        (void)server_database_remove(local->database, finding->key);
    recovery->lost_some = true;
    server_log_message(SERVER_LOG_ERROR, "store_lost",
                       "the surface '%s' is lost: its manifest and its row in the database are "
                       "damaged; its bytes are kept",
                       finding->key);
}

/* Repairs what the table above lists. False without memory. */
static bool repair_all(struct recovery *recovery)
{
    struct local *local = recovery->local;
    if (recovery->count)
        qsort(recovery->findings, recovery->count, sizeof *recovery->findings, text_compare);
    local->found = calloc(recovery->count + 1, sizeof *local->found);
    if (!local->found) return false;
    for (uint32_t i = 0; i < recovery->count; i++) {
        const struct finding *finding = &recovery->findings[i];
        if (!finding->manifest)
            repair_manifest(recovery, finding);
        else if (finding->differ)
            repair_row(local, finding);
        struct server_record *record = finding->manifest ? finding->manifest : finding->row;
        if (record)
            local->found[local->found_count++] = (struct server_stored){
                .record = server_record_retain(record), .uses = finding->uses};
    }
    return true;
}

/* Removes the objects that no surface has. */
static void collect_objects(const struct local *local)
{
    size_t count = 0;
    char(*used)[SERVER_OBJECT] =
        malloc((SERVER_PARTS * (size_t)local->found_count + 1) * sizeof *used);
    struct server_object object;
    if (!used) return;
    for (uint32_t i = 0; i < local->found_count; i++)
        for (int part = 0; part < SERVER_PARTS; part++)
            if (server_record_object(local->found[i].record, part, &object))
                strcpy(used[count++], object.id);
    qsort(used, count, sizeof *used, text_compare);
    struct server_listing folders = server_files_list(&local->files, "objects");
    while (server_listing_next(&folders)) {
        struct server_listing objects = server_disk_list(folders.path);
        while (server_listing_next(&objects))
            if (server_files_object_check(objects.name) &&
                !bsearch(objects.name, used, count, sizeof *used, text_compare))
                server_files_remove_object(&local->files, objects.name);
    }
    free(used);
}

/* Finds and repairs what the folder holds. False with a sentence. */
static bool recovery_run(struct recovery *recovery, char *error, size_t error_size)
{
    struct local *local = recovery->local;
    struct server_listing temporary = server_files_list(&local->files, "temporary");
    while (server_listing_next(&temporary)) (void)unlink(temporary.path);
    open_database(recovery);
    struct server_listing manifests = server_files_list(&local->files, "manifests");
    while (server_listing_next(&manifests)) read_manifest(recovery, manifests.name);
    if (recovery->is_newer) {
        snprintf(error, error_size, "a later version of geodesicd wrote into '%s': run that one",
                 local->files.folder);
        return false;
    }
    if (recovery->no_memory || !repair_all(recovery)) return false; /* the caller has set `error` */
    /* after damage nothing is deleted: a person may be able to repair it */
    if (recovery->lost_some || local->is_read_only) return true;
    collect_objects(local);
    if (server_files_load_ballast(&local->files) == SERVER_STORE_READ_ONLY)
        local_forbid(local, "the ballast could not be made durable");
    return true;
}

/* --- open and close --------------------------------------------------------------------------- */

static void local_close(struct server_store *store)
{
    struct local *local = (struct local *)store;
    local_forget_found(local);
    server_database_close(local->database, !local->is_read_only);
    server_files_close(&local->files);
    while (local->quarantine.first) quarantine_lift(local, local->quarantine.first->object);
    pthread_mutex_destroy(&local->quarantine.lock);
    free(local);
}

struct server_store *server_store_local_open(const char *folder, char *error, size_t error_size)
{
    struct local *local = calloc(1, sizeof *local);
    snprintf(error, error_size, "out of memory");
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
    struct recovery recovery = {.local = local};
    pthread_mutex_init(&local->quarantine.lock, NULL);
    bool is_open = server_files_open(&local->files, folder);
    if (!is_open) snprintf(error, error_size, "%s", local->files.error);
    is_open = is_open && recovery_run(&recovery, error, error_size);
    recovery_forget(&recovery);
    free(recovery.findings);
    if (is_open) return &local->store;
    local_close(&local->store);
    return NULL;
}
