#include "proto/queries/trims.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"

/* A loop being read: its curves, whose arrays it owns. */
struct loop {
    struct gd_trim_curve *curves;
    uint32_t count;
    char place[PROTO_PLACE];
};

struct trims {
    struct loop loops[GD_TRIM_LOOPS_MAX];
    uint32_t count;
    bool has_outer;
};

static void trims_free(struct trims *trims)
{
    for (uint32_t i = 0; i < trims->count; i++) {
        for (uint32_t k = 0; k < trims->loops[i].count; k++) {
            free((void *)trims->loops[i].curves[k].points);
            free((void *)trims->loops[i].curves[k].weights);
            free((void *)trims->loops[i].curves[k].knots);
        }
        free(trims->loops[i].curves);
    }
    free(trims);
}

/* Reads an array of numbers. */
static bool read_list(const json_t *value, size_t count, const char *place, double **out,
                      struct proto_problem *problem)
{
    *out = malloc((count + 1) * sizeof **out);
    if (!*out) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    return proto_read_numbers(value, count, *out) ||
           proto_problem_refuse(problem, place, "expected %zu numbers", count);
}

/* Reads points [u, v], or [u, v, weight] if the first one has a weight. */
static bool read_points(const json_t *list, const char *place, struct gd_trim_curve *out,
                        struct proto_problem *problem)
{
    size_t count = json_array_size(list);
    size_t columns = json_array_size(json_array_get(list, 0)) == 3 ? 3 : 2;
    if (count < 2 || count > GD_TRIM_POINTS_MAX)
        return proto_problem_refuse(problem, place, "expected 2 to %d points", GD_TRIM_POINTS_MAX);
    double(*points)[2] = malloc(count * sizeof *points);
    double *weights = columns == 3 ? malloc(count * sizeof *weights) : NULL;
    out->points = (const double(*)[2])points;
    out->weights = weights;
    out->count = (uint32_t)count;
    if (!points || (columns == 3 && !weights))
        return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (size_t i = 0; i < count; i++) {
        double numbers[3];
        char element[PROTO_PLACE];
        proto_place_of_element(element, place, i);
        if (!proto_read_numbers(json_array_get(list, i), columns, numbers))
            return proto_problem_refuse(problem, element, "expected [u, v]%s",
                                        columns == 3 ? " with a weight, as the first point" : "");
        memcpy(points[i], numbers, sizeof points[i]);
        if (weights) weights[i] = numbers[2];
    }
    return true;
}

static bool read_polyline(const json_t *value, const char *place, struct gd_trim_curve *out,
                          struct proto_problem *problem)
{
    static const char *const members[] = {"polyline", NULL};
    char inner[PROTO_PLACE];
    proto_place_of_member(inner, place, "polyline");
    out->degree = 1;
    return proto_decode_object(value, place, members, problem) &&
           read_points(json_object_get(value, "polyline"), inner, out, problem) &&
           (!out->weights ||
            proto_problem_refuse(problem, inner, "the points of a polyline are [u, v]"));
}

static bool read_weights(const json_t *value, const char *place, struct gd_trim_curve *out,
                         struct proto_problem *problem)
{
    char inner[PROTO_PLACE];
    double *weights = NULL;
    const json_t *list = json_object_get(value, "weights");
    proto_place_of_member(inner, place, "weights");
    if (!list) return true;
    if (out->weights)
        return proto_problem_refuse(problem, inner,
                                    "the control points have weights of their own; leave one of "
                                    "the two out");
    bool ok = read_list(list, out->count, inner, &weights, problem);
    out->weights = weights;
    return ok;
}

static bool read_knots(const json_t *value, const char *place, struct gd_trim_curve *out,
                       struct proto_problem *problem)
{
    char inner[PROTO_PLACE];
    double *knots = NULL;
    const json_t *list = json_object_get(value, "knots");
    proto_place_of_member(inner, place, "knots");
    if (!list) return true;
    size_t needed = out->count + (size_t)out->degree + 1;
    if (json_array_size(list) != needed)
        return proto_problem_refuse(problem, inner, "%u control points of degree %u need %zu knots",
                                    out->count, out->degree, needed);
    bool ok = read_list(list, needed, inner, &knots, problem);
    out->knots = knots;
    return ok;
}

