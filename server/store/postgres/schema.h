/* Schema of a PostgreSQL store: its tables, in the schema `geodesicd`, and how they came to be.
 *
 *     migrations  version                                    of the steps that were made
 *     clock       version, forgotten                         one row: the last change's version; up
 * to `forgotten`, what was removed is not known any more objects     id, size, created files and
 * attachments (record.h), immutable chunks      object, number, digest, bytes              an
 * object's bytes, by the MiB, each with its own SHA-256 surfaces    key, version, file, attachment,
 * record     a surface; without a record: there was one batches, items see batch_queue.h
 *
 * Who changes a surface locks the clock's row first, until it commits. So versions are committed in
 * their order: who has seen one has seen all those before it. */
#ifndef SERVER_STORE_POSTGRES_SCHEMA_H
#define SERVER_STORE_POSTGRES_SCHEMA_H

#include "server/store/postgres/transactions.h"

/* Makes the tables, or brings them up to date; one process at a time, the others wait.
 * PRECONDITION: a later version of this program made them. Else as server_postgres_transact. */
enum server_store_outcome server_postgres_migrate(struct server_postgres *postgres);

#endif
