#include "field/sources.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "mesh/segment.h"

/* Merges the chunks of an edge to one list of wedges by contests, as the final stage of Liu's
 * algorithm (gd/field.h) does. Chunks contain no windows whose sources lie on the edge's own line.
 * Therefore the edge's ends and the seeds on the edge are merged here. They are Liu's tuples with
 * d0 = 0 or d1 = 0. */

/* Stored ends of wedges are rounded to one unit. Two ends that were equal before rounding may lie
 * this far apart. */
#define ROUNDED (2 * GD__WEDGE_UNIT)

/* Dropped pieces leave gaps of at most this width. The wedge before such a gap is extended over the
 * gap. */
#define NARROW (4 * ROUNDED)

struct merger {
    struct gd__stack list, chunk, merged;
};

static void close_merger(struct merger *merger)
{
    gd__stack_destroy(&merger->list);
    gd__stack_destroy(&merger->chunk);
    gd__stack_destroy(&merger->merged);
}

/* Merges the windows of m->chunk into the list. In a tie, the window of the list wins. */
static enum gd_status merge_windows(struct merger *m, double length)
{
    enum gd_status status =
        gd__stack_reserve(&m->merged, gd__merged_bound(m->list.count, m->chunk.count));
    if (status) return status;
    m->merged.count = 0;
    gd__merge(m->list.windows, m->list.count, m->chunk.windows, m->chunk.count, ROUNDED * length,
              &m->merged);
    struct gd__stack swap = m->list;
    m->list = m->merged;
    m->merged = swap;
    return GD_OK;
}

static enum gd_status merge_chunk(const struct gd_field *field, const struct gd__chunk *chunk,
                                  double length, struct merger *m)
{
    enum gd_status status = gd__stack_reserve(&m->chunk, chunk->count + 1);
    if (status) return status;
    m->chunk.count = 0;
    for (uint32_t i = 0; i < chunk->count; i++) {
        struct gd__window w = gd__field_window(field, chunk, i, length);
        if (w.source != GD_NONE) m->chunk.windows[m->chunk.count++] = w;
    }
    return merge_windows(m, length);
}

/* Merges a window that lies on the edge itself. */
static enum gd_status merge_own_window(double length, struct gd__window w, struct merger *m)
{
    enum gd_status status = gd__stack_reserve(&m->chunk, 1);
    if (status) return status;
    m->chunk.windows[0] = w;
    m->chunk.count = 1;
    return merge_windows(m, length);
}

/* Merges the window of a source at parameter x of the edge itself, within the field's reach. */
static enum gd_status merge_own_source(const struct gd_field *field, double length, double x,
                                       uint32_t source, struct merger *m)
{
    double sigma = gd__field_sigma(field, source), radius = field->reach - sigma;
    if (sigma >= GD__FAR || radius <= 0) return GD_OK;
    struct gd__window w = {.b0 = fmax(x - radius, 0),
                           .b1 = fmin(x + radius, length),
                           .x = x,
                           .sigma = sigma,
                           .source = source};
    return merge_own_window(length, w, m);
}

/* Merges the window of a seed on the edge: a point, or a segment along the edge, which is visible
 * perpendicularly everywhere. */
static enum gd_status merge_own_seed(const struct gd_field *field, uint32_t edge, uint32_t number,
                                     struct merger *m)
{
    const struct gd_mesh *mesh = field->mesh;
    const struct gd__seed *seed = &field->seeds[number];
    double length = mesh->side[2 * edge].length;
    uint32_t source = mesh->vertex_count + number;
    double x = gd__edge_parameter(mesh, edge, &seed->point);
    if (!seed->is_segment) return merge_own_source(field, length, x, source, m);
    double to = gd__edge_parameter(mesh, edge, &seed->end);
    if (seed->offset > field->reach) return GD_OK;
    struct gd__window w = {.b0 = fmin(x, to),
                           .b1 = fmax(x, to),
                           .y = 1,
                           .sigma = seed->offset,
                           .source = source | GD__SOURCE_LINEAR};
    return merge_own_window(length, w, m);
}

