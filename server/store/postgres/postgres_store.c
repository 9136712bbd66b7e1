/* See store.h: the store in a PostgreSQL database, which many daemons share. Tables: schema.c. */
#include <stdlib.h>

#include "gd/control.h"
#include "server/base/log.h"
#include "server/base/thread.h"
#include "server/store/postgres/connection.h"

#define CHANNEL "geodesicd" /* notified by each change */
/* number of changes after which a removal is no longer listed */
#define REMEMBERED "100000"
#define PAGE       500                   /* rows of one statement */
#define PAGE_TEXT  "500"                 /* PAGE as text in SQL */
#define START_NS   UINT64_C(10000000000) /* time to reach the database at the start */
#define LOAD_NS    UINT64_C(8000000000)  /* time to read an object, or all rows */
#define FOLLOW_NS  UINT64_C(1000000000)
#define SWEEP_NS   UINT64_C(3600000000000) /* time between two removals of unused objects */
#define AWAY                                                                                       \
    "the database does not answer: surfaces in memory are served, and changes are refused until "  \
    "it is back"

struct shared {
    struct server_store store; /* must be the first member */
    struct server_pg_pool *pool;
    uint64_t seen; /* last visited version; guarded by the follower's lock */
    /* used by the thread that calls await: */
    struct server_pg *listener; /* NULL means that there is none */
    bool was_away;
    uint64_t swept_ns; /* time of the last removal of unused objects */
};

/* --- changes ---------------------------------------------------------------------------------- */

static enum server_outcome shared_stage(struct server_store *store,
                                        const struct server_record *record,
                                        const struct server_content *content)
{
    struct server_pg_attempt attempt = server_pg_transaction(((struct shared *)store)->pool);
    while (server_pg_next(&attempt))
        for (int part = 0; !attempt.outcome && part < SERVER_PARTS; part++)
            if (record->objects[part].id[0])
                attempt.outcome = server_pg_write_object(attempt.pg, &record->objects[part],
                                                         content->parts[part]);
    return attempt.outcome;
}

struct change {
    const struct server_record *record;
    const char *text; /* text of the record; NULL means remove the surface */
    size_t size;
    uint64_t before; /* the expected version; 0 means none */
    struct server_sql_integers version;
    struct server_sql_surface found; /* current row of the key; version 0 means none */
};

/* Finds the key's row. Returns PRECONDITION if the row's version differs from that in the
 * registry. */
static enum server_outcome pg_change_check(struct server_pg *pg, struct change *change)
{
    change->found = (struct server_sql_surface){0};
    enum server_outcome outcome =
        server_pg_run(pg, SERVER_SQL("SELECT version, file, attachment FROM surfaces"
                                     " WHERE key = $1 AND record IS NOT NULL",
                                     SERVER_VALUES(server_sql_text(change->record->key)),
                                     server_sql_on_surface, &change->found));
    if (outcome) return outcome;
    return (uint64_t)change->found.version == change->before ? SERVER_STORE_DONE
                                                             : SERVER_STORE_PRECONDITION;
}

/* Writes the change. Returns PRECONDITION if a staged object was deleted. */
static enum server_outcome pg_change_write(struct server_pg *pg, const struct change *change)
{
    const struct server_object *objects = change->record->objects;
    struct server_sql_value values[] = {
        server_sql_text(change->record->key), server_sql_integer(change->version.at[0]),
        server_sql_text(NULL), server_sql_text(NULL), server_sql_bytes(change->text, change->size)};
    for (int part = 0; change->text && part < SERVER_PARTS; part++)
        if (objects[part].id[0]) values[2 + part] = server_sql_text(objects[part].id);
    enum server_outcome outcome = server_pg_run(
        pg, change->text
                ? SERVER_SQL("INSERT INTO surfaces (key, version, file, attachment, record)"
                             " VALUES ($1, $2, $3, $4, $5) ON CONFLICT (key) DO UPDATE"
                             " SET version = $2, file = $3, attachment = $4, record = $5",
                             values, 5)
                : SERVER_SQL("UPDATE surfaces SET version = $2, file = $3, attachment = $4,"
                             " record = NULL WHERE key = $1",
                             values, 4));
    return outcome == SERVER_STORE_STALE ? SERVER_STORE_PRECONDITION : outcome;
}

static enum server_outcome pg_change_forget(struct server_pg *pg, const struct change *change)
{
    const int64_t version = change->version.at[0];
    return server_pg_run(
        pg,
        SERVER_SQL(
            "WITH gone AS (DELETE FROM surfaces WHERE record IS NULL AND version < $1 - " REMEMBERED
            " RETURNING version) UPDATE clock SET forgotten ="
            " greatest(forgotten, coalesce((SELECT max(version) FROM gone), 0))",
            SERVER_VALUES(server_sql_integer(version))));
}

