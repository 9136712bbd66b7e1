/* Checks that each vertex has one fan of faces, open or closed: a walk around the vertex visits all
 * of its corners. If a walk misses a corner, counts the fans of each vertex. */
#include <stdatomic.h>
#include <stdlib.h>

#include "base/large.h"
#include "base/slices.h"
#include "construction/steps.h"
#include "construction/offenders.h"
#include "repair/repair.h"

/* The number of a corner is that of the side that starts there: 3 face + k. The next two functions
 * return the neighbouring corner of the same vertex, in the next face counter-clockwise or
 * clockwise. */

static uint32_t counter_clockwise(const uint32_t *neighbour, uint32_t corner)
{
    return neighbour[corner - corner % 3 + gd__previous_corner(corner % 3)];
}

static uint32_t clockwise(const uint32_t *neighbour, uint32_t corner)
{
    uint32_t across = neighbour[corner];
    return across == GD_NONE ? GD_NONE : across - across % 3 + gd__next_corner(across % 3);
}

static void walk_fan(struct gd__construction *work, uint32_t start, uint8_t *visited)
{
    const uint32_t *neighbour = work->neighbour;
    for (uint32_t c = start; c != GD_NONE && !visited[c] && gd__pace(&work->pace, 1);
         c = counter_clockwise(neighbour, c))
        visited[c] = 1;
    for (uint32_t c = clockwise(neighbour, start);
         c != GD_NONE && !visited[c] && gd__pace(&work->pace, 1); c = clockwise(neighbour, c))
        visited[c] = 1;
}

static void count_fans(struct gd__construction *work, uint8_t *visited, uint32_t *fans)
{
    GD__PACED (&work->pace, c, 3 * work->mesh->face_count) {
        if (visited[c]) continue;
        fans[work->corner[c / 3][c % 3]]++;
        walk_fan(work, c, visited);
    }
}

static enum gd_status manifold_refuse(const struct gd__construction *work,
                                      const struct gd__offenders *split)
{
    gd_fail(work->detail, GD_NON_MANIFOLD_VERTEX,
            "the faces around vertex %u form %u separate fans; give each fan a vertex of its own",
            (unsigned)split->lowest[0].a, split->lowest[0].witness);
    gd__blame_weld(work, (uint32_t[1]){(uint32_t)split->lowest[0].a}, 1);
    return gd__offenders_report(split, GD_ELEMENT_VERTEX, GD_NON_MANIFOLD_VERTEX, work->detail);
}

/* Reports the vertices with several fans. */
static enum gd_status refuse_fans(struct gd__construction *work)
{
    const struct gd_mesh *mesh = work->mesh;
    uint8_t *visited = gd__large_zeroed(3 * (size_t)mesh->face_count, sizeof *visited);
    uint32_t *fans = gd__large_zeroed(mesh->vertex_count, sizeof *fans);
    struct gd__offenders split = {0};
    if (visited && fans) {
        count_fans(work, visited, fans);
        GD__PACED (&work->pace, v, mesh->vertex_count) {
            if (fans[v] > 1) gd__offenders_add(&split, mesh->index_of_vertex[v], 0, fans[v]);
        }
    }
    enum gd_status status = visited && fans ? GD_OK : GD_NO_MEMORY;
    free(visited);
    free(fans);
    return split.total ? manifold_refuse(work, &split) : status;
}

/* Counts the corners of each vertex, and sets the first entry of its fan and its lowest corner. */
static void count_corners(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    const uint32_t *corner = work->corner[0];
    uint32_t *first = mesh->fan_first;
    GD__PACED (&work->pace, done, 3 * mesh->face_count) {
        uint32_t c = 3 * mesh->face_count - 1 - done;
        first[corner[c] + 1]++;
        work->any_corner[corner[c]] = c;
    }
    GD__PACED (&work->pace, v, mesh->vertex_count) first[v + 1] += first[v];
}

/* Returns the number of corners in the fan of a corner. */
static uint32_t fan_size(const uint32_t *neighbour, uint32_t start, struct gd__pace *pace)
{
    uint32_t count = 1, c = counter_clockwise(neighbour, start);
    for (; c != GD_NONE && c != start && gd__pace(pace, 1); c = counter_clockwise(neighbour, c))
        count++;
    if (c != GD_NONE) return count;
    for (c = clockwise(neighbour, start); c != GD_NONE && gd__pace(pace, 1);
         c = clockwise(neighbour, c))
        count++;
    return count;
}

struct fan_check {
    const struct gd__construction *work;
    atomic_bool has_split; /* true if a vertex has several fans */
};

static void check_fans(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct fan_check *check = context;
    const struct gd__construction *work = check->work;
    const uint32_t *first = work->mesh->fan_first;
    for (uint32_t v = begin; v < end; v++)
        if (fan_size(work->neighbour, work->any_corner[v], pace) != first[v + 1] - first[v])
            atomic_store_explicit(&check->has_split, true, memory_order_relaxed);
}

enum gd_status gd__check_vertices(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    struct fan_check check = {.work = work};
    mesh->fan_first = gd__mesh_array(work, (size_t)mesh->vertex_count + 1, sizeof *mesh->fan_first);
    work->any_corner = gd__scratch_array(work, NULL, mesh->vertex_count, sizeof *work->any_corner);
    if (!mesh->fan_first || !work->any_corner) return GD_NO_MEMORY;
    count_corners(work);
    gd__slices_run(&work->pace, mesh->vertex_count, check_fans, &check);
    return check.has_split ? refuse_fans(work) : GD_OK;
}
