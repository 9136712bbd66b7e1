#include "field/layout.h"

#include <stdlib.h>
#include <string.h>

/* The final stage: the lists of the two sides of an edge become one (Properties 1-3 of the paper), sorted, disjoint, 24 bytes a wedge. Edges
 * are independent, so blocks of them are counted in parallel, then written in parallel behind each other. */

#define EDGES_PER_BLOCK 4096

struct compaction {
    struct gd_field *field;
    struct gd__wavefront *front;
    uint32_t blocks;
    uint64_t *count;        /* per block: wedges, then their offset */
    enum gd_status *status; /* per block */
    bool writing;
};

/* The merged windows of an edge in the frame of its side 0, whose windows win ties; windows of side 1 keep tags = 1 to be told apart. */
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
        mirrored[i].tags = 1;
    }
    gd__merge(both->windows, near->count, mirrored, far->count, GD_TOL_WIDTH * length, merged);
    return GD_OK;
}

static uint32_t fixed_point(double t, double length)
{
    double scaled = t / length / GD__WEDGE_UNIT;
    return scaled <= 0 ? 0 : scaled >= 4294967295.0 ? UINT32_MAX : (uint32_t)scaled;
}

/* Where packed wedges go; `out` NULL: they are only counted. A wedge that starts where the last one did, in fixed point, takes its place. */
struct packing {
    struct gd__wedge *out;
    uint32_t count, last_b0;
};

static void pack_wedge(struct packing *packing, struct gd__wedge wedge)
{
    if (packing->count && packing->last_b0 == wedge.b0) packing->count--;
    if (packing->out) packing->out[packing->count] = wedge;
    packing->last_b0 = wedge.b0;
    packing->count++;
}

/* Packs a merged list; gaps become wedges without a source. Returns how many wedges. */
static uint32_t pack_edge(const struct gd__stack *merged, double length, struct gd__wedge *out)
{
    struct packing packing = {.out = out};
    double end = 0, slack = GD_TOL_ADJACENT * length;
    for (uint32_t i = 0; i < merged->count; i++) {
        const struct gd__window *w = &merged->windows[i];
        bool gap = w->b0 > end + slack;
        if (gap) pack_wedge(&packing, (struct gd__wedge){.b0 = fixed_point(end, length), .source = GD_NONE});
        double start = gap || i ? w->b0 : 0;
        pack_wedge(&packing,
                   (struct gd__wedge){
                       .x = w->x, .y = w->tags ? w->y : -w->y, .b0 = fixed_point(start, length), .source = w->source});
        end = w->b1;
    }
    if (merged->count && end < length - slack)
        pack_wedge(&packing, (struct gd__wedge){.b0 = fixed_point(end, length), .source = GD_NONE});
    return packing.count;
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
        c->status[block] = merge_edge(c->front, edge, scratch);
        if (c->status[block]) break;
        if (c->writing) field->first[edge] = (uint32_t)offset;
        offset +=
            pack_edge(&scratch[1], field->mesh->side[2 * edge].length, c->writing ? field->wedges + offset : NULL);
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