static enum gd_status merge_own_sources(const struct gd_field *field, uint32_t edge,
                                        struct merger *m)
{
    const struct gd_mesh *mesh = field->mesh;
    double length = mesh->side[2 * edge].length;
    enum gd_status status = merge_own_source(field, length, 0, mesh->origin[2 * edge], m);
    if (!status) status = merge_own_source(field, length, length, mesh->origin[2 * edge + 1], m);
    for (struct gd__face_seeds f = gd__edge_seeds(field, edge); f.at < f.end && !status; f.at++) {
        const struct gd__seed *seed = &field->seeds[f.at->seed];
        if (gd__point_is_on_edge(mesh, &seed->point, edge) &&
            (!seed->is_segment || gd__point_is_on_edge(mesh, &seed->end, edge)))
            status = merge_own_seed(field, edge, f.at->seed, m);
    }
    return status;
}

/* Joins the pieces of a wedge from several chunks. Closes overlaps and gaps of a few units, which
 * result from the rounding of stored ends. */
static void close_up(struct gd__stack *list, double length)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        struct gd__window w = list->windows[i], *last = kept ? &list->windows[kept - 1] : NULL;
        bool is_same = last && gd__window_same_source(last, &w);
        if (is_same && w.b0 <= last->b1 + ROUNDED * length) {
            last->b1 = fmax(last->b1, w.b1);
            continue;
        }
        if (last) w.b0 = fmax(w.b0, last->b1);
        if (w.b0 >= w.b1) continue;
        if (last && w.b0 <= last->b1 + NARROW * length) last->b1 = w.b0;
        list->windows[kept++] = w;
    }
    list->count = kept;
    if (!kept) return;
    struct gd__window *first = &list->windows[0], *last = &list->windows[kept - 1];
    if (first->b0 <= NARROW * length) first->b0 = 0;
    if (last->b1 >= length - NARROW * length) last->b1 = length;
}

static enum gd_status merge_edge(const struct gd_field *field, uint32_t edge, struct merger *m)
{
    enum gd_status status = gd__stack_reserve(&m->list, 1);
    for (uint32_t at = field->newest[edge]; at != GD_NONE && !status;) {
        const struct gd__chunk *chunk = gd__field_chunk(field, at);
        status = merge_chunk(field, chunk, field->mesh->side[2 * edge].length, m);
        at = gd__chunk_previous(chunk);
    }
    if (!status) status = merge_own_sources(field, edge, m);
    close_up(&m->list, field->mesh->side[2 * edge].length);
    return status;
}

/* Converts a wedge to the caller's units; parameters grow from the edge's lower-numbered vertex. */
static struct gd_wedge export_wedge(const struct gd_field *field, double length,
                                    struct gd__window w, bool reversed)
{
    const struct gd_mesh *mesh = field->mesh;
    if (reversed) w = gd__window_mirrored(&w, length);
    /* relative to the edge as stored */
    bool at_vertex = w.source < mesh->vertex_count, left = w.tags & GD__WINDOW_FAR_SIDE;
    double sigma = gd__field_sigma(field, w.source);
    w.sigma -= sigma;
    /* d0, d1 of a linear wedge: distances from its line, which may be below 0 in a closed gap */
    return (struct gd_wedge){.b0 = w.b0 * mesh->unit,
                             .b1 = w.b1 * mesh->unit,
                             .d0 = fmax(gd__window_distance(&w, w.b0), 0) * mesh->unit,
                             .d1 = fmax(gd__window_distance(&w, w.b1), 0) * mesh->unit,
                             .sigma = sigma * mesh->unit,
                             .tau = left != reversed,
                             .linear = gd__window_is_linear(&w),
                             .at_vertex = at_vertex,
                             .source = at_vertex ? mesh->index_of_vertex[w.source]
                                                 : gd__field_seed_of(field, w.source)};
}

static bool is_reversed(const struct gd_mesh *mesh, uint32_t edge)
{
    return mesh->index_of_vertex[mesh->origin[2 * edge]] >
           mesh->index_of_vertex[mesh->origin[2 * edge + 1]];
}

static void export_edge(const struct gd_field *field, uint32_t edge, const struct gd__stack *list,
                        struct gd_wedge *out)
{
    const struct gd_mesh *mesh = field->mesh;
    bool reversed = is_reversed(mesh, edge);
    for (uint32_t i = 0; i < list->count; i++)
        out[reversed ? list->count - 1 - i : i] =
            export_wedge(field, mesh->side[2 * edge].length, list->windows[i], reversed);
}

