/* See store_postgres_objects.h. */
#include "server/store/postgres/objects.h"

#define CHUNK ((size_t)1 << 20)

struct chunk {
    uint64_t number;
    const char *bytes;
    size_t size;
    char digest[SERVER_SHA256_HEX];
};

uint64_t server_postgres_chunks(const struct server_object *object)
{
    return (object->size + CHUNK - 1) / CHUNK;
}

static size_t chunk_size(const struct server_object *object, uint64_t number)
{
    uint64_t left = object->size - number * CHUNK;
    return left < CHUNK ? (size_t)left : CHUNK;
}

static bool on_row(void *user, const struct server_sql_value *row)
{
    bool *is_there = user;
    (void)row;
    *is_there = true;
    return true;
}

/* --- writing ---------------------------------------------------------------------------------- */

/* Is it there, and whole? */
static enum server_store_outcome find_chunk(struct server_postgres_connection *connection,
                                            const struct server_object *object,
                                            const struct chunk *chunk, bool *is_there)
{
    const struct server_sql_value values[] = {server_sql_text(object->id),
                                              server_sql_integer((int64_t)chunk->number),
                                              server_sql_text(chunk->digest)};
    *is_there = false;
    return server_postgres_run(
        connection,
        "SELECT true FROM chunks WHERE object = $1 AND number = $2 AND digest = $3"
        " AND encode(sha256(bytes), 'hex') = $3",
        values, 3, on_row, is_there);
}

static enum server_store_outcome put_chunk(struct server_postgres_connection *connection,
                                           const struct server_object *object,
                                           const struct chunk *chunk)
{
    const struct server_sql_value values[] = {
        server_sql_text(object->id), server_sql_integer((int64_t)chunk->number),
        server_sql_text(chunk->digest), server_sql_bytes(chunk->bytes, chunk->size)};
    return server_postgres_run(
        connection,
        "INSERT INTO chunks (object, number, digest, bytes) VALUES ($1, $2, $3, $4)"
        " ON CONFLICT (object, number) DO UPDATE SET digest = $3, bytes = $4",
        values, 4, NULL, NULL);
}

static enum server_store_outcome write_chunk(struct server_postgres_connection *connection,
                                             const struct server_object *object,
                                             const struct chunk *chunk, bool is_new)
{
    bool is_there = false;
    enum server_store_outcome outcome =
        is_new ? SERVER_STORE_DONE : find_chunk(connection, object, chunk, &is_there);
    return outcome || is_there ? outcome : put_chunk(connection, object, chunk);
}

enum server_store_outcome
server_postgres_write_object(struct server_postgres_connection *connection,
                             const struct server_object *object, const void *bytes)
{
    const struct server_sql_value values[] = {server_sql_text(object->id),
                                              server_sql_integer((int64_t)object->size)};
    bool is_new = false;
    enum server_store_outcome outcome = server_postgres_run(
        connection,
        "INSERT INTO objects (id, size) VALUES ($1, $2) ON CONFLICT (id) DO NOTHING RETURNING true",
        values, 2, on_row, &is_new);
    for (uint64_t i = 0; !outcome && i < server_postgres_chunks(object); i++) {
        struct chunk chunk = {
            .number = i, .bytes = (const char *)bytes + i * CHUNK, .size = chunk_size(object, i)};
        server_sha256(chunk.bytes, chunk.size, chunk.digest);
        outcome = write_chunk(connection, object, &chunk, is_new);
    }
    return outcome;
}

enum server_store_outcome server_postgres_drop_object(struct server_postgres_connection *connection,
                                                      const char *object)
{
    const struct server_sql_value id = server_sql_text(object);
    if (!object) return SERVER_STORE_DONE;
    return server_postgres_run(connection,
                               "DELETE FROM objects WHERE id = $1"
                               " AND NOT EXISTS (SELECT FROM surfaces WHERE file = $1)"
                               " AND NOT EXISTS (SELECT FROM surfaces WHERE attachment = $1)",
                               &id, 1, NULL, NULL);
}

/* --- reading ---------------------------------------------------------------------------------- */

struct reading {
    char *bytes;
    size_t size;
    bool is_there, fits;
};

static bool on_chunk(void *user, const struct server_sql_value *row)
{
    struct reading *reading = user;
    reading->is_there = true;
    reading->fits = row[0].type == SERVER_SQL_BYTES && row[0].size == reading->size;
    if (reading->fits) memcpy(reading->bytes, row[0].bytes, reading->size);
    return true;
}

static enum server_store_outcome read_chunk(struct server_postgres_connection *connection,
                                            const struct server_object *object, uint64_t number,
                                            char *bytes)
{
    struct reading reading = {.bytes = bytes + number * CHUNK, .size = chunk_size(object, number)};
    const struct server_sql_value values[] = {server_sql_text(object->id),
                                              server_sql_integer((int64_t)number)};
    enum server_store_outcome outcome = server_postgres_run(
        connection, "SELECT bytes FROM chunks WHERE object = $1 AND number = $2", values, 2,
        on_chunk, &reading);
    if (outcome) return outcome;
    if (!reading.is_there) return number ? SERVER_STORE_DAMAGED : SERVER_STORE_ABSENT;
    return reading.fits ? SERVER_STORE_DONE : SERVER_STORE_DAMAGED;
}

enum server_store_outcome server_postgres_read_object(struct server_postgres_connection *connection,
                                                      const struct server_object *object,
                                                      void *bytes)
{
    char sha256[SERVER_SHA256_HEX];
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    for (uint64_t i = 0; !outcome && i < server_postgres_chunks(object); i++)
        outcome = read_chunk(connection, object, i, bytes);
    if (outcome) return outcome;
    server_sha256(bytes, object->size, sha256);
    return strncmp(object->id, sha256, strlen(sha256)) == 0 ? SERVER_STORE_DONE
                                                            : SERVER_STORE_DAMAGED;
}

/* --- looking ---------------------------------------------------------------------------------- */

struct look {
    bool is_there, is_sound;
    int64_t size;
};

static bool on_look(void *user, const struct server_sql_value *row)
{
    *(struct look *)user =
        (struct look){.is_there = true, .is_sound = row[0].integer != 0, .size = row[1].integer};
    return true;
}

enum server_store_outcome server_postgres_check_chunk(struct server_postgres_connection *connection,
                                                      const struct server_object *object,
                                                      uint64_t number, size_t *size)
{
    const struct server_sql_value values[] = {server_sql_text(object->id),
                                              server_sql_integer((int64_t)number)};
    struct look look = {0};
    enum server_store_outcome outcome =
        server_postgres_run(connection,
                            "SELECT (encode(sha256(bytes), 'hex') = digest)::int::bigint, "
                            "length(bytes)::bigint FROM chunks"
                            " WHERE object = $1 AND number = $2",
                            values, 2, on_look, &look);
    if (outcome) return outcome;
    if (!look.is_there) return SERVER_STORE_ABSENT;
    *size = (size_t)look.size;
    return look.is_sound && *size == chunk_size(object, number) ? SERVER_STORE_DONE
                                                                : SERVER_STORE_DAMAGED;
}