/* Applies a change. Locks the clock's row, so that other daemons change nothing meanwhile. */
static enum server_outcome pg_change_apply(struct server_pg *pg, struct change *change)
{
    enum server_outcome outcome =
        server_pg_run(pg, SERVER_SQL("UPDATE clock SET version = version + 1 RETURNING version",
                                     NULL, 0, server_sql_on_integers, &change->version));
    if (!outcome) outcome = pg_change_check(pg, change);
    if (!outcome) outcome = pg_change_write(pg, change);
    if (!outcome)
        outcome = server_pg_run(
            pg, SERVER_SQL(
                    "DELETE FROM objects WHERE id IN ($1, $2) AND " SERVER_PG_UNUSED,
                    SERVER_VALUES(server_sql_text(change->found.objects[SERVER_PART_FILE]),
                                  server_sql_text(change->found.objects[SERVER_PART_ATTACHMENT]))));
    if (!outcome && !change->text) outcome = pg_change_forget(pg, change);
    return outcome ? outcome : server_pg_run(pg, SERVER_SQL("NOTIFY " CHANNEL));
}

static enum server_outcome pg_change_make(struct server_store *store, struct change *change,
                                          uint64_t *version)
{
    struct server_pg_attempt attempt = server_pg_transaction(((struct shared *)store)->pool);
    change->before = *version;
    while (server_pg_next(&attempt)) attempt.outcome = pg_change_apply(attempt.pg, change);
    if (!attempt.outcome) *version = (uint64_t)change->version.at[0];
    return attempt.outcome == SERVER_STORE_PRECONDITION ? SERVER_STORE_STALE : attempt.outcome;
}

static enum server_outcome shared_put(struct server_store *store,
                                      const struct server_record *record,
                                      const struct server_content *content, uint64_t *version)
{
    struct change change = {.record = record};
    (void)content; /* staged */
    char *text = server_record_write(record, &change.size);
    if (!text) return SERVER_STORE_NO_MEMORY;
    change.text = text;
    enum server_outcome outcome = pg_change_make(store, &change, version);
    free(text);
    return outcome;
}

static enum server_outcome shared_remove(struct server_store *store,
                                         const struct server_record *record, uint64_t *version)
{
    return pg_change_make(store, &(struct change){.record = record}, version);
}

/* --- reading ---------------------------------------------------------------------------------- */

static enum server_outcome shared_fetch(struct server_store *store,
                                        const struct server_object *object, void **bytes)
{
    void *read = malloc(object->size ? object->size : 1);
    if (!read) return SERVER_STORE_NO_MEMORY;
    struct server_pg_attempt attempt = server_pg_reading(((struct shared *)store)->pool, LOAD_NS);
    while (server_pg_next(&attempt))
        attempt.outcome = server_pg_read_object(attempt.pg, object, read);
    if (attempt.outcome)
        free(read);
    else
        *bytes = read;
    return attempt.outcome;
}

static enum server_outcome shared_verify(struct server_store *store,
                                         const struct server_object *object, server_pace *pace,
                                         void *user)
{
    enum server_outcome outcome = SERVER_STORE_DONE;
    size_t size = 0;
    for (uint64_t i = 0; !outcome && i < server_pg_chunks(object); i++) {
        struct server_pg_attempt attempt =
            server_pg_reading(((struct shared *)store)->pool, LOAD_NS);
        while (server_pg_next(&attempt))
            attempt.outcome = server_pg_check_chunk(attempt.pg, object, i, &size);
        outcome =
            attempt.outcome == SERVER_STORE_ABSENT && i ? SERVER_STORE_DAMAGED : attempt.outcome;
        if (!outcome && !pace(user, size)) outcome = SERVER_STORE_UNAVAILABLE;
    }
    return outcome == SERVER_STORE_NO_MEMORY ? SERVER_STORE_UNAVAILABLE : outcome;
}

/* --- rows ------------------------------------------------------------------------------------- */

struct page {
    server_stored_visit *visit;
    void *user;
    bool is_following;          /* true if removals are visited, too */
    uint64_t seen;              /* all changes up to this version are visited */
    char last[SERVER_KEY_TEXT]; /* the last surface's key */
    uint32_t rows;
    bool is_over; /* true if the visitor has ended the visit, or memory is short */
    bool is_forgotten;
};

