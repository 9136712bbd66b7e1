#include "field/array.h"
#include "field/voronoi_parts.h"
#include "mesh/canonical.h"

/* Along an edge: whose its points are, by the lower envelope of all windows that look across it, its ends, and the seeds on it. */

enum { STEPS = 8 /* of Newton's method, from places that are right but for the nudge */ };

static uint32_t end_of(const struct gd__diagram *diagram, uint32_t edge, int k)
{
    return diagram->mesh->origin[2 * edge + k];
}

bool gd__edge_is_mixed(const struct gd__diagram *diagram, uint32_t edge)
{
    const uint32_t *of = diagram->members.of, member = of[end_of(diagram, edge, 0)];
    if (diagram->owner[end_of(diagram, edge, 0)] != member || diagram->owner[end_of(diagram, edge, 1)] != member)
        return true;
    for (uint32_t at = diagram->field->newest[edge]; at != GD_NONE;) {
        const struct gd__chunk *chunk = gd__field_chunk(diagram->field, at);
        struct gd__wedges wedges = gd__chunk_wedges(chunk);
        for (uint32_t i = 0; i < chunk->count; i++) {
            uint32_t source = gd__wedge_source(wedges.start[i]);
            if (source != GD_NONE && of[source] != member) return true;
        }
        at = chunk->previous;
    }
    return false;
}

/* --- the envelope ---------------------------------------------------------------------------------------------------------- */

static enum gd_status push(const struct gd__diagram *diagram, uint32_t edge, struct gd__window w,
                           struct gd__voronoi_scratch *scratch)
{
    uint32_t member = diagram->members.of[w.source];
    w.sigma += diagram->members.nudge[member];
    return gd__stack_push(&scratch->envelope, &w, GD_TOL_WIDTH * diagram->mesh->side[2 * edge].length, &scratch->tail);
}

static enum gd_status push_windows(const struct gd__diagram *diagram, uint32_t edge,
                                   struct gd__voronoi_scratch *scratch)
{
    enum gd_status status = GD_OK;
    for (uint32_t at = diagram->field->newest[edge]; at != GD_NONE;
         at = gd__field_chunk(diagram->field, at)->previous) {
        const struct gd__chunk *chunk = gd__field_chunk(diagram->field, at);
        for (uint32_t i = 0; i < chunk->count && !status; i++) {
            struct gd__window w;
            if (gd__sources_window(diagram->field, chunk, i, 2 * edge, &w)) status = push(diagram, edge, w, scratch);
        }
    }
    return status;
}

/* Seeds on the edge lie in either of its faces. */
static enum gd_status push_seeds(const struct gd__diagram *diagram, uint32_t edge, struct gd__voronoi_scratch *scratch)
{
    const struct gd_field *field = diagram->field;
    const struct gd_mesh *mesh = diagram->mesh;
    uint32_t face = mesh->side_face[gd__side_is_boundary(mesh, 2 * edge) ? 2 * edge + 1 : 2 * edge];
    double length = mesh->side[2 * edge].length;
    enum gd_status status = GD_OK;
    const struct gd__face_seed *end = field->face_seeds + field->face_seed_count;
    for (const struct gd__face_seed *f = gd__field_seeds_in(field, face); f < end && f->face == face && !status; f++) {
        const struct gd_point *point = &field->seeds[f->seed].point;
        struct gd__window w = {.b1 = length, .x = point->weight[0] * length, .source = mesh->vertex_count + f->seed};
        w.sigma = field->seeds[f->seed].offset;
        if (point->kind == GD_POINT_EDGE && point->element == edge) status = push(diagram, edge, w, scratch);
    }
    return status;
}

static enum gd_status find_envelope(const struct gd__diagram *diagram, uint32_t edge,
                                    struct gd__voronoi_scratch *scratch)
{
    double length = diagram->mesh->side[2 * edge].length;
    scratch->envelope.count = 0;
    enum gd_status status = push_windows(diagram, edge, scratch);
    for (int k = 0; k < 2 && !status; k++) {
        struct gd__window w = {.b1 = length, .x = k * length, .source = end_of(diagram, edge, k)};
        w.sigma = gd__field_sigma(diagram->field, w.source);
        status = push(diagram, edge, w, scratch);
    }
    return status ? status : push_seeds(diagram, edge, scratch);
}

