#include "field/voronoi_branch.h"

/* steps of Newton's method; it starts at positions that are accurate up to rounding or the height
 * of a chord */
enum { STEPS = 8 };

/* Returns a + t b. */
static struct gd__local along(struct gd__local a, double t, struct gd__local b)
{
    return (struct gd__local){a.x + t * b.x, a.y + t * b.y};
}

/* --- the branch ------------------------------------------------------------------------------- */

static struct gd__local unit_vector(double angle)
{
    return (struct gd__local){cos(angle), sin(angle)};
}

static bool from_point_to_point(const struct gd__focus *source, const struct gd__focus *other,
                                struct gd__branch *out)
{
    struct gd__local a = gd__local_minus(other->at, source->at);
    double k = other->sigma - source->sigma, apart = gd__local_length(a),
           excess = (apart - k) * (apart + k);
    if (!(excess > 0)) return false;
    out->slope = (struct gd__local){2 / excess * a.x, 2 / excess * a.y};
    out->rest = -2 / excess * k;
    return true;
}

static bool from_point_to_line(const struct gd__focus *source, const struct gd__focus *line,
                               struct gd__branch *out)
{
    double k = gd__focus_distance(line, source->at) - source->sigma;
    if (!(k > 0)) return false;
    out->slope = (struct gd__local){-line->gradient.x / k, -line->gradient.y / k};
    out->rest = 1 / k;
    return true;
}

/* Computes the branch of two linear sources: the line d p = k, where d is the difference of the
 * gradients. The centre of the polar form lies at distance `size` from the line. Gradients that
 * differ by less than the nudge count as equal. */
static bool between_lines(const struct gd__focus *source, const struct gd__focus *other,
                          struct gd__local middle, double size, struct gd__branch *out)
{
    struct gd__local d = gd__local_minus(source->gradient, other->gradient);
    double steepness = gd__local_length(d);
    if (!(steepness > GD_TOL_TIE)) return false;
    struct gd__local m = {d.x / steepness, d.y / steepness};
    double off =
        (gd__focus_distance(source, middle) - gd__focus_distance(other, middle)) / steepness;
    out->centre = along(middle, -off - size, m);
    out->slope = (struct gd__local){m.x / size, m.y / size};
    out->rest = 0;
    out->zero = atan2(m.y, m.x);
    return true;
}

bool gd__branch_between(const struct gd__focus *source, const struct gd__focus *other,
                        struct gd__local middle, double size, struct gd__branch *out)
{
    struct gd__local towards = gd__local_minus(middle, source->at);
    struct gd__branch branch = {
        .source = *source, .centre = source->at, .zero = atan2(towards.y, towards.x)};
    bool is_there = source->linear  ? between_lines(source, other, middle, size, &branch)
                    : other->linear ? from_point_to_line(source, other, &branch)
                                    : from_point_to_point(source, other, &branch);
    if (!is_there) return false;
    branch.towards = unit_vector(branch.zero);
    *out = branch;
    return true;
}

double gd__branch_width(const struct gd__branch *branch)
{
    return 1 / gd__local_length(branch->slope);
}

struct gd__local gd__branch_place(const struct gd__branch *branch, double angle)
{
    struct gd__local u = unit_vector(branch->zero + angle);
    return along(branch->centre, 1 / (gd__local_dot(branch->slope, u) + branch->rest), u);
}

/* --- parts of a branch ------------------------------------------------------------------------ */

/* Returns the angles whose unit vector u has m u >= h. */
static struct gd__turn where(const struct gd__branch *branch, struct gd__local m, double h)
{
    struct gd__local z = branch->towards;
    double size = gd__local_length(m);
    if (!(size > 0)) return h <= 0 ? gd__turn_all : (struct gd__turn){0};
    return gd__turn_around(atan2(z.x * m.y - z.y * m.x, gd__local_dot(z, m)), h / size);
}

/* Returns the angles with m r u >= h, that is m u - h / r >= 0. */
static struct gd__turn where_beyond(const struct gd__branch *branch, struct gd__local m, double h)
{
    return where(branch, along(m, -h, branch->slope), h * branch->rest);
}

struct gd__turn gd__branch_turn(const struct gd__branch *branch)
{
    return where(branch, branch->slope, -branch->rest);
}

struct gd__turn gd__branch_beyond(const struct gd__branch *branch, struct gd__local normal,
                                  struct gd__local through)
{
    return where_beyond(branch, normal,
                        gd__local_dot(normal, gd__local_minus(through, branch->centre)));
}

/* Solves |r u - b| < r - l. Squared and divided by r: 2 (b u - l) > (b b - l^2) / r. */
static struct gd__turn point_lost_to_point(const struct gd__branch *branch,
                                           const struct gd__focus *third, double slack)
{
    struct gd__local b = gd__local_minus(third->at, branch->centre);
    double l = third->sigma + slack - branch->source.sigma, apart = gd__local_length(b);
    if (l >= apart) return (struct gd__turn){0};
    if (l <= -apart) return gd__turn_all;
    double g = 0.5 * (apart - l) * (apart + l);
    return where(branch, along(b, -g, branch->slope), l + g * branch->rest);
}

