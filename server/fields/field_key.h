/* Field key: which field a field is. Requests with the same seeds in the same order, to the last
 * bit, have equal keys; of two fields of theirs the one that reaches farther answers all that the
 * other does. A request without target has a key. */
#ifndef SERVER_FIELDS_FIELD_KEY_H
#define SERVER_FIELDS_FIELD_KEY_H

#include "gd/field.h"

struct server_field_key {
    uint64_t hash; /* of the seeds */
    double radius; /* 0: no limit */
    uint32_t seed_count;
    const struct gd_seed *seeds;
};

/* The request's key, which borrows its seeds. */
struct server_field_key server_field_key_of(const struct gd_field_request *request);

/* The same seeds; how far they reach is no matter. */
bool server_field_key_equal(const struct server_field_key *a, const struct server_field_key *b);

/* Of equal keys: `a` reaches as far as `b`, or farther. */
static inline bool server_field_key_covers(const struct server_field_key *a,
                                           const struct server_field_key *b)
{
    return a->radius == 0 || (b->radius != 0 && a->radius >= b->radius);
}

/* A key with seeds of its own, freed by server_field_key_free. False without memory. */
bool server_field_key_copy(const struct server_field_key *key, struct server_field_key *out);
void server_field_key_free(struct server_field_key *key); /* of a copy */

/* The key of the whole field of one point. `seed` is filled in, and borrowed by it. */
struct server_field_key server_field_key_of_point(const struct gd_point *source,
                                                  struct gd_seed *seed);

/* True for such a key. */
bool server_field_key_is_point(const struct server_field_key *key);

#endif
