/* Field table: things by the key of a field. A slot stands inside what the table holds. Not
 * thread-safe. */
#ifndef SERVER_FIELDS_FIELD_TABLE_H
#define SERVER_FIELDS_FIELD_TABLE_H

#include "server/fields/field_key.h"

struct server_field_slot {
    struct server_field_key key; /* the owner's; stays as it is while the slot is in a table */
    struct server_field_slot *next;
};

struct server_field_table { /* all zero is an empty table */
    struct server_field_slot **buckets;
    uint32_t bucket_count, count; /* bucket_count is a power of two, or 0 */
};

/* The slot of that key, or NULL. */
struct server_field_slot *server_field_table_find(const struct server_field_table *table,
                                                  const struct server_field_key *key);

/* Makes room for one more slot; false without memory. */
bool server_field_table_reserve(struct server_field_table *table);

/* Room was reserved, and no slot has its key. */
void server_field_table_insert(struct server_field_table *table, struct server_field_slot *slot);

/* The slot is in the table. */
void server_field_table_remove(struct server_field_table *table, struct server_field_slot *slot);

/* the buckets; the slots are their owners' */
void server_field_table_free(struct server_field_table *table);

#endif
