/* See field_table.h. */
#include "server/fields/field_table.h"

#include <stdlib.h>

#define FIRST_BUCKETS 8

static struct server_field_slot **bucket_of(const struct server_field_table *table, uint64_t hash)
{
    return &table->buckets[hash & (table->bucket_count - 1)];
}

struct server_field_slot *server_field_table_find(const struct server_field_table *table,
                                                  const struct server_field_key *key)
{
    if (!table->bucket_count) return NULL;
    struct server_field_slot *slot = *bucket_of(table, key->hash);
    while (slot && !server_field_key_equal(&slot->key, key)) slot = slot->next;
    return slot;
}

static void push(struct server_field_slot **bucket, struct server_field_slot *slot)
{
    slot->next = *bucket;
    *bucket = slot;
}

bool server_field_table_reserve(struct server_field_table *table)
{
    if (table->count < table->bucket_count) return true;
    struct server_field_table grown = {.bucket_count = table->bucket_count ? 2 * table->bucket_count
                                                                           : FIRST_BUCKETS,
                                       .count = table->count};
    grown.buckets = calloc(grown.bucket_count, sizeof *grown.buckets);
    if (!grown.buckets) return false;
    for (uint32_t i = 0; i < table->bucket_count; i++) {
        for (struct server_field_slot *slot = table->buckets[i], *next; slot; slot = next) {
            next = slot->next;
            push(bucket_of(&grown, slot->key.hash), slot);
        }
    }
    free(table->buckets);
    *table = grown;
    return true;
}

void server_field_table_insert(struct server_field_table *table, struct server_field_slot *slot)
{
    push(bucket_of(table, slot->key.hash), slot);
    table->count++;
}

void server_field_table_remove(struct server_field_table *table, struct server_field_slot *slot)
{
    struct server_field_slot **link = bucket_of(table, slot->key.hash);
    while (*link != slot) link = &(*link)->next;
    *link = slot->next;
    slot->next = NULL;
    table->count--;
}

void server_field_table_free(struct server_field_table *table)
{
    free(table->buckets);
    *table = (struct server_field_table){0};
}
