#include "wedge/domain.h"

#include <stdlib.h>
#include <string.h>

#include "wedge/wavefront.h"

#define FACES_LEAST    20000 /* a smaller surface is done before the turns pay */
#define TURN_BUCKETS   4     /* how far a turn goes; fewer wait for each other more often, more do more work twice */
#define TURN_WORK      4096  /* sides and vertices: a millisecond or two */
#define DIRECTIONS     9     /* tried for the cut */
#define SAMPLES        1024  /* faces that tell how evenly a cut divides */
#define BUDGET_AN_EDGE 1000  /* bytes: with less there may be no room for two of all */

/* --- mail ---------------------------------------------------------------------------------------------------------------- */

static enum gd_status make_room(void **array, uint32_t count, uint32_t *capacity, size_t size)
{
    if (count < *capacity) return GD_OK;
    uint32_t larger = *capacity ? 2 * *capacity : 256;
    void *grown = realloc(*array, larger * size);
    if (!grown) return GD_NO_MEMORY;
    *array = grown;
    *capacity = larger;
    return GD_OK;
}

enum gd_status gd__domain_send_vertex(struct gd__domain *domain, const struct gd__vertex_letter *letter)
{
    struct gd__mail *mail = &domain->mail;
    enum gd_status status =
        make_room((void **)&mail->vertices, mail->vertex_count, &mail->vertex_capacity, sizeof *mail->vertices);
    if (!status) mail->vertices[mail->vertex_count++] = *letter;
    return status;
}

enum gd_status gd__domain_send_windows(struct gd__domain *domain, uint32_t side, const struct gd__children *children)
{
    struct gd__mail *mail = &domain->mail;
    enum gd_status status =
        make_room((void **)&mail->lists, mail->list_count, &mail->list_capacity, sizeof *mail->lists);
    if (!status) status = gd__stack_reserve(&mail->windows, mail->windows.count + children->count);
    if (status) return status;
    mail->lists[mail->list_count++] = (struct gd__list_letter){side, children->count};
    gd__stack_load(&mail->windows, &children->at, 0, children->count);
    return GD_OK;
}

static void free_mail(struct gd__mail *mail)
{
    free(mail->vertices);
    free(mail->lists);
    gd__stack_destroy(&mail->windows);
}

/* What waits of a source whose distance fell is on its way again: gd__propagate_side would drop it, and so would who sent it. */
static uint32_t put_fresh(const struct gd__wavefront *front, const struct gd__window *windows, uint32_t count)
{
    uint32_t fresh = 0;
    for (uint32_t i = 0; i < count; i++)
        if (windows[i].source >= front->mesh->vertex_count || windows[i].sigma == front->distance[windows[i].source])
            gd__windows_put(&front->work->left.at, fresh++, &windows[i]);
    return fresh;
}

static void receive_list(struct gd__wavefront *front, uint32_t side, const struct gd__window *windows, uint32_t count)
{
    struct gd__children *children = &front->work->left;
    front->status = gd__children_open(children, &front->work->pool, count);
    if (front->status) return;
    children->count = put_fresh(front, windows, count);
    uint32_t origin = front->mesh->origin[side], destination = front->mesh->origin[side ^ 1];
    struct gd__receiver to = {
        side,        front->mesh->side[side].length, front->distance[origin], front->distance[destination], 0, 0,
        front->falls};
    gd__wavefront_deliver(front, &to, children);
}

/* Vertices first: the windows' sources are among them. */
static void receive(struct gd__wavefront *front, struct gd__mail *mail)
{
    for (uint32_t i = 0; i < mail->vertex_count; i++) gd__wavefront_learn(front, &mail->vertices[i]);
    const struct gd__window *windows = mail->windows.windows;
    for (uint32_t i = 0; i < mail->list_count && !front->status; i++) {
        receive_list(front, mail->lists[i].side, windows, mail->lists[i].count);
        windows += mail->lists[i].count;
    }
    mail->vertex_count = mail->list_count = mail->windows.count = 0;
}

/* --- the cut ------------------------------------------------------------------------------------------------------------- */

