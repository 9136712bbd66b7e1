/* Finds the closest point. In each face whose box is near enough, applies Newton's method from each
 * local minimum of a grid. A minimum on the border of two faces is searched in only one of the two
 * faces. */
#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "subdiv/domain.h"
#include "subdiv/grid.h"

enum { SEED_LEVEL = 3, SEED_CELLS = 1 << SEED_LEVEL, SEED_ROW = SEED_CELLS + 1, ITERATIONS = 60 };

struct search {
    struct gd__walker walker;
    struct gd_vec3 xyz;
    struct gd__face_place best;
    struct gd_vec3 position;
    double square; /* squared distance */
};

/* Half of the squared distance as a function of (s, t): gradient and Hessian. */
struct model {
    double g[2], ss, st, tt;
    /* Hessian of the Gauss-Newton method: it ignores the surface's second derivatives, so it is
       never indefinite */
    double gauss_ss, gauss_st, gauss_tt;
    struct gd_vec3 position;
};

static double square_to(struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 way = gd_vec3_sub(a, b);
    return gd_vec3_dot(way, way);
}

/* Evaluates the model at a place. Returns false at a vertex without derivatives, where it only sets
 * out->position. */
static bool model_at(struct search *search, const struct gd__face_place *local, struct model *out)
{
    uint32_t corner;
    struct gd__vertex vertex;
    if (!gd__cell_at(&search->walker, local, 0, 0, &corner)) {
        gd__corner_limit(&search->walker, local->face, corner, &vertex);
        out->position = vertex.position;
        return false;
    }
    struct gd__jet jet = gd__cell_jet(&search->walker, local->s, local->t);
    struct gd_vec3 way = gd_vec3_sub(jet.p, search->xyz);
    double ss = gd_vec3_dot(jet.s, jet.s), st = gd_vec3_dot(jet.s, jet.t),
           tt = gd_vec3_dot(jet.t, jet.t);
    *out = (struct model){.g = {gd_vec3_dot(way, jet.s), gd_vec3_dot(way, jet.t)},
                          .ss = ss + gd_vec3_dot(way, jet.ss),
                          .st = st + gd_vec3_dot(way, jet.st),
                          .tt = tt + gd_vec3_dot(way, jet.tt),
                          .gauss_ss = ss,
                          .gauss_st = st,
                          .gauss_tt = tt,
                          .position = jet.p};
    return true;
}

static void newton_step(const struct model *m, double out[2])
{
    double a = m->ss, b = m->st, c = m->tt, determinant = a * c - b * b;
    if (!(a > 0 && determinant > 0))
        a = m->gauss_ss, b = m->gauss_st, c = m->gauss_tt, determinant = a * c - b * b;
    out[0] = (b * m->g[1] - c * m->g[0]) / determinant;
    out[1] = (b * m->g[0] - a * m->g[1]) / determinant;
}

static void step_along_side(const struct model *m, uint32_t arity, uint32_t k, double out[2])
{
    double a[2], b[2];
    gd__place_on_side(arity, k, 0, a);
    gd__place_on_side(arity, k, 1, b);
    double x = b[0] - a[0], y = b[1] - a[1], slope = x * m->g[0] + y * m->g[1];
    double bend = x * x * m->ss + 2 * x * y * m->st + y * y * m->tt;
    if (!(bend > 0)) bend = x * x * m->gauss_ss + 2 * x * y * m->gauss_st + y * y * m->gauss_tt;
    out[0] = -slope / bend * x;
    out[1] = -slope / bend * y;
}

/* Returns the first side that contains the place and that the step would cross, or GD_NONE if there
 * is none. */
static uint32_t blocked_by(uint32_t arity, const struct gd__face_place *local, const double step[2])
{
    for (uint32_t k = 0; k < arity; k++) {
        bool on = gd__line_at(arity, k, local->s, local->t) <= GD_TOL_FOOT;
        if (on && gd__line_slope(arity, k, step[0], step[1]) < 0) return k;
    }
    return GD_NONE;
}

