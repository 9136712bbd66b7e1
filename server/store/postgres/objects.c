/* See connection.h: objects. */
#include "server/store/postgres/connection.h"

#define CHUNK ((size_t)1 << 20)

uint64_t server_pg_chunks(const struct server_object *object)
{
    return (object->size + CHUNK - 1) / CHUNK;
}

static size_t chunk_size(const struct server_object *object, uint64_t number)
{
    uint64_t left = object->size - number * CHUNK;
    return left < CHUNK ? (size_t)left : CHUNK;
}

static enum server_outcome chunk_write(struct server_pg *pg, const struct server_object *object,
                                       uint64_t number, const char *bytes, bool is_new)
{
    char digest[SERVER_SHA256_HEX];
    size_t size = chunk_size(object, number);
    server_sha256(bytes, size, digest);
    const struct server_sql_value values[] = {
        server_sql_text(object->id), server_sql_integer((int64_t)number), server_sql_text(digest),
        server_sql_bytes(bytes, size)};
    struct server_sql_integers sound = {0};
    enum server_outcome outcome = SERVER_STORE_DONE;
    if (!is_new)
        outcome = server_pg_run(
            pg,
            SERVER_SQL("SELECT true FROM chunks WHERE object = $1 AND number = $2 AND digest = $3"
                       " AND encode(sha256(bytes), 'hex') = $3",
                       values, 3, server_sql_on_integers, &sound));
    if (outcome || sound.rows) return outcome;
    return server_pg_run(
        pg, SERVER_SQL("INSERT INTO chunks (object, number, digest, bytes) VALUES ($1, $2, $3, $4)"
                       " ON CONFLICT (object, number) DO UPDATE SET digest = $3, bytes = $4",
                       values, 4));
}

enum server_outcome server_pg_write_object(struct server_pg *pg, const struct server_object *object,
                                           const void *bytes)
{
    struct server_sql_integers made = {0};
    enum server_outcome outcome =
        server_pg_run(pg, SERVER_SQL("INSERT INTO objects (id, size) VALUES ($1, $2)"
                                     " ON CONFLICT (id) DO NOTHING RETURNING true",
                                     SERVER_VALUES(server_sql_text(object->id),
                                                   server_sql_integer((int64_t)object->size)),
                                     server_sql_on_integers, &made));
    for (uint64_t i = 0; !outcome && i < server_pg_chunks(object); i++)
        outcome = chunk_write(pg, object, i, (const char *)bytes + i * CHUNK, made.rows);
    return outcome;
}

struct chunk_reading {
    char *bytes;
    size_t size;
    bool is_there, fits;
};

static bool on_chunk(void *user, const struct server_sql_value *row)
{
    struct chunk_reading *reading = user;
    reading->is_there = true;
    reading->fits = row[0].type == SERVER_SQL_BYTES && row[0].size == reading->size;
    if (reading->fits) memcpy(reading->bytes, row[0].bytes, reading->size);
    return true;
}

static enum server_outcome chunk_read(struct server_pg *pg, const struct server_object *object,
                                      uint64_t number, char *bytes)
{
    struct chunk_reading reading = {.bytes = bytes, .size = chunk_size(object, number)};
    enum server_outcome outcome = server_pg_run(
        pg,
        SERVER_SQL("SELECT bytes FROM chunks WHERE object = $1 AND number = $2",
                   SERVER_VALUES(server_sql_text(object->id), server_sql_integer((int64_t)number)),
                   on_chunk, &reading));
    if (outcome || reading.fits) return outcome;
    return reading.is_there || number ? SERVER_STORE_DAMAGED : SERVER_STORE_ABSENT;
}

enum server_outcome server_pg_read_object(struct server_pg *pg, const struct server_object *object,
                                          void *bytes)
{
    char sha256[SERVER_SHA256_HEX];
    enum server_outcome outcome = SERVER_STORE_DONE;
    for (uint64_t i = 0; !outcome && i < server_pg_chunks(object); i++)
        outcome = chunk_read(pg, object, i, (char *)bytes + i * CHUNK);
    if (outcome) return outcome;
    server_sha256(bytes, object->size, sha256);
    return strncmp(object->id, sha256, strlen(sha256)) == 0 ? SERVER_STORE_DONE
                                                            : SERVER_STORE_DAMAGED;
}

enum server_outcome server_pg_check_chunk(struct server_pg *pg, const struct server_object *object,
                                          uint64_t number, size_t *size)
{
    struct server_sql_integers found = {0}; /* 1 if the chunk is sound, and its size */
    enum server_outcome outcome = server_pg_run(
        pg,
        SERVER_SQL("SELECT (encode(sha256(bytes), 'hex') = digest)::int::bigint,"
                   " length(bytes)::bigint FROM chunks"
                   " WHERE object = $1 AND number = $2",
                   SERVER_VALUES(server_sql_text(object->id), server_sql_integer((int64_t)number)),
                   server_sql_on_integers, &found));
    if (outcome) return outcome;
    if (!found.rows) return SERVER_STORE_ABSENT;
    *size = (size_t)found.at[1];
    return found.at[0] && *size == chunk_size(object, number) ? SERVER_STORE_DONE
                                                              : SERVER_STORE_DAMAGED;
}
