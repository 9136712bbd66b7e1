#include "wedge/wavefront.h"

#include <stdlib.h>

#define BUCKET_WIDTH   0.25 /* of the mean edge: measured, see doc/001 */
#define KEY_WEIGHT     0.25 /* a side's key between the nearer and the farther end's distance */
#define CHECK_INTERVAL 256  /* work items between two looks at the monitor: well under a millisecond */

/* --- distances, windows, order ------------------------------------------------------------------------------------------- */

static void shrink_bound(struct gd__wavefront *front, uint32_t vertex)
{
    for (int i = 0; i < 4; i++) {
        if (front->target_corner[i] != vertex) continue;
        double through = (front->distance[vertex] + front->target_leg[i]) * (1 + GD_TOL_CHECK);
        if (through < front->bound) front->bound = through;
    }
}

void gd__wavefront_reach(struct gd__wavefront *front, uint32_t vertex, double distance, struct gd__birth birth)
{
    if (distance >= front->distance[vertex] * (1 - GD_TOL_BETTER)) return;
    front->distance[vertex] = distance;
    front->birth[vertex] = birth;
    shrink_bound(front, vertex);
    if (front->mesh->vertex_kind[vertex] != GD_VERTEX_CONVEX && distance <= front->bound)
        gd__queue_push(&front->queue, 2 * front->mesh->edge_count + vertex, distance);
}

static void schedule(struct gd__wavefront *front, uint32_t side)
{
    double a = front->distance[front->mesh->origin[side]], b = front->distance[front->mesh->origin[side ^ 1]];
    double near = a < b ? a : b, far = a < b ? b : a;
    if (far >= GD__FAR) far = near;
    gd__queue_push(&front->queue, side, near + KEY_WEIGHT * (far - near));
}

/* Keeps only windows that come within the bound somewhere. */
static void drop_beyond_bound(const struct gd__wavefront *front, struct gd__stack *windows)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < windows->count; i++)
        if (gd__window_nearest(&windows->windows[i]) <= front->bound) windows->windows[kept++] = windows->windows[i];
    windows->count = kept;
}

void gd__wavefront_deliver(struct gd__wavefront *front, uint32_t side, struct gd__stack *windows)
{
    if (front->bound < GD__FAR) drop_beyond_bound(front, windows);
    if (!windows->count || front->status) return;
    struct gd__list *list = &front->lists[side];
    front->effort.windows_created += windows->count;
    double min_width = GD_TOL_WIDTH * front->mesh->side[side].length;
    front->status = gd__list_insert(list, &front->pool, windows, min_width, &front->scratch);
    list->pending = true;
    if (!front->status && !gd__side_is_boundary(front->mesh, side)) schedule(front, side);
}

/* --- set-up -------------------------------------------------------------------------------------------------------------- */

/* The corners of the target's faces and the straight ways to them: an upper bound of its distance at any time. */
static void aim(struct gd__wavefront *front, const struct gd_point *target)
{
    const struct gd_mesh *mesh = front->mesh;
    uint32_t count = 0;
    for (int i = 0; i < 4; i++) front->target_corner[i] = GD_NONE;
    if (!target) return;
    if (target->kind == GD_POINT_VERTEX) {
        front->target_corner[0] = target->element;
        front->target_leg[0] = 0;
    } else if (target->kind == GD_POINT_EDGE) {
        double length = mesh->side[2 * target->element].length;
        for (uint32_t k = 0; k < 2; k++) {
            front->target_corner[k] = mesh->origin[2 * target->element + k];
            front->target_leg[k] = length * (k ? 1 - target->weight[0] : target->weight[0]);
        }
    } else {
        for (int k = 0; k < 3; k++) { /* the corner opposite to side k, in that side's frame */
            uint32_t side = mesh->face_side[target->element][k];
            const struct gd_side *s = &mesh->side[side];
            double apex_weight = target->weight[(k + 2) % 3], px = s->left_length * s->left_x,
                   py = s->left_length * s->left_y;
            double x = target->weight[(k + 1) % 3] * s->length + apex_weight * px, y = apex_weight * py;
            front->target_corner[count] = gd__side_apex(mesh, side);
            front->target_leg[count++] = sqrt((x - px) * (x - px) + (y - py) * (y - py));
        }
    }
}

static uint32_t component_of(const struct gd_mesh *mesh, const struct gd_point *point)
{
    switch (point->kind) {
    case GD_POINT_VERTEX:
        return mesh->vertex_component[point->element];
    case GD_POINT_EDGE:
        return mesh->vertex_component[mesh->origin[2 * point->element]];
    case GD_POINT_FACE:
        break;
    }
    return mesh->vertex_component[mesh->origin[mesh->face_side[point->element][0]]];
}

/* Buckets fit the smallest component that holds a seed: one that is a million times smaller than another must not fall into one bucket. */
static double bucket_width(const struct gd__wavefront *front)
{
    double mean = GD__FAR;
    for (uint32_t i = 0; i < front->seed_count; i++) {
        double edge = front->mesh->component[component_of(front->mesh, &front->seeds[i].point)].mean_edge;
        if (edge < mean) mean = edge;
    }
    return BUCKET_WIDTH * mean;
}

