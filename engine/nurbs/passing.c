/* Determines the side on which a path passes an obstacle.
 *
 * A geodesic between contacts may cross a hole. The path has to pass the hole on the side of the
 * path of the tessellation (the seed), even if the geodesic crosses the hole close to a corner on
 * the other side. The angles by which path and seed turn around a place of the hole differ by 0 if
 * they pass the place on the same side. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nurbs/taut.h"

enum {
    ARC_SAMPLES = 32,
    SCAN_LINES = 7,
    CROSSINGS_MOST = 64,
};

/* --- angles around a place -------------------------------------------------------------------- */

/* The angle by which a sequence of places turns around the origin `about`. */
struct sweep {
    double about[2], last[2], angle;
    bool has_last;
};

static void sweep_add(struct sweep *sweep, const double at[2])
{
    double to[2] = {at[0] - sweep->about[0], at[1] - sweep->about[1]};
    const double *from = sweep->last;
    if (sweep->has_last)
        sweep->angle += atan2(from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1]);
    memcpy(sweep->last, to, sizeof to);
    sweep->has_last = true;
}

static void sweep_line(struct sweep *sweep, const struct gd__uv_polyline *line, uint32_t begin,
                       uint32_t end)
{
    for (uint32_t i = begin; i < end; i++) sweep_add(sweep, line->at[i]);
}

static void sweep_contact(struct sweep *sweep, const struct gd__loops *loops,
                          const struct gd__contact *contact)
{
    const struct gd__span *span =
        &loops->spans[loops->loops[contact->loop].first_span + contact->span];
    int steps = span->is_straight ? 1 : ARC_SAMPLES;
    for (int k = 0; k <= steps && gd__contact_is_arc(contact); k++) {
        struct gd__span_jet jet;
        gd__span_jet(span, contact->begin + (contact->end - contact->begin) * k / steps, &jet);
        sweep_add(sweep, (double[]){jet.at[0] + contact->shift[0], jet.at[1] + contact->shift[1]});
    }
}

/* Adds the gap that leaves the domain. The worst place, `about`, is on its right. */
static void sweep_leaving(struct sweep *sweep, const struct gd__leaving *leaving)
{
    const struct gd__uv_polyline *samples = &leaving->samples;
    uint32_t after = leaving->sample + 1, before = after - (leaving->is_sample && after > 1);
    sweep_line(sweep, samples, 0, before);
    double angle = sweep->angle;
    if (after < samples->count) sweep_add(sweep, samples->at[after]);
    if (sweep->angle > angle) sweep->angle -= 2 * M_PI;
    sweep_line(sweep, samples, after + 1, samples->count);
}

/* Returns the winding number, around `about`, of the closed curve that follows the path and then
 * the seed in reverse. It is 0 if both pass this place on the same side. The samples of `leaving`
 * replace gap `gap`. */
static long passing_turns(const struct gd__taut *taut, const double about[2], uint32_t gap,
                          const struct gd__leaving *leaving)
{
    const struct gd__uv_polyline *seed = &taut->seed->polyline;
    struct sweep path = {.about = {about[0], about[1]}}, other = path;
    sweep_line(&other, seed, 0, seed->count);
    sweep_line(&path, seed, 0, 1); /* the ends of the path may have moved along their curves */
    for (uint32_t i = 0; i < taut->gap_count; i++) {
        const struct gd__gap *part = &taut->gaps[i];
        if (i == gap)
            sweep_leaving(&path, leaving);
        else if (!part->is_empty)
            sweep_line(&path, &part->line, 0, part->line.count);
        if (i < taut->contacts.count)
            sweep_contact(&path, taut->task->surface->loops, &taut->contacts.items[i]);
    }
    sweep_line(&path, seed, seed->count - 1, seed->count);
    return lround((path.angle - other.angle) / (2 * M_PI));
}

/* --- places of the loop ----------------------------------------------------------------------- */

/* One of the two parts of the loop between the places where the gap crosses it. */
struct flank {
    double height; /* largest scaled distance from the chord between these places */
    double s;      /* the place at this distance */
};

