/* Places: converts between places in faces of the control mesh (the form that callers use) and
 * places in base faces. */
#include "subdiv/surface.h"

#include <math.h>

#include "base/tolerance.h"

struct gd__chart gd__chart_child(const struct gd__chart *frame, const struct gd__child *child)
{
    struct gd__chart out;
    for (int i = 0; i < 2; i++) {
        out.origin[i] = frame->origin[i] +
                        (child->origin[0] * frame->s[i] + child->origin[1] * frame->t[i]) / 2;
        out.s[i] = (child->s[0] * frame->s[i] + child->s[1] * frame->t[i]) / 2;
        out.t[i] = (child->t[0] * frame->s[i] + child->t[1] * frame->t[i]) / 2;
    }
    return out;
}

void gd__chart_out(const struct gd__chart *frame, double s, double t, double out[2])
{
    for (int i = 0; i < 2; i++) out[i] = frame->origin[i] + s * frame->s[i] + t * frame->t[i];
}

void gd__chart_in(const struct gd__chart *frame, double u, double v, double out[2])
{
    double x = u - frame->origin[0], y = v - frame->origin[1];
    double determinant = frame->s[0] * frame->t[1] - frame->s[1] * frame->t[0];
    out[0] = (x * frame->t[1] - y * frame->t[0]) / determinant;
    out[1] = (frame->s[0] * y - frame->s[1] * x) / determinant;
}

/* Returns x a + y b. */
static struct gd_vec3 sum(double x, struct gd_vec3 a, double y, struct gd_vec3 b)
{
    return gd_vec3_along(gd_vec3_scale(a, x), y, b);
}

struct gd__jet gd__chart_jet(const struct gd__chart *frame, const struct gd__jet *jet)
{
    double determinant = frame->s[0] * frame->t[1] - frame->s[1] * frame->t[0];
    double su = frame->t[1] / determinant, tu = -frame->s[1] / determinant;
    double sv = -frame->t[0] / determinant, tv = frame->s[0] / determinant;
    struct gd_vec3 us = sum(su, jet->ss, tu, jet->st), ut = sum(su, jet->st, tu, jet->tt);
    struct gd_vec3 vs = sum(sv, jet->ss, tv, jet->st), vt = sum(sv, jet->st, tv, jet->tt);
    return (struct gd__jet){
        .p = jet->p,
        .s = sum(su, jet->s, tu, jet->t),
        .t = sum(sv, jet->s, tv, jet->t),
        .ss = sum(su, us, tu, ut),
        .st = sum(sv, us, tv, ut),
        .tt = sum(sv, vs, tv, vt),
    };
}

static bool is_split_quad(const struct gd_subdivision *surface, uint32_t face)
{
    return surface->split_first && surface->split_first[face + 1] - surface->split_first[face] == 4;
}

struct gd__face_place gd__face_place_of(const struct gd_subdivision *surface,
                                        const struct gd_limit_point *place)
{
    if (!surface->split_first) return (struct gd__face_place){place->face, place->u, place->v};
    uint32_t first = surface->split_first[place->face];
    if (!is_split_quad(surface, place->face))
        return (struct gd__face_place){first + place->corner, place->u, place->v};
    uint32_t child = surface->rules->child_at(place->u, place->v, 0, 0, 0);
    struct gd__chart whole = GD__CHART_WHOLE,
                     frame = gd__chart_child(&whole, &surface->rules->children[child]);
    double st[2];
    gd__chart_in(&frame, place->u, place->v, st);
    return (struct gd__face_place){first + child, st[0], st[1]};
}

/* Returns the control face of a base face, by binary search. */
static uint32_t control_face(const struct gd_subdivision *surface, uint32_t base)
{
    uint32_t low = 0, high = surface->control_faces;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (surface->split_first[middle] <= base)
            low = middle;
        else
            high = middle;
    }
    return low;
}

struct gd__chart gd__base_frame(const struct gd_subdivision *surface, uint32_t base, uint32_t *face,
                                uint32_t *corner)
{
    struct gd__chart whole = GD__CHART_WHOLE;
    *face = surface->split_first ? control_face(surface, base) : base;
    *corner = 0;
    if (!surface->split_first) return whole;
    uint32_t child = base - surface->split_first[*face];
    if (is_split_quad(surface, *face))
        return gd__chart_child(&whole, &surface->rules->children[child]);
    *corner = child;
    return whole;
}

struct gd_limit_point gd__place_of(const struct gd_subdivision *surface,
                                   const struct gd__face_place *local)
{
    struct gd_limit_point place;
    struct gd__chart frame = gd__base_frame(surface, local->face, &place.face, &place.corner);
    double uv[2];
    gd__chart_out(&frame, local->s, local->t, uv);
    place.u = uv[0];
    place.v = uv[1];
    return place;
}

static enum gd_status check_corner(const struct gd_subdivision *surface,
                                   const struct gd_limit_point *place, struct gd_detail *detail)
{
    if (place->face >= surface->control_faces)
        return gd_fail(detail, GD_OUT_OF_RANGE, "there is no face %u: the control mesh has %u",
                       place->face, surface->control_faces);
    bool polygon = surface->split_first && !is_split_quad(surface, place->face);
    uint32_t corners =
        polygon ? surface->split_first[place->face + 1] - surface->split_first[place->face] : 1;
    if (place->corner < corners) return GD_OK;
    if (!polygon)
        return gd_fail(detail, GD_OUT_OF_RANGE,
                       "face %u is one piece, whose corner must be 0, not %u", place->face,
                       place->corner);
    return gd_fail(detail, GD_OUT_OF_RANGE, "face %u has %u corners, and none of number %u",
                   place->face, corners, place->corner);
}

enum gd_status gd__place_check(const struct gd_subdivision *surface, struct gd_limit_point *place,
                               struct gd_detail *detail)
{
    enum gd_status status = check_corner(surface, place, detail);
    if (status) return status;
    bool triangle = surface->rules->arity == 3;
    double u = place->u, v = place->v, most = triangle ? u + v : fmax(u, v);
    if (!(u >= -GD_TOL_INPUT && v >= -GD_TOL_INPUT && most <= 1 + GD_TOL_INPUT))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "(u,v) = (%g,%g) is outside of the face: %s", u,
                       v,
                       triangle ? "both must be at least 0 and their sum at most 1"
                                : "both must be from 0 to 1");
    place->u = fmin(fmax(u, 0), 1);
    place->v = fmin(fmax(v, 0), triangle ? 1 - place->u : 1);
    return GD_OK;
}