/* --- owners of its ends ---------------------------------------------------------------------------------------------------- */

static void offer(struct gd__diagram *diagram, uint32_t vertex, const struct gd__window *w, double t)
{
    if (t < w->b0 || t > w->b1) return;
    uint32_t member = diagram->members.of[w->source];
    double distance = gd__window_distance(w, t) + diagram->members.nudge[member];
    if (distance >= diagram->nearest[vertex]) return;
    diagram->nearest[vertex] = distance;
    diagram->changed += diagram->owner[vertex] == diagram->members.of[vertex];
    diagram->owner[vertex] = member;
}

void gd__edge_own_ends(struct gd__diagram *diagram, uint32_t edge)
{
    const struct gd_field *field = diagram->field;
    for (uint32_t at = field->newest[edge]; at != GD_NONE; at = gd__field_chunk(field, at)->previous) {
        const struct gd__chunk *chunk = gd__field_chunk(field, at);
        for (uint32_t i = 0; i < chunk->count; i++) {
            struct gd__window w;
            if (!gd__sources_window(field, chunk, i, 2 * edge, &w)) continue;
            offer(diagram, end_of(diagram, edge, 0), &w, 0);
            offer(diagram, end_of(diagram, edge, 1), &w, diagram->mesh->side[2 * edge].length);
        }
    }
}

/* --- switches -------------------------------------------------------------------------------------------------------------- */

static enum gd_status append(struct gd__diagram *diagram, uint32_t edge, double t, uint32_t before, uint32_t after)
{
    if (before == after) return GD_OK;
    struct gd__switch *grown =
        gd__array_reserve(diagram->edge_switch, &diagram->switch_capacity, diagram->switch_count + 1, sizeof *grown);
    if (!grown) return GD_NO_MEMORY;
    diagram->edge_switch = grown;
    struct gd_point point = gd__point_of_edge(diagram->mesh, edge, t / diagram->mesh->side[2 * edge].length);
    struct gd__switch found = {.t = t, .before = before, .after = after};
    enum gd_status status = gd__diagram_add_node(diagram, &point, &found.node);
    if (!status) grown[diagram->switch_count++] = found;
    return status;
}

/* Without the nudge. */
static double distance_of(const struct gd__diagram *diagram, const struct gd__window *w, double t)
{
    return gd__window_distance(w, t) - diagram->members.nudge[diagram->members.of[w->source]];
}

static double slope_of(const struct gd__window *w, double t)
{
    double dx = t - w->x, distance = sqrt(dx * dx + w->y * w->y);
    return distance > 0 ? dx / distance : 0;
}

/* Where two windows that take turns at t give the same distance; t itself if that is not close by. */
static double refine(const struct gd__diagram *diagram, const struct gd__window *a, const struct gd__window *b,
                     double t, double length)
{
    double place = t;
    for (int i = 0; i < STEPS; i++) {
        double off = distance_of(diagram, a, place) - distance_of(diagram, b, place);
        if (off == 0) break;
        place -= off / (slope_of(a, place) - slope_of(b, place));
        if (!(fabs(place - t) <= GD_TOL_NODE * length)) return t;
    }
    return fmin(fmax(place, 0), length);
}

enum gd_status gd__edge_switch(struct gd__diagram *diagram, uint32_t edge, struct gd__voronoi_scratch *scratch)
{
    double length = diagram->mesh->side[2 * edge].length;
    uint32_t owner = diagram->owner[end_of(diagram, edge, 0)];
    enum gd_status status = find_envelope(diagram, edge, scratch);
    double reached = 0;
    for (uint32_t i = 0; i < scratch->envelope.count && !status; i++) {
        const struct gd__window *w = &scratch->envelope.windows[i];
        uint32_t member = diagram->members.of[w->source];
        if (member != owner)
            reached = fmax(reached, i ? refine(diagram, w - 1, w, 0.5 * (w[-1].b1 + w->b0), length) : 0);
        status = append(diagram, edge, reached, owner, member);
        owner = member;
    }
    return status ? status : append(diagram, edge, length, owner, diagram->owner[end_of(diagram, edge, 1)]);
}
