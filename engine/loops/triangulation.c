#include "loops/triangulation.h"

#include <stdlib.h>

#include "plane/triangulation.h"

/* Returns true if the corner across the side lies inside the circle through the triangle. */
static bool in_circle(const struct gd__plane *plane, struct gd__plane_side side)
{
    struct gd__site o = plane->sites[gd__plane_opposite(plane, side)];
    __int128 x[3], y[3], square[3];
    for (int i = 0; i < 3; i++) {
        struct gd__site p = plane->sites[plane->triangles[side.triangle].corner[i]];
        x[i] = p.u - o.u, y[i] = p.v - o.v;
        square[i] = x[i] * x[i] + y[i] * y[i];
    }
    return square[0] * (x[1] * y[2] - x[2] * y[1]) + square[1] * (x[2] * y[0] - x[0] * y[2]) +
               square[2] * (x[0] * y[1] - x[1] * y[0]) >
           0;
}

/* Begins with a triangle around all points. Its corners are the last sites, after those of the
 * points. */
static enum gd_status begin(struct gd__plane *plane, const struct gd__triangulation_input *input)
{
    const int64_t e = GD__LATTICE_EXTENT;
    const struct gd__site far[3] = {{-e, -e}, {4 * e, -e}, {-e, 4 * e}};
    uint32_t n = input->count;
    enum gd_status status =
        gd_control_afford(plane->pace->control, gd__plane_bytes(n + 3) + n * sizeof(uint32_t));
    if (!status) status = gd__plane_create(plane, n + 3);
    if (status) return status;
    memcpy(plane->sites, input->points, n * sizeof *plane->sites);
    memcpy(plane->sites + n, far, sizeof far);
    gd__plane_begin(plane, (uint32_t[]){n, n + 1, n + 2});
    return GD_OK;
}

/* Inserts the points, and then the segments. Points at the same place are one site. */
static enum gd_status fill(struct gd__plane *plane, const struct gd__triangulation_input *input)
{
    uint32_t *same = malloc((input->count + (size_t)1) * sizeof *same);
    enum gd_status status = same ? GD_OK : GD_NO_MEMORY;
    for (uint32_t i = 0; i < input->count && !status; i++)
        status = gd__plane_insert(plane, i, &same[i]);
    for (uint32_t i = 0; i < input->segment_count && !status; i++) {
        uint32_t a = same[input->segments[i][0]], b = same[input->segments[i][1]];
        if (a != b) status = gd__plane_fix(plane, a, b);
    }
    free(same);
    return status;
}

enum { UNKNOWN = 2 };

/* Marks the triangles that an odd number of segments separates from the outside, which is at
 * triangle `first`. */
static void mark_inside(struct gd__plane *plane, uint32_t first, uint8_t *inside)
{
    uint32_t waiting = 0;
    memset(inside, UNKNOWN, plane->triangle_count);
    inside[first] = 0;
    plane->queue[waiting++][0] = first;
    while (waiting && gd__pace(plane->pace, 1)) {
        uint32_t t = plane->queue[--waiting][0];
        for (int k = 0; k < 3; k++) {
            uint32_t other = plane->triangles[t].across[k];
            if (other == GD_NONE || inside[other] != UNKNOWN) continue;
            inside[other] = inside[t] ^ plane->triangles[t].is_fixed[k];
            plane->queue[waiting++][0] = other;
        }
    }
}

static enum gd_status collect(struct gd__plane *plane, uint32_t outer,
                              struct gd__triangulation *out)
{
    uint8_t *inside = malloc(plane->triangle_count);
    uint32_t(*triangles)[3] = malloc(plane->triangle_count * sizeof *triangles);
    enum gd_status status = GD_NO_MEMORY;
    uint32_t count = 0;
    if (inside && triangles) {
        mark_inside(plane, plane->triangle_at[outer], inside);
        status = plane->pace->status;
    }
    for (uint32_t i = 0; !status && i < plane->triangle_count; i++)
        if (inside[i] == 1)
            memcpy(triangles[count++], plane->triangles[i].corner, sizeof *triangles);
    free(inside);
    if (status)
        free(triangles);
    else
        *out = (struct gd__triangulation){count, triangles};
    return status;
}

enum gd_status gd__loops_triangulate(const struct gd__triangulation_input *input,
                                     struct gd__pace *pace, struct gd__triangulation *out)
{
    struct gd__plane plane = {.pace = pace, .is_bad = in_circle};
    enum gd_status status = begin(&plane, input);
    if (!status) status = fill(&plane, input);
    if (!status) status = collect(&plane, input->count, out);
    gd__plane_free(&plane);
    return status;
}
