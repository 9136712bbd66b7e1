#include "mesh/construction.h"

#include <assert.h>
#include <stdlib.h>

#include "base/large.h"
#include "base/slices.h"

#define LINE ((size_t)64)

/* Returns an upper bound on the number of edges E. A manifold vertex with d faces has at most d + 1
 * edges, so 2 E <= 3 F + V. */
static uint64_t most_edges(uint64_t faces, uint64_t vertices)
{
    uint64_t referenced = vertices < 3 * faces ? vertices : 3 * faces;
    return (3 * faces + referenced) / 2;
}

void *gd__mesh_array(struct gd__construction *work, size_t count, size_t size)
{
    if (count == 0) count = 1;
    void *array = gd__large_zeroed(count, size);
    if (array) work->mesh->bytes += count * size;
    gd__slices_touch(&work->pace, array, count * size);
    return array;
}

void *gd__scratch_array(struct gd__construction *work, struct gd__loan *loan, size_t count,
                        size_t size)
{
    size_t bytes = (count * size + LINE - 1) & ~(LINE - 1);
    void *array;
    if (loan && loan->begin && bytes <= (size_t)(loan->end - loan->free)) {
        array = loan->free;
        loan->free += bytes;
    } else {
        array = gd__large_array(count, size);
    }
    gd__slices_touch(&work->pace, array, count * size);
    return array;
}

static bool is_in_loan(const struct gd__loan *loan, const char *array)
{
    return loan->begin && array >= loan->begin && array < loan->end;
}

void gd__scratch_free(const struct gd__construction *work, void *array)
{
    if (!is_in_loan(&work->until_sides, array) && !is_in_loan(&work->until_fans, array))
        free(array);
}

static void *loan_begin(struct gd__loan *loan, size_t count, size_t size)
{
    char *array = gd__large_array(count, size);
    if (array) *loan = (struct gd__loan){array, array, array + count * size};
    return array;
}

enum gd_status gd__lend_arrays(struct gd__construction *work)
{
    static_assert(sizeof(struct gd_side) == LINE, "a side fills one cache line");
    struct gd_mesh *mesh = work->mesh;
    /* the number of edges is not known yet; pages of surplus sides are never touched */
    size_t sides = 2 * most_edges(mesh->face_count, mesh->summary.index_count);
    if (sides * sizeof *mesh->side < GD__HUGE_PAGE) return GD_OK;
    mesh->side = loan_begin(&work->until_sides, sides, sizeof *mesh->side);
    mesh->fan = loan_begin(&work->until_fans, 3 * (size_t)mesh->face_count, sizeof *mesh->fan);
    return mesh->side && mesh->fan ? GD_OK : GD_NO_MEMORY;
}

void *gd__take_back(struct gd__construction *work, const struct gd__loan *loan, size_t count,
                    size_t size)
{
    assert(!loan->begin || count * size <= (size_t)(loan->end - loan->begin));
    void *array = loan->begin ? loan->begin : gd__large_array(count, size);
    if (array) work->mesh->bytes += count * size;
    gd__slices_touch(&work->pace, array, count * size);
    return array;
}

uint32_t gd__input_polygon(const struct gd_mesh *mesh, uint32_t face)
{
    uint32_t index = mesh->index_of_face[face];
    return mesh->source_polygon ? mesh->source_polygon[index] : index;
}

/* Bytes of memory for each vertex, edge and face. They include the mesh and the working arrays of
 * the steps. COST_FIXED is the size of the table of interval.c. */
#define COST_VERTEX 90
#define COST_FACE   150
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
