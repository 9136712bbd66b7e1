#include "server/surfaces/slots.h"

#include <stdlib.h>

int server_slot_compare(const void *item, const void *key)
{
    const struct server_slot *slot = item;
    const struct server_key own = server_record_key(slot->now.record);
    return server_key_compare(&own, key);
}

static int slots_compare(const void *a, const void *b)
{
    const struct server_slot *const *second = b;
    const struct server_key key = server_record_key((*second)->now.record);
    return server_slot_compare(*(const struct server_slot *const *)a, &key);
}

struct server_slot *server_slots_enter(struct server_sorted *all, struct server_slot *slot)
{
    const struct server_key key = server_record_key(slot->now.record);
    struct server_slot *found = server_sorted_find(all, &key);
    if (!found) {
        server_sorted_insert(all, server_sorted_index(all, &key), slot);
        return NULL;
    }
    const struct server_listed left = found->now;
    found->now = slot->now;
    found->version = slot->version;
    slot->now = left;
    return slot;
}

struct server_listed server_slot_share(const struct server_slot *slot)
{
    const struct server_listed *now = &slot->now;
    return (struct server_listed){server_record_retain(now->record),
                                  now->surface ? server_surface_retain(now->surface) : NULL};
}

struct server_slot *server_slot_create(struct server_record *record, struct server_surface *surface)
{
    struct server_slot *slot = calloc(1, sizeof *slot);
    if (!slot) return NULL;
    slot->now.record = server_record_retain(record);
    if (surface) slot->now.surface = server_surface_retain(surface);
    return slot;
}

void server_slot_free(struct server_slot *slot)
{
    if (slot) server_listed_release(&slot->now);
    free(slot);
}

/* The slots that were read from the store so far. */
struct collection {
    struct server_sorted slots;
    bool is_incomplete; /* memory was short */
};

static bool on_stored(void *user, const struct server_stored *stored)
{
    struct collection *all = user;
    struct server_slot *slot =
        server_sorted_reserve(&all->slots) ? server_slot_create(stored->record, NULL) : NULL;
    all->is_incomplete |= !slot;
    if (!slot) return false;
    slot->uses = slot->noted = stored->uses.count;
    slot->last = stored->uses.last;
    slot->version = stored->version;
    all->slots.items[all->slots.count++] = slot;
    return true;
}

enum server_outcome server_slots_collect(struct server_store *store, struct server_budget *budget,
                                         struct server_sorted *out)
{
    struct collection all = {.slots = {.compare = server_slot_compare}};
    enum server_outcome outcome = SERVER_STORE_DONE;
    if (store->each) outcome = store->each(store, on_stored, &all);
    *out = all.slots;
    for (uint32_t i = 0; i < out->count; i++)
        server_record_count(((struct server_slot *)out->items[i])->now.record, budget);
    if (out->count) qsort(out->items, out->count, sizeof *out->items, slots_compare);
    return !outcome && all.is_incomplete ? SERVER_STORE_NO_MEMORY : outcome;
}

void server_slots_keep(struct server_sorted *all, struct server_sorted *fresh)
{
    for (uint32_t i = 0; i < fresh->count; i++) {
        struct server_slot *new = fresh->items[i], *slot;
        const struct server_key key = server_record_key(new->now.record);
        slot = server_sorted_find(all, &key);
        if (!slot || slot->version != new->version) continue;
        all->items[server_sorted_index(all, &key)] = new;
        fresh->items[i] = slot;
    }
}

bool server_slots_follow(struct server_sorted *all, struct server_budget *budget,
                         const struct server_key *key, const struct server_stored *change,
                         struct server_slot **left)
{
    struct server_slot *before = server_sorted_find(all, key);
    if (before && before->version >= change->version) return true;
    if (before && change->record &&
        server_record_is_same_upload(before->now.record, change->record)) {
        server_record_exchange_captions(before->now.record, change->record);
        before->version = change->version;
        return true;
    }
    if (!change->record) {
        if (before) *left = server_sorted_remove(all, server_sorted_index(all, key));
        return true;
    }
    struct server_slot *after =
        server_sorted_reserve(all) ? server_slot_create(change->record, NULL) : NULL;
    if (!after) return false;
    server_record_count(change->record, budget);
    after->version = change->version;
    *left = server_slots_enter(all, after);
    return true;
}

struct server_slot *server_slots_of_record(const struct server_sorted *all,
                                           const struct server_record *record)
{
    const struct server_key key = server_record_key(record);
    struct server_slot *slot = server_sorted_find(all, &key);
    return slot && slot->now.record == record ? slot : NULL;
}
