/* See store_local.h. */
#include "server/store/local/local_store.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/log.h"

static struct server_store_local *local_of(struct server_store *store)
{
    return (struct server_store_local *)store;
}

/* --- health ----------------------------------------------------------------------------------- */

void server_local_forbid(struct server_store_local *local, const char *format, ...)
{
    va_list arguments;
    if (atomic_load(&local->is_read_only)) return;
    va_start(arguments, format);
    vsnprintf(local->reason, sizeof local->reason, format, arguments);
    va_end(arguments);
    atomic_store(&local->is_read_only, true);
    server_log_message(SERVER_LOG_ERROR, "store_read_only", "%s", local->reason);
}

static const char *health(struct server_store *store)
{
    static const char missing[] =
        "the data folder, or a part of it (objects, manifests, geodesicd.db), was removed or "
        "replaced under the daemon: put it back, or restart on what there is";
    struct server_store_local *local = local_of(store);
    if (atomic_load(&local->is_read_only)) return local->reason;
    bool is_missing = !server_files_are_there(&local->files);
    if (atomic_exchange(&local->was_missing, is_missing) != is_missing)
        server_log_message(SERVER_LOG_ERROR, "store_missing", "%s",
                           is_missing ? missing : "the data folder is back");
    return is_missing ? missing : NULL;
}

static bool can_write(struct server_store_local *local)
{
    return !atomic_load(&local->is_read_only);
}

/* What failed in a way that more writing could make worse ends all writing. */
static enum server_store_outcome judge(struct server_store_local *local,
                                       enum server_store_outcome outcome, const char *what)
{
    if (outcome == SERVER_STORE_REFUSED)
        server_log_message(SERVER_LOG_ERROR, "store_refused",
                           "%s could not be written (%s): mend the folder", what, strerror(errno));
    if (outcome != SERVER_STORE_READ_ONLY && outcome != SERVER_STORE_DAMAGED) return outcome;
    server_local_forbid(
        local, "%s could not be written and made durable (%s): mend the disk and restart", what,
        outcome == SERVER_STORE_DAMAGED ? server_database_error(local->database) : strerror(errno));
    return SERVER_STORE_READ_ONLY;
}

/* Once a change is durable: what the next one needs. */
static void look_after(struct server_store_local *local)
{
    if (!server_database_is_sound(local->database))
        (void)judge(local, SERVER_STORE_READ_ONLY, "the database's log");
    else
        (void)judge(local, server_files_load_ballast(&local->files), "the ballast");
}

/* --- objects ---------------------------------------------------------------------------------- */

static enum server_store_outcome write_object(struct server_store_local *local,
                                              const struct server_object *object, const void *bytes)
{
    enum server_store_outcome outcome = server_files_write_object(&local->files, object, bytes);
    if (!outcome) server_quarantine_lift(&local->quarantine, object->id);
    return outcome;
}

static enum server_store_outcome write_objects(struct server_store_local *local,
                                               const struct server_record *record,
                                               const struct server_content *content)
{
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    struct server_object object;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (server_record_object(record, part, &object))
            outcome = write_object(local, &object, content->parts[part]);
    return judge(local, outcome, "a surface's file");
}

static void drop_if_unused(struct server_store_local *local, const char *object)
{
    int64_t count;
    if (!can_write(local) || local->lacks_rows) return;
    if (server_database_count(local->database, object, &count) != SERVER_STORE_DONE) return;
    if (count) return;
    server_files_remove_object(&local->files, object);
    server_quarantine_lift(&local->quarantine, object);
}

static void drop_unused(struct server_store_local *local, const struct server_record *record)
{
    struct server_object object;
    for (int part = 0; part < SERVER_PARTS; part++)
        if (server_record_object(record, part, &object)) drop_if_unused(local, object.id);
}

static void tidy(struct server_store *store)
{
    struct server_store_local *local = local_of(store);
    for (int part = 0; part < SERVER_PARTS; part++) {
        if (local->left[part][0]) drop_if_unused(local, local->left[part]);
        local->left[part][0] = '\0';
    }
    if (can_write(local)) look_after(local); /* after the bytes: the ballast may need their room */
}

/* --- put -------------------------------------------------------------------------------------- */

/* The object is there. */
static enum server_store_outcome put_record(struct server_store_local *local,
                                            const struct server_record *record)
{
    enum server_store_outcome outcome =
        judge(local, server_files_write_manifest(&local->files, record), "a manifest");
    if (outcome) return outcome;
    outcome = judge(local, server_database_put(local->database, record), "a row of the database");
    if (outcome && outcome != SERVER_STORE_READ_ONLY)
        (void)judge(local, server_files_undo_manifest(&local->files, record->key), "a manifest");
    if (!outcome) server_files_settle_manifest(&local->files);
    return outcome;
}

static enum server_store_outcome put(struct server_store *store, const struct server_record *record,
                                     const struct server_content *content, uint64_t *version)
{
    struct server_store_local *local = local_of(store);
    (void)version;
    char before[SERVER_PARTS][SERVER_OBJECT];
    if (!can_write(local)) return SERVER_STORE_READ_ONLY;
    enum server_store_outcome outcome =
        judge(local, server_database_find(local->database, record->key, before), "the database");
    if (outcome && outcome != SERVER_STORE_ABSENT) return outcome;
    bool replaces = outcome == SERVER_STORE_DONE;
    outcome = write_objects(local, record, content);
    if (!outcome) outcome = put_record(local, record);
    if (outcome)
        drop_unused(local, record);
    else if (replaces)
        memcpy(local->left, before, sizeof before);
    return outcome;
}