/* Computes a descent step whose direction does not lead out of the face. Returns false if there is
 * no such step. */
static bool feasible_step(const struct model *m, uint32_t arity, const struct gd__face_place *local,
                          double step[2])
{
    newton_step(m, step);
    if (blocked_by(arity, local, step) == GD_NONE) return true;
    for (uint32_t k = 0; k < arity; k++) {
        if (gd__line_at(arity, k, local->s, local->t) > GD_TOL_FOOT) continue;
        step_along_side(m, arity, k, step);
        if (fabs(step[0]) + fabs(step[1]) > GD_TOL_FOOT &&
            blocked_by(arity, local, step) == GD_NONE)
            return true;
    }
    return false;
}

static struct gd__face_place subdiv_nearest_moved(uint32_t arity, const struct gd__face_place *from,
                                                  const double step[2], double part)
{
    struct gd__face_place to = {from->face, from->s + part * step[0], from->t + part * step[1]};
    to.s = fmin(fmax(to.s, 0), 1);
    to.t = fmin(fmax(to.t, 0), arity == 3 ? 1 - to.s : 1);
    return to;
}

/* Returns the fraction of a step up to the face's border, at most 1. */
static double part_inside(uint32_t arity, const struct gd__face_place *local, const double step[2])
{
    double part = 1;
    for (uint32_t k = 0; k < arity; k++) {
        double slope = gd__line_slope(arity, k, step[0], step[1]),
               height = gd__line_at(arity, k, local->s, local->t);
        if (slope < 0 && height + part * slope < 0) part = fmax(height, 0) / -slope;
    }
    return part;
}

static void note(struct search *search, const struct gd__face_place *local, struct gd_vec3 position)
{
    double square = square_to(position, search->xyz);
    if (!(square < search->square)) return;
    search->square = square;
    search->best = *local;
    search->position = position;
}

static void subdiv_nearest_descend(struct search *search, struct gd__face_place local)
{
    uint32_t arity = search->walker.surface->rules->arity;
    struct model here, there;
    bool smooth = model_at(search, &local, &here);
    if (!smooth) { /* at a vertex without derivatives, starts half a cell away from the vertex */
        note(search, &local, here.position);
        const double inwards[2] = {(arity == 3 ? 1.0 / 3 : 0.5) - local.s,
                                   (arity == 3 ? 1.0 / 3 : 0.5) - local.t};
        local = subdiv_nearest_moved(arity, &local, inwards, 0.5 / SEED_CELLS);
        smooth = model_at(search, &local, &here);
    }
    for (int i = 0; smooth && i < ITERATIONS; i++) {
        double step[2];
        if (!feasible_step(&here, arity, &local, step)) break;
        double part = part_inside(arity, &local, step),
               before = square_to(here.position, search->xyz);
        struct gd__face_place next = subdiv_nearest_moved(arity, &local, step, part);
        smooth = model_at(search, &next, &there);
        while (square_to(there.position, search->xyz) > before * (1 + GD_TOL_BETTER) &&
               part > GD_TOL_FOOT) {
            part /= 2;
            next = subdiv_nearest_moved(arity, &local, step, part);
            smooth = model_at(search, &next, &there);
        }
        if (square_to(there.position, search->xyz) > before * (1 + GD_TOL_BETTER)) break;
        local = next;
        here = there;
        if (part * fmax(fabs(step[0]), fabs(step[1])) <= GD_TOL_FOOT) break;
    }
    note(search, &local, here.position);
}

/* Returns true if no neighbour in the grid is nearer. */
static bool is_local_minimum(const double *squares, uint32_t arity, int i, int j)
{
    for (int di = -1; di <= 1; di++) {
        for (int dj = -1; dj <= 1; dj++) {
            int x = i + di, y = j + dj;
            bool inside = x >= 0 && y >= 0 &&
                          (arity == 3 ? x + y <= SEED_CELLS : x <= SEED_CELLS && y <= SEED_CELLS);
            if (inside && squares[x * SEED_ROW + y] < squares[i * SEED_ROW + j]) return false;
        }
    }
    return true;
}