static size_t fixed_bytes(const struct gd_mesh *mesh)
{
    size_t sides = 2 * (size_t)mesh->edge_count, vertices = mesh->vertex_count;
    return sides * (sizeof(struct gd__list) + sizeof(struct gd__queue_node)) +
           vertices * (2 * sizeof(double) + sizeof(struct gd__birth) + sizeof(struct gd__queue_node));
}

static enum gd_status open_front(struct gd__wavefront *front, const struct gd__propagation *propagation)
{
    const struct gd_mesh *mesh = front->mesh;
    size_t sides = 2 * (size_t)mesh->edge_count, vertices = mesh->vertex_count;
    enum gd_status status = gd_control_afford(front->monitor, fixed_bytes(mesh));
    if (status) return status;
    gd__pool_init(&front->pool, sizeof(struct gd__window), front->monitor, fixed_bytes(mesh));
    front->lists = calloc(sides, sizeof *front->lists);
    front->distance = malloc(sizeof *front->distance * vertices);
    front->emitted = malloc(sizeof *front->emitted * vertices);
    front->birth = malloc(sizeof *front->birth * vertices);
    if (!front->lists || !front->distance || !front->emitted || !front->birth) return GD_NO_MEMORY;
    for (size_t v = 0; v < vertices; v++) {
        front->distance[v] = front->emitted[v] = GD__FAR;
        front->birth[v] = (struct gd__birth){.side = GD_NONE, .source = GD_NONE};
    }
    front->bound = propagation->radius;
    aim(front, propagation->target);
    return gd__queue_init(&front->queue, (uint32_t)(sides + vertices), bucket_width(front));
}

static void close_front(struct gd__wavefront *front)
{
    free(front->lists);
    free(front->distance);
    free(front->emitted);
    free(front->birth);
    gd__queue_destroy(&front->queue);
    gd__pool_destroy(&front->pool);
    gd__stack_destroy(&front->left);
    gd__stack_destroy(&front->right);
    gd__stack_destroy(&front->scratch);
}

/* --- the loop ------------------------------------------------------------------------------------------------------------ */

static void work_on_side(struct gd__wavefront *front, uint32_t side)
{
    struct gd__list *list = &front->lists[side];
    if (!list->visited) front->sides_visited++;
    list->visited = true;
    if (list->pending) gd__propagate_side(front, side);
}

static void work_on_vertex(struct gd__wavefront *front, uint32_t vertex)
{
    double distance = front->distance[vertex];
    if (distance != front->emitted[vertex] && distance <= front->bound) gd__emit_vertex(front, vertex);
}

/* Asks for what the next two sides in the queue will need: the second's records, the first's windows. */
static void prefetch_next(const struct gd__wavefront *front)
{
    uint32_t sides = 2 * front->mesh->edge_count, next = gd__queue_peek(&front->queue);
    if (next >= sides) return;
    const struct gd__window *windows = front->lists[next].windows;
    const struct gd_side *side = &front->mesh->side[next];
    __builtin_prefetch(windows);
    __builtin_prefetch((const char *)windows + 64);
    __builtin_prefetch((const char *)windows + 128);
    __builtin_prefetch(&front->lists[side->left]);
    __builtin_prefetch(&front->lists[side->right]);
    uint32_t second = front->queue.nodes[next].next;
    if (second >= sides) return;
    __builtin_prefetch(&front->lists[second]);
    __builtin_prefetch(&front->mesh->side[second]);
    __builtin_prefetch(&front->queue.nodes[second]);
}

static enum gd_status propagate_all(struct gd__wavefront *front)
{
    uint32_t sides = 2 * front->mesh->edge_count, node;
    for (uint64_t work = 0; !front->status && (node = gd__queue_pop(&front->queue)) != GD_NONE; work++) {
        prefetch_next(front);
        if (node < sides)
            work_on_side(front, node);
        else
            work_on_vertex(front, node - sides);
        if (work % CHECK_INTERVAL == 0 && !front->status)
            front->status = gd_control_check(front->monitor, (double)front->sides_visited / sides);
    }
    return front->status;
}

enum gd_status gd__wavefront_run(const struct gd_mesh *mesh, const struct gd__propagation *propagation,
                                 const struct gd__sink *sink, const struct gd_control *monitor,
                                 const struct gd_executor *executor)
{
    struct gd__wavefront front = {.mesh = mesh,
                                  .seeds = propagation->seeds,
                                  .seed_count = propagation->seed_count,
                                  .methods = propagation->methods,
                                  .monitor = monitor};
    enum gd_status status = open_front(&front, propagation);
    if (!status) {
        gd__emit_seeds(&front);
        status = propagate_all(&front);
    }
    if (!status) status = sink->take(sink->user, &front, executor);
    close_front(&front);
    return status;
}
