#include <string.h>

#include "wavefront/wavefront.h"

/* Resuming: continues a propagation that ended at a bound (doc 022). Copies the distances,
 * predecessors and wedges of that propagation. All of them describe existing paths, and those
 * within the bound are final. The windows that were dropped because of the bound are generated
 * again from stored data: they are cast from the stored wedges, emitted by vertices that have
 * emitted before, and emitted by vertices beyond the bound, which have not yet emitted with their
 * stored distance.
 *
 * A window is useful on an edge only where its distance is shorter than the paths along the edge
 * from the edge's ends. If these paths are within the bound on the whole edge, no window is missing
 * there. On all other edges, all wedges are cast again. A child (a window cast from a wedge) is
 * dropped if its smallest distance is below the bound by more than a rounding error, because the
 * bound cannot have been the reason to drop such a child in the earlier propagation. The rounding
 * error comes from the ends of wedges, which are stored with an error of 2^-32 of an edge. A window
 * that is cast twice costs only time. Windows are not joined here, so that a window that was
 * dropped is not joined to a window that was kept. */

#define COPY_BYTES  ((size_t)1 << 20) /* bytes copied between two checks of the monitor */
#define CHECK_NODES 1024              /* edges or vertices between two checks of the monitor */

/* Returns a bound on the distance along the side by which the end of a window differs from its end
 * when the window was first cast. The bound is at most the side's length. The difference arises
 * because the rounding of a wedge's end turns the ray through this end; the more slanted the ray,
 * the larger the difference along the side. The formula holds if the ray is longer than twice the
 * longest edge of the face, so that at least half of the ray lies before the face. Otherwise the
 * bound is the side's length. */
static double end_slack(const struct gd__wavefront *front, uint32_t side,
                        const struct gd__window *w)
{
    /* the face that the window crossed */
    const struct gd_side *s = &front->mesh->side[side ^ 1];
    double longest = fmax(s->length, fmax(s->left_length, s->right_length)),
           rounded = GD_TOL_STRAIGHT * longest;
    if (gd__window_is_linear(w)) return fmin(s->length, rounded / w->y);
    double r0 = hypot(w->b0 - w->x, w->y), r1 = hypot(w->b1 - w->x, w->y);
    return fmin(r0, r1) > 2 * longest ? fmin(s->length, rounded * fmax(r0, r1) / w->y) : s->length;
}

void gd__keep_beyond(const struct gd__wavefront *front, uint32_t side, struct gd__children *windows)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < windows->count; i++) {
        struct gd__window w = gd__windows_get(&windows->at, i);
        double nearest = gd__window_nearest(&w);
        if (nearest + end_slack(front, side, &w) > front->inner * (1 - GD_TOL_BOUND))
            gd__windows_put(&windows->at, kept++, &w);
    }
    windows->count = kept;
}

static void check_control(struct gd__wavefront *front, uint32_t node)
{
    double part = (double)front->sides_visited / (2 * (double)front->mesh->edge_count);
    if (node % CHECK_NODES == 0 && !front->status)
        front->status = gd_control_check(front->monitor, part);
}

/* --- stored data ------------------------------------------------------------------------------ */

static void copy_checked(struct gd__wavefront *front, void *to, const void *from, size_t bytes)
{
    for (size_t at = 0; at < bytes && !front->status; at += COPY_BYTES) {
        size_t part = bytes - at < COPY_BYTES ? bytes - at : COPY_BYTES;
        memcpy((char *)to + at, (const char *)from + at, part);
        front->status = gd_control_check(front->monitor, 0);
    }
}

/* Copies the stored data. Afterwards any element of the workspace may be dirty. A vertex beyond the
 * bound may have emitted with an earlier, longer distance. Its `emitted` is set to 0, which means
 * that the vertex may have emitted. */
static void copy_partial_field(struct gd__wavefront *front, const struct gd__partial_state *partial)
{
    const struct gd_mesh *mesh = front->mesh;
    struct gd_workspace *work = front->work;
    work->touched_count = work->touched_capacity + 1;
    copy_checked(front, front->distance, partial->distance,
                 mesh->vertex_count * sizeof *front->distance);
    copy_checked(front, front->predecessor, partial->predecessor,
                 mesh->vertex_count * sizeof *front->predecessor);
    copy_checked(front, front->newest, partial->newest, mesh->edge_count * sizeof *front->newest);
    if (!front->status) front->status = gd__region_reserve(&work->wedges, partial->wedge_bytes);
    if (front->status) return;
    copy_checked(front, work->wedges.base, partial->wedges, partial->wedge_bytes);
    work->wedges.used = partial->wedge_bytes;
    front->wedge_count = partial->wedge_count;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        if (front->distance[v] < GD__FAR)
            front->emitted[v] = front->distance[v] <= partial->bound ? front->distance[v] : 0;
}

/* --- windows beyond the bound ----------------------------------------------------------------- */

/* Returns true if a part of the edge a-b may lie beyond the bound. */
static bool is_open(const struct gd__wavefront *front, uint32_t a, uint32_t b, double length)
{
    return 0.5 * (front->distance[a] + front->distance[b] + length) >
           front->inner * (1 - GD_TOL_BOUND);
}

