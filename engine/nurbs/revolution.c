/* Surface of revolution. Its profile, a NURBS curve, is stored as a NURBS surface that has degree 1
 * across the profile. */
#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "nurbs/nurbs.h"
#include "nurbs/surface.h"

enum { PLACES = 64 }; /* number of places where the profile's radius is tested */

struct revolution {
    struct gd_parametric *profile; /* u: the profile's parameter */
};

static void revolution_destroy(void *shape)
{
    struct revolution *revolution = shape;
    gd_parametric_release(revolution->profile);
    free(revolution);
}

static void jet(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                struct gd_jet *out)
{
    (void)cell_u;
    const struct revolution *revolution = shape;
    const struct gd_evaluator *profile = &revolution->profile->evaluator;
    struct gd_jet p;
    profile->jet(profile->shape, cell_v, 0, v, 0, &p);
    double c = cos(u), s = sin(u);
    *out = (struct gd_jet){.x = {p.x.x * c, p.x.x * s, p.x.z},
                           .u = {-p.x.x * s, p.x.x * c, 0},
                           .v = {p.u.x * c, p.u.x * s, p.u.z},
                           .uu = {-p.x.x * c, -p.x.x * s, 0},
                           .uv = {-p.u.x * s, p.u.x * c, 0},
                           .vv = {p.uu.x * c, p.uu.x * s, p.uu.z}};
}

static double revolution_extent(const struct gd_profile *profile)
{
    double most = 0;
    for (uint32_t i = 0; i < profile->count; i++)
        most = fmax(most, fmax(fabs(profile->points[i][0]), fabs(profile->points[i][1])));
    return most;
}

/* Creates the surface that stores the profile. The profile lies in the plane y = 0 and is extruded
 * along y, by the largest coordinate of the profile. */
static enum gd_status take_profile(const struct gd_profile *profile, struct gd_parametric **out,
                                   struct gd_detail *detail)
{
    if (profile->count > GD_NURBS_COUNT_MAX)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the profile has more than %d points",
                       GD_NURBS_COUNT_MAX);
    struct gd__arena arena = {0};
    double(*points)[3] = gd__arena_take(&arena, 2 * (size_t)profile->count, sizeof *points);
    double *weights = gd__arena_take(&arena, 2 * (size_t)profile->count, sizeof *weights);
    double width = revolution_extent(profile);
    enum gd_status status = arena.status ? gd_fail_status(detail, arena.status) : GD_OK;
    for (uint32_t i = 0; i < 2 * profile->count && !status; i++) {
        const double *point = profile->points[i / 2];
        points[i][0] = point[0], points[i][1] = i % 2 * width, points[i][2] = point[1];
        weights[i] = profile->weights ? profile->weights[i / 2] : 1;
    }
    struct gd_nurbs_data data = {.degree_u = profile->degree,
                                 .degree_v = 1,
                                 .count_u = profile->count,
                                 .count_v = 2,
                                 .knots_u = profile->knots,
                                 .knots_v = (double[]){0, 0, 1, 1},
                                 .knot_count_u = profile->count + profile->degree + 1,
                                 .knot_count_v = 4,
                                 .points = (const double(*)[3])points,
                                 .weights = weights};
    if (!status) status = gd_nurbs_create(&data, out, detail);
    gd__arena_free(&arena);
    return status;
}

static double radius(const struct gd_parametric *profile, double t)
{
    return gd__surface_position(profile, (double[2]){t, 0}).x;
}

static enum gd_status check_radius(const struct gd_parametric *profile, struct gd_axis *v,
                                   struct gd_detail *detail)
{
    double near = GD_TOL_CLOSED * profile->size;
    v->pole_low = !v->closed && fabs(radius(profile, v->low)) <= near;
    v->pole_high = !v->closed && fabs(radius(profile, v->high)) <= near;
    for (int i = 0; i <= PLACES; i++) {
        if ((i == 0 && v->pole_low) || (i == PLACES && v->pole_high)) continue;
        double t = i == PLACES ? v->high : v->low + (v->high - v->low) * i / PLACES;
        if (radius(profile, t) <= near)
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "the profile meets the axis at its parameter %.17g: only its ends may",
                           t);
    }
    return GD_OK;
}

enum gd_status gd_parametric_revolution(const struct gd_profile *profile,
                                        struct gd_parametric **out, struct gd_detail *detail)
{
    struct revolution *revolution = calloc(1, sizeof *revolution);
    if (!revolution) return gd_fail_status(detail, GD_NO_MEMORY);
    enum gd_status status = take_profile(profile, &revolution->profile, detail);
    if (status) {
        free(revolution);
        return status;
    }
    struct gd_axis v = *revolution->profile->axis[0];
    v.pole_low = v.pole_high = false;
    status = check_radius(revolution->profile, &v, detail);
    if (status) {
        revolution_destroy(revolution);
        return status;
    }
    struct gd_axis turn = {.low = 0, .high = 2 * M_PI, .closed = true};
    size_t bytes = sizeof *revolution + gd_parametric_memsize(revolution->profile);
    return gd_parametric_create(
        &(struct gd_evaluator){turn, v, jet, revolution_destroy, revolution, bytes}, out, detail);
}
