/* See field_key.h. */
#include "server/fields/field_key.h"

#include <stdlib.h>
#include <string.h>

static uint64_t hash_add(uint64_t hash, uint64_t value)
{
    hash = (hash ^ value) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ hash >> 29;
}

static uint64_t hash_add_number(uint64_t hash, double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return hash_add(hash, bits);
}

static uint64_t hash_add_point(uint64_t hash, const struct gd_point *point)
{
    hash = hash_add(hash_add(hash, (uint64_t)point->kind), point->element);
    for (int i = 0; i < 3; i++) hash = hash_add_number(hash, point->weight[i]);
    return hash;
}

static uint64_t hash_add_seed(uint64_t hash, const struct gd_seed *seed)
{
    hash = hash_add_point(hash, &seed->point);
    if (seed->is_segment) hash = hash_add_point(hash, &seed->end);
    return hash_add_number(hash, seed->offset);
}

static bool is_equal_seed(const struct gd_seed *a, const struct gd_seed *b)
{
    if (!gd_point_equal(&a->point, &b->point) || a->offset != b->offset ||
        a->is_segment != b->is_segment)
        return false;
    return !a->is_segment || gd_point_equal(&a->end, &b->end);
}

struct server_field_key server_field_key_of(const struct gd_field_request *request)
{
    uint64_t hash = request->seed_count;
    for (uint32_t i = 0; i < request->seed_count; i++)
        hash = hash_add_seed(hash, &request->seeds[i]);
    return (struct server_field_key){hash, request->radius, request->seed_count, request->seeds};
}

bool server_field_key_equal(const struct server_field_key *a, const struct server_field_key *b)
{
    if (a->hash != b->hash || a->seed_count != b->seed_count) return false;
    for (uint32_t i = 0; i < a->seed_count; i++)
        if (!is_equal_seed(&a->seeds[i], &b->seeds[i])) return false;
    return true;
}

bool server_field_key_copy(const struct server_field_key *key, struct server_field_key *out)
{
    struct gd_seed *seeds = malloc(key->seed_count * sizeof *seeds);
    if (!seeds) return false;
    memcpy(seeds, key->seeds, key->seed_count * sizeof *seeds);
    *out = *key;
    out->seeds = seeds;
    return true;
}

void server_field_key_free(struct server_field_key *key)
{
    free((struct gd_seed *)key->seeds);
}

struct server_field_key server_field_key_of_point(const struct gd_point *source,
                                                  struct gd_seed *seed)
{
    *seed = (struct gd_seed){.point = *source};
    return server_field_key_of(&(struct gd_field_request){.seeds = seed, .seed_count = 1});
}

bool server_field_key_is_point(const struct server_field_key *key)
{
    return key->seed_count == 1 && !key->seeds[0].is_segment && key->seeds[0].offset == 0 &&
           key->radius == 0;
}