/* Returns true if windows of the side may have children beyond the bound. */
static bool leads_beyond(const struct gd__wavefront *front, uint32_t side)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd_side *s = &mesh->side[side];
    if (gd__side_is_boundary(mesh, side)) return false;
    uint32_t apex = gd__side_apex(mesh, side);
    return is_open(front, mesh->origin[side], apex, s->left_length) ||
           is_open(front, apex, mesh->origin[side ^ 1], s->right_length);
}

/* Restores the common end of two windows to its position before rounding, if this end is the border
 * of a shadow. In this case the nearer source lies on the ray from the farther source through the
 * end, and both windows give the same distance and direction along this ray. If the windows did not
 * meet exactly on the ray, their children would overlap and be contested on every later edge. */
static void mend_end(struct gd__window *a, struct gd__window *b, double length)
{
    if (a->b1 != b->b0 || gd__window_is_linear(a) || gd__window_is_linear(b)) return;
    double ray = a->x - a->y * (a->x - b->x) / (a->y - b->y);
    if (fabs(ray - a->b1) <= 2 * GD__WEDGE_UNIT * length && ray > a->b0 && ray < b->b1)
        a->b1 = b->b0 = ray;
}

/* Unpacks the windows of a chunk that belong to the side to scratch.tail. Returns their number.
 * Some may be narrower than the precision of their ends. */
static uint32_t unpack_chunk(struct gd__wavefront *front, uint32_t side,
                             const struct gd__chunk *chunk)
{
    struct gd__stack *stack = &front->work->scratch.stack[0];
    struct gd__window_builder *tail = &front->work->scratch.tail;
    uint32_t count = 0;
    front->status = gd__stack_reserve(stack, chunk->count + 1);
    if (!front->status) front->status = gd__window_builder_reserve(tail, chunk->count + 1);
    if (front->status) return 0;
    stack->count = 0;
    gd__stored_windows(front, chunk, side, true, stack);
    double length = front->mesh->side[side].length;
    for (uint32_t i = 0; i + 1 < stack->count; i++)
        mend_end(&stack->windows[i], &stack->windows[i + 1], length);
    for (uint32_t i = 0; i < stack->count; i++)
        if (stack->windows[i].b1 > stack->windows[i].b0)
            gd__windows_put(&tail->at, count++, &stack->windows[i]);
    return count;
}

static void cast_chunk(struct gd__wavefront *front, uint32_t side, const struct gd__chunk *chunk)
{
    uint32_t count = unpack_chunk(front, side, chunk);
    struct gd__windows windows = front->work->scratch.tail.at;
    struct gd__receiver at = gd__wavefront_receiver(front, side);
    if (count) count = front->kernel->filter(&windows, count, at.length, at.d0, at.d1);
    if (count) gd__cast(front, &at, &windows, count);
}

static void cast_edge(struct gd__wavefront *front, uint32_t edge)
{
    bool leads[2] = {leads_beyond(front, 2 * edge), leads_beyond(front, 2 * edge + 1)};
    if (!leads[0] && !leads[1]) return;
    for (uint32_t at = front->newest[edge]; at != GD_NONE && !front->status;) {
        const struct gd__chunk *chunk =
            (const struct gd__chunk *)(front->work->wedges.base + (size_t)at * GD__CHUNK_UNIT);
        for (uint32_t k = 0; k < 2 && !front->status; k++)
            if (leads[k]) cast_chunk(front, 2 * edge + k, chunk);
        at = chunk->previous;
    }
}

static void cast_edges(struct gd__wavefront *front)
{
    for (uint32_t edge = 0; edge < front->mesh->edge_count && !front->status; edge++) {
        check_control(front, edge);
        if (front->status || front->newest[edge] == GD_NONE) continue;
        front->sides_visited++;
        cast_edge(front, edge);
    }
}

static bool sees_beyond(const struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        uint32_t side = mesh->fan[i].side;
        if (is_open(front, mesh->fan[i].tip, gd__side_apex(mesh, side),
                    mesh->side[side].right_length))
            return true;
    }
    return false;
}

static void emit_vertices(struct gd__wavefront *front)
{
    const struct gd_mesh *mesh = front->mesh;
    for (uint32_t v = 0; v < mesh->vertex_count && !front->status; v++) {
        check_control(front, v);
        double distance = front->distance[v];
        if (front->status || mesh->vertex_kind[v] == GD_VERTEX_CONVEX || distance >= GD__FAR)
            continue;
        if (distance > front->bound) continue;
        if (distance > front->inner)
            gd__queue_push(front->queue, 2 * mesh->edge_count + v, distance, &front->waiting[v]);
        else if (sees_beyond(front, v))
            gd__emit_vertex(front, v);
    }
}

void gd__resume(struct gd__wavefront *front, const struct gd__partial_state *partial)
{
    bool joins = !front->variant.no_coalescing;
    copy_partial_field(front, partial);
    if (front->status) return;
    gd__queue_begin(front->queue, partial->bound);
    front->inner = partial->bound;
    front->variant.no_coalescing = front->work->scratch.apart = true;
    gd__emit_seeds(front);
    cast_edges(front);
    emit_vertices(front);
    front->variant.no_coalescing = front->work->scratch.apart = !joins;
    front->inner = 0;
}
