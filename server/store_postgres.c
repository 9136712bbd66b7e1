/* See store.h: the store in a PostgreSQL database, which many daemons share. Its tables: store_postgres_schema.h. */
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "gd/control.h"
#include "server/log.h"
#include "server/store_postgres_objects.h"
#include "server/store_postgres_schema.h"

#define PAGE       500                   /* surfaces shown at once, */
#define PAGE_TEXT  "500"                 /* and as SQL has it */
#define REMEMBERED "100000"              /* changes for which what was removed is remembered */
#define START_NS   UINT64_C(10000000000) /* to reach the database at the start */
#define FOLLOW_NS  UINT64_C(1000000000)
#define LOAD_NS    UINT64_C(8000000000)
#define SWEEP_NS   UINT64_C(3600000000000)
#define CHANNEL    "geodesicd"
#define AWAY       "the database does not answer: what is in memory is served, changes are refused until it is back"

struct store_postgres {
    struct server_store store; /* first */
    struct server_postgres *postgres;
    struct server_postgres_connection *listener; /* of await's thread; NULL: none as yet */
    uint64_t seen;     /* up to this version all changes were shown; under the follower's lock */
    bool was_away;     /* of await's thread, as the next */
    uint64_t swept_ns; /* when objects that nobody has were last dropped */
};

static struct store_postgres *store_of(struct server_store *store)
{
    return (struct store_postgres *)store;
}

static bool on_integers(void *user, const struct server_sql_value *row)
{
    int64_t *integers = user;
    integers[0] = row[0].integer;
    integers[1] = row[1].integer;
    return true;
}

/* --- objects ------------------------------------------------------------------------------------------------------ */

struct staging {
    const struct server_record *record;
    const struct server_content *content;
};

static enum server_store_outcome write_objects(struct server_postgres_connection *connection, void *user)
{
    const struct staging *staging = user;
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    struct server_object object;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (server_record_object(staging->record, part, &object))
            outcome = server_postgres_write_object(connection, &object, staging->content->parts[part]);
    return outcome;
}

static enum server_store_outcome stage(struct server_store *store, const struct server_record *record,
                                       const struct server_content *content)
{
    struct staging staging = {record, content};
    return server_postgres_transact(store_of(store)->postgres, write_objects, &staging);
}

/* --- changes ------------------------------------------------------------------------------------------------------ */

struct changing {
    const struct server_record *record;
    const char *text; /* of the record; NULL: it is to go */
    size_t size;
    uint64_t before, version;
    char objects[SERVER_PARTS][SERVER_OBJECT]; /* that the key had; empty: none */
    int64_t found;                             /* version that the key has; 0: none */
};

static bool on_current(void *user, const struct server_sql_value *row)
{
    struct changing *changing = user;
    changing->found = row[0].integer;
    for (int part = 0; part < SERVER_PARTS; part++)
        if (row[1 + part].type == SERVER_SQL_TEXT)
            snprintf(changing->objects[part], SERVER_OBJECT, "%s", row[1 + part].bytes);
    return true;
}

/* From now on until the end of the transaction nobody else changes anything. */
static enum server_store_outcome advance_clock(struct server_postgres_connection *connection, struct changing *changing)
{
    int64_t version[2] = {0};
    enum server_store_outcome outcome =
        server_postgres_run(connection, "UPDATE clock SET version = version + 1 RETURNING version, forgotten", NULL, 0,
                            on_integers, version);
    changing->version = (uint64_t)version[0];
    return outcome;
}

/* PRECONDITION: the key has something else than is known. */
static enum server_store_outcome find_current(struct server_postgres_connection *connection, struct changing *changing)
{
    const struct server_sql_value key = server_sql_text(changing->record->key);
    memset(changing->objects, 0, sizeof changing->objects);
    changing->found = 0;
    enum server_store_outcome outcome = server_postgres_run(
        connection, "SELECT version, file, attachment FROM surfaces WHERE key = $1 AND record IS NOT NULL", &key, 1,
        on_current, changing);
    if (outcome) return outcome;
    return (uint64_t)changing->found == changing->before ? SERVER_STORE_DONE : SERVER_STORE_PRECONDITION;
}

