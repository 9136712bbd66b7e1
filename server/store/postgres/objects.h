/* Objects of a PostgreSQL store: files and attachments (record.h) as rows of a MiB each. Each
 * function is a step of a transaction, or a reading, on one connection: it answers as
 * server_postgres_run. */
#ifndef SERVER_STORE_POSTGRES_OBJECTS_H
#define SERVER_STORE_POSTGRES_OBJECTS_H

#include "server/store/postgres/transactions.h"
#include "server/store/store.h"

/* Writes what is not there, whole, chunk by chunk: those that are there and whole are only looked
 * at, by the database itself. */
enum server_store_outcome
server_postgres_write_object(struct server_postgres_connection *connection,
                             const struct server_object *object, const void *bytes);

/* Deletes the object (NULL: none), unless a surface has it. */
enum server_store_outcome server_postgres_drop_object(struct server_postgres_connection *connection,
                                                      const char *object);

/* Reads it into `bytes`, of its size, and compares it with its name. ABSENT: there is none;
 * DAMAGED. */
enum server_store_outcome server_postgres_read_object(struct server_postgres_connection *connection,
                                                      const struct server_object *object,
                                                      void *bytes);

/* Has the database compare one chunk with its checksum, which it answers with its size. ABSENT;
 * DAMAGED. */
enum server_store_outcome server_postgres_check_chunk(struct server_postgres_connection *connection,
                                                      const struct server_object *object,
                                                      uint64_t number, size_t *size);

/* How many chunks it has. */
uint64_t server_postgres_chunks(const struct server_object *object);

#endif
