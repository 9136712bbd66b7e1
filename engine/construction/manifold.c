/* Checks that each vertex has one fan of faces, open or closed. Counts the fans of a vertex: walks
 * around the vertex from each corner that no earlier walk has visited. */
#include <stdlib.h>

#include "base/large.h"
#include "construction/steps.h"
#include "construction/offenders.h"
#include "repair/repair.h"

/* A corner has the number of the side that starts there: 3 face + k. The next two functions return
 * the neighbouring corners around its vertex. */

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

enum gd_status gd__check_vertices(struct gd__construction *work)
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
