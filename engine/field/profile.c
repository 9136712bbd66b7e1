#include "field/profile.h"

#include "field/sources.h"

/* A segment and its windows under construction, in the frame of side k of the current face. */
struct gathering {
    const struct gd_field *field;
    struct gd__profile *profile;
    uint32_t face;
    struct gd__chord chord; /* in the frame of the current side */
};

void gd__profile_destroy(struct gd__profile *profile)
{
    gd__stack_destroy(&profile->windows);
    gd__stack_destroy(&profile->scratch);
    *profile = (struct gd__profile){0};
}

/* --- windows ---------------------------------------------------------------------------------- */

/* Clips a window to the interval in which a linear function is not negative. `value` is the value
 * of the function at the origin, `slope` its derivative. */
static void clip_window(struct gd__window *w, double value, double slope)
{
    double end = value + slope * w->b1, begin = value + slope * w->b0;
    if (begin < 0 && end < 0) {
        w->b1 = w->b0;
    } else if (begin < 0) {
        w->b0 = fmin(fmax(-value / slope, w->b0), w->b1);
    } else if (end < 0) {
        w->b1 = fmax(fmin(-value / slope, w->b1), w->b0);
    }
}

static enum gd_status push_window(struct gathering *g, const struct gd__window *w)
{
    if (w->b1 <= w->b0) return GD_OK;
    return gd__stack_push(&g->profile->windows, w, GD_TOL_WIDTH * g->profile->length,
                          &g->profile->scratch);
}

/* Returns the window of a point source that sees the whole segment. */
static struct gd__window window_of_point(const struct gathering *g, struct gd__local at,
                                         double sigma, uint32_t source)
{
    return (struct gd__window){.b1 = g->profile->length,
                               .x = gd__chord_foot(&g->chord, at),
                               .y = fabs(gd__chord_height(&g->chord, at)),
                               .sigma = sigma,
                               .source = source};
}

/* Returns the window of a linear source whose distance is `value` at the segment's origin and whose
 * gradient is (nx, ny). */
static struct gd__window window_of_line(const struct gathering *g, double value, double nx,
                                        double ny, uint32_t source)
{
    const struct gd__local u = g->chord.along;
    return (struct gd__window){.b1 = g->profile->length,
                               .x = -(nx * u.x + ny * u.y),
                               .y = fabs(u.x * ny - u.y * nx),
                               .sigma = value,
                               .source = source};
}

/* Adds the part of the segment that the source of a side's window sees. This part lies between the
 * rays through the window's ends. */
static enum gd_status push_seen(struct gathering *g, const struct gd__window *seen)
{
    struct gd__local at = g->chord.from, u = g->chord.along;
    bool linear = gd__window_is_linear(seen);
    double x = seen->x, y = seen->y, weight = linear ? 0 : 1;
    struct gd__window w =
        linear
            ? window_of_line(g, gd__window_distance_beyond(seen, at.x, at.y), -x, y, seen->source)
            : window_of_point(g, (struct gd__local){x, -y}, seen->sigma, seen->source);
    /* clips by the ray from the source (x, -y, weight) through (b, 0) */
    for (int end = 0; end < 2; end++) {
        double b = end ? seen->b1 : seen->b0, sign = end ? -1 : 1, across = weight * b - x;
        clip_window(&w, sign * (y * (at.x - b) - across * at.y), sign * (y * u.x - across * u.y));
    }
    return push_window(g, &w);
}

/* Adds the wedges that enter the face across its side k. */
static enum gd_status push_wedges(struct gathering *g, int k)
{
    const struct gd_field *field = g->field;
    uint32_t side = field->mesh->face_side[g->face][k], across = side & 1 ? GD__WINDOW_FAR_SIDE : 0;
    struct gd__edge_windows windows = gd__edge_windows(field, side);
    enum gd_status status = GD_OK;
    for (struct gd__window w; !status && gd__edge_windows_next(&windows, &w);)
        if (w.tags == across) status = push_seen(g, &w);
    return status;
}

/* Adds a seed segment in the face. Points on both sides see the segment perpendicularly. */
static enum gd_status push_chord(struct gathering *g, const struct gd__seed *seed, uint32_t source)
{
    struct gd__chord chord = gd__chord(g->field->mesh, g->face, 0, &seed->point, &seed->end);
    struct gd__local at = g->chord.from, u = g->chord.along;
    double foot = gd__chord_foot(&chord, at), height = gd__chord_height(&chord, at);
    double onwards = u.x * chord.along.x + u.y * chord.along.y,
           upwards = chord.along.x * u.y - chord.along.y * u.x;
    enum gd_status status = GD_OK;
    for (int left = -1; left <= 1 && !status; left += 2) {
        double nx = -left * chord.along.y, ny = left * chord.along.x;
        struct gd__window w = window_of_line(g, seed->offset + left * height, nx, ny, source);
        clip_window(&w, foot, onwards);
        clip_window(&w, chord.length - foot, -onwards);
        clip_window(&w, left * height, left * upwards);
        status = push_window(g, &w);
    }
    return status;
}