/* PRECONDITION: an object is gone that was there when it was staged. */
static enum server_store_outcome write_row(struct server_postgres_connection *connection,
                                           const struct changing *changing)
{
    struct server_object objects[SERVER_PARTS];
    bool has[SERVER_PARTS];
    for (int part = 0; part < SERVER_PARTS; part++)
        has[part] = changing->text && server_record_object(changing->record, part, &objects[part]);
    const struct server_sql_value values[] = {
        server_sql_text(changing->record->key), server_sql_integer((int64_t)changing->version),
        server_sql_text(has[SERVER_PART_FILE] ? objects[SERVER_PART_FILE].id : NULL),
        server_sql_text(has[SERVER_PART_ATTACHMENT] ? objects[SERVER_PART_ATTACHMENT].id : NULL),
        changing->text ? server_sql_bytes(changing->text, changing->size)
                       : (struct server_sql_value){.type = SERVER_SQL_NULL}};
    static const char *const texts[] = {
        "UPDATE surfaces SET version = $2, file = $3, attachment = $4, record = NULL WHERE key = $1",
        "INSERT INTO surfaces (key, version, file, attachment, record) VALUES ($1, $2, $3, $4, $5)"
        " ON CONFLICT (key) DO UPDATE SET version = $2, file = $3, attachment = $4, record = $5"};
    enum server_store_outcome outcome =
        server_postgres_run(connection, texts[changing->text != NULL], values, changing->text ? 5 : 4, NULL, NULL);
    return outcome == SERVER_STORE_STALE ? SERVER_STORE_PRECONDITION : outcome;
}

static enum server_store_outcome drop_objects(struct server_postgres_connection *connection,
                                              const struct changing *changing)
{
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (changing->objects[part][0]) outcome = server_postgres_drop_object(connection, changing->objects[part]);
    return outcome;
}

/* What was removed long ago is forgotten. */
static enum server_store_outcome forget(struct server_postgres_connection *connection, const struct changing *changing)
{
    const struct server_sql_value version = server_sql_integer((int64_t)changing->version);
    return server_postgres_run(
        connection,
        "WITH gone AS (DELETE FROM surfaces WHERE record IS NULL AND version < $1 - " REMEMBERED " RETURNING version)"
        " UPDATE clock SET forgotten = greatest(forgotten, coalesce((SELECT max(version) FROM gone), 0))",
        &version, 1, NULL, NULL);
}

static enum server_store_outcome change(struct server_postgres_connection *connection, void *user)
{
    struct changing *changing = user;
    enum server_store_outcome outcome = advance_clock(connection, changing);
    if (!outcome) outcome = find_current(connection, changing);
    if (!outcome) outcome = write_row(connection, changing);
    if (!outcome) outcome = drop_objects(connection, changing);
    if (!outcome && !changing->text) outcome = forget(connection, changing);
    if (!outcome) outcome = server_postgres_run(connection, "NOTIFY " CHANNEL, NULL, 0, NULL, NULL);
    return outcome;
}

static enum server_store_outcome make_change(struct server_store *store, struct changing *changing, uint64_t *version)
{
    changing->before = *version;
    enum server_store_outcome outcome = server_postgres_transact(store_of(store)->postgres, change, changing);
    if (!outcome) *version = changing->version;
    return outcome == SERVER_STORE_PRECONDITION ? SERVER_STORE_STALE : outcome;
}

static enum server_store_outcome put(struct server_store *store, const struct server_record *record,
                                     const struct server_content *content, uint64_t *version)
{
    struct changing changing = {.record = record};
    (void)content;
    char *text = server_record_write(record, &changing.size);
    if (!text) return SERVER_STORE_NO_MEMORY;
    changing.text = text;
    enum server_store_outcome outcome = make_change(store, &changing, version);
    free(text);
    return outcome;
}

