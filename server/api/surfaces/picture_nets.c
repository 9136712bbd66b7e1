#include "server/api/surfaces/picture_layers.h"

#include "gd/nurbs.h"
#include "server/surfaces/kinds.h"

#define NET_COLOUR 0x3d4552
#define NET_WIDTH  1.2
#define ISO_WIDTH  1.0

enum {
    ISO_POINTS = 193,  /* points of a line of constant u or v */
    ISO_HALVINGS = 40, /* halvings of the interval in which such a line leaves the domain */
    CURVE_STEPS = 1024 /* steps of a curve in the domain; at least this many for a polyline */
};

/* --- lines of constant parameters ------------------------------------------------------------- */

static double axis_at(const struct gd_axis *axis, double part)
{
    return part < 1 ? axis->low + part * (axis->high - axis->low) : axis->high;
}

/* A line of constant u (side 0) or v (side 1). */
struct iso_line {
    const struct gd_parametric *surface;
    int side;
    double at; /* the constant parameter */
};

static bool iso_is_inside(const struct iso_line *line, double on)
{
    return gd_parametric_contains(line->surface, line->side ? on : line->at,
                                  line->side ? line->at : on);
}

/* Returns the parameter, between `inside` and `outside`, at which the line leaves the domain. */
static double iso_border(const struct iso_line *line, double inside, double outside)
{
    for (int i = 0; i < ISO_HALVINGS; i++) {
        double middle = (inside + outside) / 2;
        *(iso_is_inside(line, middle) ? &inside : &outside) = middle;
    }
    return inside;
}

static bool iso_add(const struct iso_line *line, double on, struct server_query *query,
                    struct gd_vec3 **points)
{
    struct gd_jet jet;
    enum gd_status status = gd_parametric_evaluate(line->surface, line->side ? on : line->at,
                                                   line->side ? line->at : on, &jet);
    if (status) return server_query_refuse(query, status, "the figure");
    *(*points)++ = jet.x;
    return true;
}

/* Adds the parts of a line that are inside the domain. */
static bool iso_draw_line(const struct iso_line *line, const struct gd_axis *along,
                          struct server_query *query, struct gd_vec3 **points,
                          struct gd_picture_layer *drawn)
{
    uint32_t *first = (uint32_t *)drawn->first;
    bool was_inside = false, ok = true;
    double before = 0;
    for (uint32_t t = 0; t < ISO_POINTS && ok; t++) {
        double on = axis_at(along, (double)t / (ISO_POINTS - 1));
        bool is_inside = iso_is_inside(line, on);
        if (t && is_inside && !was_inside)
            ok = iso_add(line, iso_border(line, on, before), query, points);
        if (was_inside && !is_inside)
            ok = iso_add(line, iso_border(line, before, on), query, points);
        if (ok && is_inside) ok = iso_add(line, on, query, points);
        if (is_inside ? t + 1 == ISO_POINTS : was_inside)
            first[++drawn->count] = (uint32_t)(*points - drawn->points);
        was_inside = is_inside;
        before = on;
    }
    return ok;
}

/* Adds lines at equal steps of one parameter: u (0) or v (1). */
static bool isoparametric_draw(struct server_picture_layers *layers, struct server_query *query,
                               uint32_t i, int side)
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    struct iso_line line = {.surface = server_nurbs_of(query->surface)->surface, .side = side};
    const struct gd_axis *axes[] = {gd_parametric_axis_u(line.surface),
                                    gd_parametric_axis_v(line.surface)},
                         *across = axes[side], *along = axes[!side];
    uint32_t parts = side ? wanted->isoparametric.v : wanted->isoparametric.u,
             count = parts ? parts + !across->closed : 0;
    struct gd_picture_layer *drawn = server_drawn_add(layers, i);
    /* at most every second sample begins a part, and a part has two more points: those at which the
       line crosses the border */
    struct gd_vec3 *points =
        server_drawn_lines(layers, query, (const uint32_t[]){count * ISO_POINTS / 2 + 1, 4}, drawn);
    if (!points) return false;
    drawn->count = 0;
    drawn->width = wanted->has_width ? wanted->width : ISO_WIDTH;
    if (!wanted->has_color) drawn->colour = GD_PICTURE_RGB(NET_COLOUR);
    if (!wanted->has_hidden) drawn->hidden = GD_HIDDEN_NONE;
    if (side) drawn->name = NULL;
    for (uint32_t k = 0; k < count; k++) {
        line.at = axis_at(across, (double)k / parts);
        if (!iso_draw_line(&line, along, query, &points, drawn)) return false;
    }
    return true;
}

bool server_isoparametric_draw(struct server_picture_layers *layers, struct server_query *query,
                               uint32_t i)
{
    return isoparametric_draw(layers, query, i, 0) && isoparametric_draw(layers, query, i, 1);
}

/* --- curves in the domain --------------------------------------------------------------------- */

/* Adds the points of a curve at equal steps of its parameter. The corners of a polyline, which have
 * whole parameters, are among them. */