/* Returns the number of spans from one place of a loop to another, in a direction. */
static double loop_run(double from, double to, int direction, double spans)
{
    double run = fmod((to - from) * direction, spans);
    return run < 0 ? run + spans : run;
}

static struct flank flank_of(const struct gd_parametric *surface, const struct gd__leaving *leaving,
                             int direction)
{
    const struct gd__loops *loops = surface->loops;
    const struct gd__loop_samples *samples = &loops->samples;
    uint32_t loop = leaving->place.loop;
    double spans = loops->loops[loop].span_count,
           most = loop_run(leaving->s[0], leaving->s[1], direction, spans);
    struct gd__span_jet jet[2];
    for (int side = 0; side < 2; side++)
        gd__loop_jet(loops, loop, leaving->s[side], false, &jet[side]);
    double chord[2];
    for (int k = 0; k < 2; k++) chord[k] = (jet[1].at[k] - jet[0].at[k]) / loops->width[k];
    double length = hypot(chord[0], chord[1]);
    struct flank flank = {0, leaving->place.s};
    for (uint32_t i = samples->first[loop]; i < samples->first[loop + 1] && length > 0; i++) {
        double run = loop_run(leaving->s[0], samples->s[i], direction, spans);
        if (!(run > 0 && run < most)) continue;
        double x = (samples->at[i][0] - jet[0].at[0]) / loops->width[0],
               y = (samples->at[i][1] - jet[0].at[1]) / loops->width[1];
        double height = direction * (chord[0] * y - chord[1] * x) / length;
        if (height > flank.height) flank = (struct flank){height, samples->s[i]};
    }
    return flank;
}

/* Returns the scaled distance of a place from the polyline of the seed. */
static double seed_distance(const struct gd__taut *taut, const double at[2])
{
    const struct gd__uv_polyline *seed = &taut->seed->polyline;
    const double *width = taut->task->surface->loops->width;
    double least = INFINITY;
    for (uint32_t i = 0; i + 1 < seed->count; i++) {
        double run[2], from[2], square = 0, along = 0;
        for (int k = 0; k < 2; k++) {
            run[k] = (seed->at[i + 1][k] - seed->at[i][k]) / width[k];
            from[k] = (at[k] - seed->at[i][k]) / width[k];
            square += run[k] * run[k];
            along += run[k] * from[k];
        }
        double part = square > 0 ? fmin(fmax(along / square, 0), 1) : 0;
        least = fmin(least, hypot(from[0] - part * run[0], from[1] - part * run[1]));
    }
    return least;
}

/* Returns the largest scaled distance of a loop from its samples. */
static double loop_sag(const struct gd__loops *loops, uint32_t number)
{
    const struct gd__loop *loop = &loops->loops[number];
    for (uint32_t i = 0; i < loop->span_count; i++)
        if (!loops->spans[loop->first_span + i].is_straight) return GD__LOOPS_SAG;
    return 0;
}

struct gd__contact gd__passing_contact(const struct gd__taut *taut, uint32_t gap,
                                       const struct gd__leaving *leaving)
{
    const struct gd_parametric *surface = taut->task->surface;
    struct gd__loop_place place = leaving->place;
    if (!leaving->has_crossings) {
        struct gd__contact touch = gd__contact_touch(surface, &place, 1, leaving->at);
        struct gd__contact_place at;
        gd__contact_at(surface, &touch, touch.begin, &at);
        if (gd_vec3_dot(at.tangent, leaving->velocity) < 0) touch.direction = -1;
        return touch;
    }
    struct flank left = flank_of(surface, leaving, 1), right = flank_of(surface, leaving, -1);
    int direction = left.height <= right.height ? 1 : -1;
    /* the seed follows the samples of the loops: a place near a loop may be on either side of it */
    if (seed_distance(taut, leaving->at) > 2 * loop_sag(surface->loops, place.loop))
        direction = passing_turns(taut, leaving->at, gap, leaving) >= 0 ? 1 : -1;
    place.s = direction > 0 ? left.s : right.s;
    struct gd__span_jet jet;
    gd__loop_jet(surface->loops, place.loop, place.s, false, &jet);
    memcpy(place.at, jet.at, sizeof place.at);
    return gd__contact_touch(surface, &place, direction, leaving->at);
}