static enum server_store_outcome remove_record(struct server_store *store, const struct server_record *record,
                                               uint64_t *version)
{
    struct changing changing = {.record = record};
    return make_change(store, &changing, version);
}

/* All was seen to when it was staged. */
static enum server_store_outcome keep(struct server_store *store, const struct server_record *record,
                                      const struct server_content *content)
{
    (void)store, (void)record, (void)content;
    return SERVER_STORE_DONE;
}

static void tidy(struct server_store *store)
{
    (void)store;
}

/* --- following ---------------------------------------------------------------------------------------------------- */

/* What a row says; NULL with `*lacks_memory`, or when it can't be read, which is logged. */
static struct server_record *read_record(const char *key, const struct server_sql_value *text, bool *lacks_memory)
{
    struct server_record *record = NULL;
    enum server_record_reading reading = server_record_read_named(key, text->bytes, text->size, &record);
    *lacks_memory = reading == SERVER_RECORD_NO_MEMORY;
    if (reading == SERVER_RECORD_DAMAGED || reading == SERVER_RECORD_NEWER)
        server_log_message(SERVER_LOG_ERROR, "surface_unavailable", "the row of '%s' %s", key,
                           reading == SERVER_RECORD_NEWER ? "was written by a later version of this program"
                                                          : "is damaged: upload it again");
    return reading == SERVER_RECORD_READ ? record : NULL;
}

