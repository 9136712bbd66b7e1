#include "field/layout.h"

#include <stdlib.h>
#include <string.h>

/* The final stage: the lists of the two sides of an edge become one (Properties 1-3 of the paper), sorted, disjoint, 24 bytes a wedge. Edges
 * are independent, so blocks of them are counted in parallel, then written in parallel behind each other. */

#define EDGES_PER_BLOCK 4096
#define PREFETCH_EDGES  6
#define FAR_SIDE        GD__WINDOW_SERIAL /* tag: a window of side 1, mirrored into the frame of side 0 */

struct compaction {
    struct gd_field *field;
    struct gd__wavefront *front;
    uint32_t blocks;
    uint64_t *count;        /* per block: wedges, then their offset */
    enum gd_status *status; /* per block */
    bool writing;
};

/* The merged windows of an edge, in scratch[1], in the frame of its side 0, whose windows win ties. */
static enum gd_status merge_edge(const struct gd__wavefront *front, uint32_t edge, struct gd__stack scratch[2])
{
    const struct gd__list *near = &front->lists[2 * edge], *far = &front->lists[2 * edge + 1];
    double length = front->mesh->side[2 * edge].length;
    struct gd__stack *both = &scratch[0], *merged = &scratch[1];
    merged->count = 0;
    enum gd_status status = gd__stack_reserve(both, near->count + far->count + 1);
    if (!status) status = gd__stack_reserve(merged, gd__merged_bound(near->count, far->count));
    if (status) return status;
    for (uint32_t i = 0; i < near->count; i++) {
        both->windows[i] = near->windows[i];
        both->windows[i].tags = 0;
    }
    struct gd__window *mirrored = both->windows + near->count;
    for (uint32_t i = 0; i < far->count; i++) {
        mirrored[i] = gd__window_mirrored(&far->windows[far->count - 1 - i], length);
        mirrored[i].tags = FAR_SIDE;
    }
    gd__merge(both->windows, near->count, mirrored, far->count, GD_TOL_WIDTH * length, merged);
    return GD_OK;
}

static uint32_t fixed_point(double t, double length)
{
    double scaled = t / length * 4294967296.0;
    return scaled <= 0 ? 0 : scaled >= 4294967295.0 ? UINT32_MAX : (uint32_t)scaled;
}

/* Where the wedges of an edge go, in order of b0. A wedge that starts where the last one did, in fixed point, takes its place; where no window
 * continues the last one, a wedge without a source marks the gap. */
struct packing {
    struct gd__wedge *out; /* NULL: they are only counted */
    uint32_t count, last_b0;
    double length, end;
};

static void pack_wedge(struct packing *packing, struct gd__wedge wedge)
{
    if (packing->count && packing->last_b0 == wedge.b0) packing->count--;
    if (packing->out) packing->out[packing->count] = wedge;
    packing->last_b0 = wedge.b0;
    packing->count++;
}

static void pack_gap(struct packing *packing, double until)
{
    if (until <= packing->end + GD_TOL_ADJACENT * packing->length) return;
    pack_wedge(packing, (struct gd__wedge){.b0 = fixed_point(packing->end, packing->length), .source = GD_NONE});
    packing->end = until;
}

/* The window of side 0 or 1 of the edge, its interval and x in the frame of side 0. */
static void pack_window(struct packing *packing, const struct gd__window *w, bool far, double b0, double b1, double x)
{
    pack_gap(packing, b0);
    double start = packing->count ? b0 : packing->end; /* the first begins at the edge's end, but for a gap */
    pack_wedge(packing,
               (struct gd__wedge){
                   .x = x, .y = far ? w->y : -w->y, .b0 = fixed_point(start, packing->length), .source = w->source});
    packing->end = b1;
}

static void pack_near(struct packing *packing, const struct gd__list *list)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const struct gd__window *w = &list->windows[i];
        pack_window(packing, w, false, w->b0, w->b1, w->x);
    }
}

static void pack_merged(struct packing *packing, const struct gd__stack *merged)
{
    for (uint32_t i = 0; i < merged->count; i++) {
        const struct gd__window *w = &merged->windows[i];
        pack_window(packing, w, w->tags == FAR_SIDE, w->b0, w->b1, w->x);
    }
}

static void pack_far(struct packing *packing, const struct gd__list *list)
{
    for (uint32_t i = list->count; i-- > 0;) {
        const struct gd__window *w = &list->windows[i];
        pack_window(packing, w, true, packing->length - w->b1, packing->length - w->b0, packing->length - w->x);
    }
}

