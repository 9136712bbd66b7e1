/* The kernel for one set of lanes. kernel_plain.c, kernel_avx2.c and kernel_avx512.c define the
 * lanes (lanes_*.h) and then include this file. kernel_linear_plain.c, kernel_linear_avx2.c and
 * kernel_linear_avx512.c define WITH_LINEAR as 1 first. In the other kernels, the code for linear
 * windows is omitted.
 *
 * A `lanes` holds LANES doubles, an `ids` LANES 32-bit integers, and a `mask` one truth value for
 * each lane. Arithmetic uses C's operators. `pick(m, a, b)` has the lanes of `a` where m is true,
 * and of `b` elsewhere. `compress` moves the lanes of a mask to the front. `after(first, a)` shifts
 * all lanes up by one and sets the lowest lane to the number `first`. `ahead` shifts them down by
 * one. `first_of` returns the number in the lowest lane, `last_of` that in lane count - 1. `bits`
 * and `mask_of` convert a mask to and from an integer. A `floats` holds FLOATS floats.
 *
 * In a side's frame the apex is p = (px, py) and a source (x, -y). For a point (b, 0) of the edge,
 * k(b) = (b - x)(py + y) - y (px - x) is negative if the ray through the point passes left of p. */
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

/* Returns the lowest lane that is set. */
static inline uint32_t first_set(mask m)
{
    return (uint32_t)__builtin_ctz(bits(m));
}

static inline uint32_t last_set(mask m)
{
    return 31 - (uint32_t)__builtin_clz(bits(m));
}

/* Returns the lanes whose windows are linear (window/window.h). */
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
    .linear = &KERNEL_LINEAR(kernel),
    .filter = filter,
    .within = within,
    .store = store_wedges,
    .cast = cast,
    .ring = ring};
