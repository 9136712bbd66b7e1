#include <string.h>

#include "base/array.h"
#include "field/voronoi_parts.h"
#include "mesh/canonical.h"

/* Owners along an edge, from the lower envelope of the windows that reach the edge, the edge's
 * ends, and the seeds on the edge. */

/* steps of Newton's method; it starts at positions that are accurate up to the nudge */
enum { STEPS = 8 };

static uint32_t end_of(const struct gd__diagram *diagram, uint32_t edge, int k)
{
    return diagram->mesh->origin[2 * edge + k];
}

static uint32_t member_of(const struct gd__diagram *diagram, uint32_t source)
{
    return gd__member_of(&diagram->members, source);
}

static bool has_seed_of_another(const struct gd__diagram *diagram, uint32_t edge, uint32_t member)
{
    struct gd__window w;
    for (struct gd__face_seeds f = gd__edge_seeds(diagram->field, edge); f.at < f.end; f.at++)
        if (gd__edge_seed_window(diagram->field, edge, f.at->seed, &w) &&
            member_of(diagram, w.source) != member)
            return true;
    return false;
}

static bool windows_are_mixed(const struct gd__diagram *diagram, uint32_t edge, uint32_t member)
{
    if (has_seed_of_another(diagram, edge, member)) return true;
    for (uint32_t at = diagram->field->newest[edge]; at != GD_NONE;) {
        const struct gd__chunk *chunk = gd__field_chunk(diagram->field, at);
        struct gd__wedges wedges = gd__chunk_wedges(chunk);
        for (uint32_t i = 0; i < chunk->count; i++) {
            uint32_t source = gd__wedge_source(&wedges, i);
            if (source != GD_NONE && member_of(diagram, source) != member) return true;
        }
        at = gd__chunk_previous(chunk);
    }
    return false;
}

bool gd__edge_is_mixed(const struct gd__diagram *diagram, uint32_t edge)
{
    uint32_t member = member_of(diagram, end_of(diagram, edge, 0));
    if (diagram->owner[end_of(diagram, edge, 0)] != member ||
        diagram->owner[end_of(diagram, edge, 1)] != member)
        return true;
    if (diagram->mixture[edge] == GD__MIXTURE_UNKNOWN)
        diagram->mixture[edge] =
            windows_are_mixed(diagram, edge, member) ? GD__MIXTURE_MIXED : GD__MIXTURE_PURE;
    return diagram->mixture[edge] == GD__MIXTURE_MIXED;
}

/* --- the envelope ----------------------------------------------------------------------------- */

static void lengthen_window(struct gd__window *w, double offset, double length)
{
    double before = gd__line_lengthened(length, gd__window_distance(w, w->b0) - offset),
           behind = gd__line_lengthened(length, gd__window_distance(w, w->b1) - offset);
    w->b0 = fmax(w->b0 - before, 0);
    w->b1 = fmin(w->b1 + behind, length);
}

static enum gd_status push_window(const struct gd__diagram *diagram, uint32_t edge,
                                  struct gd__window w, struct gd__voronoi_scratch *scratch)
{
    double length = diagram->mesh->side[2 * edge].length;
    if (gd__window_is_linear(&w))
        lengthen_window(&w, gd__field_sigma(diagram->field, w.source), length);
    w.sigma += diagram->members.nudge[member_of(diagram, w.source)];
    return gd__stack_push(&scratch->envelope, &w, GD_TOL_WIDTH * length, &scratch->tail);
}

static enum gd_status find_envelope(const struct gd__diagram *diagram, uint32_t edge,
                                    struct gd__voronoi_scratch *scratch)
{
    const struct gd_field *field = diagram->field;
    double length = diagram->mesh->side[2 * edge].length;
    struct gd__edge_windows windows = gd__edge_windows(field, 2 * edge);
    enum gd_status status = GD_OK;
    struct gd__window w;
    scratch->envelope.count = 0;
    while (!status && gd__edge_windows_next(&windows, &w))
        status = push_window(diagram, edge, w, scratch);
    for (int k = 0; k < 2 && !status; k++) {
        w = (struct gd__window){.b1 = length, .x = k * length, .source = end_of(diagram, edge, k)};
        w.sigma = gd__field_sigma(field, w.source);
        status = push_window(diagram, edge, w, scratch);
    }
    for (struct gd__face_seeds f = gd__edge_seeds(field, edge); f.at < f.end && !status; f.at++)
        if (gd__edge_seed_window(field, edge, f.at->seed, &w))
            status = push_window(diagram, edge, w, scratch);
    return status;
}

