/* Slots of the registry: its entries, sorted by key. Not thread-safe; registry.c guards them. */
#pragma once

#include "server/base/sorted.h"
#include "server/store/store.h"
#include "server/surfaces/surface.h"

/* The registry's entry for one surface. */
struct server_slot {
    struct server_listed now; /* record and surface; the surface is NULL if it is not in memory */
    atomic_uint_least64_t uses;
    atomic_int_least64_t last;  /* time of the last use, seconds since 1970 */
    atomic_uint_least64_t turn; /* value of the registry's clock at the last use */
    uint64_t noted;             /* number of uses in the store; guarded by the writer lock */
    uint64_t version;           /* version of the record in a shared store */
    atomic_bool was_tried;      /* set by server_registry_hottest */
};

/* Compares a slot with a struct server_key, for the arrays of slots. */
int server_slot_compare(const void *item, const void *key);

/* Retains the record, and the surface, which may be NULL. Returns NULL if out of memory. */
struct server_slot *server_slot_create(struct server_record *record,
                                       struct server_surface *surface);
void server_slot_free(struct server_slot *slot); /* NULL is allowed */

/* Returns record and surface, retained. */
struct server_listed server_slot_share(const struct server_slot *slot);

/* Inserts a slot, for which room was reserved, and returns NULL. If its key already has a slot,
 * exchanges the contents of the two, and returns `slot` with the old contents. */
struct server_slot *server_slots_enter(struct server_sorted *all, struct server_slot *slot);

/* Returns the slot of that record, or NULL. */
struct server_slot *server_slots_of_record(const struct server_sorted *all,
                                           const struct server_record *record);

/* Makes slots for all surfaces in the store. On failure `*out` contains some of them. */
enum server_outcome server_slots_collect(struct server_store *store, struct server_budget *budget,
                                         struct server_sorted *out);

/* Moves slots of unchanged versions from `all` to `fresh`, so that their surfaces stay in
 * memory. */
void server_slots_keep(struct server_sorted *all, struct server_sorted *fresh);

/* Applies a change of another daemon. Sets `*left` to the replaced or removed slot. Returns false
 * if out of memory. */
bool server_slots_follow(struct server_sorted *all, struct server_budget *budget,
                         const struct server_key *key, const struct server_stored *change,
                         struct server_slot **left);