/* --- check of a path -------------------------------------------------------------------------- */

static int by_value(const void *x, const void *y)
{
    const double *p = x, *q = y;
    return *p < *q ? -1 : *p > *q;
}

/* Sets at[0] to the middle of the widest part of the line v = at[1] inside a loop. Returns its
 * width, or 0 if there is none or the line has too many crossings. */
static double scan_line(const struct gd__loops *loops, uint32_t loop, double at[2])
{
    const struct gd__loop_samples *samples = &loops->samples;
    uint32_t first = samples->first[loop], n = samples->first[loop + 1] - first, count = 0;
    double cross[CROSSINGS_MOST], widest = 0;
    for (uint32_t i = 0; i < n && count < CROSSINGS_MOST; i++) {
        const double *a = samples->at[first + i], *b = samples->at[first + (i + 1) % n];
        if ((a[1] > at[1]) != (b[1] > at[1]))
            cross[count++] = a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1]);
    }
    if (count == CROSSINGS_MOST) return 0;
    qsort(cross, count, sizeof *cross, by_value);
    for (uint32_t i = 0; i + 1 < count; i += 2) {
        if (cross[i + 1] - cross[i] <= widest) continue;
        widest = cross[i + 1] - cross[i];
        at[0] = 0.5 * (cross[i] + cross[i + 1]);
    }
    return widest;
}

/* Finds a place inside a hole, far from its boundary. Returns false if it does not find one, for
 * example because each line has too many crossings. */
static bool hole_inside(const struct gd__loops *loops, uint32_t loop, double out[2])
{
    const struct gd__loop_samples *samples = &loops->samples;
    double low = INFINITY, high = -INFINITY, widest = 0;
    for (uint32_t i = samples->first[loop]; i < samples->first[loop + 1]; i++) {
        low = fmin(low, samples->at[i][1]);
        high = fmax(high, samples->at[i][1]);
    }
    for (int k = 1; k <= SCAN_LINES; k++) {
        double at[2] = {0, low + (high - low) * k / (SCAN_LINES + 1)},
               width = scan_line(loops, loop, at);
        if (width <= widest) continue;
        widest = width;
        memcpy(out, at, sizeof at);
    }
    return widest > 0;
}

/* Returns true if the path and its seed pass all copies of a place on the same side. */
static bool is_same_side(const struct gd__taut *taut, const double inside[2])
{
    const struct gd__uv_polyline *seed = &taut->seed->polyline;
    int low[2] = {0, 0}, high[2] = {0, 0};
    double period[2];
    for (int k = 0; k < 2; k++) {
        period[k] = gd__axis_period(taut->task->surface->axis[k]);
        for (uint32_t i = 0; i < seed->count && period[k] > 0; i++) {
            int turn = (int)floor((seed->at[i][k] - inside[k]) / period[k]);
            low[k] = turn < low[k] ? turn : low[k];
            high[k] = turn + 1 > high[k] ? turn + 1 : high[k];
        }
    }
    for (int i = low[0]; i <= high[0]; i++)
        for (int k = low[1]; k <= high[1]; k++) {
            const double at[2] = {inside[0] + i * period[0], inside[1] + k * period[1]};
            if (passing_turns(taut, at, taut->gap_count, NULL)) return false;
        }
    return true;
}

bool gd__passing_agrees(const struct gd__taut *taut)
{
    const struct gd__loops *loops = taut->task->surface->loops;
    uint64_t places = taut->seed->polyline.count;
    for (uint32_t i = 0; i < taut->gap_count; i++) places += taut->gaps[i].line.count;
    for (uint32_t i = loops->has_outer; i < loops->count; i++) {
        double inside[2];
        uint64_t samples = loops->samples.first[i + 1] - loops->samples.first[i];
        if (!gd__pace(taut->task->pace, places + samples)) return false;
        if (hole_inside(loops, i, inside) && !is_same_side(taut, inside)) return false;
    }
    return true;
}
