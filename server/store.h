/* Store: where surfaces outlive the process. What a back-end must do; the registry keeps the names, the order, the
 * conditions and what is in memory.
 *
 * store_memory.c keeps nothing, store_local.c SQLite and files in a folder.
 *
 * Threads: put, keep, remove, tidy and note_uses are called by one thread at a time (the registry's writer lock);
 * fetch, verify, damaged and health by any. each is called once, before the others. */
#ifndef SERVER_STORE_H
#define SERVER_STORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/record.h"

enum server_store_outcome {
    SERVER_STORE_DONE,
    SERVER_STORE_CREATED,      /* of the registry: done, the name is new */
    SERVER_STORE_REPLACED,     /* of the registry: done, the name had another surface, or the same */
    SERVER_STORE_ABSENT,       /* there is no such surface */
    SERVER_STORE_PRECONDITION, /* of the registry: it does not hold; nothing changed */
    SERVER_STORE_NO_MEMORY,    /* nothing changed */
    SERVER_STORE_FULL,         /* no room on the disk; nothing changed */
    SERVER_STORE_REFUSED,      /* the system refused to open or rename; nothing changed */
    SERVER_STORE_READ_ONLY,    /* an earlier write, or this one, could not be made durable: no more are tried */
    SERVER_STORE_DAMAGED       /* what is stored is not what was put */
};

/* What a look at the stored bytes showed. */
enum server_store_verdict {
    SERVER_VERDICT_SOUND,
    SERVER_VERDICT_DAMAGED, /* they are not what was put; they are in quarantine: fetch refuses them without reading */
    SERVER_VERDICT_MISSING, /* there is no such file */
    SERVER_VERDICT_UNREADABLE, /* the system can't read the file */
    SERVER_VERDICT_NONE        /* the look was ended, or the bytes were written meanwhile, or there was no memory */
};

/* What a surface is made from, by its parts, as many bytes as the record says; borrowed. */
struct server_content {
    const void *parts[SERVER_PARTS]; /* NULL: the surface has no such part */
};

/* How often a surface was used since it was created, and when last. It decides what is loaded first after a start. */
struct server_store_uses {
    uint64_t count;
    int64_t last; /* seconds since 1970 */
};

struct server_store {
    /* Visits what is stored, in any order. The visitor retains what it keeps; false ends the visit. */
    void (*each)(struct server_store *store,
                 bool (*visit)(void *user, struct server_record *record, const struct server_store_uses *uses),
                 void *user);
    /* Stores a surface under its key, in the place of the one that was there, with what it is made from. Durable when
     * it returns DONE. */
    enum server_store_outcome (*put)(struct server_store *store, const struct server_record *record,
                                     const struct server_content *content);
    /* Makes sure that what a stored surface is made from is there, and whole. */
    enum server_store_outcome (*keep)(struct server_store *store, const struct server_record *record,
                                      const struct server_content *content);
    /* Durable when it returns DONE. */
    enum server_store_outcome (*remove)(struct server_store *store, const struct server_record *record);
    /* Does what a put or a remove that was DONE has left to be done, once nobody can find what it took away: only
     * now may bytes go that no surface has any more. */
    void (*tidy)(struct server_store *store);
    /* The bytes of a part that the surface has, as many as its record says, verified, malloc'ed. DAMAGED; ABSENT;
     * NO_MEMORY; REFUSED. NULL: this store keeps no bytes, and what is loaded must stay in memory. */
    enum server_store_outcome (*fetch)(struct server_store *store, const struct server_record *record,
                                       enum server_part part, void **bytes);
    /* Reads a part that the surface has, and compares it with its checksum, in little memory; `pace` is told of each
     * piece of so many bytes, and returns false to end it. NULL: this store keeps no bytes. */
    enum server_store_verdict (*verify)(struct server_store *store, const struct server_record *record,
                                        enum server_part part, bool (*pace)(void *user, size_t bytes), void *user);
    /* How many objects are in quarantine. NULL: this store keeps no bytes. */
    uint32_t (*damaged)(struct server_store *store);
    /* Remembers the uses of some surfaces, if it can. */
    void (*note_uses)(struct server_store *store, const struct server_record *const *records,
                      const struct server_store_uses *uses, uint32_t count);
    /* Why nothing can be written, as a sentence that lives as long as the store; NULL: all is well. */
    const char *(*health)(struct server_store *store);
    void (*close)(struct server_store *store); /* frees it */
};

/* A store that forgets everything when it is closed. NULL without memory. */
struct server_store *server_store_memory_create(void);

/* The store in a folder, which is created if need be and belongs to one process at a time. NULL with a sentence in
 * `error`: another process has it, the folder can't be used, or a later version wrote it. Damage never keeps it from
 * opening: it is mended as far as possible, and logged. */
struct server_store *server_store_local_open(const char *folder, char *error, size_t error_size);

#endif
