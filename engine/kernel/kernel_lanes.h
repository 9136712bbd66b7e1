/* The kernel for one set of lanes; included by kernel_plain.c, kernel_avx2.c and kernel_avx512.c
 * behind their lanes_*.h, and once more by kernel_linear_plain.c and so on with WITH_LINEAR 1: what
 * concerns linear windows is left out of the former.
 *
 * LANES doubles make one `lanes`, their 32-bit companions `ids`, a truth value a lane `mask`.
 * Arithmetic is written with C's operators; of the functions, `pick` chooses by lane, `compress`
 * moves the lanes of a mask to the front, `after(carry, a)` moves all lanes one up and takes the
 * carry's last one in, `ahead` moves them one down, `last_of` spreads lane count - 1. bits and
 * mask_of convert a mask to and from an integer. FLOATS floats make one `floats`.
 *
 * In a side's frame the apex is p = (px, py), a source (x, -y). For a point (b, 0) of the edge,
 * k(b) = (b - x)(py + y) - y (px - x) is negative when the ray through it passes left of p. */
#include "base/tolerance.h"
#include "kernel/kernel.h"

static inline mask ge(lanes a, lanes b)
{
    return le(b, a);
}

static inline mask gt(lanes a, lanes b)
{
    return lt(b, a);
}

static inline bool any(mask m)
{
    return bits(m) != 0;
}

/* The lowest lane that is set. */
static inline uint32_t first_set(mask m)
{
    return (uint32_t)__builtin_ctz(bits(m));
}

static inline uint32_t last_set(mask m)
{
    return 31 - (uint32_t)__builtin_clz(bits(m));
}

/* Lanes whose windows are linear (window/window.h). */
static inline mask linear_of(ids source)
{
#if WITH_LINEAR
    return ids_top(source);
#else
    (void)source;
    return mask_of(0);
#endif
}

#include "kernel/kernel_filter.h"
#include "kernel/kernel_store.h"
#include "kernel/kernel_contest.h"
#include "kernel/kernel_children.h"
#include "kernel/kernel_cast.h"
#include "kernel/kernel_ring.h"

#if WITH_LINEAR
const struct gd__kernel KERNEL_LINEAR(kernel) = {
#else
const struct gd__kernel KERNEL(kernel) = {
#endif
    .name = KERNEL_NAME,
    .filter = filter,
    .within = within,
    .store = store_wedges,
    .cast = cast,
    .ring = ring};
