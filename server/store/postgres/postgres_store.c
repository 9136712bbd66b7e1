/* See store.h: the store in a PostgreSQL database, which many daemons share. Its tables:
 * store_postgres_schema.h. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/control.h"
#include "server/store/postgres/postgres_store.h"
#include "server/store/postgres/objects.h"
#include "server/store/postgres/schema.h"

#define REMEMBERED "100000"              /* changes for which what was removed is remembered */
#define START_NS   UINT64_C(10000000000) /* to reach the database at the start */
#define AWAY                                                                                       \
    "the database does not answer: what is in memory is served, changes are refused until it is "  \
    "back"

/* --- objects ---------------------------------------------------------------------------------- */

struct staging {
    const struct server_record *record;
    const struct server_content *content;
};

static enum server_store_outcome write_objects(struct server_postgres_connection *connection,
                                               void *user)
{
    const struct staging *staging = user;
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    struct server_object object;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (server_record_object(staging->record, part, &object))
            outcome =
                server_postgres_write_object(connection, &object, staging->content->parts[part]);
    return outcome;
}

static enum server_store_outcome stage(struct server_store *store,
                                       const struct server_record *record,
                                       const struct server_content *content)
{
    struct staging staging = {record, content};
    return server_postgres_transact(server_store_postgres_of(store)->postgres, write_objects,
                                    &staging);
}

/* --- changes ---------------------------------------------------------------------------------- */

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

static bool on_version(void *user, const struct server_sql_value *row)
{
    struct changing *changing = user;
    changing->version = (uint64_t)row[0].integer;
    return true;
}

/* From now on until the end of the transaction nobody else changes anything. */
static enum server_store_outcome advance_clock(struct server_postgres_connection *connection,
                                               struct changing *changing)
{
    return server_postgres_run(connection,
                               "UPDATE clock SET version = version + 1 RETURNING version", NULL, 0,
                               on_version, changing);
}

/* PRECONDITION: the key has something else than is known. */
static enum server_store_outcome find_current(struct server_postgres_connection *connection,
                                              struct changing *changing)
{
    const struct server_sql_value key = server_sql_text(changing->record->key);
    memset(changing->objects, 0, sizeof changing->objects);
    changing->found = 0;
    enum server_store_outcome outcome = server_postgres_run(
        connection,
        "SELECT version, file, attachment FROM surfaces WHERE key = $1 AND record IS NOT NULL",
        &key, 1, on_current, changing);
    if (outcome) return outcome;
    return (uint64_t)changing->found == changing->before ? SERVER_STORE_DONE
                                                         : SERVER_STORE_PRECONDITION;
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
        "UPDATE surfaces SET version = $2, file = $3, attachment = $4, record = NULL WHERE key = "
        "$1",
        "INSERT INTO surfaces (key, version, file, attachment, record) VALUES ($1, $2, $3, $4, $5)"
        " ON CONFLICT (key) DO UPDATE SET version = $2, file = $3, attachment = $4, record = $5"};
    enum server_store_outcome outcome = server_postgres_run(
        connection, texts[changing->text != NULL], values, changing->text ? 5 : 4, NULL, NULL);
    return outcome == SERVER_STORE_STALE ? SERVER_STORE_PRECONDITION : outcome;
}

static enum server_store_outcome drop_objects(struct server_postgres_connection *connection,
                                              const struct changing *changing)
{
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (changing->objects[part][0])
            outcome = server_postgres_drop_object(connection, changing->objects[part]);
    return outcome;
}

