/* See store_postgres.h: what there is and what changes is shown, and changes are waited for. */
#include <stdio.h>
#include <time.h>

#include "gd/control.h"
#include "server/base/log.h"
#include "server/store/postgres/postgres_store.h"

#define PAGE      500   /* surfaces shown at once, */
#define PAGE_TEXT "500" /* and as SQL has it */
#define FOLLOW_NS UINT64_C(1000000000)
#define SWEEP_NS  UINT64_C(3600000000000)

/* --- showing ---------------------------------------------------------------------------------- */

/* What a row says; NULL with `*lacks_memory`, or when it can't be read, which is logged. */
static struct server_record *read_record(const char *key, const struct server_sql_value *text,
                                         bool *lacks_memory)
{
    struct server_record *record = NULL;
    enum server_record_reading reading =
        server_record_read_named(key, text->bytes, text->size, &record);
    *lacks_memory = reading == SERVER_RECORD_NO_MEMORY;
    if (reading == SERVER_RECORD_DAMAGED || reading == SERVER_RECORD_NEWER)
        server_log_message(SERVER_LOG_ERROR, "surface_unavailable", "the row of '%s' %s", key,
                           reading == SERVER_RECORD_NEWER
                               ? "was written by a later version of this program"
                               : "is damaged: upload it again");
    return reading == SERVER_RECORD_READ ? record : NULL;
}

struct page {
    /* NULL: it is all that is stored */
    bool (*visit_change)(void *user, const struct server_store_change *change);
    bool (*visit_stored)(void *user, const struct server_stored *stored);
    void *user;
    uint64_t seen;              /* versions up to this are shown */
    char last[SERVER_KEY_TEXT]; /* key */
    uint32_t rows;
    bool is_over, lacks_memory, is_forgotten;
};

static bool on_change(void *user, const struct server_sql_value *row)
{
    struct page *page = user;
    struct server_record *record = NULL;
    if (row[2].type == SERVER_SQL_BYTES)
        record = read_record(row[0].bytes, &row[2], &page->lacks_memory);
    if (page->lacks_memory) return false;
    const struct server_store_change shown = {row[0].bytes, record, (uint64_t)row[1].integer};
    page->is_over = !page->visit_change(page->user, &shown);
    server_record_release(record);
    if (page->is_over) return false;
    page->seen = shown.version;
    page->rows++;
    return true;
}

static bool on_stored(void *user, const struct server_sql_value *row)
{
    struct page *page = user;
    snprintf(page->last, sizeof page->last, "%s", row[0].bytes);
    page->rows++;
    struct server_record *record = read_record(row[0].bytes, &row[2], &page->lacks_memory);
    if (!record) return !page->lacks_memory;
    const struct server_stored stored = {.record = record, .version = (uint64_t)row[1].integer};
    page->is_over = !page->visit_stored(page->user, &stored);
    server_record_release(record);
    return !page->is_over;
}

static bool on_clock(void *user, const struct server_sql_value *row)
{
    int64_t *clock = user;
    clock[0] = row[0].integer;
    clock[1] = row[1].integer;
    return true;
}

static enum server_store_outcome read_clock(struct server_postgres_connection *connection,
                                            void *user)
{
    return server_postgres_run(connection, "SELECT version, forgotten FROM clock", NULL, 0,
                               on_clock, user);
}

/* Visits change by change: a page that is shown again, since the connection was lost, begins where
 * the one before ended. */
static enum server_store_outcome show_changes(struct server_postgres_connection *connection,
                                              void *user)
{
    struct page *page = user;
    int64_t clock[2] = {0};
    enum server_store_outcome outcome = read_clock(connection, clock);
    if (outcome) return outcome;
    page->is_forgotten = (uint64_t)clock[1] > page->seen || (uint64_t)clock[0] < page->seen;
    if (page->is_forgotten || (uint64_t)clock[0] == page->seen) return SERVER_STORE_DONE;
    do {
        const struct server_sql_value seen = server_sql_integer((int64_t)page->seen);
        page->rows = 0;
        outcome = server_postgres_run(connection,
                                      "SELECT key, version, record FROM surfaces WHERE version > $1"
                                      " ORDER BY version LIMIT " PAGE_TEXT,
                                      &seen, 1, on_change, page);
    } while (!outcome && page->rows == PAGE && !page->is_over && !page->lacks_memory);
    return outcome;
}

