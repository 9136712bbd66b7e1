/* Slot: the place of one surface in the registry. The registry sorts its slots by key, and uses
 * them under its lock. */
#ifndef SERVER_SURFACES_SLOT_H
#define SERVER_SURFACES_SLOT_H

#include "server/base/sorted.h"
#include "server/store/store.h"
#include "server/surfaces/surface.h"

struct server_listed {
    struct server_record *record;
    struct server_surface *surface; /* NULL if not in memory */
};
void server_listed_release(struct server_listed *listed); /* accepts all zero */

struct server_slot {
    struct server_listed now; /* record and surface; the surface is NULL if it is not in memory */
    atomic_uint_least64_t uses;
    atomic_int_least64_t last;  /* time of the last use, seconds since 1970 */
    atomic_uint_least64_t turn; /* value of the registry's clock at the last use */
    uint64_t noted;             /* number of uses in the store; guarded by the writer lock */
    uint64_t version;           /* version of the record in a shared store */
    atomic_bool was_tried;      /* set by server_registry_hottest */
};

/* Creates a slot of a record and a surface, which may be NULL. Retains both. Returns NULL if out of
 * memory. */
struct server_slot *server_slot_create(struct server_record *record,
                                       struct server_surface *surface);
void server_slot_free(struct server_slot *slot); /* NULL is allowed */

/* Compares a slot with a struct server_key. The result is like that of strcmp. */
int server_slot_compare(const void *item, const void *key);

/* Inserts a slot, for which room was reserved, and returns NULL. If its key already has a slot,
 * exchanges the contents of the two, and returns `slot` with the old contents. */
struct server_slot *server_slot_enter(struct server_sorted *all, struct server_slot *slot);

/* Returns record and surface, retained. */
struct server_listed server_slot_share(const struct server_slot *slot);

/* Makes slots for all surfaces in the store. On failure `*out` contains some of them. */
enum server_outcome server_slots_collect(struct server_store *store, struct server_budget *budget,
                                         struct server_sorted *out);

#endif