static bool curve_add(struct server_picture_layers *layers, struct server_query *query, uint32_t i,
                      const struct gd_domain_curve *curve)
{
    const struct gd_parametric *surface = server_nurbs_of(query->surface)->surface;
    double low, high;
    gd_domain_curve_range(curve, &low, &high);
    uint32_t spans = layers->curves[i].form == PROTO_DOMAIN_CURVE_POLYLINE ? (uint32_t)high : 1;
    uint32_t steps = spans * ((CURVE_STEPS + spans - 1) / spans);
    struct gd_vec3 *points = server_drawn_lines(layers, query, (const uint32_t[]){1, steps + 1},
                                                server_drawn_add(layers, i));
    for (uint32_t k = 0; points && k <= steps; k++) {
        double uv[2];
        struct gd_jet jet;
        gd_domain_curve_at(curve, low + k * (high - low) / steps, uv);
        enum gd_status status = gd_parametric_evaluate(surface, uv[0], uv[1], &jet);
        if (status) return server_query_refuse(query, status, "the figure");
        points[k] = jet.x;
    }
    return points != NULL;
}

bool server_domain_curve_draw(struct server_picture_layers *layers, struct server_query *query,
                              uint32_t i)
{
    struct server_monitor monitor = server_query_monitor(query, 0, 0);
    const struct gd_control control = server_exchange_control(&monitor);
    struct gd_domain_curve *curve;
    if (!proto_domain_curve_locate(server_nurbs_of(query->surface)->surface, &layers->curves[i],
                                   &control, &curve, query->problem))
        return false;
    bool ok = curve_add(layers, query, i, curve);
    gd_domain_curve_release(curve);
    return ok;
}

/* --- control nets ----------------------------------------------------------------------------- */

static struct gd_vec3 *net_lines(struct server_picture_layers *layers, struct server_query *query,
                                 uint32_t i, const uint32_t shape[2])
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    struct gd_picture_layer *drawn = server_drawn_add(layers, i);
    drawn->width = wanted->has_width ? wanted->width : NET_WIDTH;
    if (!wanted->has_color) drawn->colour = GD_PICTURE_RGB(NET_COLOUR);
    return server_drawn_lines(layers, query, shape, drawn);
}

/* Adds control points with the pen of the last layer. */
static void net_marks(struct server_picture_layers *layers, uint32_t i,
                      const struct gd_vec3 *points, uint32_t count)
{
    const struct gd_picture_layer *lines = &layers->drawn[layers->count - 1];
    if (!layers->wanted->items[i].control_net.points) return;
    struct gd_picture_layer *marks = server_drawn_add(layers, i);
    *marks = *lines;
    marks->points = points;
    marks->first = NULL;
    marks->name = NULL;
    marks->count = count;
    marks->width = SERVER_DRAWN_MARK;
}

/* Adds the lines of a NURBS surface's control net in one direction: of constant i (0) or j (1).
 * Returns their points, or NULL. */
static const struct gd_vec3 *nurbs_lines(struct server_picture_layers *layers,
                                         struct server_query *query, uint32_t i,
                                         const uint32_t counts[2], int side)
{
    const struct gd_parametric *surface = server_nurbs_of(query->surface)->surface;
    const uint32_t shape[] = {counts[side], counts[!side]};
    struct gd_vec3 *points = net_lines(layers, query, i, shape), *next = points;
    if (!points) return NULL;
    if (side) layers->drawn[layers->count - 1].name = NULL;
    for (uint32_t k = 0; k < counts[side]; k++)
        for (uint32_t t = 0; t < counts[!side]; t++)
            *next++ = gd_nurbs_control_point(surface, side ? t : k, side ? k : t);
    return points;
}

static bool nurbs_net_draw(struct server_picture_layers *layers, struct server_query *query,
                           uint32_t i)
{
    uint32_t counts[2];
    if (!gd_nurbs_counts(server_nurbs_of(query->surface)->surface, counts))
        return proto_problem_refuse(query->problem, "",
                                    "only a surface of control points has a control net");
    const struct gd_vec3 *points = nurbs_lines(layers, query, i, counts, 0);
    if (!points || !nurbs_lines(layers, query, i, counts, 1)) return false;
    net_marks(layers, i, points, counts[0] * counts[1]);
    return true;
}

static bool subdivision_net_draw(struct server_picture_layers *layers, struct server_query *query,
                                 uint32_t i)
{
    const struct gd_subdivision *surface = server_subdivision_of(query->surface)->surface;
    const struct gd_subdivision_summary summary = gd_subdivision_summary(surface);
    const struct gd_vec3 *control = gd_subdivision_control_points(surface);
    struct gd_vec3 *points = net_lines(layers, query, i, (const uint32_t[]){summary.edge_count, 2});
    uint32_t(*edges)[2] =
        points ? server_query_allocate(query, summary.edge_count, sizeof *edges) : NULL;
    if (points && !edges) server_query_refuse(query, GD_BUDGET, "the figure");
    if (!edges) return false;
    gd_subdivision_control_edges(surface, edges);
    for (uint32_t k = 0; k < summary.edge_count; k++)
        for (int end = 0; end < 2; end++) points[2 * k + end] = control[edges[k][end]];
    net_marks(layers, i, control, summary.vertex_count);
    return true;
}

bool server_control_net_draw(struct server_picture_layers *layers, struct server_query *query,
                             uint32_t i)
{
    return query->surface->record->kind == &server_kind_nurbs
               ? nurbs_net_draw(layers, query, i)
               : subdivision_net_draw(layers, query, i);
}
