/* Chooses the normalised unit: an exact power of two near the mean edge length, so that no square
 * overflows or underflows. */
#include <stdlib.h>

#include "base/slices.h"
#include "construction/steps.h"

struct edge_range {
    double min, mean, max; /* edge lengths, in the unit of `scale` */
};

struct edge_measuring {
    const struct gd__construction *work;
    double scale;
    struct edge_range *slices; /* one for each slice of faces; `mean` is the sum */
};

static void measure_slice(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct edge_measuring *measuring = context;
    const struct gd__construction *work = measuring->work;
    const struct gd_mesh *mesh = work->mesh;
    struct edge_range range = {.min = INFINITY};
    (void)pace;
    for (uint32_t f = begin; f < end; f++) {
        struct gd_vec3 p[3];
        for (uint32_t k = 0; k < 3; k++)
            p[k] = gd__input_position(work, mesh->index_of_vertex[work->corner[f][k]]);
        for (uint32_t k = 0; k < 3; k++) {
            struct gd_vec3 edge = gd_vec3_sub(p[gd__next_corner(k)], p[k]);
            double length = gd_vec3_length(gd_vec3_scale(edge, measuring->scale));
            if (length < range.min) range.min = length;
            if (length > range.max) range.max = length;
            range.mean += length;
        }
    }
    measuring->slices[begin / GD__PACE_STEPS] = range;
}

/* The sums of slices are added in order, so that the mean does not depend on the threads. */
static enum gd_status measure_edges(struct gd__construction *work, double scale,
                                    struct edge_range *out)
{
    uint32_t faces = work->mesh->face_count, count = (faces - 1) / GD__PACE_STEPS + 1;
    struct edge_measuring measuring = {work, scale, calloc(count, sizeof *measuring.slices)};
    if (!measuring.slices) return GD_NO_MEMORY;
    gd__slices_run(&work->pace, faces, measure_slice, &measuring);
    struct edge_range range = {.min = INFINITY};
    for (uint32_t i = 0; i < count; i++) {
        range.min = fmin(range.min, measuring.slices[i].min);
        range.max = fmax(range.max, measuring.slices[i].max);
        range.mean += measuring.slices[i].mean;
    }
    range.mean /= 3.0 * faces;
    free(measuring.slices);
    *out = range;
    return work->pace.status;
}

/* Returns the largest absolute coordinate of the bounding box. */
static double farthest_coordinate(const struct gd_mesh_summary *s)
{
    return fmax(fmax(fmax(fabs(s->min.x), fabs(s->max.x)), fmax(fabs(s->min.y), fabs(s->max.y))),
                fmax(fabs(s->min.z), fabs(s->max.z)));
}

static enum gd_status keep_input_positions(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    uint32_t count = mesh->summary.index_count;
    mesh->input_position = gd__mesh_array(work, count, sizeof *mesh->input_position);
    if (!mesh->input_position) return GD_NO_MEMORY;
    GD__PACED (&work->pace, i, count) mesh->input_position[i] = gd__input_position(work, i);
    return GD_OK;
}

/* Scales the vertices. A power of two loses bits only if a coordinate underflows. */
static enum gd_status place_vertices(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    bool is_exact = mesh->vertex_count == mesh->summary.index_count;
    mesh->position = gd__mesh_array(work, mesh->vertex_count, sizeof *mesh->position);
    if (!mesh->position) return GD_NO_MEMORY;
    GD__PACED (&work->pace, v, mesh->vertex_count) {
        struct gd_vec3 p = gd__input_position(work, mesh->index_of_vertex[v]);
        struct gd_vec3 scaled = gd_vec3_scale(p, 1 / mesh->unit),
                       q = gd_vec3_scale(scaled, mesh->unit);
        is_exact = is_exact && p.x == q.x && p.y == q.y && p.z == q.z;
        mesh->position[v] = scaled;
    }
    return is_exact ? GD_OK : keep_input_positions(work);
}

enum gd_status gd__scale(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd_vec3 size = gd_vec3_sub(mesh->summary.max, mesh->summary.min);
    double extent = fmax(fmax(size.x, size.y), size.z);
    if (!(extent >= 1 / GD_EXTENT_MAX && extent <= GD_EXTENT_MAX))
        return gd_fail(work->detail, GD_EXTENT,
                       "the bounding box measures %g; between %g and %g can be computed with",
                       extent, 1 / GD_EXTENT_MAX, GD_EXTENT_MAX);
    int exponent, finer;
    frexp(extent, &exponent);
    struct edge_range range;
    enum gd_status status = measure_edges(work, ldexp(1, -exponent), &range);
    if (status) return status;
    frexp(range.mean, &finer);
    double mean = ldexp(1, finer),
           coordinate = ldexp(farthest_coordinate(&mesh->summary), -exponent) / mean;
    if (!(range.min / mean >= 1 / GD_EXTENT_RATIO && range.max / mean <= GD_EXTENT_RATIO &&
          coordinate <= GD_EXTENT_RATIO))
        return gd_fail(work->detail, GD_EXTENT,
                       "edges between %g and %g at coordinates up to %g: more than a factor of %g "
                       "apart from their mean",
                       ldexp(range.min, exponent), ldexp(range.max, exponent),
                       farthest_coordinate(&mesh->summary), GD_EXTENT_RATIO);
    mesh->unit = ldexp(1, exponent + finer);
    status = place_vertices(work);
    if (!status && work->consumed) { /* no later step reads the positions of the input */
        free(work->consumed->positions);
        work->consumed->positions = NULL;
    }
    return status;
}
