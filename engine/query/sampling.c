#include "gd/sampling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "base/share.h"
#include "gd/field.h"
#include "mesh/topology.h"

/* Farthest-point sampling: each step builds the field of all samples so far, and adds the vertex
 * that is farthest from them. */

struct sampler {
    const struct gd_mesh *mesh;
    struct gd_detail *detail;
    struct gd_seed *seeds; /* the samples so far */
    double *radii;
    double *distances; /* for each vertex index, distance from the samples */
    uint32_t count;
};

/* Finds the unreached vertex of lowest index. Returns false if there is none. */
static bool find_unreached(const struct sampler *sampler, const struct gd_field *field,
                           struct gd_point *out)
{
    uint32_t indices = sampler->mesh->summary.index_count;
    gd_field_vertex_distances(field, sampler->distances);
    for (uint32_t i = 0; i < indices; i++) {
        if (!isinf(sampler->distances[i])) continue;
        *out = (struct gd_point){.kind = GD_POINT_VERTEX,
                                 .element = sampler->mesh->vertex_of_index[i]};
        return true;
    }
    return false;
}

static enum gd_status find_next(const struct sampler *sampler, const struct gd_field *field,
                                const struct gd_control *control, struct gd_point *next,
                                double *radius)
{
    if (!find_unreached(sampler, field, next))
        return gd_field_farthest(field, control, next, radius);
    *radius = INFINITY;
    return GD_OK;
}

/* Builds the field of the samples, and adds the next sample. Each of these steps is one part of the
 * progress. */
static enum gd_status add_point(struct sampler *sampler, struct gd__share *share,
                                const struct gd_control *control)
{
    struct gd_field_request request = {.seeds = sampler->seeds, .seed_count = sampler->count};
    struct gd_field *field;
    struct gd_point next;
    enum gd_status status =
        gd_field_build(sampler->mesh, &request, control, &field, sampler->detail);
    if (status) return status;
    share->done++;
    status = find_next(sampler, field, control, &next, &sampler->radii[sampler->count - 1]);
    gd_field_release(field);
    share->done++;
    if (!status) sampler->seeds[sampler->count++] = (struct gd_seed){.point = next};
    return status;
}

static struct gd_point first_vertex(const struct gd_mesh *mesh)
{
    uint32_t index = 0;
    while (mesh->vertex_of_index[index] == GD_NONE) index++;
    return (struct gd_point){.kind = GD_POINT_VERTEX, .element = mesh->vertex_of_index[index]};
}

static enum gd_status sampling_sample(struct sampler *sampler, const struct gd_point *start,
                                      uint32_t count, const struct gd_control *control, size_t held)
{
    struct gd__share share = {.control = control, .total = 2 * count};
    struct gd_control own = gd__share_control(&share, held);
    enum gd_status status = GD_OK;
    sampler->seeds[sampler->count++].point = start ? *start : first_vertex(sampler->mesh);
    while (sampler->count <= count && !status) status = add_point(sampler, &share, &own);
    return status;
}

enum gd_status gd_sampling_farthest(const struct gd_mesh *mesh, const struct gd_point *start,
                                    const struct gd_control *control, struct gd_sampling *out,
                                    struct gd_detail *detail)
{
    uint32_t count = out->count;
    if (count == 0)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "a sampling has at least one point");
    size_t indices = mesh->summary.index_count,
           held = (count + (size_t)1) * (sizeof(struct gd_seed) + sizeof(double)) +
                  indices * sizeof(double);
    enum gd_status status = gd_control_afford(control, held);
    if (status) return status;
    struct gd__arena arena = {0};
    struct sampler sampler = {.mesh = mesh, .detail = detail};
    sampler.seeds = gd__arena_zeroed(&arena, count + (size_t)1, sizeof *sampler.seeds);
    sampler.radii = gd__arena_take(&arena, count, sizeof *sampler.radii);
    sampler.distances = gd__arena_take(&arena, indices, sizeof *sampler.distances);
    status = arena.status;
    if (!status) status = sampling_sample(&sampler, start, count, control, held);
    for (uint32_t i = 0; i < count && !status; i++) out->points[i] = sampler.seeds[i].point;
    if (!status) memcpy(out->radii, sampler.radii, count * sizeof *out->radii);
    gd__arena_free(&arena);
    return status;
}
