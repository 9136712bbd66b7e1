#include "proto/queries/trims.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generated/requests.h"
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

/* Reads points [u, v], or [u, v, weight] if the first one has a weight. */
static bool read_points(const json_t *curve, const char *member, const char *place,
                        struct gd_trim_curve *out, struct proto_problem *problem)
{
    char inner[PROTO_PLACE];
    const json_t *list = json_object_get(curve, member);
    size_t count = json_array_size(list);
    bool is_weighted = json_array_size(json_array_get(list, 0)) == 3;
    proto_place_of_member(inner, place, member);
    if (count < 2 || count > GD_TRIM_POINTS_MAX)
        return proto_problem_refuse(problem, inner, "expected 2 to %d points", GD_TRIM_POINTS_MAX);
    if (is_weighted && strcmp(member, "polyline") == 0)
        return proto_problem_refuse(problem, inner, "the points of a polyline are [u, v]");
    if (is_weighted && out->weights)
        return proto_problem_refuse_member(problem, place, "weights",
                                           "the control points have weights of their own; leave "
                                           "one of the two out");
    double(*points)[2] = malloc(count * sizeof *points);
    double *weights = is_weighted ? malloc(count * sizeof *weights) : NULL;
    out->points = (const double(*)[2])points;
    if (is_weighted) out->weights = weights;
    out->count = (uint32_t)count;
    if (!points || (is_weighted && !weights))
        return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (size_t i = 0; i < count; i++) {
        double numbers[3];
        char element[PROTO_PLACE];
        if (proto_read_numbers(json_array_get(list, i), is_weighted ? 3 : 2, numbers)) {
            memcpy(points[i], numbers, sizeof points[i]);
            if (is_weighted) weights[i] = numbers[2];
            continue;
        }
        proto_place_of_element(element, inner, i);
        return proto_problem_refuse(problem, element, "expected [u, v]%s",
                                    is_weighted ? " with a weight, as the first point" : "");
    }
    return true;
}

static bool read_curve(const json_t *value, const char *place, struct gd_trim_curve *out,
                       struct proto_problem *problem)
{
    struct proto_trim_curve read;
    if (!proto_trim_curve_decode(value, place, &read, problem)) return false;
    bool is_polyline = read.form == PROTO_TRIM_CURVE_POLYLINE;
    out->degree = is_polyline ? 1 : read.degree;
    out->knots = read.knots.items;
    out->weights = read.weights.items;
    if (!read_points(value, is_polyline ? "polyline" : "controlPoints", place, out, problem))
        return false;
    if (read.weights.count && read.weights.count != out->count)
        return proto_problem_refuse_member(problem, place, "weights", "expected %u numbers",
                                           out->count);
    size_t needed = out->count + (size_t)out->degree + 1;
    return !read.knots.count || read.knots.count == needed ||
           proto_problem_refuse_member(problem, place, "knots",
                                       "%u control points of degree %u need %zu knots", out->count,
                                       out->degree, needed);
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
