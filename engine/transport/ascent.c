#include "transport/ascent.h"

/* The directions around a point: a circle whose circumference is the total angle around the point,
 * or, at the boundary, an interval. */
struct cone {
    const struct gd__pull *pulls;
    uint32_t count;
    double first, total;
    bool is_closed;
};

static struct cone cone_at(const struct gd_mesh *mesh, const struct gd_point *point,
                           const struct gd__pull *pulls, uint32_t count)
{
    struct cone cone = {pulls, count, 0, gd__turn_total(mesh, point),
                        gd__turn_is_closed(mesh, point)};
    if (cone.is_closed || point->kind == GD_POINT_VERTEX) return cone;
    cone.total = M_PI;
    if (gd__side_is_boundary(mesh, 2 * point->element)) cone.first = M_PI;
    return cone;
}

/* Returns the signed angle from one turn to another: of the two angles around an interior point,
 * the smaller one. */
static double ascent_between(const struct cone *cone, double from, double to)
{
    return cone->is_closed ? remainder(to - from, cone->total) : to - from;
}

static double ascent_clamp(const struct cone *cone, double turn)
{
    return cone->is_closed ? turn : fmin(fmax(turn, cone->first), cone->first + cone->total);
}

static double sum_at(const struct cone *cone, double turn)
{
    double sum = 0;
    for (uint32_t i = 0; i < cone->count; i++)
        sum += cone->pulls[i].strength *
               cos(fmin(fabs(ascent_between(cone, turn, cone->pulls[i].turn)), M_PI));
    return sum;
}

/* Unfolds the vectors whose turns differ from `turn` by less than pi into the plane, and adds them.
 * Returns the turn of their sum. */
static double climb(const struct cone *cone, double turn)
{
    double x = 0, y = 0;
    for (uint32_t i = 0; i < cone->count; i++) {
        double angle = ascent_between(cone, turn, cone->pulls[i].turn);
        if (fabs(angle) >= M_PI) continue;
        x += cone->pulls[i].strength * cos(angle);
        y += cone->pulls[i].strength * sin(angle);
    }
    return x == 0 && y == 0 ? turn : ascent_clamp(cone, turn + atan2(y, x));
}

static void try_turn(const struct cone *cone, double turn, double *best, double *out)
{
    double sum = sum_at(cone, turn);
    if (sum <= *best) return;
    *best = sum;
    *out = turn;
}

/* Finds the greatest sum. A vector's term depends on the direction only if the vector's turn
 * differs from the direction by less than pi. The set of these vectors changes only at directions
 * that differ from the turn of a vector by pi. So testing both sides of each such direction covers
 * all sets. At the boundary, the greatest sum may also be at an end of the interval. */
static double climb_all(const struct cone *cone, double *turn)
{
    enum { SIDES = 2 };
    static const double off[SIDES] = {-1e-9, 1e-9};
    double best = -INFINITY;
    try_turn(cone, climb(cone, cone->first), &best, turn);
    if (!cone->is_closed) try_turn(cone, cone->first, &best, turn);
    if (!cone->is_closed) try_turn(cone, cone->first + cone->total, &best, turn);
    for (uint32_t i = 0; i < cone->count; i++) {
        try_turn(cone, climb(cone, cone->pulls[i].turn), &best, turn);
        for (int side = 0; side < SIDES; side++) {
            try_turn(cone, climb(cone, ascent_clamp(cone, cone->pulls[i].turn + M_PI + off[side])),
                     &best, turn);
            try_turn(cone, climb(cone, ascent_clamp(cone, cone->pulls[i].turn - M_PI + off[side])),
                     &best, turn);
        }
    }
    return best;
}

double gd__ascent(const struct gd_mesh *mesh, const struct gd_point *point,
                  const struct gd__pull *pulls, uint32_t count, double *turn)
{
    struct cone cone = cone_at(mesh, point, pulls, count);
    double best;
    if (cone.is_closed && point->kind != GD_POINT_VERTEX) {
        *turn = climb(&cone, 0);
        best = sum_at(&cone, *turn);
    } else {
        best = climb_all(&cone, turn);
    }
    *turn = gd__turn_reduce(mesh, point, *turn);
    return best;
}

static double step_along(const struct cone *cone, double turn)
{
    double force = 0, stiffness = 0;
    for (uint32_t i = 0; i < cone->count; i++) {
        const struct gd__pull *pull = &cone->pulls[i];
        double cosine = cos(fmin(fabs(ascent_between(cone, turn, pull->turn)), M_PI));
        force += pull->strength * cosine;
        stiffness += pull->weight * (cosine * cosine + pull->bend * (1 - cosine * cosine));
    }
    return fmax(force, 0) / stiffness;
}

static double step_in_plane(const struct cone *cone, double *turn)
{
    double fx = 0, fy = 0, xx = 0, xy = 0, yy = 0;
    for (uint32_t i = 0; i < cone->count; i++) {
        const struct gd__pull *pull = &cone->pulls[i];
        double x = cos(pull->turn), y = sin(pull->turn), across = pull->weight * pull->bend;
        fx += pull->strength * x, fy += pull->strength * y;
        xx += pull->weight * x * x + across * y * y;
        yy += pull->weight * y * y + across * x * x;
        xy += (pull->weight - across) * x * y;
    }
    double determinant = xx * yy - xy * xy, x = (yy * fx - xy * fy) / determinant,
           y = (xx * fy - xy * fx) / determinant;
    *turn = atan2(y, x);
    return hypot(x, y);
}

double gd__ascent_step(const struct gd_mesh *mesh, const struct gd_point *point,
                       const struct gd__pull *pulls, uint32_t count, double heading, double *turn)
{
    struct cone cone = cone_at(mesh, point, pulls, count);
    if (!cone.is_closed || point->kind == GD_POINT_VERTEX) {
        *turn = heading;
        return step_along(&cone, heading);
    }
    double length = step_in_plane(&cone, turn);
    *turn = gd__turn_reduce(mesh, point, *turn);
    return length;
}
