/* Store: where surfaces outlive the process. What a back-end must do; the registry keeps the names,
 * the order, the conditions and what is in memory.
 *
 * store_memory.c keeps nothing, store_local.c SQLite and files in a folder, store_postgres.c a
 * PostgreSQL database that many daemons share.
 *
 * A store that is shared has a version for each change of a surface: they grow in the order of the
 * changes. The registry tells which version it knows a key to have, and a change that rests on
 * another is STALE: then the registry learns what others changed (follow), and decides anew.
 *
 * Threads: stage, put, keep, remove, tidy and note_uses are called by one thread at a time (the
 * registry's writer lock), each and follow too (its follower's lock), await by one thread; fetch,
 * verify, damaged and health by any. each is called before the others, and of a shared store again
 * when follow asks for it. */
#ifndef SERVER_STORE_STORE_H
#define SERVER_STORE_STORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/store/record.h"

enum server_store_outcome {
    SERVER_STORE_DONE,
    SERVER_STORE_CREATED, /* of the registry: done, the name is new */
    /* of the registry: done, the name had another surface, or the same */
    SERVER_STORE_REPLACED,
    SERVER_STORE_ABSENT,       /* there is no such surface */
    SERVER_STORE_PRECONDITION, /* of the registry: it does not hold; nothing changed */
    SERVER_STORE_NO_MEMORY,    /* nothing changed */
    SERVER_STORE_FULL,         /* no room on the disk; nothing changed */
    /* the system refused to open or rename, or a folder is gone; nothing changed */
    SERVER_STORE_REFUSED,
    /* an earlier write, or this one, could not be made durable: no more are tried */
    SERVER_STORE_READ_ONLY,
    SERVER_STORE_DAMAGED, /* what is stored is not what was put */
    SERVER_STORE_STALE,   /* another daemon has changed what this rests on; nothing changed */
    /* the store can't be reached for now; a change may still turn out to be done */
    SERVER_STORE_UNAVAILABLE
};

/* What a look at the stored bytes showed. */
enum server_store_verdict {
    SERVER_VERDICT_SOUND,
    /* they are not what was put; they are in quarantine: fetch refuses them without reading */
    SERVER_VERDICT_DAMAGED,
    SERVER_VERDICT_MISSING,    /* there is no such file */
    SERVER_VERDICT_UNREADABLE, /* the system can't read the file */
    /* the look was ended, or the bytes were written meanwhile, or there was no memory */
    SERVER_VERDICT_NONE
};

/* What a surface is made from, by its parts, as many bytes as the record says; borrowed. */
struct server_content {
    const void *parts[SERVER_PARTS]; /* NULL: the surface has no such part */
};

/* How often a surface was used since it was created, and when last. It decides what is loaded first
 * after a start. */
struct server_store_uses {
    uint64_t count;
    int64_t last; /* seconds since 1970 */
};

/* A surface as it is stored. */
struct server_stored {
    struct server_record *record; /* the visitor retains what it keeps */
    struct server_store_uses uses;
    uint64_t version; /* 0: the store is not shared */
};

/* A change that another daemon made, or this one. */
struct server_store_change {
    const char *key;
    struct server_record *record; /* NULL: the key has no surface any more */
    uint64_t version;
};

struct server_store {
    /* Visits what is stored, in any order; false ends the visit. DONE, UNAVAILABLE, NO_MEMORY. */
    enum server_store_outcome (*each)(struct server_store *store,
                                      bool (*visit)(void *user, const struct server_stored *stored),
                                      void *user);
    /* Brings what a surface is made from to the store, and sees to it that it is whole, which may
     * take its time; to be followed by put or keep. NULL: they do so themselves. */
    enum server_store_outcome (*stage)(struct server_store *store,
                                       const struct server_record *record,
                                       const struct server_content *content);
    /* Stores a surface under its key, in the place of the one that was there, with what it is made
     * from. Durable when it returns DONE. `*version`: what the key was known to have, 0: none; and
     * then what it has now. */
    enum server_store_outcome (*put)(struct server_store *store, const struct server_record *record,
                                     const struct server_content *content, uint64_t *version);
    /* Makes sure that what a stored surface is made from is there, and whole. */
    enum server_store_outcome (*keep)(struct server_store *store,
                                      const struct server_record *record,
                                      const struct server_content *content);
    /* Durable when it returns DONE. `*version` as for a put. */
    enum server_store_outcome (*remove)(struct server_store *store,
                                        const struct server_record *record, uint64_t *version);
    /* Does what a put or a remove that was DONE has left to be done, once nobody can find what it
     * took away: only now may bytes go that no surface has any more. */
    void (*tidy)(struct server_store *store);
    /* The bytes of a part that the surface has, as many as its record says, verified, malloc'ed.
     * DAMAGED; ABSENT; NO_MEMORY; REFUSED. NULL: this store keeps no bytes, and what is loaded must
     * stay in memory. */
    enum server_store_outcome (*fetch)(struct server_store *store,
                                       const struct server_record *record, enum server_part part,
                                       void **bytes);
    /* Reads a part that the surface has, and compares it with its checksum, in little memory;
     * `pace` is told of each piece of so many bytes, and returns false to end it. NULL: this store
     * keeps no bytes. */
    enum server_store_verdict (*verify)(struct server_store *store,
                                        const struct server_record *record, enum server_part part,
                                        bool (*pace)(void *user, size_t bytes), void *user);
    /* How many objects are in quarantine. NULL: this store keeps no bytes. */
    uint32_t (*damaged)(struct server_store *store);
    /* Shows what was changed since the last time, in the order of versions; false ends it. STALE:
     * too much was; each is to be called, and what it does not visit is gone. UNAVAILABLE,
     * NO_MEMORY. NULL: the store is not shared. */
    enum server_store_outcome (*follow)(struct server_store *store,
                                        bool (*visit)(void *user,
                                                      const struct server_store_change *change),
                                        void *user);
    /* Waits until something was changed, as far as that is told at once, or so long. NULL as
     * follow. */
    void (*await)(struct server_store *store, uint64_t ns);
    /* Remembers the uses of some surfaces, if it can. */
    void (*note_uses)(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count);
    /* Why nothing can be written, or the store not be reached, as a sentence that lives as long as
     * it; NULL: all is well. */
    const char *(*health)(struct server_store *store);
    void (*close)(struct server_store *store); /* frees it */
};

/* A store that forgets everything when it is closed. NULL without memory. */
struct server_store *server_store_memory_create(void);

/* The store in a folder, which is created if need be and belongs to one process at a time. NULL
 * with a sentence in `error`: another process has it, the folder can't be used, or a later version
 * wrote it. Damage never keeps it from opening: it is mended as far as possible, and logged. */
struct server_store *server_store_local_open(const char *folder, char *error, size_t error_size);

/* The store in a PostgreSQL database ("postgresql://…"), whose tables are made or brought up to
 * date if need be. NULL with a sentence in `error`: it does not answer within ten seconds, refuses,
 * or has the tables of a later version. */
struct server_store *server_store_postgres_open(const char *url, char *error, size_t error_size);

#endif