enum gd_status gd_field_wedges(const struct gd_field *field, struct gd_vertex a, struct gd_vertex b,
                               struct gd_wedge **out, uint32_t *count)
{
    const struct gd_mesh *mesh = field->mesh;
    uint32_t limit = mesh->summary.index_count;
    uint32_t va = a.index < limit ? mesh->vertex_of_index[a.index] : GD_NONE,
             vb = b.index < limit ? mesh->vertex_of_index[b.index] : GD_NONE;
    uint32_t side = va == GD_NONE || vb == GD_NONE ? GD_NONE : gd__side_between(mesh, va, vb);
    if (side == GD_NONE) return GD_NO_SUCH_EDGE;
    struct merger merger = {0};
    enum gd_status status = merge_edge(field, side >> 1, &merger);
    struct gd_wedge *wedges =
        status ? NULL : malloc(sizeof *wedges * ((size_t)merger.list.count + 1));
    if (!status && !wedges) status = GD_NO_MEMORY;
    if (!status) {
        export_edge(field, side >> 1, &merger.list, wedges);
        *out = wedges;
        *count = merger.list.count;
    }
    close_merger(&merger);
    return status;
}

/* --- all edges -------------------------------------------------------------------------------- */

#define CHECK_EDGES 256 /* edges between two checks: about half a millisecond */

size_t gd_all_wedges_memsize(const struct gd_all_wedges *all)
{
    size_t edges = all->edge_count;
    if (!all->first) return 0;
    return edges * sizeof *all->edges + (edges + 1) * sizeof *all->first +
           all->first[edges] * sizeof *all->wedges;
}

void gd_all_wedges_free(struct gd_all_wedges *all)
{
    free(all->edges);
    free(all->first);
    free(all->wedges);
    *all = (struct gd_all_wedges){0};
}

/* Merges the edge's chunks and appends its wedges. *capacity is the capacity of all->wedges. */
static enum gd_status append_edge(const struct gd_field *field, uint32_t edge, struct merger *m,
                                  struct gd_all_wedges *all, uint32_t *capacity)
{
    const struct gd_mesh *mesh = field->mesh;
    m->list.count = 0;
    enum gd_status status = merge_edge(field, edge, m);
    if (status) return status;
    uint64_t count = (uint64_t)all->first[edge] + m->list.count;
    if (count >= UINT32_MAX) return GD_BUDGET;
    status = gd__array_extend(&all->wedges, capacity, count, sizeof *all->wedges, NULL);
    if (status) return status;
    all->first[edge + 1] = (uint32_t)count;
    export_edge(field, edge, &m->list, all->wedges + all->first[edge]);
    bool reversed = is_reversed(mesh, edge);
    for (int k = 0; k < 2; k++)
        all->edges[edge][k].index = mesh->index_of_vertex[mesh->origin[2 * edge + (k != reversed)]];
    return GD_OK;
}

static enum gd_status append_edges(const struct gd_field *field, const struct gd_control *control,
                                   struct merger *m, struct gd_all_wedges *all)
{
    uint32_t edges = field->mesh->edge_count, capacity = 0;
    size_t fixed = edges * (sizeof *all->edges + sizeof *all->first);
    enum gd_status status = GD_OK;
    for (uint32_t edge = 0; edge < edges && !status; edge++) {
        uint32_t before = capacity;
        status = append_edge(field, edge, m, all, &capacity);
        if (status || (capacity == before && edge % CHECK_EDGES != 0)) continue;
        /* while the array grows, the old array and a new one of twice its size exist */
        status = gd_control_afford(control, fixed + 3 * (size_t)capacity * sizeof *all->wedges);
        if (!status) status = gd_control_check(control, (double)edge / edges);
    }
    return status;
}

enum gd_status gd_field_all_wedges(const struct gd_field *field, const struct gd_control *control,
                                   struct gd_all_wedges *out)
{
    size_t edges = field->mesh->edge_count;
    *out = (struct gd_all_wedges){.edge_count = (uint32_t)edges};
    enum gd_status status =
        gd_control_afford(control, edges * (sizeof *out->edges + sizeof *out->first));
    if (status) return status;
    out->edges = malloc(edges * sizeof *out->edges);
    out->first = calloc(edges + 1, sizeof *out->first);
    struct merger merger = {0};
    status = out->edges && out->first ? append_edges(field, control, &merger, out) : GD_NO_MEMORY;
    close_merger(&merger);
    if (status) {
        gd_all_wedges_free(out);
        return status;
    }
    struct gd_wedge *exact = realloc(out->wedges, (out->first[edges] + (size_t)1) * sizeof *exact);
    if (exact) out->wedges = exact;
    return GD_OK;
}