enum server_store_outcome
server_store_postgres_follow(struct server_store *store,
                             bool (*visit)(void *user, const struct server_store_change *change),
                             void *user)
{
    struct server_store_postgres *own = server_store_postgres_of(store);
    struct page page = {.visit_change = visit, .user = user, .seen = own->seen};
    enum server_store_outcome outcome =
        server_postgres_read(own->postgres, FOLLOW_NS, show_changes, &page);
    own->seen = page.seen;
    if (page.lacks_memory || page.is_over) return SERVER_STORE_NO_MEMORY;
    return !outcome && page.is_forgotten ? SERVER_STORE_STALE : outcome;
}

static enum server_store_outcome show_all(struct server_postgres_connection *connection, void *user)
{
    struct page *page = user;
    enum server_store_outcome outcome;
    do {
        const struct server_sql_value last = server_sql_text(page->last);
        page->rows = 0;
        outcome = server_postgres_run(
            connection,
            "SELECT key, version, record FROM surfaces WHERE key > $1 AND record IS NOT NULL"
            " ORDER BY key LIMIT " PAGE_TEXT,
            &last, 1, on_stored, page);
    } while (!outcome && page->rows == PAGE && !page->is_over && !page->lacks_memory);
    return outcome;
}

/* What changes while all is shown is shown again by the next follow. */
enum server_store_outcome
server_store_postgres_each(struct server_store *store,
                           bool (*visit)(void *user, const struct server_stored *stored),
                           void *user)
{
    struct server_store_postgres *own = server_store_postgres_of(store);
    struct page page = {.visit_stored = visit, .user = user};
    int64_t clock[2] = {0};
    enum server_store_outcome outcome =
        server_postgres_read(own->postgres, SERVER_STORE_POSTGRES_LOAD_NS, read_clock, clock);
    if (!outcome)
        outcome =
            server_postgres_read(own->postgres, SERVER_STORE_POSTGRES_LOAD_NS, show_all, &page);
    if (page.lacks_memory || page.is_over) return SERVER_STORE_NO_MEMORY;
    if (!outcome) own->seen = (uint64_t)clock[0];
    return outcome;
}

/* --- waiting ---------------------------------------------------------------------------------- */

static void tell_turn(struct server_store_postgres *own, bool is_away, const char *error)
{
    if (is_away == own->was_away) return;
    own->was_away = is_away;
    if (is_away)
        server_log_message(SERVER_LOG_ERROR, "database_away", "%s", error);
    else
        server_log_message(SERVER_LOG_INFO, "database_back", "the database answers again");
}

static bool listen_anew(struct server_store_postgres *own)
{
    char error[SERVER_POSTGRES_ERROR];
    if (server_postgres_take(own->postgres, true, &own->listener, error)) {
        own->listener = NULL;
        tell_turn(own, server_postgres_is_away(own->postgres), error);
        return false;
    }
    if (server_postgres_run(own->listener, "LISTEN " SERVER_STORE_POSTGRES_CHANNEL, NULL, 0, NULL,
                            NULL))
        return false;
    server_postgres_has_answered(own->postgres);
    tell_turn(own, false, error);
    return true;
}

void server_store_postgres_rest(uint64_t ns)
{
    const struct timespec pause = {.tv_sec = (time_t)(ns / 1000000000),
                                   .tv_nsec = (long)(ns % 1000000000)};
    nanosleep(&pause, NULL);
}

/* Objects whose upload was cut short before it had a surface go after a day; nobody can give them
 * to one while the clock is held. */
static enum server_store_outcome drop_forsaken(struct server_postgres_connection *connection,
                                               void *user)
{
    (void)user;
    enum server_store_outcome outcome = server_postgres_run(
        connection, "SELECT version FROM clock FOR UPDATE", NULL, 0, NULL, NULL);
    if (outcome) return outcome;
    return server_postgres_run(connection,
                               "DELETE FROM objects WHERE created < now() - interval '1 day'"
                               " AND NOT EXISTS (SELECT FROM surfaces WHERE file = id)"
                               " AND NOT EXISTS (SELECT FROM surfaces WHERE attachment = id)",
                               NULL, 0, NULL, NULL);
}

static void sweep(struct server_store_postgres *own)
{
    uint64_t now_ns = gd_now_ns();
    if (own->swept_ns && now_ns - own->swept_ns < SWEEP_NS) return;
    own->swept_ns = now_ns;
    (void)server_postgres_transact(own->postgres, drop_forsaken, NULL);
}

/* Who listens is also who finds out that the database is back. */
void server_store_postgres_await(struct server_store *store, uint64_t ns)
{
    struct server_store_postgres *own = server_store_postgres_of(store);
    sweep(own);
    bool listens = own->listener || listen_anew(own);
    if (listens && !server_postgres_is_away(own->postgres) &&
        server_postgres_await(own->listener, ns))
        return;
    if (own->listener) server_postgres_give(own->postgres, own->listener);
    own->listener = NULL;
    server_store_postgres_rest(ns);
}
