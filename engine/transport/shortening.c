#include "gd/shortening.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "transport/pieces.h"

enum { PIECES_MOST = 65536 };

void gd_shortening_free(struct gd_shortening *shortening)
{
    if (!shortening) return;
    gd_curve_free(&shortening->curve);
    *shortening = (struct gd_shortening){0};
}

struct shortening {
    struct gd__straightener straightener;
    /* `route` is the curve before a round, `line` the curve after it. The route of a closed curve
       ends at its first point. */
    struct gd__route route, line;
    bool closed;
    double length; /* length of the original curve */
    struct gd_detail *detail;
};

static void shortening_swap(struct shortening *s)
{
    struct gd__route route = s->route;
    s->route = s->line;
    s->line = route;
}

/* --- bends ------------------------------------------------------------------------------------ */

/* Returns the excess of a bend: the angle by which a line differs from a taut line at the point
 * `at`. The line arrives from the turn `back` and leaves in the turn `ahead`. */
static double shortening_excess(const struct gd_mesh *mesh, const struct gd_point *at, double back,
                                double ahead)
{
    struct gd__bend bend = gd__bend_of_turns(mesh, at, back, ahead);
    return fmax(M_PI - fmin(bend.left, bend.right), 0);
}

/* Computes the excess where a closed route begins and ends. */
static enum gd_status excess_at_joint(const struct shortening *s, double *out)
{
    const struct gd_mesh *mesh = s->straightener.mesh;
    const struct gd__route *route = &s->route;
    double back, ahead;
    enum gd_status status = gd__route_back(mesh, route->points, route->count, &back);
    if (!status) status = gd__route_ahead(mesh, route->points, route->count, &ahead);
    if (!status) *out = shortening_excess(mesh, &route->points[0], back, ahead);
    return status;
}

/* --- until it is a geodesic ------------------------------------------------------------------- */

/* Rotates a closed route to begin at another of its points. */
static enum gd_status begin_at(struct shortening *s, uint32_t at)
{
    const struct gd__route *route = &s->route;
    const struct gd_control *control = s->straightener.control;
    gd__route_clear(&s->line);
    enum gd_status status = gd__route_join(&s->line, route->points + at, route->count - at,
                                           route->length, false, control);
    if (!status) status = gd__route_join(&s->line, route->points, at + 1, 0, false, control);
    shortening_swap(s);
    return status;
}

/* Rotates a closed route to begin at another point, so that the next round straightens the bend at
 * the present beginning. If the route passes vertices, it begins at the vertex nearest to its
 * middle, because a geodesic may bend at a vertex. Otherwise it begins at its middle. */
static enum gd_status begin_elsewhere(struct shortening *s)
{
    uint32_t count = s->route.count, best = 0;
    for (uint32_t i = 1; i + 1 < count; i++) {
        bool is_nearer = !best || labs((long)i - count / 2) < labs((long)best - count / 2);
        if (s->route.points[i].kind == GD_POINT_VERTEX && is_nearer) best = i;
    }
    enum gd_status status = GD_OK;
    if (!best)
        status =
            gd__route_split(s->straightener.mesh, &s->route, 0.5, s->straightener.control, &best);
    return status ? status : begin_at(s, best);
}

static enum gd_status pull_tight(struct shortening *s)
{
    enum gd_status status = gd__straighten(&s->straightener, &s->route, &s->line);
    shortening_swap(s);
    if (!status && s->closed &&
        !(s->route.count > 2 && s->route.length > GD_TOL_VANISH * s->length))
        return gd_fail(s->detail, GD_INVALID_ARGUMENT,
                       "the curve shrinks to a point: nothing on the surface holds it, so it has "
                       "no closed geodesic");
    return status;
}

static enum gd_status close_up(struct shortening *s, struct gd_shortening *out)
{
    enum gd_status status = pull_tight(s);
    if (!status) status = excess_at_joint(s, &out->turn);
    for (out->rounds = 1;
         !status && out->turn > GD_TOL_CLOSED_TURN && out->rounds < GD_SHORTENING_ROUNDS;
         out->rounds++) {
        s->straightener.progress = (double)out->rounds / GD_SHORTENING_ROUNDS;
        status = gd_control_check(s->straightener.control, s->straightener.progress);
        if (!status) status = begin_elsewhere(s);
        if (!status) status = pull_tight(s);
        if (!status) status = excess_at_joint(s, &out->turn);
    }
    return status;
}

/* --- by rounds -------------------------------------------------------------------------------- */

