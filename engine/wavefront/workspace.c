#include "wavefront/workspace.h"

#include <stdlib.h>
#include <string.h>

#include "base/large.h"

/* Address space for wedges, in bytes per edge. Most fields need less. Unused address space takes no
 * memory (gd__region_open). */
#define WEDGES_AN_EDGE ((size_t)2 << 10)
/* If more than 1 / TOUCHED_PART of all nodes are touched, cleaning all nodes in order is faster
 * than cleaning the listed ones. */
#define TOUCHED_PART 4

/* --- clean arrays ----------------------------------------------------------------------------- */

static void clean_lists(struct gd_workspace *w, uint32_t first, uint32_t end)
{
    for (uint32_t side = first; side < end; side++)
        w->lists[side] = (struct gd__list){.bucket = GD_NONE};
}

static void clean_vertices(struct gd_workspace *w, uint32_t first, uint32_t end)
{
    for (uint32_t v = first; v < end; v++) {
        w->emitted[v] = GD__FAR;
        w->valid_from[v] = 0;
        w->waiting[v] = GD_NONE;
    }
}

static void clean_results(struct gd_workspace *w, uint32_t first, uint32_t end)
{
    for (uint32_t v = first; v < end; v++) {
        w->distance[v] = GD__FAR;
        w->predecessor[v] = (struct gd__predecessor){.side = GD_NONE, .source = GD_NONE};
    }
}

static void clean_all(struct gd_workspace *w)
{
    clean_lists(w, 0, 2 * w->edges);
    clean_vertices(w, 0, w->vertices);
    if (!w->newest) return;
    clean_results(w, 0, w->result_vertices);
    memset(w->newest, 0xff, sizeof *w->newest * w->result_edges);
}

static void clean_touched(struct gd_workspace *w, uint32_t node)
{
    uint32_t sides = 2 * w->edges;
    if (node < sides) {
        clean_lists(w, node, node + 1);
        if (w->newest) w->newest[node >> 1] = GD_NONE;
    } else {
        clean_vertices(w, node - sides, node - sides + 1);
        if (w->newest) clean_results(w, node - sides, node - sides + 1);
    }
}

void gd__workspace_clean(struct gd_workspace *w)
{
    if (w->touched_count > w->touched_capacity) {
        clean_all(w);
    } else {
        for (uint32_t i = 0; i < w->touched_count; i++) clean_touched(w, w->touched[i]);
    }
    w->touched_count = 0;
    gd__paged_close(&w->paged);
    w->wedges.used = 0;
    if (w->queue) gd__queue_clear(w->queue);
}

/* --- memory ----------------------------------------------------------------------------------- */

static void free_results(struct gd_workspace *w)
{
    free(w->distance);
    free(w->predecessor);
    free(w->newest);
    w->distance = NULL;
    w->predecessor = NULL;
    w->newest = NULL;
}

static void free_arrays(struct gd_workspace *w)
{
    free_results(w);
    free(w->lists);
    free(w->emitted);
    free(w->valid_from);
    free(w->waiting);
    free(w->touched);
    w->lists = NULL;
    w->emitted = NULL;
    w->waiting = w->valid_from = w->touched = NULL;
    w->edges = w->vertices = w->touched_capacity = w->touched_count = 0;
}

static bool take_arrays(struct gd_workspace *w, uint32_t edges, uint32_t vertices)
{
    uint32_t touched = (2 * edges + vertices) / TOUCHED_PART;
    w->lists = gd__large_array(2 * (size_t)edges, sizeof *w->lists);
    w->emitted = gd__large_array(vertices, sizeof *w->emitted);
    w->valid_from = gd__large_array(vertices, sizeof *w->valid_from);
    w->waiting = gd__large_array(vertices, sizeof *w->waiting);
    w->touched = gd__large_array(touched, sizeof *w->touched);
    if (!w->lists || !w->emitted || !w->valid_from || !w->waiting || !w->touched) return false;
    w->edges = edges;
    w->vertices = vertices;
    w->touched_capacity = touched;
    clean_lists(w, 0, 2 * edges);
    clean_vertices(w, 0, vertices);
    return true;
}

/* Allocates the result arrays for the mesh if a propagation has taken them or if their sizes do not
 * fit. */
static bool take_results(struct gd_workspace *w, uint32_t edges, uint32_t vertices)
{
    if (w->newest && w->result_edges == edges && w->result_vertices == vertices) return true;
    free_results(w);
    w->distance = gd__large_array(vertices, sizeof *w->distance);
    w->predecessor = gd__large_array(vertices, sizeof *w->predecessor);
    w->newest = gd__large_array(edges, sizeof *w->newest);
    if (!w->distance || !w->predecessor || !w->newest) {
        free_results(w);
        return false;
    }
    w->result_edges = edges;
    w->result_vertices = vertices;
    clean_results(w, 0, vertices);
    memset(w->newest, 0xff, sizeof *w->newest * edges);
    return true;
}

