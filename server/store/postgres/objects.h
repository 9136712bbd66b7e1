/* Objects of a PostgreSQL store: files and attachments (record.h) as rows of a MiB each. Each
 * function is a part of a transaction, or a reading, on one connection, with the outcomes of
 * server_pg_run. */
#ifndef SERVER_STORE_POSTGRES_OBJECTS_H
#define SERVER_STORE_POSTGRES_OBJECTS_H

#include "server/store/postgres/connection.h"

/* Writes the chunks that are missing or damaged; the database verifies the others. */
enum server_store_outcome
server_pg_write_object(struct server_pg *pg, const struct server_object *object, const void *bytes);

/* Deletes the object, unless a surface has it. */
enum server_store_outcome server_pg_drop_object(struct server_pg *pg, const char *object);

/* Reads the object into `bytes`, of its size, and verifies it. ABSENT; DAMAGED. */
enum server_store_outcome server_pg_read_object(struct server_pg *pg,
                                                const struct server_object *object, void *bytes);

/* Has the database verify one chunk; returns its size. ABSENT; DAMAGED. */
enum server_store_outcome server_pg_check_chunk(struct server_pg *pg,
                                                const struct server_object *object, uint64_t number,
                                                size_t *size);

/* The number of chunks of the object. */
uint64_t server_pg_chunks(const struct server_object *object);

/* Makes the tables (schema.c), or migrates them; one process at a time. PRECONDITION: a later
 * version made them. Else as a transaction. */
enum server_store_outcome server_pg_migrate(struct server_pg_pool *pool);

#endif
