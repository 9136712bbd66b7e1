#include "mesh/construction.h"

#include <assert.h>

#include "base/large.h"
#include "base/slices.h"

void *gd__mesh_array(struct gd__construction *work, size_t count, size_t size)
{
    if (count == 0) count = 1;
    void *array = gd__large_zeroed(count, size);
    if (array) work->mesh->bytes += count * size;
    gd__slices_touch(&work->pace, array, count * size);
    return array;
}

struct gd_side *gd__mesh_sides(struct gd__construction *work, size_t count)
{
    static_assert(sizeof(struct gd_side) == 64, "a side fills one cache line");
    struct gd_side *sides = gd__scratch_array(work, count, sizeof *sides);
    if (sides) work->mesh->bytes += count * sizeof *sides;
    return sides;
}

void *gd__scratch_array(struct gd__construction *work, size_t count, size_t size)
{
    void *array = gd__large_array(count, size);
    gd__slices_touch(&work->pace, array, count * size);
    return array;
}

uint32_t gd__input_polygon(const struct gd_mesh *mesh, uint32_t face)
{
    uint32_t index = mesh->index_of_face[face];
    return mesh->source_polygon ? mesh->source_polygon[index] : index;
}

/* Returns an upper bound on the number of edges E. A manifold vertex with d faces has at most d + 1
 * edges, so 2 E <= 3 F + V. */
static uint64_t most_edges(uint64_t faces, uint64_t vertices)
{
    uint64_t referenced = vertices < 3 * faces ? vertices : 3 * faces;
    return (3 * faces + referenced) / 2;
}

/* Bytes of memory for each vertex, edge and face. They include the mesh and the working arrays of
 * the steps. COST_FIXED is the size of the table of interval.c. */
#define COST_VERTEX 90
#define COST_FACE   170
#define COST_EDGE   170
#define COST_FIXED  65536

size_t gd_mesh_build_cost(uint64_t faces, uint64_t vertices)
{
    return COST_FIXED + COST_VERTEX * vertices + COST_FACE * faces +
           COST_EDGE * most_edges(faces, vertices);
}

enum gd_status gd__afford(const struct gd__construction *work, uint64_t faces, uint64_t vertices)
{
    size_t cost = gd_mesh_build_cost(faces, vertices);
    if (!gd_control_afford(work->control, cost)) return GD_OK;
    return gd_fail(work->detail, GD_BUDGET,
                   "building this mesh takes up to %zu bytes, more than the budget of %zu", cost,
                   work->control->budget_bytes);
}
