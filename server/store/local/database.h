/* Store database: the records of a local store as rows of SQLite. It is the store's fast index:
 * each row has a manifest (record.h) beside it, from which it can be made again.
 *
 * One connection, used by one thread at a time, writes and does all checkpoints itself, when it
 * sees fit to: SQLite 3.40 can reset its log wrongly when two connections do. Every statement
 * answers with an outcome of the store: READ_ONLY means that SQLite could not write or sync. */
#ifndef SERVER_STORE_LOCAL_DATABASE_H
#define SERVER_STORE_LOCAL_DATABASE_H

#include "server/store/store.h"

struct server_database;

/* Opens or creates the file, checks it from end to end and brings it to today's schema. DAMAGED: it
 * is to be put aside and made again. */
enum server_store_outcome server_database_open(const char *path, struct server_database **out);

/* Opens it to read it, for a moment, while another process may be writing: nothing is changed, but
 * for the index of a log (-shm) that a crash left. ABSENT: there is none, or it has no tables yet.
 */
enum server_store_outcome server_database_open_to_read(const char *path,
                                                       struct server_database **out);

/* Likewise one with whatever tables (batch_queue.h): to check it, which this does, and to copy it.
 */
enum server_store_outcome server_database_open_to_copy(const char *path,
                                                       struct server_database **out);

/* Closes. `is_sound`: what is in the log may go into the database. NULL is harmless. */
void server_database_close(struct server_database *database, bool is_sound);

struct server_row {         /* borrowed, for the time of a visit */
    const char *key, *text; /* `text`: the record, `size` bytes, unchecked */
    size_t size;
    struct server_store_uses uses;
};

/* Visits the rows in the order of their keys; the visitor returns false to end it. */
enum server_store_outcome
server_database_each(struct server_database *database,
                     bool (*visit)(void *user, const struct server_row *row), void *user);

enum server_store_outcome server_database_put(struct server_database *database,
                                              const struct server_record *record);
enum server_store_outcome server_database_remove(struct server_database *database, const char *key);

/* How many rows name this object, as file or attachment. */
enum server_store_outcome server_database_count(struct server_database *database,
                                                const char *object, int64_t *count);

/* Ids of the objects that the key has now, empty where it has none; ABSENT. */
enum server_store_outcome server_database_find(struct server_database *database, const char *key,
                                               char objects[SERVER_PARTS][SERVER_OBJECT]);

enum server_store_outcome server_database_note_uses(struct server_database *database,
                                                    const struct server_record *const *records,
                                                    const struct server_store_uses *uses,
                                                    uint32_t count);

/* Copies the database, as it is at one moment, into a new file. */
enum server_store_outcome server_database_copy(struct server_database *database, const char *path);

/* False once the log could not be moved into the database: then every write is refused. */
bool server_database_is_sound(const struct server_database *database);

/* What SQLite says of the last failure. */
const char *server_database_error(struct server_database *database);

#endif
