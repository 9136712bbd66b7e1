#include "io/weld.h"

#include <stdlib.h>
#include <string.h>

#include "base/large.h"

#define SMALLEST_SLOT_COUNT 256

/* The first 64 fractional bits of the golden ratio. */
#define GOLDEN UINT64_C(0x9E3779B97F4A7C15)

/* Combines both halves of the product, so that every bit of either factor affects every bit of the
 * result. */
static uint64_t folded_product(uint64_t a, uint64_t b)
{
    unsigned __int128 product = (unsigned __int128)a * b;
    return (uint64_t)product ^ (uint64_t)(product >> 64);
}

/* The secret numbers in the hash differ from call to call, so that nobody can make a file whose
 * positions all have the same hash. The numbering of vertices does not depend on them. */
struct gd__weld gd__weld_begin(struct gd__builder *builder)
{
    uint64_t seed = folded_product(gd_now_ns() ^ GOLDEN, (uint64_t)(uintptr_t)builder ^ ~GOLDEN);
    return (struct gd__weld){.builder = builder,
                             .secret = {seed ^ GOLDEN, folded_product(seed, GOLDEN) | 1}};
}

void gd__weld_free(struct gd__weld *weld)
{
    free(weld->slots);
    *weld = (struct gd__weld){0};
}

static uint64_t bits_of(double coordinate)
{
    double unsigned_zero = coordinate + 0.0; /* -0 + 0 = 0 */
    uint64_t bits;
    memcpy(&bits, &unsigned_zero, sizeof bits);
    return bits;
}

static uint64_t hash(const struct gd__weld *weld, const double xyz[3])
{
    uint64_t plane =
        folded_product(bits_of(xyz[0]) ^ weld->secret[0], bits_of(xyz[1]) ^ weld->secret[1]);
    return folded_product(plane ^ bits_of(xyz[2]), weld->secret[1]);
}

/* Returns the slot that holds the vertex at `xyz`, or the free slot where it belongs. */
static uint32_t *slot_of(const struct gd__weld *weld, const double xyz[3])
{
    size_t mask = weld->slot_count - 1;
    for (size_t slot = hash(weld, xyz) & mask;; slot = (slot + 1) & mask) {
        if (weld->slots[slot] == GD_NONE) return &weld->slots[slot];
        const double *known = weld->builder->positions[weld->slots[slot]];
        if (known[0] == xyz[0] && known[1] == xyz[1] && known[2] == xyz[2])
            return &weld->slots[slot];
    }
}

static enum gd_status grow(struct gd__weld *weld)
{
    const struct gd__builder *builder = weld->builder;
    size_t slot_count = weld->slot_count ? 2 * weld->slot_count : SMALLEST_SLOT_COUNT;
    free(weld->slots);
    weld->slots = gd__large_array(slot_count, sizeof *weld->slots);
    if (!weld->slots) return gd_fail_status(builder->scan->detail, GD_NO_MEMORY);
    weld->slot_count = slot_count;
    struct gd__pace pace = gd__builder_pace(builder);
    gd__pace_fill(&pace, weld->slots, slot_count * sizeof *weld->slots);
    GD__PACED (&pace, vertex, (uint32_t)builder->position_count)
        *slot_of(weld, builder->positions[vertex]) = vertex;
    return pace.status;
}

enum gd_status gd__weld_vertex(struct gd__weld *weld, const double xyz[3], const char *at,
                               uint32_t *vertex)
{
    enum gd_status status = GD_OK;
    if (2 * weld->builder->position_count >= weld->slot_count) status = grow(weld);
    if (status != GD_OK) return status;
    uint32_t *slot = slot_of(weld, xyz);
    if (*slot == GD_NONE) {
        uint32_t next = (uint32_t)weld->builder->position_count;
        status = gd__builder_add_position(weld->builder, xyz, at);
        if (status != GD_OK) return status;
        *slot = next;
    }
    *vertex = *slot;
    return GD_OK;
}
