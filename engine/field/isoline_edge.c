#include "base/array.h"
#include "field/isoline_parts.h"

/* Crossings: where the distance along an edge passes the level. For each source seen from the edge,
 * the positions where its distance equals the level are candidates. Between two consecutive
 * candidates, either all points of the edge are below the level or none is. One evaluation in the
 * middle shows which.
 *
 * A distance that equals the level up to rounding counts as not below. This rule is needed because
 * the isoline of a segment may run along whole edges, and may touch other edges between their ends.
 * At a vertex the stored distance decides without slack, so that all edges of the vertex agree. */

static enum gd_status put_place(struct gd__places *places, double t, double length)
{
    if (!(t > 0 && t < length)) return GD_OK;
    return gd__array_append(&places->at, &places->count, &places->capacity, &t, sizeof t);
}

/* Solves sigma - x t = level within a linear window. A line that coincides with the edge up to
 * rounding does not cross the edge (see circle.c). */
static enum gd_status put_root(struct gd__places *places, const struct gd__window *w, double level,
                               double length)
{
    double t = (w->sigma - level) / w->x, more = gd__stored_slack(length);
    if (!(fabs(w->x) * length > gd__envelope_slack(level, length))) return GD_OK;
    return t >= w->b0 - more && t <= w->b1 + more ? put_place(places, t, length) : GD_OK;
}

/* Solves sigma + |(t, 0) - (x, -y)| = level within the window. A circle that touches the edge up to
 * rounding does not cross the edge. */
static enum gd_status put_roots(struct gd__places *places, const struct gd__window *w, double level,
                                double length)
{
    if (gd__window_is_linear(w)) return put_root(places, w, level, length);
    double radius = level - w->sigma;
    if (!(radius > w->y + gd__envelope_slack(level, length))) return GD_OK;
    double half = sqrt((radius - w->y) * (radius + w->y));
    enum gd_status status = GD_OK;
    for (int sign = -1; sign <= 1 && !status; sign += 2) {
        double t = w->x + sign * half;
        if (t >= w->b0 && t <= w->b1) status = put_place(places, t, length);
    }
    return status;
}

/* Adds the candidates of all wedges, and of the seeds on the edge itself. Along a segment on the
 * edge the distance is constant. */
static enum gd_status put_sources(const struct gd_field *field, uint32_t edge, double level,
                                  struct gd__places *places)
{
    double length = field->mesh->side[2 * edge].length;
    struct gd__edge_windows windows = gd__edge_windows(field, 2 * edge);
    enum gd_status status = GD_OK;
    struct gd__window w;
    while (!status && gd__edge_windows_next(&windows, &w))
        status = put_roots(places, &w, level, length);
    for (struct gd__face_seeds f = gd__edge_seeds(field, edge); f.at < f.end && !status; f.at++)
        if (gd__edge_seed_window(field, edge, f.at->seed, &w))
            status = put_roots(places, &w, level, length);
    return status;
}

static int by_place(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* Collects all candidates on the edge and its two ends, sorted. */
static enum gd_status find_places(const struct gd_field *field, uint32_t edge, double level,
                                  struct gd__places *places)
{
    const struct gd_mesh *mesh = field->mesh;
    double length = mesh->side[2 * edge].length, d0 = field->distance[mesh->origin[2 * edge]],
           d1 = field->distance[mesh->origin[2 * edge + 1]];
    places->count = 0;
    enum gd_status status = put_sources(field, edge, level, places);
    if (!status) status = put_place(places, level - d0, length);
    if (!status) status = put_place(places, length - (level - d1), length);
    if (status) return status;
    status = gd__array_extend(&places->at, &places->capacity, places->count + UINT64_C(2),
                              sizeof *places->at, NULL);
    if (status) return status;
    places->at[places->count++] = 0;
    places->at[places->count++] = length;
    qsort(places->at, places->count, sizeof *places->at, by_place);
    return GD_OK;
}

static bool is_below(const struct gd_field *field, uint32_t edge, double t, double level)
{
    double length = field->mesh->side[2 * edge].length;
    struct gd_point point = gd__point_of_edge(field->mesh, edge, t / length);
    struct gd__leg_key way;
    gd__field_leg_key(field, &point, &way);
    return way.distance < level - gd__envelope_slack(level, length);
}

enum gd_status gd__isoline_cross_edge(const struct gd_field *field, uint32_t edge, double level,
                                      struct gd__pace *pace, struct gd__places *places,
                                      struct gd__isoline_parts *parts)
{
    const struct gd_mesh *mesh = field->mesh;
    enum gd_status status = find_places(field, edge, level, places);
    double narrow = gd__envelope_slack(level, mesh->side[2 * edge].length);
    bool below = field->distance[mesh->origin[2 * edge]] < level;
    for (uint32_t i = 0; i < places->count && !status; i++) {
        double t = places->at[i];
        bool is_last = i + 1 == places->count, then = below;
        status = gd__pace_step(pace, places->count);
        if (status) break;
        if (is_last)
            then = field->distance[mesh->origin[2 * edge + 1]] < level;
        else if (places->at[i + 1] - t > narrow)
            then = is_below(field, edge, 0.5 * (t + places->at[i + 1]), level);
        if (then != below)
            status = gd__arena_append(
                &parts->arena, &parts->crossing, &parts->crossing_count, &parts->crossing_capacity,
                &(struct gd__crossing){edge, t, below}, sizeof *parts->crossing);
        below = then;
    }
    return status;
}
