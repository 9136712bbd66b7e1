#include "field/voronoi_branch.h"

enum { STEPS = 8 /* of Newton's method, from places that are right but for rounding or a chord's height */ };

static double dot(struct gd__local a, struct gd__local b)
{
    return a.x * b.x + a.y * b.y;
}

static struct gd__local minus(struct gd__local a, struct gd__local b)
{
    return (struct gd__local){a.x - b.x, a.y - b.y};
}

/* a + t b */
static struct gd__local along(struct gd__local a, double t, struct gd__local b)
{
    return (struct gd__local){a.x + t * b.x, a.y + t * b.y};
}

static double norm(struct gd__local a)
{
    return sqrt(dot(a, a));
}

/* --- the branch ---------------------------------------------------------------------------------------------------------- */

bool gd__branch_between(const struct gd__focus *source, const struct gd__focus *other, struct gd__local middle,
                        struct gd__branch *out)
{
    struct gd__local a = minus(other->at, source->at), towards = minus(middle, source->at);
    double k = other->sigma - source->sigma, apart = norm(a);
    double excess = (apart - k) * (apart + k);
    if (!(excess > 0)) return false;
    double zero = atan2(towards.y, towards.x);
    *out = (struct gd__branch){source->at, a, source->sigma, k, 2 / excess, zero, {cos(zero), sin(zero)}};
    return true;
}

struct gd__local gd__branch_place(const struct gd__branch *branch, double angle)
{
    double turned = branch->zero + angle;
    struct gd__local u = {cos(turned), sin(turned)};
    return along(branch->focus, 1 / (branch->scale * (dot(branch->other, u) - branch->later)), u);
}

/* Where w u >= q for the unit vector u of the angle. */
static struct gd__turn where(const struct gd__branch *branch, struct gd__local w, double q)
{
    struct gd__local z = branch->towards;
    double size = norm(w);
    if (!(size > 0)) return q <= 0 ? gd__turn_all : (struct gd__turn){0};
    return gd__turn_around(atan2(z.x * w.y - z.y * w.x, dot(z, w)), q / size);
}

struct gd__turn gd__branch_turn(const struct gd__branch *branch)
{
    return where(branch, branch->other, branch->later);
}

/* n r u >= h, where h is how far the line lies from the source: n u - h / r >= 0. */
struct gd__turn gd__branch_beyond(const struct gd__branch *branch, struct gd__local normal, struct gd__local through)
{
    double h = dot(normal, minus(through, branch->focus)), c = h * branch->scale;
    return where(branch, along(normal, -c, branch->other), -c * branch->later);
}

/* |r u - b| < r - l, squared and divided by r: 2 (b u - l) > (b b - l^2) / r. */
struct gd__turn gd__branch_lost_to(const struct gd__branch *branch, const struct gd__focus *third, double slack)
{
    struct gd__local b = minus(third->at, branch->focus);
    double l = third->sigma + slack - branch->sigma, apart = norm(b);
    if (l >= apart) return (struct gd__turn){0};
    if (l <= -apart) return gd__turn_all;
    double g = 0.5 * (apart - l) * (apart + l) * branch->scale;
    return where(branch, along(b, -g, branch->other), l - g * branch->later);
}

/* --- places by Newton's method ------------------------------------------------------------------------------------------- */

static struct gd__local direction_from(const struct gd__focus *focus, struct gd__local at)
{
    struct gd__local d = minus(at, focus->at);
    double size = norm(d);
    return size > 0 ? (struct gd__local){d.x / size, d.y / size} : (struct gd__local){0, 0};
}

/* How much farther the first source is than another, and which way that grows. */
static double difference(const struct gd__focus *first, const struct gd__focus *other, struct gd__local at,
                         struct gd__local *gradient)
{
    *gradient = minus(direction_from(first, at), direction_from(other, at));
    return gd__focus_distance(first, at) - gd__focus_distance(other, at);
}

struct gd__local gd__between_two(const struct gd__focus focus[2], struct gd__local at, double reach)
{
    struct gd__local place = at;
    for (int i = 0; i < STEPS; i++) {
        struct gd__local gradient;
        double off = difference(&focus[0], &focus[1], place, &gradient), slope = dot(gradient, gradient);
        if (off == 0) break;
        place = along(place, -off / slope, gradient);
        if (!(norm(minus(place, at)) <= reach)) return at;
    }
    return place;
}

struct gd__local gd__between_three(const struct gd__focus focus[3], struct gd__local at, double reach)
{
    struct gd__local place = at;
    for (int i = 0; i < STEPS; i++) {
        struct gd__local m, n;
        double f = difference(&focus[0], &focus[1], place, &m), g = difference(&focus[0], &focus[2], place, &n);
        double area = m.x * n.y - m.y * n.x;
        if (!(fabs(area) > GD_TOL_TIE * norm(m))) return gd__between_two(focus, at, reach); /* two of them are one */
        if (f == 0 && g == 0) break;
        place.x -= (f * n.y - g * m.y) / area;
        place.y -= (g * m.x - f * n.x) / area;
        if (!(norm(minus(place, at)) <= reach)) return at;
    }
    return place;
}