/* Packs the windows of an edge's two sides. Mostly one side's windows all lie before the other's and need no contest. */
static enum gd_status pack_edge(const struct gd__wavefront *front, uint32_t edge, struct gd__stack scratch[2],
                                struct packing *packing)
{
    const struct gd__list *near = &front->lists[2 * edge], *far = &front->lists[2 * edge + 1];
    double length = packing->length, width = GD_TOL_WIDTH * length;
    if (!near->count || !far->count ||
        near->windows[near->count - 1].b1 <= length - far->windows[far->count - 1].b1 + width) {
        pack_near(packing, near);
        pack_far(packing, far);
    } else if (length - far->windows[0].b0 <= near->windows[0].b0 + width) {
        pack_far(packing, far);
        pack_near(packing, near);
    } else {
        enum gd_status status = merge_edge(front, edge, scratch);
        if (status) return status;
        pack_merged(packing, &scratch[1]);
    }
    if (packing->count) pack_gap(packing, length);
    return GD_OK;
}

/* The lists lie all over the pool: their first windows are asked for some edges ahead. */
static void prefetch_edge(const struct gd__wavefront *front, uint32_t edge)
{
    if (edge >= front->mesh->edge_count) return;
    for (uint32_t side = 2 * edge; side < 2 * edge + 2; side++)
        for (uint32_t i = 0; i < front->lists[side].count; i++) __builtin_prefetch(&front->lists[side].windows[i]);
}

static void compact_block(void *context, uint32_t block)
{
    struct compaction *c = context;
    struct gd_field *field = c->field;
    uint32_t edge = block * EDGES_PER_BLOCK, end = edge + EDGES_PER_BLOCK;
    if (end > field->mesh->edge_count) end = field->mesh->edge_count;
    uint64_t offset = c->writing ? c->count[block] : 0;
    struct gd__stack scratch[2] = {{0}, {0}};
    for (; edge < end && !c->status[block]; edge++) {
        prefetch_edge(c->front, edge + PREFETCH_EDGES);
        struct packing packing = {.out = c->writing ? field->wedges + offset : NULL,
                                  .length = field->mesh->side[2 * edge].length};
        if (c->writing) field->first[edge] = (uint32_t)offset;
        c->status[block] = pack_edge(c->front, edge, scratch, &packing);
        offset += packing.count;
    }
    if (!c->writing) c->count[block] = offset;
    gd__stack_destroy(&scratch[0]);
    gd__stack_destroy(&scratch[1]);
}

static enum gd_status run_blocks(struct compaction *c, const struct gd_executor *executor)
{
    gd_executor_run(executor, compact_block, c, c->blocks);
    for (uint32_t i = 0; i < c->blocks; i++)
        if (c->status[i]) return c->status[i];
    return GD_OK;
}

/* Turns counts into offsets and takes memory for all wedges. */
static enum gd_status allocate(struct compaction *c)
{
    struct gd_field *field = c->field;
    uint64_t total = 0;
    for (uint32_t i = 0; i < c->blocks; i++) {
        uint64_t count = c->count[i];
        c->count[i] = total;
        total += count;
    }
    if (total >= UINT32_MAX) return GD_BUDGET; /* 100 GB of wedges: `first` would overflow */
    size_t held = c->front->pool.overhead + c->front->pool.bytes;
    enum gd_status status = gd_control_afford(c->front->monitor, held + total * sizeof *field->wedges);
    if (status) return status;
    field->wedges = malloc(total ? total * sizeof *field->wedges : 1);
    field->first = malloc(sizeof *field->first * ((size_t)field->mesh->edge_count + 1));
    if (!field->wedges || !field->first) return GD_NO_MEMORY;
    field->first[field->mesh->edge_count] = (uint32_t)total;
    field->statistics.wedges = total;
    return GD_OK;
}

static enum gd_status compact(struct compaction *c, const struct gd_executor *executor)
{
    enum gd_status status = run_blocks(c, executor);
    if (!status) status = allocate(c);
    if (status) return status;
    c->writing = true;
    return run_blocks(c, executor);
}

enum gd_status gd__field_take(void *user, struct gd__wavefront *front, const struct gd_executor *executor)
{
    struct gd_field *field = user;
    field->statistics = (struct gd_field_statistics){.windows_created = front->effort.windows_created,
                                                     .windows_propagated = front->effort.windows_propagated,
                                                     .sides_propagated = front->effort.sides_propagated,
                                                     .vertices_emitted = front->effort.vertices_emitted};
    struct compaction c = {
        .field = field, .front = front, .blocks = (front->mesh->edge_count + EDGES_PER_BLOCK - 1) / EDGES_PER_BLOCK};
    c.count = calloc(c.blocks, sizeof *c.count);
    c.status = calloc(c.blocks, sizeof *c.status);
    enum gd_status status = c.count && c.status ? compact(&c, executor) : GD_NO_MEMORY;
    free(c.count);
    free(c.status);
    if (status) return status;
    field->reach = front->bound;
    field->distance = front->distance;
    field->birth = front->birth;
    front->distance = NULL;
    front->birth = NULL;
    return GD_OK;
}