/* What was removed long ago is forgotten. */
static enum server_store_outcome forget(struct server_postgres_connection *connection,
                                        const struct changing *changing)
{
    const struct server_sql_value version = server_sql_integer((int64_t)changing->version);
    return server_postgres_run(
        connection,
        "WITH gone AS (DELETE FROM surfaces WHERE record IS NULL AND version < $1 - " REMEMBERED
        " RETURNING version)"
        " UPDATE clock SET forgotten = greatest(forgotten, coalesce((SELECT max(version) FROM "
        "gone), 0))",
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
    if (!outcome)
        outcome = server_postgres_run(connection, "NOTIFY " SERVER_STORE_POSTGRES_CHANNEL, NULL, 0,
                                      NULL, NULL);
    return outcome;
}

static enum server_store_outcome make_change(struct server_store *store, struct changing *changing,
                                             uint64_t *version)
{
    changing->before = *version;
    enum server_store_outcome outcome =
        server_postgres_transact(server_store_postgres_of(store)->postgres, change, changing);
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

static enum server_store_outcome
remove_record(struct server_store *store, const struct server_record *record, uint64_t *version)
{
    struct changing changing = {.record = record};
    return make_change(store, &changing, version);
}

/* All was seen to when it was staged. */
static enum server_store_outcome keep(struct server_store *store,
                                      const struct server_record *record,
                                      const struct server_content *content)
{
    (void)store, (void)record, (void)content;
    return SERVER_STORE_DONE;
}

static void tidy(struct server_store *store)
{
    (void)store;
}

/* --- reading ---------------------------------------------------------------------------------- */

struct fetching {
    struct server_object object;
    void *bytes;
    uint64_t number; /* chunk to be looked at */
    size_t size;     /* of that chunk */
};

static enum server_store_outcome read_object(struct server_postgres_connection *connection,
                                             void *user)
{
    const struct fetching *fetching = user;
    return server_postgres_read_object(connection, &fetching->object, fetching->bytes);
}

static enum server_store_outcome fetch(struct server_store *store,
                                       const struct server_record *record, enum server_part part,
                                       void **bytes)
{
    struct fetching fetching;
    if (!server_record_object(record, part, &fetching.object)) return SERVER_STORE_ABSENT;
    fetching.bytes = malloc(fetching.object.size ? fetching.object.size : 1);
    if (!fetching.bytes) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome =
        server_postgres_read(server_store_postgres_of(store)->postgres,
                             SERVER_STORE_POSTGRES_LOAD_NS, read_object, &fetching);
    if (outcome)
        free(fetching.bytes);
    else
        *bytes = fetching.bytes;
    return outcome;
}

static enum server_store_outcome check_chunk(struct server_postgres_connection *connection,
                                             void *user)
{
    struct fetching *fetching = user;
    return server_postgres_check_chunk(connection, &fetching->object, fetching->number,
                                       &fetching->size);
}

/* The bytes stay where they are: the database compares. */
static enum server_store_verdict verify(struct server_store *store,
                                        const struct server_record *record, enum server_part part,
                                        bool (*pace)(void *user, size_t bytes), void *user)
{
    struct fetching fetching = {.bytes = NULL};
    if (!server_record_object(record, part, &fetching.object)) return SERVER_VERDICT_MISSING;
    for (; fetching.number < server_postgres_chunks(&fetching.object); fetching.number++) {
        switch (server_postgres_read(server_store_postgres_of(store)->postgres,
                                     SERVER_STORE_POSTGRES_LOAD_NS, check_chunk, &fetching)) {
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

/* --- the rest --------------------------------------------------------------------------------- */

/* What a node has used most says little about the others: nothing is loaded before it is asked for.
 */
static void note_uses(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count)
{
    (void)store, (void)records, (void)uses, (void)count;
}

static const char *health(struct server_store *store)
{
    return server_postgres_is_away(server_store_postgres_of(store)->postgres) ? AWAY : NULL;
}

static void close_store(struct server_store *store)
{
    struct server_store_postgres *own = server_store_postgres_of(store);
    if (own->listener) server_postgres_give(own->postgres, own->listener);
    server_postgres_destroy(own->postgres);
    free(own);
}

/* Until it answers, for a while; a refusal is final. */
static enum server_store_outcome reach(struct server_postgres *postgres,
                                       char error[SERVER_POSTGRES_ERROR])
{
    struct server_postgres_connection *connection;
    uint64_t until_ns = gd_now_ns() + START_NS;
    enum server_store_outcome outcome;
    while ((outcome = server_postgres_take(postgres, true, &connection, error)) ==
               SERVER_STORE_UNAVAILABLE &&
           gd_now_ns() < until_ns)
        server_store_postgres_rest(200000000);
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
        snprintf(error, error_size,
                 "a later version of this program made the tables of --store; start that one");
        return false;
    default:
        snprintf(error, error_size,
                 "the tables of --store can't be made; the lines before say why");
        return false;
    }
}

struct server_store *server_store_postgres_open(const char *url, char *error, size_t error_size)
{
    struct server_store_postgres *own = calloc(1, sizeof *own);
    snprintf(error, error_size, "out of memory");
    if (!own) return NULL;
    own->store = (struct server_store){.each = server_store_postgres_each,
                                       .stage = stage,
                                       .put = put,
                                       .keep = keep,
                                       .remove = remove_record,
                                       .tidy = tidy,
                                       .fetch = fetch,
                                       .verify = verify,
                                       .follow = server_store_postgres_follow,
                                       .await = server_store_postgres_await,
                                       .note_uses = note_uses,
                                       .health = health,
                                       .close = close_store};
    own->postgres = server_postgres_create(url);
    if (own->postgres && prepare(own->postgres, error, error_size)) return &own->store;
    server_postgres_destroy(own->postgres);
    free(own);
    return NULL;
}