static void search_face(struct search *search, uint32_t face)
{
    struct gd_vec3 positions[SEED_ROW * SEED_ROW], normals[SEED_ROW * SEED_ROW];
    double squares[SEED_ROW * SEED_ROW];
    uint32_t arity = search->walker.surface->rules->arity;
    const struct gd__grid_room room = {positions, normals};
    (void)gd__grid(&search->walker, face, SEED_LEVEL, &room, NULL);
    for (int i = 0; i <= SEED_CELLS; i++) {
        for (int j = 0; j <= (arity == 3 ? SEED_CELLS - i : SEED_CELLS); j++)
            squares[i * SEED_ROW + j] = square_to(positions[i * SEED_ROW + j], search->xyz);
    }
    for (int i = 0; i <= SEED_CELLS; i++) {
        for (int j = 0; j <= (arity == 3 ? SEED_CELLS - i : SEED_CELLS); j++) {
            if (!is_local_minimum(squares, arity, i, j)) continue;
            subdiv_nearest_descend(search, (struct gd__face_place){face, (double)i / SEED_CELLS,
                                                                   (double)j / SEED_CELLS});
        }
    }
}

static double square_to_box(const struct gd__box *box, struct gd_vec3 p)
{
    double x = fmax(fmax(box->low.x - p.x, p.x - box->high.x), 0);
    double y = fmax(fmax(box->low.y - p.y, p.y - box->high.y), 0);
    double z = fmax(fmax(box->low.z - p.z, p.z - box->high.z), 0);
    return x * x + y * y + z * z;
}

/* Returns the face whose box has the centre nearest to the point. The distance from this face is a
 * good first bound. */
static uint32_t first_face(const struct gd_subdivision *surface, struct gd_vec3 xyz)
{
    uint32_t found = 0;
    double least = INFINITY;
    for (uint32_t face = 0; face < surface->base.face_count; face++) {
        const struct gd__box *box = &surface->boxes[face];
        double square = square_to(gd_vec3_scale(gd_vec3_add(box->low, box->high), 0.5), xyz);
        if (square < least) least = square, found = face;
    }
    return found;
}

static enum gd_status search_all(struct search *search, const struct gd_control *control)
{
    const struct gd_subdivision *surface = search->walker.surface;
    uint32_t first = first_face(surface, search->xyz), faces = surface->base.face_count, looked = 0;
    enum gd_status status = GD_OK;
    search_face(search, first);
    for (uint32_t face = 0; !status && face < faces; face++) {
        bool near =
            face != first && square_to_box(&surface->boxes[face], search->xyz) < search->square;
        if (near) search_face(search, face);
        looked += near ? 4096 : 1;
        if (looked < 1 << 16) continue;
        looked = 0;
        status = gd_control_check(control, (double)face / faces);
    }
    return status;
}

enum gd_status gd_limit_nearest(const struct gd_subdivision *surface, struct gd_vec3 xyz,
                                const struct gd_control *control, struct gd_limit_closest *out,
                                struct gd_detail *detail)
{
    if (!gd_vec3_is_finite(xyz))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the point has a coordinate that is not a finite number");
    struct search search = {.xyz = xyz, .square = INFINITY};
    enum gd_status status =
        gd__walker_create(&search.walker, surface, gd__grid_stages(SEED_LEVEL), control);
    if (status) return status;
    status = search_all(&search, control);
    gd__walker_free(&search.walker);
    if (status) return status;
    if (!isfinite(search.square))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the point is so far away that the square of its distance overflows");
    *out = (struct gd_limit_closest){gd__place_of(surface, &search.best), search.position,
                                     sqrt(search.square)};
    return GD_OK;
}