/* Parses row[2]. Returns NULL if out of memory, or after logging a damaged record. */
static struct server_record *page_record(struct page *page, const struct server_sql_value *row)
{
    struct server_record *record = NULL;
    enum server_record_reading reading =
        server_record_read(row[0].bytes, row[2].bytes, row[2].size, &record);
    page->is_over |= reading == SERVER_RECORD_NO_MEMORY;
    if (reading == SERVER_RECORD_DAMAGED || reading == SERVER_RECORD_NEWER)
        server_log_message(
            SERVER_LOG_ERROR, "surface_unavailable", "the row of '%s' %s", row[0].bytes,
            reading == SERVER_RECORD_NEWER ? "was written by a later version of this program"
                                           : "is damaged: upload it again");
    return record;
}

static bool on_page_row(void *user, const struct server_sql_value *row)
{
    struct page *page = user;
    const char *key = row[0].bytes;
    uint64_t version = (uint64_t)row[1].integer;
    struct server_record *record = row[2].type == SERVER_SQL_BYTES ? page_record(page, row) : NULL;
    const struct server_stored stored = {.key = key, .record = record, .version = version};
    if (!page->is_over && (record || page->is_following))
        page->is_over = !page->visit(page->user, &stored);
    server_record_release(record);
    if (page->is_over) return false;
    page->seen = version;
    snprintf(page->last, sizeof page->last, "%s", key);
    page->rows++;
    return true;
}

static enum server_outcome read_clock(struct server_pg *pg, struct server_sql_integers *clock)
{
    return server_pg_run(pg, SERVER_SQL("SELECT version, forgotten FROM clock", NULL, 0,
                                        server_sql_on_integers, clock));
}

/* Visits changes. After a lost connection it continues after the last visited change. */
static enum server_outcome visit_changes(struct server_pg *pg, struct page *page)
{
    struct server_sql_integers clock = {0};
    enum server_outcome outcome = read_clock(pg, &clock);
    if (outcome) return outcome;
    uint64_t now = (uint64_t)clock.at[0], forgotten = (uint64_t)clock.at[1];
    page->is_forgotten = forgotten > page->seen || now < page->seen;
    if (page->is_forgotten || now == page->seen) return SERVER_STORE_DONE;
    do {
        page->rows = 0;
        outcome = server_pg_run(
            pg,
            SERVER_SQL("SELECT key, version, record FROM surfaces WHERE version > $1"
                       " ORDER BY version LIMIT " PAGE_TEXT,
                       SERVER_VALUES(server_sql_integer((int64_t)page->seen)), on_page_row, page));
    } while (!outcome && page->rows == PAGE);
    return outcome;
}

static enum server_outcome shared_follow(struct server_store *store, server_stored_visit *visit,
                                         void *user)
{
    struct shared *own = (struct shared *)store;
    struct page page = {.visit = visit, .user = user, .is_following = true, .seen = own->seen};
    struct server_pg_attempt attempt = server_pg_reading(own->pool, FOLLOW_NS);
    while (server_pg_next(&attempt)) attempt.outcome = visit_changes(attempt.pg, &page);
    own->seen = page.seen;
    if (page.is_over) return SERVER_STORE_NO_MEMORY;
    return !attempt.outcome && page.is_forgotten ? SERVER_STORE_STALE : attempt.outcome;
}

/* Visits all surfaces. The next call of follow visits changes that are made meanwhile. */
static enum server_outcome shared_each(struct server_store *store, server_stored_visit *visit,
                                       void *user)
{
    struct shared *own = (struct shared *)store;
    struct page page = {.visit = visit, .user = user};
    struct server_sql_integers clock = {0};
    struct server_pg_attempt attempt = server_pg_reading(own->pool, LOAD_NS);
    while (server_pg_next(&attempt)) {
        /* the clock is read only once, because a change made while rows are visited has a later
           version */
        attempt.outcome = clock.rows ? SERVER_STORE_DONE : read_clock(attempt.pg, &clock);
        page.rows = PAGE;
        while (!attempt.outcome && page.rows == PAGE) {
            page.rows = 0;
            attempt.outcome = server_pg_run(
                attempt.pg,
                SERVER_SQL("SELECT key, version, record FROM surfaces WHERE key > $1"
                           " AND record IS NOT NULL ORDER BY key LIMIT " PAGE_TEXT,
                           SERVER_VALUES(server_sql_text(page.last)), on_page_row, &page));
        }
    }
    if (page.is_over) return SERVER_STORE_NO_MEMORY;
    if (!attempt.outcome) own->seen = (uint64_t)clock.at[0];
    return attempt.outcome;
}

/* --- waiting ---------------------------------------------------------------------------------- */

