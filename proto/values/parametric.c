#include "proto/values/parametric.h"

#include "generated/requests.h"

/* --- the shapes ------------------------------------------------------------------------------- */

#define ROWS_MOST (GD_GRAPH_DEGREE_MAX + 1)

/* Reads the coefficients of the graph in `shape`, whose place is "…/graph". */
static bool decode_coefficients(const json_t *graph, const char *place, double *out,
                                struct gd_graph *into, struct proto_problem *problem)
{
    const json_t *rows = proto_decode_member(graph, place, "coefficients", problem);
    if (!rows) return false;
    size_t count = json_array_size(rows), columns = json_array_size(json_array_get(rows, 0));
    bool ok = count >= 1 && count <= ROWS_MOST && columns >= 1 && columns <= ROWS_MOST;
    for (size_t i = 0; i < count && ok; i++)
        ok = proto_read_numbers(json_array_get(rows, i), columns, out + i * columns);
    into->coefficients = out;
    into->degree_u = (uint32_t)count - 1;
    into->degree_v = (uint32_t)columns - 1;
    return ok || proto_problem_refuse_member(
                     problem, place, "coefficients",
                     "coefficients[i][j] belongs to u^i v^j: at most %d rows of equal length, "
                     "each with at most as many numbers",
                     ROWS_MOST);
}

bool proto_revolution_check(const struct proto_object *object, struct proto_revolution *read)
{
    uint32_t points = read->control_points.count, weights = read->weights.count;
    if (!proto_knots_check(points, read->degree, read->knots.count, object->place, object->problem))
        return false;
    return !weights || weights == points ||
           proto_problem_refuse_member(object->problem, object->place, "weights",
                                       "there are %u control points, and %u weights", points,
                                       weights);
}

static enum gd_status make_revolution(const struct proto_revolution *read,
                                      struct gd_parametric **out, struct gd_detail *detail)
{
    const struct gd_profile profile = {.degree = read->degree,
                                       .count = read->control_points.count,
                                       .knots = read->knots.items,
                                       .points = (const double(*)[2])read->control_points.items,
                                       .weights = read->weights.items};
    return gd_parametric_revolution(&profile, out, detail);
}

/* Makes the surface; `place` is the place of its shape. */
static bool make(const struct proto_shape *shape, const json_t *value, const char *place,
                 struct gd_parametric **out, struct proto_problem *problem)
{
    double coefficients[ROWS_MOST * ROWS_MOST];
    struct gd_graph graph = {.u_range = shape->graph.u, .v_range = shape->graph.v};
    struct gd_detail detail = {0};
    if (shape->has_graph &&
        !decode_coefficients(json_object_get(value, "graph"), place, coefficients, &graph, problem))
        return false;
    enum gd_status status;
    if (shape->has_torus)
        status = gd_parametric_torus(shape->torus.major, shape->torus.minor, out, &detail);
    else if (shape->has_helicoid)
        status = gd_parametric_helicoid(shape->helicoid.pitch, shape->helicoid.u, shape->helicoid.v,
                                        out, &detail);
    else if (shape->has_graph)
        status = gd_parametric_graph(&graph, out, &detail);
    else
        status = make_revolution(&shape->revolution, out, &detail);
    if (!status) return true;
    proto_problem_from_status(problem, status, &detail);
    return status == GD_INVALID_ARGUMENT ? proto_problem_at(problem, place) : false;
}

bool proto_parametric_decode(const json_t *value, const char *place, struct gd_parametric **out,
                             const char **shape, struct proto_problem *problem)
{
    const struct proto_object object = {value, place, problem};
    struct proto_shape read;
    char inner[PROTO_PLACE];
    if (!proto_decode_object(value, place, proto_shape_members, problem)) return false;
    if (json_object_size(value) != 1)
        return proto_problem_refuse(
            problem, place,
            "a surface is exactly one of \"torus\", \"helicoid\", \"graph\", \"revolution\"");
    if (!proto_shape_read(&object, &read)) return false;
    unsigned i = 0;
    while (!proto_object_has(&object, proto_shape_members[i])) i++;
    proto_place_of_member(inner, place, proto_shape_members[i]);
    bool ok = make(&read, value, inner, out, problem);
    if (ok) *shape = proto_shape_members[i];
    proto_shape_free(&read);
    return ok;
}