/* --- owners of an edge's ends ----------------------------------------------------------------- */

static void offer_owner(struct gd__diagram *diagram, uint32_t vertex, const struct gd__window *w,
                        double t)
{
    if (t < w->b0 || t > w->b1) return;
    uint32_t member = member_of(diagram, w->source);
    double distance = gd__window_distance(w, t) + diagram->members.nudge[member];
    if (distance >= diagram->nearest[vertex]) return;
    diagram->nearest[vertex] = distance;
    diagram->changed += diagram->owner[vertex] == diagram->members.of[vertex];
    diagram->owner[vertex] = member;
}

void gd__edge_own_ends(struct gd__diagram *diagram, uint32_t edge)
{
    struct gd__edge_windows windows = gd__edge_windows(diagram->field, 2 * edge);
    for (struct gd__window w; gd__edge_windows_next(&windows, &w);) {
        offer_owner(diagram, end_of(diagram, edge, 0), &w, 0);
        offer_owner(diagram, end_of(diagram, edge, 1), &w, diagram->mesh->side[2 * edge].length);
    }
}

/* --- switches --------------------------------------------------------------------------------- */

static enum gd_status append_switch(struct gd__diagram *diagram, uint32_t edge, double t,
                                    uint32_t before, uint32_t after)
{
    if (before == after) return GD_OK;
    struct gd_point point =
        gd__point_of_edge(diagram->mesh, edge, t / diagram->mesh->side[2 * edge].length);
    struct gd__owner_change found = {.t = t, .before = before, .after = after};
    enum gd_status status = gd__diagram_add_node(diagram, &point, &found.node);
    return status ? status
                  : gd__arena_append(&diagram->arena, &diagram->edge_switch, &diagram->switch_count,
                                     &diagram->switch_capacity, &found, sizeof found);
}

/* Returns the distance without the nudge. */
static double distance_of(const struct gd__diagram *diagram, const struct gd__window *w, double t)
{
    return gd__window_distance(w, t) - diagram->members.nudge[member_of(diagram, w->source)];
}

static double slope_of(const struct gd__window *w, double t)
{
    if (gd__window_is_linear(w)) return -w->x;
    double dx = t - w->x, distance = sqrt(dx * dx + w->y * w->y);
    return distance > 0 ? dx / distance : 0;
}

/* Returns the parameter near t where two consecutive windows give the same distance, or t itself if
 * that parameter is not close. */
static double refine_switch(const struct gd__diagram *diagram, const struct gd__window *a,
                            const struct gd__window *b, double t, double length)
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

/* Drops pieces shorter than the nudge at vertices with seeds: they belong to other seeds at the
 * same vertex. */
static void drop_ends(const struct gd__diagram *diagram, uint32_t edge, struct gd__stack *envelope)
{
    double length = diagram->mesh->side[2 * edge].length,
           least = GD_TOL_CHECK * diagram->members.farthest;
    uint32_t first = 0;
    if (diagram->nearest[end_of(diagram, edge, 0)] == 0)
        while (first < envelope->count && envelope->windows[first].b1 <= least) first++;
    if (diagram->nearest[end_of(diagram, edge, 1)] == 0)
        while (envelope->count > first &&
               envelope->windows[envelope->count - 1].b0 >= length - least)
            envelope->count--;
    envelope->count -= first;
    memmove(envelope->windows, envelope->windows + first,
            envelope->count * sizeof *envelope->windows);
}

enum gd_status gd__edge_owner_change(struct gd__diagram *diagram, uint32_t edge,
                                     struct gd__voronoi_scratch *scratch)
{
    double length = diagram->mesh->side[2 * edge].length;
    uint32_t owner = diagram->owner[end_of(diagram, edge, 0)];
    enum gd_status status = find_envelope(diagram, edge, scratch);
    if (status) return status;
    drop_ends(diagram, edge, &scratch->envelope);
    double reached = 0;
    for (uint32_t i = 0; i < scratch->envelope.count && !status; i++) {
        const struct gd__window *w = &scratch->envelope.windows[i];
        uint32_t member = member_of(diagram, w->source);
        if (member != owner)
            reached =
                fmax(reached,
                     i ? refine_switch(diagram, w - 1, w, 0.5 * (w[-1].b1 + w->b0), length) : 0);
        status = append_switch(diagram, edge, reached, owner, member);
        owner = member;
    }
    return status ? status
                  : append_switch(diagram, edge, length, owner,
                                  diagram->owner[end_of(diagram, edge, 1)]);
}