static bool read_curve(const json_t *value, const char *place, struct gd_trim_curve *out,
                       struct proto_problem *problem)
{
    static const char *const members[] = {"degree", "knots", "controlPoints", "weights", NULL};
    char inner[PROTO_PLACE];
    double degree;
    if (json_object_get(value, "polyline")) return read_polyline(value, place, out, problem);
    proto_place_of_member(inner, place, "controlPoints");
    if (!proto_decode_object(value, place, members, problem) ||
        !proto_decode_number(value, place, "degree", &degree, problem))
        return false;
    if (!(degree >= 1 && degree <= GD_TRIM_DEGREE_MAX && degree == (uint32_t)degree))
        return proto_problem_refuse_member(
            problem, place, "degree", "expected a whole number from 1 to %d", GD_TRIM_DEGREE_MAX);
    out->degree = (uint32_t)degree;
    return proto_decode_member(value, place, "controlPoints", problem) &&
           read_points(json_object_get(value, "controlPoints"), inner, out, problem) &&
           read_weights(value, place, out, problem) && read_knots(value, place, out, problem);
}

static bool read_loop(const json_t *value, const char *place, struct trims *trims,
                      struct proto_problem *problem)
{
    struct loop *loop = &trims->loops[trims->count];
    size_t count = json_array_size(value);
    if (count < 1 || count > GD_TRIM_CURVES_MAX)
        return proto_problem_refuse(problem, place, "a loop is an array of 1 to %d curves",
                                    GD_TRIM_CURVES_MAX);
    loop->curves = calloc(count, sizeof *loop->curves);
    if (!loop->curves) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    snprintf(loop->place, sizeof loop->place, "%s", place);
    trims->count++;
    bool ok = true;
    for (size_t k = 0; k < count && ok; k++) {
        char inner[PROTO_PLACE];
        proto_place_of_element(inner, place, k);
        loop->count++;
        ok = read_curve(json_array_get(value, k), inner, &loop->curves[k], problem);
    }
    return ok;
}

static bool read_trims(const json_t *value, struct trims *trims, struct proto_problem *problem)
{
    static const char *const members[] = {"outer", "holes", NULL};
    const json_t *outer = json_object_get(value, "outer"), *holes = json_object_get(value, "holes");
    if (!proto_decode_object(value, "/trims", members, problem)) return false;
    size_t count = json_array_size(holes);
    if (holes && !json_is_array(holes))
        return proto_problem_refuse(problem, "/trims/holes", "expected an array of loops");
    if (count + (outer != NULL) < 1 || count + (outer != NULL) > GD_TRIM_LOOPS_MAX)
        return proto_problem_refuse(problem, "/trims", "expected 1 to %d loops: outer and holes",
                                    GD_TRIM_LOOPS_MAX);
    trims->has_outer = outer != NULL;
    bool ok = !outer || read_loop(outer, "/trims/outer", trims, problem);
    for (size_t i = 0; i < count && ok; i++) {
        char place[PROTO_PLACE];
        proto_place_of_element(place, "/trims/holes", i);
        ok = read_loop(json_array_get(holes, i), place, trims, problem);
    }
    return ok;
}

/* Trims the surface. The problem of a fault points to the faulty curve. */
static bool trim(const struct trims *trims, const struct gd_control *control,
                 struct gd_parametric **surface, struct proto_problem *problem)
{
    struct gd_trim_loop loops[GD_TRIM_LOOPS_MAX];
    struct gd_trim_fault fault;
    struct gd_parametric *trimmed;
    for (uint32_t i = 0; i < trims->count; i++)
        loops[i] = (struct gd_trim_loop){trims->loops[i].curves, trims->loops[i].count};
    const struct gd_trims data = {loops, trims->count, trims->has_outer};
    enum gd_status status = gd_parametric_trim(*surface, &data, control, &trimmed, &fault);
    if (status == GD_INVALID_ARGUMENT) {
        char place[PROTO_PLACE];
        proto_place_of_element(place, trims->loops[fault.loop].place, fault.curve);
        proto_problem_set(problem, PROTO_PROBLEM_INVALID_MESH, "%s", fault.detail.text);
        problem->reason = "trims";
        return proto_problem_at(problem, place);
    }
    if (status) return proto_problem_from_status(problem, status, &fault.detail);
    gd_parametric_release(*surface);
    *surface = trimmed;
    return true;
}

bool proto_trims_apply(const json_t *document, const struct gd_control *control,
                       struct gd_parametric **surface, struct proto_problem *problem)
{
    const json_t *value = json_object_get(document, "trims");
    if (!value) return true;
    struct trims *trims = calloc(1, sizeof *trims);
    if (!trims) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    bool ok = read_trims(value, trims, problem) && trim(trims, control, surface, problem);
    trims_free(trims);
    return ok;
}
