/* Schema: the tables of the store's database, and how older ones become today's. */
#ifndef SERVER_STORE_LOCAL_SCHEMA_H
#define SERVER_STORE_LOCAL_SCHEMA_H

#include "server/store/store.h"

struct sqlite3;

/* SQL that makes version i + 1 of version i. Steps are added at the end and never changed. */
extern const char *const server_store_schema[];
extern const int server_store_schema_version; /* how many there are */

/* Brings the database from the version in its user_version to `version` by `steps`, in one
 * transaction. A database that is not new is copied to `copy_path` first. DAMAGED: the version is
 * none that there was, or a step fails. */
enum server_store_outcome server_store_migrate(struct sqlite3 *database, const char *const *steps,
                                               int version, const char *copy_path);

/* The version that the database says it has; 0: it has no tables yet. */
enum server_store_outcome server_store_version(struct sqlite3 *database, int *version);

/* A copy in memory of a database of an earlier version, brought to today's; for the caller to
 * close. The database stays as it is. */
enum server_store_outcome server_store_lift(struct sqlite3 *database, struct sqlite3 **out);

/* Copies the database, as it is at one moment, into a new file. */
enum server_store_outcome server_store_copy(struct sqlite3 *database, const char *path);

/* What an SQLite result code means for the store. */
enum server_store_outcome server_store_outcome_of(int code);

#endif