static void turn_log(struct shared *own, bool is_away, const char *error)
{
    if (is_away == own->was_away) return;
    own->was_away = is_away;
    if (is_away)
        server_log_message(SERVER_LOG_ERROR, "database_away", "%s", error);
    else
        server_log_message(SERVER_LOG_INFO, "database_back", "the database answers again");
}

static bool listen_again(struct shared *own)
{
    char error[SERVER_PG_ERROR];
    if (server_pg_pool_take(own->pool, &own->listener, error)) {
        own->listener = NULL;
        turn_log(own, server_pg_pool_is_away(own->pool), error);
        return false;
    }
    if (server_pg_run(own->listener, SERVER_SQL("LISTEN " CHANNEL))) return false;
    server_pg_pool_has_answered(own->pool);
    turn_log(own, false, error);
    return true;
}

/* Deletes the objects of uploads that were interrupted more than a day ago. Locks the clock's row,
 * so that no change can refer to such an object meanwhile. */
static void objects_sweep(struct server_pg_pool *pool)
{
    struct server_pg_attempt attempt = server_pg_transaction(pool);
    while (server_pg_next(&attempt)) {
        attempt.outcome =
            server_pg_run(attempt.pg, SERVER_SQL("SELECT version FROM clock FOR UPDATE"));
        if (!attempt.outcome)
            attempt.outcome = server_pg_run(
                attempt.pg,
                SERVER_SQL("DELETE FROM objects WHERE created < now() - interval '1 day'"
                           " AND " SERVER_PG_UNUSED));
    }
}

/* Waits for a change. Also detects that the database is reachable again. */
static void shared_await(struct server_store *store, uint64_t ns)
{
    struct shared *own = (struct shared *)store;
    uint64_t now_ns = gd_now_ns();
    if (!own->swept_ns || now_ns - own->swept_ns >= SWEEP_NS) {
        own->swept_ns = now_ns;
        objects_sweep(own->pool);
    }
    bool listens = own->listener || listen_again(own);
    if (listens && !server_pg_pool_is_away(own->pool) && server_pg_await(own->listener, ns)) return;
    if (own->listener) server_pg_pool_give(own->pool, own->listener);
    own->listener = NULL;
    server_pause(ns);
}

static const char *shared_health(struct server_store *store)
{
    return server_pg_pool_is_away(((struct shared *)store)->pool) ? AWAY : NULL;
}

/* --- open and close --------------------------------------------------------------------------- */

static void shared_close(struct server_store *store)
{
    struct shared *own = (struct shared *)store;
    if (own->listener) server_pg_pool_give(own->pool, own->listener);
    server_pg_pool_destroy(own->pool);
    free(own);
}

/* Connects and makes the tables; retries for START_NS unless refused. On failure, returns false
 * with a sentence. */
static bool postgres_prepare(struct server_pg_pool *pool, char error[SERVER_ERROR])
{
    struct server_pg *pg;
    char reason[SERVER_PG_ERROR];
    uint64_t until_ns = gd_now_ns() + START_NS;
    enum server_outcome outcome, reached;
    do {
        outcome = reached = server_pg_pool_take(pool, &pg, reason);
        if (!reached) server_pg_pool_give(pool, pg);
        if (!reached) outcome = server_pg_migrate(pool);
        if (outcome == SERVER_STORE_UNAVAILABLE) server_pause(UINT64_C(200000000));
    } while (outcome == SERVER_STORE_UNAVAILABLE && gd_now_ns() < until_ns);
    if (reached)
        snprintf(error, SERVER_ERROR, "the database of --store can't be reached: %s", reason);
    else if (outcome)
        snprintf(error, SERVER_ERROR, "%s",
                 outcome == SERVER_STORE_PRECONDITION
                     ? "a later version of this program made the tables of --store; start that one"
                     : "the tables of --store can't be made; see the lines above");
    return !outcome;
}

struct server_store *server_store_postgres_open(const char *url, char error[SERVER_ERROR])
{
    struct shared *own = calloc(1, sizeof *own);
    snprintf(error, SERVER_ERROR, "out of memory");
    if (!own) return NULL;
    /* keep, tidy and note_uses are NULL: stage repairs objects, each change deletes unused objects,
       and the numbers of uses differ between daemons */
    own->store = (struct server_store){.each = shared_each,
                                       .stage = shared_stage,
                                       .put = shared_put,
                                       .remove = shared_remove,
                                       .fetch = shared_fetch,
                                       .verify = shared_verify,
                                       .follow = shared_follow,
                                       .await = shared_await,
                                       .health = shared_health,
                                       .close = shared_close};
    own->pool = server_pg_pool_create(url);
    if (own->pool && postgres_prepare(own->pool, error)) return &own->store;
    server_pg_pool_destroy(own->pool);
    free(own);
    return NULL;
}
