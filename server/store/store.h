/* Store: keeps surfaces beyond the life of the process. This is the interface of a back-end:
 * memory.c stores nothing, local/ uses SQLite and files in a folder, postgres/ a PostgreSQL
 * database that many daemons share. The registry does the rest: order, conditional requests, and
 * loaded surfaces.
 *
 * A shared store gives each change of a surface a version; versions grow in the order of the
 * changes. The registry passes the version that it knows. If the surface has another one, the
 * change is STALE: the registry calls follow and decides anew.
 *
 * Threads. One thread at a time calls stage, put, keep, remove, tidy and note_uses (under the
 * registry's writer lock), one at a time each and follow (under its follower's lock), and one
 * thread await. Any thread calls fetch, verify, damaged and health. each comes before all
 * others. */
#ifndef SERVER_STORE_STORE_H
#define SERVER_STORE_STORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "server/base/disk.h"
#include "server/store/record.h"

/* Bytes of a surface's objects, of the sizes in its record; borrowed. */
struct server_content {
    const void *parts[SERVER_PARTS]; /* NULL: the surface has no such part */
};

/* Uses of a surface since it was created. They decide what is loaded first after a start. */
struct server_store_uses {
    uint64_t count;
    int64_t last; /* seconds since 1970 */
};

/* A surface, or a change of it by another daemon or this one. */
struct server_stored {
    const char *key;              /* of a change */
    struct server_record *record; /* the visitor retains it to keep it. NULL: it was removed */
    struct server_store_uses uses;
    uint64_t version; /* 0: the store is not shared */
};

/* Visitors; they return false to end the visit. */
typedef bool server_stored_visit(void *user, const struct server_stored *stored);
typedef bool server_pace(void *user, size_t bytes); /* called for each piece that was read */

/* A back-end leaves out what it does not need: close is the only function that all have, put and
 * remove, fetch and verify, and follow and await come in pairs. Without put nothing is stored,
 * without fetch no bytes, so that surfaces can't be unloaded; without follow it is not shared. */
struct server_store {
    /* Visits all surfaces, in any order. DONE, UNAVAILABLE, NO_MEMORY. Of a shared store it is
     * called again when follow returns STALE. */
    enum server_store_outcome (*each)(struct server_store *store, server_stored_visit *visit,
                                      void *user);
    /* Writes the objects and verifies those that exist; may be slow. put or keep comes next. */
    enum server_store_outcome (*stage)(struct server_store *store,
                                       const struct server_record *record,
                                       const struct server_content *content);
    /* Stores a surface, or replaces it; durable when it returns DONE. `*version`: in, the known
     * version of the key, 0 for none; out, the new one. */
    enum server_store_outcome (*put)(struct server_store *store, const struct server_record *record,
                                     const struct server_content *content, uint64_t *version);
    /* Verifies the objects of a stored surface and rewrites damaged ones. */
    enum server_store_outcome (*keep)(struct server_store *store,
                                      const struct server_record *record,
                                      const struct server_content *content);
    /* Durable when it returns DONE. `*version` as for put. */
    enum server_store_outcome (*remove)(struct server_store *store,
                                        const struct server_record *record, uint64_t *version);
    /* Deletes objects that the last put or remove left unused, after the registry has unlisted the
     * surface. */
    void (*tidy)(struct server_store *store);
    /* Reads and verifies a part, malloc'ed. DAMAGED; ABSENT; NO_MEMORY; REFUSED. */
    enum server_store_outcome (*fetch)(struct server_store *store,
                                       const struct server_record *record, enum server_part part,
                                       void **bytes);
    /* Verifies a part in little memory. DAMAGED: it is in quarantine now, so that fetch refuses the
     * object without reading it. ABSENT; REFUSED: the system can't read it; UNAVAILABLE: ended
     * early, rewritten meanwhile, or no memory. */
    enum server_store_outcome (*verify)(struct server_store *store,
                                        const struct server_record *record, enum server_part part,
                                        server_pace *pace, void *user);
    /* The number of objects in quarantine. */
    uint32_t (*damaged)(struct server_store *store);
    /* Visits the changes since the last call, in the order of versions. STALE: too many; call each,
     * and drop what it does not visit. UNAVAILABLE, NO_MEMORY. */
    enum server_store_outcome (*follow)(struct server_store *store, server_stored_visit *visit,
                                        void *user);
    /* Blocks for `ns`, or less if there is a change. */
    void (*await)(struct server_store *store, uint64_t ns);
    void (*note_uses)(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count);
    /* Why the store can't write or be reached, a sentence of the store's; NULL: all is well. */
    const char *(*health)(struct server_store *store);
    void (*close)(struct server_store *store); /* frees it */
};

/* A store that forgets everything when it is closed. NULL without memory. */
struct server_store *server_store_memory_create(void);

/* Opens the store in a folder, creates it if need be, and locks it. Repairs and logs damage. NULL
 * with a sentence in `error`: another process has it, it can't be used, or a later version wrote
 * it. */
struct server_store *server_store_local_open(const char *folder, char *error, size_t error_size);

/* Opens the store in a PostgreSQL database ("postgresql://…") and makes or updates its tables. NULL
 * with a sentence in `error`: no answer within ten seconds, a refusal, or tables of a later
 * version. */
struct server_store *server_store_postgres_open(const char *url, char *error, size_t error_size);

/* For the sandbox. Visits each port that the address of a database or the environment names, or
 * 5432. `visit` returns false to end it. False: it was ended, or the address is malformed. */
bool server_postgres_each_port(const char *url, bool (*visit)(void *user, uint16_t port),
                               void *user);

/* For the sandbox. Visits each file that libpq may read: certificates, keys, passwords. False: the
 * address is malformed. */
bool server_postgres_each_file(const char *url, void (*visit)(void *user, const char *file),
                               void *user);

/* --- tools of the operator -------------------------------------------------------------------- */

/* Reads every row, manifest, object, stored field and batch of a data folder that no daemon uses.
 * Prints to `out` one line for each fault, one for each kind of file that the next start tidies up,
 * and the sums. Changes nothing but SQLite's -shm of a killed daemon. False: there are faults, or
 * it can't be checked. */
bool server_store_check(const char *folder, FILE *out);

/* Likewise for a PostgreSQL store, in use or not: every row and every object that a row names. */
bool server_store_check_postgres(const char *url, FILE *out);

/* Copies the data folder `folder`, as it is at one moment, in use or not, to the new folder `copy`.
 * Objects become hard links where possible; each is verified. False with a sentence on `out`. */
bool server_store_backup(const char *folder, const char *copy, FILE *out);

/* Makes the new data folder `folder` from a backup and verifies every file. Copies objects, so that
 * a bad block of one folder does not damage the other. False with a sentence on `out`. */
bool server_store_restore(const char *folder, const char *backup, FILE *out);

#endif