static enum server_store_outcome keep(struct server_store *store,
                                      const struct server_record *record,
                                      const struct server_content *content)
{
    struct server_store_local *local = local_of(store);
    if (!can_write(local)) /* it was durable once; whether it still is shows when it is loaded */
        return SERVER_STORE_DONE;
    return write_objects(local, record, content);
}

/* --- remove ----------------------------------------------------------------------------------- */

/* Those that no surface has any more go when all is tidy. */
static void leave_objects(struct server_store_local *local, const struct server_record *record)
{
    struct server_object object;
    for (int part = 0; part < SERVER_PARTS; part++)
        strcpy(local->left[part], server_record_object(record, part, &object) ? object.id : "");
}

/* The row goes into the database's log: which needs room, and gets it from the ballast. */
static enum server_store_outcome remove_row(struct server_store_local *local, const char *key)
{
    enum server_store_outcome outcome = server_database_remove(local->database, key);
    if (outcome == SERVER_STORE_FULL && server_files_drop_ballast(&local->files))
        outcome = server_database_remove(local->database, key);
    return judge(local, outcome, "a row of the database");
}

static enum server_store_outcome
remove_record(struct server_store *store, const struct server_record *record, uint64_t *version)
{
    struct server_store_local *local = local_of(store);
    (void)version;
    if (!can_write(local)) return SERVER_STORE_READ_ONLY;
    enum server_store_outcome outcome = remove_row(local, record->key);
    if (outcome) return outcome;
    outcome = judge(local, server_files_remove_manifest(&local->files, record->key), "a manifest");
    if (outcome == SERVER_STORE_REFUSED)
        server_local_forbid(local,
                            "a manifest could not be removed (%s): mend the folder and restart",
                            strerror(errno));
    if (outcome) return SERVER_STORE_READ_ONLY;
    leave_objects(local, record);
    return SERVER_STORE_DONE;
}

/* --- the rest --------------------------------------------------------------------------------- */

static enum server_store_outcome fetch(struct server_store *store,
                                       const struct server_record *record, enum server_part part,
                                       void **bytes)
{
    struct server_store_local *local = local_of(store);
    struct server_object object;
    if (!server_record_object(record, part, &object)) return SERVER_STORE_ABSENT;
    if (server_quarantine_holds(&local->quarantine, object.id)) return SERVER_STORE_DAMAGED;
    uint64_t turn = server_quarantine_turn(&local->quarantine);
    enum server_store_outcome outcome = server_files_read_object(&local->files, &object, bytes);
    if (outcome == SERVER_STORE_DAMAGED)
        (void)server_quarantine_condemn(&local->quarantine, object.id, turn);
    return outcome;
}

/* Who mends a file behind the daemon's back has it back after the next look. */
static enum server_store_verdict verify(struct server_store *store,
                                        const struct server_record *record, enum server_part part,
                                        bool (*pace)(void *user, size_t bytes), void *user)
{
    struct server_store_local *local = local_of(store);
    struct server_object object;
    if (!server_record_object(record, part, &object)) return SERVER_VERDICT_MISSING;
    uint64_t turn = server_quarantine_turn(&local->quarantine);
    enum server_store_verdict verdict =
        server_files_verify_object(&local->files, &object, pace, user);
    bool was_held = server_quarantine_holds(&local->quarantine, object.id);
    if (verdict == SERVER_VERDICT_SOUND && was_held)
        server_quarantine_lift(&local->quarantine, object.id);
    if (verdict != SERVER_VERDICT_DAMAGED) return verdict;
    return server_quarantine_condemn(&local->quarantine, object.id, turn) ? verdict
                                                                          : SERVER_VERDICT_NONE;
}

static uint32_t damaged(struct server_store *store)
{
    return server_quarantine_count(&local_of(store)->quarantine);
}

static void note_uses(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count)
{
    struct server_store_local *local = local_of(store);
    if (!can_write(local)) return;
    (void)judge(local, server_database_note_uses(local->database, records, uses, count),
                "a row of the database");
}

static enum server_store_outcome each(struct server_store *store,
                                      bool (*visit)(void *user, const struct server_stored *stored),
                                      void *user)
{
    struct server_store_local *local = local_of(store);
    for (uint32_t i = 0; i < local->found_count; i++)
        if (!visit(user, &local->found[i])) break;
    server_local_forget_found(local);
    return SERVER_STORE_DONE;
}

void server_local_forget_found(struct server_store_local *local)
{
    for (uint32_t i = 0; i < local->found_count; i++) server_record_release(local->found[i].record);
    free(local->found);
    local->found = NULL;
    local->found_count = 0;
}

static void close_store(struct server_store *store)
{
    struct server_store_local *local = local_of(store);
    server_local_forget_found(local);
    server_database_close(local->database, can_write(local));
    server_files_close(&local->files);
    server_quarantine_clear(&local->quarantine);
    free(local);
}

struct server_store *server_store_local_open(const char *folder, char *error, size_t error_size)
{
    struct server_store_local *local = calloc(1, sizeof *local);
    snprintf(error, error_size, "out of memory");
    if (!local) return NULL;
    local->store = (struct server_store){.each = each,
                                         .put = put,
                                         .keep = keep,
                                         .remove = remove_record,
                                         .tidy = tidy,
                                         .fetch = fetch,
                                         .verify = verify,
                                         .damaged = damaged,
                                         .note_uses = note_uses,
                                         .health = health,
                                         .close = close_store};
    server_quarantine_init(&local->quarantine);
    if (!server_files_open(&local->files, folder, error, error_size)) {
        server_quarantine_clear(&local->quarantine);
        free(local);
        return NULL;
    }
    if (server_local_recover(local, error, error_size)) return &local->store;
    close_store(&local->store);
    return NULL;
}