/* Solves l + r g u < r, where l is the distance of the line minus that of the point, at the
 * branch's centre. Divided by r: (1 - g u) > l / r. */
static struct gd__turn point_lost_to_line(const struct gd__branch *branch,
                                          const struct gd__focus *third, double slack)
{
    struct gd__local towards = {-third->gradient.x, -third->gradient.y};
    double l = gd__focus_distance(third, branch->centre) + slack - branch->source.sigma;
    return where(branch, along(towards, -l, branch->slope), l * branch->rest - 1);
}

static struct gd__turn line_lost_to_line(const struct gd__branch *branch,
                                         const struct gd__focus *third, double slack)
{
    double l = gd__focus_distance(third, branch->centre) + slack -
               gd__focus_distance(&branch->source, branch->centre);
    return where_beyond(branch, gd__local_minus(branch->source.gradient, third->gradient), l);
}

/* Solves s^2 + y^2 < (a + b s)^2 and a + b s > 0. `s` is the position along the line, measured from
 * the projection of the third point. `y` is the distance of the third point from the line. */
static struct gd__turn line_lost_to_point(const struct gd__branch *branch,
                                          const struct gd__focus *third, double slack)
{
    struct gd__local m = branch->towards, onwards = {-m.y, m.x};
    double beside = 1 / gd__local_dot(branch->slope, m);
    struct gd__local to_third = gd__local_minus(third->at, branch->centre);
    double foot = gd__local_dot(to_third, onwards), y = gd__local_dot(to_third, m) - beside;
    double a = gd__focus_distance(&branch->source, along(third->at, -y, m)) - third->sigma - slack,
           b = gd__local_dot(branch->source.gradient, onwards), square = (1 - b) * (1 + b);
    double discriminant = a * a - square * y * y;
    if (!(a > 0 && discriminant > 0)) return (struct gd__turn){0};
    double from = (a * b - sqrt(discriminant)) / square, to = (a * b + sqrt(discriminant)) / square;
    return (struct gd__turn){
        1, {{.from = atan((foot + from) / beside), .to = atan((foot + to) / beside)}}};
}

struct gd__turn gd__branch_lost_to(const struct gd__branch *branch, const struct gd__focus *third,
                                   double slack)
{
    if (branch->source.linear)
        return third->linear ? line_lost_to_line(branch, third, slack)
                             : line_lost_to_point(branch, third, slack);
    return third->linear ? point_lost_to_line(branch, third, slack)
                         : point_lost_to_point(branch, third, slack);
}

/* --- positions by Newton's method ------------------------------------------------------------- */

static struct gd__local direction_from(const struct gd__focus *focus, struct gd__local at)
{
    if (focus->linear) return focus->gradient;
    struct gd__local d = gd__local_minus(at, focus->at);
    double size = gd__local_length(d);
    return size > 0 ? (struct gd__local){d.x / size, d.y / size} : (struct gd__local){0, 0};
}

/* Returns the distance from the first source minus that from the other, and the gradient of this
 * difference. */
static double difference(const struct gd__focus *first, const struct gd__focus *other,
                         struct gd__local at, struct gd__local *gradient)
{
    *gradient = gd__local_minus(direction_from(first, at), direction_from(other, at));
    return gd__focus_distance(first, at) - gd__focus_distance(other, at);
}

struct gd__local gd__between_two(const struct gd__focus focus[2], struct gd__local at, double reach)
{
    struct gd__local place = at;
    for (int i = 0; i < STEPS; i++) {
        struct gd__local gradient;
        double off = difference(&focus[0], &focus[1], place, &gradient),
               slope = gd__local_dot(gradient, gradient);
        if (off == 0) break;
        place = along(place, -off / slope, gradient);
        if (!(gd__local_length(gd__local_minus(place, at)) <= reach)) return at;
    }
    return place;
}

struct gd__local gd__between_three(const struct gd__focus focus[3], struct gd__local at,
                                   double reach)
{
    struct gd__local place = at;
    for (int i = 0; i < STEPS; i++) {
        struct gd__local m, n;
        double f = difference(&focus[0], &focus[1], place, &m),
               g = difference(&focus[0], &focus[2], place, &n);
        double area = m.x * n.y - m.y * n.x;
        if (!(fabs(area) > GD_TOL_TANGENT * gd__local_length(m) * gd__local_length(n)))
            return gd__between_two(focus, at, reach);
        if (f == 0 && g == 0) break;
        place.x -= (f * n.y - g * m.y) / area;
        place.y -= (g * m.x - f * n.x) / area;
        if (!(gd__local_length(gd__local_minus(place, at)) <= reach)) return at;
    }
    return place;
}