struct page {
    struct store_postgres *store;
    bool (*visit_change)(void *user, const struct server_store_change *change); /* NULL: it is all that is stored */
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
    if (row[2].type == SERVER_SQL_BYTES) record = read_record(row[0].bytes, &row[2], &page->lacks_memory);
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

/* Visits change by change: a page that is shown again, since the connection was lost, begins where the one before ended. */
static enum server_store_outcome show_changes(struct server_postgres_connection *connection, void *user)
{
    struct page *page = user;
    int64_t clock[2] = {0};
    enum server_store_outcome outcome =
        server_postgres_run(connection, "SELECT version, forgotten FROM clock", NULL, 0, on_integers, clock);
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

static enum server_store_outcome follow(struct server_store *store,
                                        bool (*visit)(void *user, const struct server_store_change *change), void *user)
{
    struct store_postgres *own = store_of(store);
    struct page page = {.store = own, .visit_change = visit, .user = user, .seen = own->seen};
    enum server_store_outcome outcome = server_postgres_read(own->postgres, FOLLOW_NS, show_changes, &page);
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
        outcome = server_postgres_run(connection,
                                      "SELECT key, version, record FROM surfaces WHERE key > $1 AND record IS NOT NULL"
                                      " ORDER BY key LIMIT " PAGE_TEXT,
                                      &last, 1, on_stored, page);
    } while (!outcome && page->rows == PAGE && !page->is_over && !page->lacks_memory);
    return outcome;
}

static enum server_store_outcome read_clock(struct server_postgres_connection *connection, void *user)
{
    return server_postgres_run(connection, "SELECT version, forgotten FROM clock", NULL, 0, on_integers, user);
}

/* What changes while all is shown is shown again by the next follow. */
static enum server_store_outcome each(struct server_store *store,
                                      bool (*visit)(void *user, const struct server_stored *stored), void *user)
{
    struct store_postgres *own = store_of(store);
    struct page page = {.store = own, .visit_stored = visit, .user = user};
    int64_t clock[2] = {0};
    enum server_store_outcome outcome = server_postgres_read(own->postgres, LOAD_NS, read_clock, clock);
    if (!outcome) outcome = server_postgres_read(own->postgres, LOAD_NS, show_all, &page);
    if (page.lacks_memory || page.is_over) return SERVER_STORE_NO_MEMORY;
    if (!outcome) own->seen = (uint64_t)clock[0];
    return outcome;
}

static void tell_turn(struct store_postgres *own, bool is_away, const char *error)
{
    if (is_away == own->was_away) return;
    own->was_away = is_away;
    if (is_away)
        server_log_message(SERVER_LOG_ERROR, "database_away", "%s", error);
    else
        server_log_message(SERVER_LOG_INFO, "database_back", "the database answers again");
}

static bool listen_anew(struct store_postgres *own)
{
    char error[SERVER_POSTGRES_ERROR];
    if (server_postgres_take(own->postgres, true, &own->listener, error)) {
        own->listener = NULL;
        tell_turn(own, server_postgres_is_away(own->postgres), error);
        return false;
    }
    if (server_postgres_run(own->listener, "LISTEN " CHANNEL, NULL, 0, NULL, NULL)) return false;
    server_postgres_has_answered(own->postgres);
    tell_turn(own, false, error);
    return true;
}

static void rest(uint64_t ns)
{
    const struct timespec pause = {.tv_sec = (time_t)(ns / 1000000000), .tv_nsec = (long)(ns % 1000000000)};
    nanosleep(&pause, NULL);
}

/* Objects whose upload was cut short before it had a surface go after a day; nobody can give them to one while the clock is held. */
static enum server_store_outcome drop_forsaken(struct server_postgres_connection *connection, void *user)
{
    (void)user;
    enum server_store_outcome outcome =
        server_postgres_run(connection, "SELECT version FROM clock FOR UPDATE", NULL, 0, NULL, NULL);
    if (outcome) return outcome;
    return server_postgres_run(connection,
                               "DELETE FROM objects WHERE created < now() - interval '1 day'"
                               " AND NOT EXISTS (SELECT FROM surfaces WHERE file = id)"
                               " AND NOT EXISTS (SELECT FROM surfaces WHERE attachment = id)",
                               NULL, 0, NULL, NULL);
}

static void sweep(struct store_postgres *own)
{
    uint64_t now_ns = gd_now_ns();
    if (own->swept_ns && now_ns - own->swept_ns < SWEEP_NS) return;
    own->swept_ns = now_ns;
    (void)server_postgres_transact(own->postgres, drop_forsaken, NULL);
}

/* Who listens is also who finds out that the database is back. */
static void await(struct server_store *store, uint64_t ns)
{
    struct store_postgres *own = store_of(store);
    sweep(own);
    bool listens = own->listener || listen_anew(own);
    if (listens && !server_postgres_is_away(own->postgres) && server_postgres_await(own->listener, ns)) return;
    if (own->listener) server_postgres_give(own->postgres, own->listener);
    own->listener = NULL;
    rest(ns);
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

struct fetching {
    struct server_object object;
    void *bytes;
    uint64_t number; /* chunk to be looked at */
    size_t size;     /* of that chunk */
};

static enum server_store_outcome read_object(struct server_postgres_connection *connection, void *user)
{
    const struct fetching *fetching = user;
    return server_postgres_read_object(connection, &fetching->object, fetching->bytes);
}

static enum server_store_outcome fetch(struct server_store *store, const struct server_record *record,
                                       enum server_part part, void **bytes)
{
    struct fetching fetching;
    if (!server_record_object(record, part, &fetching.object)) return SERVER_STORE_ABSENT;
    fetching.bytes = malloc(fetching.object.size ? fetching.object.size : 1);
    if (!fetching.bytes) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome =
        server_postgres_read(store_of(store)->postgres, LOAD_NS, read_object, &fetching);
    if (outcome)
        free(fetching.bytes);
    else
        *bytes = fetching.bytes;
    return outcome;
}

static enum server_store_outcome check_chunk(struct server_postgres_connection *connection, void *user)
{
    struct fetching *fetching = user;
    return server_postgres_check_chunk(connection, &fetching->object, fetching->number, &fetching->size);
}

/* The bytes stay where they are: the database compares. */
static enum server_store_verdict verify(struct server_store *store, const struct server_record *record,
                                        enum server_part part, bool (*pace)(void *user, size_t bytes), void *user)
{
    struct fetching fetching = {.bytes = NULL};
    if (!server_record_object(record, part, &fetching.object)) return SERVER_VERDICT_MISSING;
    for (; fetching.number < server_postgres_chunks(&fetching.object); fetching.number++) {
        switch (server_postgres_read(store_of(store)->postgres, LOAD_NS, check_chunk, &fetching)) {
        case SERVER_STORE_DONE:
            break;
        case SERVER_STORE_ABSENT:
            return fetching.number ? SERVER_VERDICT_DAMAGED : SERVER_VERDICT_MISSING;
        case SERVER_STORE_DAMAGED:
            return SERVER_VERDICT_DAMAGED;
        case SERVER_STORE_REFUSED:
            return SERVER_VERDICT_UNREADABLE;
        default:
            return SERVER_VERDICT_NONE;
        }
        if (!pace(user, fetching.size)) return SERVER_VERDICT_NONE;
    }
    return SERVER_VERDICT_SOUND;
}

/* --- the rest ----------------------------------------------------------------------------------------------------- */

/* What a node has used most says little about the others: nothing is loaded before it is asked for. */
static void note_uses(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count)
{
    (void)store, (void)records, (void)uses, (void)count;
}

static const char *health(struct server_store *store)
{
    return server_postgres_is_away(store_of(store)->postgres) ? AWAY : NULL;
}

static void close_store(struct server_store *store)
{
    struct store_postgres *own = store_of(store);
    if (own->listener) server_postgres_give(own->postgres, own->listener);
    server_postgres_destroy(own->postgres);
    free(own);
}

/* Until it answers, for a while; a refusal is final. */
static enum server_store_outcome reach(struct server_postgres *postgres, char error[SERVER_POSTGRES_ERROR])
{
    struct server_postgres_connection *connection;
    uint64_t until_ns = gd_now_ns() + START_NS;
    enum server_store_outcome outcome;
    while ((outcome = server_postgres_take(postgres, true, &connection, error)) == SERVER_STORE_UNAVAILABLE &&
           gd_now_ns() < until_ns)
        rest(200000000);
    if (!outcome) server_postgres_give(postgres, connection);
    return outcome;
}

/* False with a sentence. */
static bool prepare(struct server_postgres *postgres, char *error, size_t error_size)
{
    char reason[SERVER_POSTGRES_ERROR];
    if (reach(postgres, reason)) {
        snprintf(error, error_size, "the database of --store can't be reached: %s", reason);
        return false;
    }
    uint64_t until_ns = gd_now_ns() + START_NS;
    enum server_store_outcome outcome;
    do outcome = server_postgres_migrate(postgres);
    while (outcome == SERVER_STORE_UNAVAILABLE && gd_now_ns() < until_ns);
    switch (outcome) {
    case SERVER_STORE_DONE:
        return true;
    case SERVER_STORE_PRECONDITION:
        snprintf(error, error_size, "a later version of this program made the tables of --store; start that one");
        return false;
    default:
        snprintf(error, error_size, "the tables of --store can't be made; the lines before say why");
        return false;
    }
}

struct server_store *server_store_postgres_open(const char *url, char *error, size_t error_size)
{
    struct store_postgres *own = calloc(1, sizeof *own);
    snprintf(error, error_size, "out of memory");
    if (!own) return NULL;
    own->store = (struct server_store){.each = each,
                                       .stage = stage,
                                       .put = put,
                                       .keep = keep,
                                       .remove = remove_record,
                                       .tidy = tidy,
                                       .fetch = fetch,
                                       .verify = verify,
                                       .follow = follow,
                                       .await = await,
                                       .note_uses = note_uses,
                                       .health = health,
                                       .close = close_store};
    own->postgres = server_postgres_create(url);
    if (own->postgres && prepare(own->postgres, error, error_size)) return &own->store;
    server_postgres_destroy(own->postgres);
    free(own);
    return NULL;
}