static enum gd_status push_seeds(struct gathering *g)
{
    const struct gd_field *field = g->field;
    struct gd__face_seeds f = gd__field_seeds_in(field, g->face);
    enum gd_status status = GD_OK;
    for (; f.at < f.end && !status; f.at++) {
        const struct gd__seed *seed = &field->seeds[f.at->seed];
        uint32_t source = field->mesh->vertex_count + f.at->seed;
        if (seed->is_segment) {
            status = push_chord(g, seed, GD__SOURCE_LINEAR | source);
            continue;
        }
        struct gd__local at = gd__point_local(field->mesh, g->face, &seed->point);
        struct gd__window w = window_of_point(g, at, seed->offset, source);
        status = push_window(g, &w);
    }
    return status;
}

static enum gd_status push_corner(struct gathering *g, int k)
{
    uint32_t vertex = g->field->mesh->origin[g->field->mesh->face_side[g->face][k]];
    if (g->field->distance[vertex] >= GD__FAR) return GD_OK;
    struct gd__window w =
        window_of_point(g, (struct gd__local){0, 0}, g->field->distance[vertex], vertex);
    return push_window(g, &w);
}

/* Adds all sources of the face. */
static enum gd_status gather_windows(struct gathering *g, const struct gd_point *a,
                                     const struct gd_point *b)
{
    enum gd_status status = GD_OK;
    /* processes side 0 last, because seeds are in the frame of this side */
    for (int k = 2; k >= 0 && !status; k--) {
        g->chord = gd__chord(g->field->mesh, g->face, k, a, b);
        g->profile->length = g->chord.length;
        status = push_corner(g, k);
        if (!status) status = push_wedges(g, k);
    }
    return status ? status : push_seeds(g);
}

enum gd_status gd__profile_of(const struct gd_field *field, const struct gd_point *a,
                              const struct gd_point *b, struct gd__profile *profile)
{
    struct gathering g = {.field = field, .profile = profile};
    struct gd__segment_location location;
    enum gd_status status = GD_OK;
    profile->windows.count = 0;
    if (!gd__segment_locate(field->mesh, a, b, &location)) return GD_INVALID_ARGUMENT;
    if (location.face != GD_NONE) {
        g.face = location.face;
        return gather_windows(&g, a, b);
    }
    for (uint32_t side = 2 * location.edge; side < 2 * location.edge + 2 && !status; side++) {
        g.face = field->mesh->side_face[side];
        if (g.face != GD_NONE) status = gather_windows(&g, a, b);
    }
    return status;
}

/* --- extremes --------------------------------------------------------------------------------- */

struct gd__profile_place gd__profile_least(const struct gd__profile *profile)
{
    struct gd__profile_place least = {INFINITY, 0};
    for (uint32_t i = 0; i < profile->windows.count; i++) {
        const struct gd__window *w = &profile->windows.windows[i];
        double t = gd__window_nearest_at(w), distance = gd__window_distance(w, t);
        if (distance < least.distance) least = (struct gd__profile_place){distance, t};
    }
    return least;
}

/* Returns an upper bound of the distance at t: the distance at the nearest point of the window,
 * plus the length of the segment between that point and t. */
static double at_most(const struct gd__window *w, double t)
{
    double end = t < w->b0 ? w->b0 : fmin(t, w->b1);
    return gd__window_distance(w, end) + fabs(t - end);
}

/* Returns the distance at t, an end of window i. Because ends are rounded, gaps may lie between
 * neighbouring strips of segments. In a gap, the window of the profile belongs to a source that is
 * farther than the nearest source. The windows beside the gap bound the distance. */
static double distance_at_end(const struct gd__profile *profile, uint32_t i, double t)
{
    const struct gd__window *w = profile->windows.windows;
    double narrow = GD_TOL_GAP * profile->length, distance = gd__window_distance(&w[i], t),
           width = 0;
    for (uint32_t j = i; j-- > 0 && width <= narrow; width = w[j].b1 - w[j].b0)
        distance = fmin(distance, at_most(&w[j], t));
    width = 0;
    for (uint32_t j = i + 1; j < profile->windows.count && width <= narrow;
         width = w[j].b1 - w[j].b0, j++)
        distance = fmin(distance, at_most(&w[j], t));
    return distance;
}

struct gd__profile_place gd__profile_greatest(const struct gd__profile *profile)
{
    struct gd__profile_place greatest = {-1, 0};
    for (uint32_t i = 0; i < profile->windows.count; i++) {
        const struct gd__window *w = &profile->windows.windows[i];
        for (int end = 0; end < 2; end++) {
            double t = end ? w->b1 : w->b0, distance = distance_at_end(profile, i, t);
            if (distance > greatest.distance) greatest = (struct gd__profile_place){distance, t};
        }
    }
    return greatest;
}