/* Computes the lengths at which a round divides the curve. For open curves, the divisions of odd
 * rounds lie midway between those of even rounds. Closed curves have the same divisions in all
 * rounds, because they are rotated by half a piece instead. */
static uint32_t shortening_divide(const struct shortening *s, uint32_t pieces, bool is_odd,
                                  double *lengths)
{
    double step = s->route.length / pieces;
    uint32_t count = 0;
    lengths[count++] = 0;
    for (uint32_t i = 1; i < pieces + (is_odd && !s->closed); i++)
        lengths[count++] = (i - (is_odd && !s->closed ? 0.5 : 0)) * step;
    lengths[count++] = INFINITY;
    return count;
}

static enum gd_status shorten_once(struct shortening *s, uint32_t pieces, uint32_t round,
                                   double *lengths)
{
    bool is_odd = round % 2 == 1;
    enum gd_status status = GD_OK;
    if (is_odd && s->closed) {
        uint32_t at;
        status = gd__route_split(s->straightener.mesh, &s->route, 0.5 / pieces,
                                 s->straightener.control, &at);
        if (!status) status = begin_at(s, at);
    }
    if (status) return status;
    uint32_t count = shortening_divide(s, pieces, is_odd, lengths);
    status = gd__pieces_tighten(&s->straightener, &s->route, lengths, count, &s->line, NULL);
    shortening_swap(s);
    return status;
}

/* Computes the greatest excess at any point of the route. */
static enum gd_status greatest_excess(const struct shortening *s, double *out)
{
    const struct gd_mesh *mesh = s->straightener.mesh;
    const struct gd__route *route = &s->route;
    double back, ahead, greatest = 0;
    enum gd_status status = GD_OK;
    if (s->closed && route->count > 2) status = excess_at_joint(s, &greatest);
    for (uint32_t i = 1; i + 1 < route->count && !status; i++) {
        status = gd__route_back(mesh, route->points + i - 1, 2, &back);
        if (!status) status = gd__route_ahead(mesh, route->points + i, 2, &ahead);
        if (!status)
            greatest = fmax(greatest, shortening_excess(mesh, &route->points[i], back, ahead));
    }
    if (!status) *out = greatest;
    return status;
}

static enum gd_status shorten_by_rounds(struct shortening *s, uint32_t rounds, uint32_t pieces,
                                        struct gd_shortening *out)
{
    double *lengths = malloc((pieces + (size_t)2) * sizeof *lengths);
    enum gd_status status = lengths ? GD_OK : GD_NO_MEMORY;
    for (; out->rounds < rounds && s->route.count > 1 && !status; out->rounds++) {
        s->straightener.progress = (double)out->rounds / rounds;
        status = shorten_once(s, pieces, out->rounds, lengths);
    }
    free(lengths);
    return status ? status : greatest_excess(s, &out->turn);
}

/* --- public call ------------------------------------------------------------------------------ */

static enum gd_status shorten(struct shortening *s, uint32_t rounds, uint32_t pieces,
                              struct gd_shortening *out)
{
    if (rounds) return shorten_by_rounds(s, rounds, pieces ? pieces : GD_SHORTENING_PIECES, out);
    if (s->closed) return close_up(s, out);
    out->rounds = 1;
    return pull_tight(s);
}

enum gd_status gd_curve_shorten(const struct gd_mesh *mesh,
                                const struct gd_shortening_request *request,
                                const struct gd_control *control, struct gd_shortening *out,
                                struct gd_detail *detail)
{
    const struct gd_curve *curve = request->curve;
    struct shortening s = {.straightener = {.mesh = mesh, .control = control},
                           .closed = curve->closed,
                           .detail = detail};
    struct gd_shortening shortening = {0};
    if (request->pieces > PIECES_MOST)
        return gd_fail(detail, GD_TOO_LARGE, "a curve is shortened in at most %d pieces",
                       PIECES_MOST);
    enum gd_status status = gd__route_of_curve(mesh, curve, control, &s.route);
    s.length = s.route.length;
    if (!status) status = shorten(&s, request->rounds, request->pieces, &shortening);
    if (!status) {
        shortening.curve = gd__route_take_curve(&s.route, curve->closed);
        shortening.is_geodesic = shortening.turn <= GD_TOL_CLOSED_TURN;
        *out = shortening;
    }
    gd__route_free(&s.route);
    gd__route_free(&s.line);
    gd__straightener_free(&s.straightener);
    return status;
}
