#include "field/layout.h"

#include <stdlib.h>
#include <string.h>

/* The wedges of an edge as one list: its chunks merged by contest, as the paper's final stage has
 * them. */

/* Ends of wedges are stored to one unit: two that were one may lie so far apart, and nothing is to
 * be seen between them. */
#define ROUNDED (2 * GD__WEDGE_UNIT)

struct merger {
    struct gd__stack list, chunk, merged;
};

static void close_merger(struct merger *merger)
{
    gd__stack_destroy(&merger->list);
    gd__stack_destroy(&merger->chunk);
    gd__stack_destroy(&merger->merged);
}

static enum gd_status merge_chunk(const struct gd_field *field, const struct gd__chunk *chunk,
                                  double length, struct merger *m)
{
    enum gd_status status = gd__stack_reserve(&m->chunk, chunk->count + 1);
    if (!status)
        status = gd__stack_reserve(&m->merged, gd__merged_bound(m->list.count, chunk->count));
    if (status) return status;
    m->chunk.count = m->merged.count = 0;
    for (uint32_t i = 0; i < chunk->count; i++) {
        struct gd__window w = gd__field_window(field, chunk, i, length);
        if (w.source != GD_NONE) m->chunk.windows[m->chunk.count++] = w;
    }
    gd__merge(m->list.windows, m->list.count, m->chunk.windows, m->chunk.count, ROUNDED * length,
              &m->merged);
    struct gd__stack swap = m->list;
    m->list = m->merged;
    m->merged = swap;
    return GD_OK;
}

/* Rounded ends may overlap by a unit or two, and a wedge that went on in pieces is in as many
 * chunks: one behind the other they are one again. */
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
        if (w.b0 < w.b1) list->windows[kept++] = w;
    }
    list->count = kept;
}

static enum gd_status merge_edge(const struct gd_field *field, uint32_t edge, struct merger *m)
{
    enum gd_status status = gd__stack_reserve(&m->list, 1);
    for (uint32_t at = field->newest[edge]; at != GD_NONE && !status;) {
        const struct gd__chunk *chunk = gd__field_chunk(field, at);
        status = merge_chunk(field, chunk, field->mesh->side[2 * edge].length, m);
        at = chunk->previous;
    }
    close_up(&m->list, field->mesh->side[2 * edge].length);
    return status;
}

/* A wedge in the caller's terms: parameters from the edge's lower-numbered vertex, in the caller's
 * unit. */
static struct gd_wedge export_wedge(const struct gd_field *field, double length,
                                    struct gd__window w, bool reversed)
{
    const struct gd_mesh *mesh = field->mesh;
    if (reversed) w = gd__window_mirrored(&w, length);
    /* of the edge as stored */
    bool at_vertex = w.source < mesh->vertex_count, left = w.tags & GD__WINDOW_FAR_SIDE;
    double sigma = gd__field_sigma(field, w.source);
    w.sigma -= sigma; /* of a linear one what is left is the line's */
    return (struct gd_wedge){.b0 = w.b0 * mesh->unit,
                             .b1 = w.b1 * mesh->unit,
                             .d0 = gd__window_distance(&w, w.b0) * mesh->unit,
                             .d1 = gd__window_distance(&w, w.b1) * mesh->unit,
                             .sigma = sigma * mesh->unit,
                             .tau = left != reversed,
                             .linear = gd__window_is_linear(&w),
                             .at_vertex = at_vertex,
                             .source = at_vertex ? mesh->index_of_vertex[w.source]
                                                 : gd__field_seed_of(field, w.source)};
}

static enum gd_status export_edge(const struct gd_field *field, uint32_t edge,
                                  const struct gd__stack *list, struct gd_wedge **out,
                                  uint32_t *count)
{
    const struct gd_mesh *mesh = field->mesh;
    bool reversed = mesh->index_of_vertex[mesh->origin[2 * edge]] >
                    mesh->index_of_vertex[mesh->origin[2 * edge + 1]];
    struct gd_wedge *wedges = malloc(sizeof *wedges * ((size_t)list->count + 1));
    if (!wedges) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < list->count; i++)
        wedges[reversed ? list->count - 1 - i : i] =
            export_wedge(field, mesh->side[2 * edge].length, list->windows[i], reversed);
    *out = wedges;
    *count = list->count;
    return GD_OK;
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
    if (!status) status = export_edge(field, side >> 1, &merger.list, out, count);
    close_merger(&merger);
    return status;
}
