/* Store: stores surfaces so that they outlive the process. This is the interface of a back-end:
 * memory.c stores nothing, local/ uses SQLite and files in a folder, postgres/ uses a PostgreSQL
 * database that many daemons share. The registry is responsible for the order of changes, for
 * conditional requests and for loaded surfaces.
 *
 * A shared store gives each change of a surface a version; versions grow in the order of the
 * changes. The registry passes the last version that it has seen. If the surface has another
 * version, the outcome is STALE: the registry calls `follow` and decides again.
 *
 * Threads. One thread at a time, with the registry's writer lock, calls `stage`, `put`, `keep`,
 * `remove`, `tidy` and `note_uses`. One thread at a time, with the follower's lock, calls `each`
 * and `follow`. One thread calls `await`. Any thread calls `fetch`, `verify`, `damaged` and
 * `health`. The first call must be `each`. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "server/base/disk.h"
#include "server/base/error.h"
#include "server/store/record.h"

/* The bytes of a surface's objects; their sizes are in the record. Borrowed. */
struct server_content {
    const void *parts[SERVER_PARTS]; /* NULL means that the surface has no such part */
};

/* The number of uses of a surface since it was created. After a start the most used surfaces are
 * loaded first. */
struct server_store_uses {
    uint64_t count;
    int64_t last; /* seconds since 1970 */
};

/* A surface, or a change of it by another daemon or this one. */
struct server_stored {
    const char *key; /* set if the struct describes a change */
    /* a visitor that keeps the record retains it; NULL means that the surface was removed */
    struct server_record *record;
    struct server_store_uses uses;
    uint64_t version; /* 0 means that the store is not shared */
};

/* Types of visitors, which return false to end the visit. */
typedef bool server_stored_visit(void *user, const struct server_stored *stored);
typedef bool server_pace(void *user, size_t bytes); /* called for each piece that was read */

/* The functions of a back-end; NULL means that the back-end does not need this function. Every
 * back-end has `close`. If `put` is set, so is `remove`; the same holds for `fetch` and `verify`,
 * and for `follow` and `await`. A store without `put` stores nothing. Without `fetch`, surfaces
 * can't be unloaded. Without `follow`, the store is not shared. */
struct server_store {
    /* Visits all surfaces, in any order. For a shared store this function is called again after
       follow has returned STALE. Returns DONE, UNAVAILABLE or NO_MEMORY. */
    enum server_outcome (*each)(struct server_store *store, server_stored_visit *visit, void *user);
    /* Writes the objects, or verifies existing ones. The caller calls `put` or `keep` next. */
    enum server_outcome (*stage)(struct server_store *store, const struct server_record *record,
                                 const struct server_content *content);
    /* Stores or replaces a surface. The change is durable when `put` returns DONE. If `content` is
       NULL, only the record changes, to another record of the same upload (record.h). On entry
       `*version` is the known version of the key, or 0 for none. On return it is the new
       version. */
    enum server_outcome (*put)(struct server_store *store, const struct server_record *record,
                               const struct server_content *content, uint64_t *version);
    /* Verifies the objects of a stored surface and rewrites damaged ones. */
    enum server_outcome (*keep)(struct server_store *store, const struct server_record *record,
                                const struct server_content *content);
    /* Removes a surface. The change is durable when remove returns DONE. `*version` is used as by
       `put`. */
    enum server_outcome (*remove)(struct server_store *store, const struct server_record *record,
                                  uint64_t *version);
    /* Deletes objects that are unused since the last `put` or `remove`. Called when the registry no
       longer lists the surface that used them. */
    void (*tidy)(struct server_store *store);
    /* Reads and verifies an object, and returns its bytes in memory from malloc. Errors: DAMAGED,
       ABSENT, NO_MEMORY, REFUSED. */
    enum server_outcome (*fetch)(struct server_store *store, const struct server_object *object,
                                 void **bytes);
    /* Verifies an object piece by piece, which needs little memory. DAMAGED: the object is now in
       quarantine, and `fetch` refuses it without reading. REFUSED: the system can't read the
       object. UNAVAILABLE: the call was ended early, the object was rewritten meanwhile, or memory
       is short. Also returns ABSENT. */
    enum server_outcome (*verify)(struct server_store *store, const struct server_object *object,
                                  server_pace *pace, void *user);
    /* Returns the number of objects in quarantine. */
    uint32_t (*damaged)(struct server_store *store);
    /* Visits the changes since the last call, in the order of versions. Returns STALE if there are
       too many changes; the caller then calls `each`, and drops the surfaces that `each` does not
       visit. Other errors: UNAVAILABLE, NO_MEMORY. */
    enum server_outcome (*follow)(struct server_store *store, server_stored_visit *visit,
                                  void *user);
    /* Blocks until there is a change, at most for `ns`. */
    void (*await)(struct server_store *store, uint64_t ns);
    void (*note_uses)(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count);
    /* Returns a sentence with the reason why the store can't write or can't be reached, or NULL if
       the store works. The store owns the sentence. */
    const char *(*health)(struct server_store *store);
    void (*close)(struct server_store *store); /* frees it */
};

/* Creates a store that stores nothing. Returns NULL if out of memory. */
struct server_store *server_store_memory_create(void);

/* Opens the store in a folder, and locks the folder. Creates a missing folder. Repairs and logs
 * damage. Returns NULL with a sentence in `error` in these cases: another process uses the folder,
 * the folder is unusable, or a later version wrote it. */
struct server_store *server_store_local_open(const char *folder, char error[SERVER_ERROR]);

/* Opens the store in a PostgreSQL database ("postgresql://…") and makes or updates its tables.
 * Returns NULL with a sentence in `error` if the database does not answer within ten seconds,
 * refuses, or has tables of a later version. */
struct server_store *server_store_postgres_open(const char *url, char error[SERVER_ERROR]);

/* Visits, for the sandbox, each port that the address of a database lists. If it lists none, visits
 * those of the environment, or else 5432. `visit` returns false to end the visit. Returns false if
 * the visit was ended or the address is malformed. */
bool server_postgres_each_port(const char *url, bool (*visit)(void *user, uint16_t port),
                               void *user);

/* Visits, for the sandbox, each file that libpq may read: certificates, keys, passwords. */
bool server_postgres_each_file(const char *url, void (*visit)(void *user, const char *file),
                               void *user);

/* --- tools of the operator -------------------------------------------------------------------- */

/* Reads every row, manifest, object, stored field and batch of a data folder that no daemon uses.
 * Prints to `out` one line for each fault, one for each kind of file that the next start deletes or
 * writes, and the totals. Changes nothing except the -shm file that a killed daemon left. Returns
 * false if there are faults or the folder can't be checked. */
bool server_store_check(const char *folder, FILE *out);

/* Like server_store_check, but checks each row and each named object of a PostgreSQL store, which
 * may be in use. */
bool server_store_check_postgres(const char *url, FILE *out);

/* Copies the data folder `folder`, which may be in use, to the new folder `copy`. The copy has the
 * state of one moment. Makes hard links of objects if possible, and verifies each object. On
 * failure, returns false and prints a sentence to `out`. */
bool server_store_backup(const char *folder, const char *copy, FILE *out);

/* Makes the new data folder `folder` from a backup and verifies every file. Copies objects instead
 * of linking them, so that a bad block of one folder does not damage the other. On failure, returns
 * false and prints a sentence to `out`. */
bool server_store_restore(const char *folder, const char *backup, FILE *out);
