/* Sight: the wedges of a chunk as a point across their edge sees them. What every query does most
 * of, several lanes at a time.
 *
 * One source (sight_lanes.h) is compiled for each set of lanes, as the kernels of the wedge room
 * are; all give the same results to the last bit. Stateless; any thread. */
#ifndef GD_FIELD_SIGHT_H
#define GD_FIELD_SIGHT_H

#include "field/layout.h"

struct gd__sight {
    const struct gd__chunk *chunk;
    double length; /* of the edge */
    double x, y;   /* the point in the frame of its side of the edge, y >= 0 */
    uint32_t side; /* that one */
};

/* The shortest way that several sights offer. `place` is its wedge's, counted through all sights,
 * and of equal ones the first; GD_NONE: there is none shorter than what was known. */
struct gd__seen {
    double distance;
    uint32_t place;
};

/* The kernel: the shortest way through the sights' wedges, if one is shorter than `known`. A way is
 * straight, or round the wedge's end. The linear ones take linear wedges too. */
typedef struct gd__seen gd__sight_kernel(const struct gd_field *field,
                                         const struct gd__sight *sights, uint32_t count,
                                         double known);

extern gd__sight_kernel gd__sight_plain, gd__sight_plain_linear;
#if defined(__x86_64__)
extern gd__sight_kernel gd__sight_avx2, gd__sight_avx2_linear, gd__sight_avx512,
    gd__sight_avx512_linear;
#endif

/* The one for the kernels that are in use (kernel/kernel.h), of a field with or without segments. */
gd__sight_kernel *gd__sight_kernel_in_use(bool linear);

/* Where the way through a wedge, a window in the frame of the sight's side, to the point crosses
 * the edge: on the straight line, or at the wedge's nearer end. Ends are stored to one unit: a
 * crossing within two of them counts as inside, where a neighbour is as short; but not of a linear
 * wedge. */
double gd__sight_crossing(const struct gd__sight *sight, const struct gd__window *wedge);

#endif
