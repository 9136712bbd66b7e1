/* Field key: the seeds of a field, compared in order and bit by bit, and its reach. Of two fields
 * with equal seeds, the one of larger reach answers all requests of the other. */
#ifndef SERVER_FIELDS_FIELD_KEY_H
#define SERVER_FIELDS_FIELD_KEY_H

#include "gd/field.h"

struct server_field_key {
    uint64_t hash; /* of the seeds */
    double radius; /* 0: no limit */
    uint32_t seed_count;
    const struct gd_seed *seeds;
};

/* The key of a request without target; borrows its seeds. */
struct server_field_key server_field_key_of(const struct gd_field_request *request);

/* The key of the whole field of one point; fills in `seed` and borrows it. */
struct server_field_key server_field_key_of_point(const struct gd_point *source,
                                                  struct gd_seed *seed);

/* True for the key of the whole field of one point. */
bool server_field_key_is_point(const struct server_field_key *key);

/* True when the seeds are equal; the reach may differ. */
bool server_field_key_equal(const struct server_field_key *a, const struct server_field_key *b);

/* Of keys with equal seeds: `a` reaches at least as far as `b`. */
static inline bool server_field_key_covers(const struct server_field_key *a,
                                           const struct server_field_key *b)
{
    return a->radius == 0 || (b->radius != 0 && a->radius >= b->radius);
}

/* Copies a key with its seeds, for server_field_key_free. False without memory. */
bool server_field_key_copy(const struct server_field_key *key, struct server_field_key *out);
void server_field_key_free(struct server_field_key *key);

#endif
