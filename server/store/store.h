/* Store: keeps surfaces beyond the life of the process. This is the interface of a back-end:
 * memory.c stores nothing, local/ uses SQLite and files in a folder, postgres/ a PostgreSQL
 * database that many daemons share. The registry does the rest: order, conditional requests, and
 * loaded surfaces.
 *
 * A shared store gives each change of a surface a version; versions grow in the order of the
 * changes. The registry passes the last version that it has seen. If the surface has another one,
 * the outcome is STALE: the registry calls follow and decides again.
 *
 * Threads. Under the registry's writer lock one thread at a time calls stage, put, keep, remove,
 * tidy and note_uses; under its follower's lock, each and follow. One thread calls await. Any
 * thread calls fetch, verify, damaged and health. The first call is each. */
#ifndef SERVER_STORE_STORE_H
#define SERVER_STORE_STORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "server/base/disk.h"
#include "server/base/error.h"
#include "server/store/record.h"

/* The bytes of a surface's objects; their sizes are in the record. Borrowed. */
struct server_content {
    const void *parts[SERVER_PARTS]; /* NULL: the surface has no such part */
};

/* Uses of a surface since it was created. The most used surfaces are loaded first after a start. */
struct server_store_uses {
    uint64_t count;
    int64_t last; /* seconds since 1970 */
};

/* A surface, or a change of it by another daemon or this one. */
struct server_stored {
    const char *key;              /* set if it is a change */
    struct server_record *record; /* the visitor retains it if need be. NULL: removed */
    struct server_store_uses uses;
    uint64_t version; /* 0: the store is not shared */
};

/* Visitors; they return false to end the visit. */
typedef bool server_stored_visit(void *user, const struct server_stored *stored);
typedef bool server_pace(void *user, size_t bytes); /* called for each piece that was read */

/* The functions of a back-end. NULL: it does not need this one. All have close. put and remove come
 * together, as do fetch and verify, and follow and await. A store without put stores nothing.
 * Without fetch, surfaces can't be unloaded. Without follow, the store is not shared. */
struct server_store {
    /* Visits all surfaces, in any order. Of a shared store it is called again after follow has
     * returned STALE. DONE, UNAVAILABLE, NO_MEMORY. */
    enum server_outcome (*each)(struct server_store *store, server_stored_visit *visit, void *user);
    /* Writes the objects, or verifies existing ones. The caller calls put or keep next. */
    enum server_outcome (*stage)(struct server_store *store, const struct server_record *record,
                                 const struct server_content *content);
    /* Stores a surface, or replaces it; durable when it returns DONE. `content` NULL: only the
     * record changes, to another record of the same upload (record.h). On entry `*version` is the
     * known version of the key, 0 for none. On return it is the new version. */
    enum server_outcome (*put)(struct server_store *store, const struct server_record *record,
                               const struct server_content *content, uint64_t *version);
    /* Verifies the objects of a stored surface and rewrites damaged ones. */
    enum server_outcome (*keep)(struct server_store *store, const struct server_record *record,
                                const struct server_content *content);
    /* Removes a surface; durable when it returns DONE. `*version` as for put. */
    enum server_outcome (*remove)(struct server_store *store, const struct server_record *record,
                                  uint64_t *version);
    /* Deletes objects that the last put or remove left unused. Called when the registry no longer
     * lists the surface that used them. */
    void (*tidy)(struct server_store *store);
    /* Reads and verifies an object, malloc'ed. DAMAGED; ABSENT; NO_MEMORY; REFUSED. */
    enum server_outcome (*fetch)(struct server_store *store, const struct server_object *object,
                                 void **bytes);
    /* Verifies an object in little memory. DAMAGED: it is in quarantine now, and fetch refuses it
     * without reading. ABSENT; REFUSED: the system can't read it; UNAVAILABLE: ended early,
     * rewritten meanwhile, or out of memory. */
    enum server_outcome (*verify)(struct server_store *store, const struct server_object *object,
                                  server_pace *pace, void *user);
    /* Returns the number of objects in quarantine. */
    uint32_t (*damaged)(struct server_store *store);
    /* Visits the changes since the last call, in the order of versions. STALE: too many changes;
     * the caller calls each, and drops the surfaces that each does not visit. UNAVAILABLE,
     * NO_MEMORY. */
    enum server_outcome (*follow)(struct server_store *store, server_stored_visit *visit,
                                  void *user);
    /* Blocks until there is a change, at most for `ns`. */
    void (*await)(struct server_store *store, uint64_t ns);
    void (*note_uses)(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count);
    /* Returns a sentence, owned by the store, why it can't write or can't be reached. NULL: it
     * works. */
    const char *(*health)(struct server_store *store);
    void (*close)(struct server_store *store); /* frees it */
};

/* Creates a store that stores nothing. Returns NULL if out of memory. */
struct server_store *server_store_memory_create(void);

/* Opens the store in a folder, creates it if need be, and locks it. Repairs and logs damage.
 * Returns NULL with a sentence in `error` in these cases: another process uses the folder, the
 * folder is unusable, or a later version wrote it. */
struct server_store *server_store_local_open(const char *folder, char error[SERVER_ERROR]);

/* Opens the store in a PostgreSQL database ("postgresql://…") and makes or updates its tables.
 * Returns NULL with a sentence in `error` in these cases: no answer within ten seconds, a refusal,
 * or tables of a later version. */
struct server_store *server_store_postgres_open(const char *url, char error[SERVER_ERROR]);

/* For the sandbox. Visits each port that the address of a database or the environment names, or
 * 5432. `visit` returns false to end it. False: it was ended, or the address is malformed. */
bool server_postgres_each_port(const char *url, bool (*visit)(void *user, uint16_t port),
                               void *user);

/* For the sandbox. As above, for each file that libpq may read: certificates, keys, passwords. */
bool server_postgres_each_file(const char *url, void (*visit)(void *user, const char *file),
                               void *user);

/* --- tools of the operator -------------------------------------------------------------------- */

/* Reads every row, manifest, object, stored field and batch of a data folder that no daemon uses.
 * Prints to `out` one line for each fault, one for each kind of file that the next start deletes or
 * writes, and the totals. Changes nothing except the -shm file that a killed daemon left. False:
 * there are faults, or the folder can't be checked. */
bool server_store_check(const char *folder, FILE *out);

/* As server_store_check, for a PostgreSQL store, in use or not: each row and each named object. */
bool server_store_check_postgres(const char *url, FILE *out);

/* Copies the data folder `folder`, which may be in use, as of one moment, to the new folder `copy`.
 * Makes hard links of objects where possible, and verifies each. On failure, returns false and
 * prints a sentence to `out`. */
bool server_store_backup(const char *folder, const char *copy, FILE *out);

/* Makes the new data folder `folder` from a backup and verifies every file. Copies objects, so that
 * a bad block of one folder does not damage the other. On failure, returns false and prints a
 * sentence to `out`. */
bool server_store_restore(const char *folder, const char *backup, FILE *out);

#endif