size_t gd__workspace_need(const struct gd_mesh *mesh)
{
    size_t sides = 2 * (size_t)mesh->edge_count, vertices = mesh->vertex_count;
    return sides * sizeof(struct gd__list) + mesh->edge_count * sizeof(uint32_t) +
           sizeof(struct gd__queue) +
           vertices * (2 * sizeof(double) + sizeof(uint32_t) + sizeof(struct gd__predecessor) +
                       sizeof(uint32_t)) +
           (sides + vertices) / TOUCHED_PART * sizeof(uint32_t);
}

/* Opens queue, pool and region. The budget must be open. */
static enum gd_status open_rest(struct gd_workspace *w, const struct gd_mesh *mesh,
                                double bucket_width)
{
    if (!w->queue) w->queue = gd__queue_create();
    if (!w->queue) return GD_NO_MEMORY;
    gd__queue_set_width(w->queue, bucket_width);
    gd__pool_restart(&w->pool, GD__LIST_POOL_ITEM, &w->budget);
    w->left = w->right = (struct gd__children){0};
    return gd__region_open(&w->wedges, mesh->edge_count * WEDGES_AN_EDGE, &w->budget);
}

enum gd_status gd__workspace_open(struct gd_workspace *w, const struct gd_mesh *mesh,
                                  double bucket_width, const struct gd_control *control)
{
    size_t need = gd__workspace_need(mesh);
    enum gd_status status = gd_control_afford(control, need);
    if (status) return status;
    if (mesh->edge_count > w->edges || mesh->vertex_count > w->vertices) {
        free_arrays(w);
        if (!take_arrays(w, mesh->edge_count, mesh->vertex_count)) {
            free_arrays(w);
            return GD_NO_MEMORY;
        }
    }
    if (!take_results(w, mesh->edge_count, mesh->vertex_count)) return GD_NO_MEMORY;
    w->budget = (struct gd__budget){.control = control, .held = need};
    return open_rest(w, mesh, bucket_width);
}

enum gd_status gd__workspace_open_paged(struct gd_workspace *w, const struct gd_mesh *mesh,
                                        double bucket_width, const struct gd_control *control)
{
    w->budget = (struct gd__budget){.control = control};
    enum gd_status status = gd__budget_take(&w->budget, sizeof *w->queue);
    if (!status) status = gd__paged_open(&w->paged, mesh, &w->budget);
    return status ? status : open_rest(w, mesh, bucket_width);
}

/* --- creation and cleaning -------------------------------------------------------------------- */

struct gd_workspace *gd_workspace_create(void)
{
    return calloc(1, sizeof(struct gd_workspace));
}

struct gd_workspace *gd__workspace_partner(struct gd_workspace *w)
{
    if (!w->partner) w->partner = gd_workspace_create();
    return w->partner;
}

void gd_workspace_trim(struct gd_workspace *w)
{
    free_arrays(w);
    gd__paged_close(&w->paged);
    gd__guide_destroy(&w->guide);
    gd__queue_destroy(w->queue);
    gd__region_destroy(&w->wedges);
    gd__pool_destroy(&w->pool);
    gd__scratch_destroy(&w->scratch);
    gd_workspace_destroy(w->partner);
    *w = (struct gd_workspace){0};
}

void gd_workspace_destroy(struct gd_workspace *w)
{
    if (!w) return;
    gd_workspace_trim(w);
    free(w);
}

void gd_spare_memory(size_t bytes)
{
    gd__region_keep_spare(bytes);
}

bool gd_spare_prepare(void)
{
    return gd__region_prepare();
}

size_t gd_workspace_bytes(const struct gd_workspace *w)
{
    size_t sides = 2 * (size_t)w->edges, vertices = w->vertices,
           bytes = sizeof *w + w->pool.bytes + w->wedges.touched;
    bytes += sides * sizeof *w->lists +
             vertices * (sizeof *w->emitted + sizeof *w->valid_from + sizeof *w->waiting) +
             w->touched_capacity * sizeof *w->touched;
    if (w->newest)
        bytes += w->result_vertices * (sizeof *w->distance + sizeof *w->predecessor) +
                 w->result_edges * sizeof *w->newest;
    bytes += w->guide.capacity * sizeof *w->guide.node +
             w->guide.touched_capacity * sizeof *w->guide.touched +
             w->guide.heap_capacity * sizeof *w->guide.heap + gd__rings_held(&w->guide.rings);
    if (w->partner) bytes += gd_workspace_bytes(w->partner);
    return bytes + (w->queue ? sizeof *w->queue : 0);
}