/* Half of the directions of a cube's corners and faces, and some between: one of them divides most surfaces evenly. */
static const double direction[DIRECTIONS][3] = {{1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0}, {1, -1, 0},
                                                {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};

static uint8_t part_of(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 source, const double normal[3])
{
    double height = 0;
    for (int k = 0; k < 3; k++) {
        const struct gd_vec3 *p = &mesh->position[mesh->origin[mesh->face_side[face][k]]];
        height += normal[0] * (p->x - source.x) + normal[1] * (p->y - source.y) + normal[2] * (p->z - source.z);
    }
    return height > 0;
}

/* The direction whose plane divides the faces most evenly. */
static const double *find_direction(const struct gd_mesh *mesh, struct gd_vec3 source)
{
    uint32_t step = mesh->face_count / SAMPLES, best = 0, best_least = 0;
    for (uint32_t d = 0; d < DIRECTIONS; d++) {
        uint32_t count[2] = {0, 0};
        for (uint32_t i = 0; i < SAMPLES; i++) count[part_of(mesh, i * step, source, direction[d])]++;
        uint32_t least = count[0] < count[1] ? count[0] : count[1];
        if (least <= best_least) continue;
        best = d;
        best_least = least;
    }
    return direction[best];
}

static void cut(const struct gd_mesh *mesh, struct gd_vec3 source, uint8_t *side_part, uint8_t *vertex_parts)
{
    const double *normal = find_direction(mesh, source);
    memset(vertex_parts, 0, mesh->vertex_count);
    for (uint32_t face = 0; face < mesh->face_count; face++) {
        uint8_t part = part_of(mesh, face, source, normal);
        for (int k = 0; k < 3; k++) {
            uint32_t side = mesh->face_side[face][k];
            side_part[side] = part;
            if (gd__side_is_boundary(mesh, side ^ 1)) side_part[side ^ 1] = part;
            vertex_parts[mesh->origin[side]] |= (uint8_t)(1 << part);
        }
    }
}

/* --- one result ---------------------------------------------------------------------------------------------------------- */

/* Chains of an edge on the cut are merged, newest place first, as chains are (wedges.h). */
static void link_chunk(struct gd__wavefront *front, uint32_t edge, uint32_t at)
{
    uint32_t *next = &front->newest[edge];
    while (*next != GD_NONE && *next > at)
        next = &((struct gd__chunk *)(front->work->wedges.base + (size_t)*next * GD__CHUNK_UNIT))->previous;
    ((struct gd__chunk *)(front->work->wedges.base + (size_t)at * GD__CHUNK_UNIT))->previous = *next;
    *next = at;
}

/* From here on all of the budget is the first one's, but for what the second one still has. */
static enum gd_status take_wedges(struct gd__wavefront *front, const struct gd__wavefront *other)
{
    struct gd__region *own = &front->work->wedges;
    const struct gd__region *from = &other->work->wedges;
    front->work->purse.control = front->monitor;
    front->work->purse.held += other->work->purse.held;
    enum gd_status status = gd__region_reserve(own, from->used);
    if (status) return status;
    uint32_t shift = (uint32_t)(own->used / GD__CHUNK_UNIT);
    memcpy(own->base + own->used, from->base, from->used);
    own->used += from->used;
    for (uint32_t edge = 0; edge < front->mesh->edge_count; edge++) {
        if (other->newest[edge] == GD_NONE) continue;
        if (front->newest[edge] == GD_NONE) gd__workspace_touch(front->work, 2 * edge, true);
        for (uint32_t at = other->newest[edge], previous; at != GD_NONE; at = previous) {
            previous = ((const struct gd__chunk *)(from->base + (size_t)at * GD__CHUNK_UNIT))->previous;
            link_chunk(front, edge, at + shift);
        }
    }
    return GD_OK;
}

static void take_vertices(struct gd__wavefront *front, const struct gd__wavefront *other)
{
    for (uint32_t v = 0; v < front->mesh->vertex_count; v++) {
        if (other->distance[v] >= front->distance[v]) continue;
        if (front->distance[v] >= GD__FAR) gd__workspace_touch(front->work, 2 * front->work->edges + v, true);
        front->distance[v] = other->distance[v];
        front->birth[v] = other->birth[v];
    }
}

static enum gd_status take_all(struct gd__wavefront *front, const struct gd__wavefront *other)
{
    take_vertices(front, other);
    front->effort.windows_created += other->effort.windows_created;
    front->effort.windows_propagated += other->effort.windows_propagated;
    front->effort.sides_propagated += other->effort.sides_propagated;
    front->effort.vertices_emitted += other->effort.vertices_emitted;
    front->effort.wedges_recalled += other->effort.wedges_recalled;
    front->wedge_count += other->wedge_count;
    front->bound = fmin(front->bound, other->bound);
    return take_wedges(front, other);
}

/* --- turns --------------------------------------------------------------------------------------------------------------- */

struct pair {
    struct gd__wavefront front[2];
    struct gd__domain domain[2];
    uint32_t end; /* bucket before which a turn ends */
};

static void take_turn(void *context, uint32_t part)
{
    struct pair *pair = context;
    gd__wavefront_advance(&pair->front[part], pair->end, TURN_WORK);
}

static enum gd_status exchange(struct pair *pair)
{
    for (int part = 0; part < 2; part++) receive(&pair->front[part], &pair->domain[1 - part].mail);
    return pair->front[0].status ? pair->front[0].status : pair->front[1].status;
}

static double progress(const struct pair *pair)
{
    return (double)(pair->front[0].sides_visited + pair->front[1].sides_visited) /
           (2 * (double)pair->front[0].mesh->edge_count);
}

static enum gd_status propagate(struct pair *pair, const struct gd_control *monitor, const struct gd_executor *executor)
{
    for (int part = 0; part < 2; part++) gd__emit_seeds(&pair->front[part]);
    enum gd_status status = exchange(pair);
    while (!status) {
        uint32_t first = gd__queue_first(pair->front[0].queue), second = gd__queue_first(pair->front[1].queue);
        if (first == GD_NONE && second == GD_NONE) break;
        pair->end = (first < second ? first : second) + TURN_BUCKETS;
        gd_executor_run(executor, take_turn, pair, 2);
        status = exchange(pair);
        if (!status) status = gd_control_check(monitor, progress(pair));
    }
    return status;
}

/* Each wavefront gets half of the budget and none of the reports. */
static struct gd_control share_of(const struct gd_control *monitor, struct gd_workspace *work)
{
    struct gd_control share = monitor ? *monitor : (struct gd_control){0};
    share.budget_bytes /= 2;
    share.progress = NULL;
    share.workspace = work;
    return share;
}

static enum gd_status open_pair(struct pair *pair, const struct gd__propagation *propagation,
                                const struct gd_control share[2])
{
    enum gd_status status = GD_OK;
    for (int part = 0; part < 2 && !status; part++) {
        pair->front[part].monitor = &share[part];
        pair->front[part].work = share[part].workspace;
        pair->front[part].domain = &pair->domain[part];
        status = gd__wavefront_open(&pair->front[part], propagation);
    }
    return status;
}

static enum gd_status propagate_pair(struct gd__wavefront *front, const struct gd__propagation *propagation,
                                     const uint8_t *side_part, const uint8_t *vertex_parts,
                                     const struct gd_executor *executor)
{
    struct gd_workspace *partner = gd__workspace_partner(front->work);
    if (!partner) return GD_NO_MEMORY;
    struct gd_control share[2] = {share_of(front->monitor, front->work), share_of(front->monitor, partner)};
    struct pair pair = {.front = {*front, *front},
                        .domain = {{.side_part = side_part, .vertex_parts = vertex_parts, .part = 0},
                                   {.side_part = side_part, .vertex_parts = vertex_parts, .part = 1}}};
    enum gd_status status = open_pair(&pair, propagation, share);
    if (!status) status = propagate(&pair, front->monitor, executor);
    pair.front[0].monitor = front->monitor;
    if (!status) status = take_all(&pair.front[0], &pair.front[1]);
    for (int part = 0; part < 2; part++) free_mail(&pair.domain[part].mail);
    gd__workspace_clean(partner);
    pair.front[0].domain = NULL;
    *front = pair.front[0];
    return status;
}

bool gd__domain_is_worth_it(const struct gd_mesh *mesh, const struct gd__propagation *propagation,
                            const struct gd_control *monitor)
{
    return mesh->face_count >= FACES_LEAST && propagation->seed_count == 1 && !propagation->seeds[0].is_segment &&
           !propagation->target && !propagation->guide && !propagation->without_wedges &&
           propagation->radius >= GD__FAR &&
           (!monitor || !monitor->budget_bytes || monitor->budget_bytes > BUDGET_AN_EDGE * (size_t)mesh->edge_count);
}

enum gd_status gd__domain_propagate(struct gd__wavefront *front, const struct gd__propagation *propagation,
                                    const struct gd_executor *executor)
{
    const struct gd_mesh *mesh = front->mesh;
    uint8_t *side_part = malloc(2 * (size_t)mesh->edge_count), *vertex_parts = malloc(mesh->vertex_count);
    enum gd_status status = side_part && vertex_parts ? GD_OK : GD_NO_MEMORY;
    if (!status) {
        cut(mesh, gd__anchor(mesh, &propagation->seeds[0].point).position, side_part, vertex_parts);
        status = propagate_pair(front, propagation, side_part, vertex_parts, executor);
    }
    free(side_part);
    free(vertex_parts);
    return status;
}
