#include "proto/values/parametric.h"

#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"
#include "proto/json/writer.h"
#include "proto/values/uv.h"

/* Converts the engine's status for the numbers at a place into success or a problem. */
static bool finish(enum gd_status status, const struct gd_detail *detail, const char *place,
                   struct proto_problem *problem)
{
    if (!status) return true;
    proto_problem_from_status(problem, status, detail);
    return status == GD_INVALID_ARGUMENT ? proto_problem_at(problem, place) : false;
}

static bool decode_ranges(const json_t *value, const char *place, double u[2], double v[2],
                          struct proto_problem *problem)
{
    return proto_decode_numbers(value, place, "u", 2, u, problem) &&
           proto_decode_numbers(value, place, "v", 2, v, problem);
}

static bool decode_torus(const json_t *value, const char *place, struct gd_parametric **out,
                         struct proto_problem *problem)
{
    static const char *const members[] = {"major", "minor", NULL};
    struct gd_detail detail = {0};
    double major, minor;
    return proto_decode_object(value, place, members, problem) &&
           proto_decode_number(value, place, "major", &major, problem) &&
           proto_decode_number(value, place, "minor", &minor, problem) &&
           finish(gd_parametric_torus(major, minor, out, &detail), &detail, place, problem);
}

static bool decode_helicoid(const json_t *value, const char *place, struct gd_parametric **out,
                            struct proto_problem *problem)
{
    static const char *const members[] = {"pitch", "u", "v", NULL};
    struct gd_detail detail = {0};
    double pitch, u[2], v[2];
    return proto_decode_object(value, place, members, problem) &&
           proto_decode_number(value, place, "pitch", &pitch, problem) &&
           decode_ranges(value, place, u, v, problem) &&
           finish(gd_parametric_helicoid(pitch, u, v, out, &detail), &detail, place, problem);
}

/* --- graph of a polynomial -------------------------------------------------------------------- */

#define ROWS_MOST (GD_GRAPH_DEGREE_MAX + 1)

struct polynomial {
    uint32_t rows, columns;
    /* row i holds the coefficients of u^i and begins at i * columns */
    double coefficients[ROWS_MOST * ROWS_MOST];
};

static bool refuse_coefficients(const char *place, struct proto_problem *problem)
{
    return proto_problem_refuse_member(
        problem, place, "coefficients",
        "coefficients[i][j] belongs to u^i v^j: rows of equal length, %d at most, "
        "and at most so many "
        "numbers in each",
        ROWS_MOST);
}

static bool decode_coefficients(const json_t *value, const char *place, struct polynomial *out,
                                struct proto_problem *problem)
{
    const json_t *rows = proto_decode_member(value, place, "coefficients", problem);
    if (!rows) return false;
    size_t count = json_array_size(rows), columns = json_array_size(json_array_get(rows, 0));
    if (count < 1 || count > ROWS_MOST || columns < 1 || columns > ROWS_MOST)
        return refuse_coefficients(place, problem);
    for (size_t i = 0; i < count; i++) {
        const json_t *row = json_array_get(rows, i);
        if (!proto_read_numbers(row, columns, out->coefficients + i * columns))
            return refuse_coefficients(place, problem);
    }
    out->rows = (uint32_t)count;
    out->columns = (uint32_t)columns;
    return true;
}

static bool decode_graph(const json_t *value, const char *place, struct gd_parametric **out,
                         struct proto_problem *problem)
{
    static const char *const members[] = {"coefficients", "u", "v", NULL};
    struct polynomial polynomial;
    struct gd_detail detail = {0};
    double u[2], v[2];
    return proto_decode_object(value, place, members, problem) &&
           decode_coefficients(value, place, &polynomial, problem) &&
           decode_ranges(value, place, u, v, problem) &&
           finish(
               gd_parametric_graph(&(struct gd_graph){polynomial.rows - 1, polynomial.columns - 1,
                                                      polynomial.coefficients, u, v},
                                   out, &detail),
               &detail, place, problem);
}

/* --- surface of revolution -------------------------------------------------------------------- */

struct profile { /* all zero: empty */
    uint32_t degree, knot_count, weight_count;
    struct proto_uvs points; /* (radius, height) */
    double *knots, *weights;
};

static bool check_profile(const struct profile *profile, const char *place,
                          struct proto_problem *problem)
{
    if (!proto_knots_check(profile->points.count, profile->degree, profile->knot_count, place,
                           problem))
        return false;
    return !profile->weights || profile->weight_count == profile->points.count ||
           proto_problem_refuse_member(problem, place, "weights",
                                       "there are %u control points, and %u weights",
                                       profile->points.count, profile->weight_count);
}

static bool decode_profile(const json_t *value, const char *place, struct profile *profile,
                           struct proto_problem *problem)
{
    static const char *const members[] = {"degree", "knots", "control_points", "weights", NULL};
    return proto_decode_object(value, place, members, problem) &&
           proto_decode_index(value, place, "degree", &profile->degree, problem) &&
           proto_uvs_decode(value, place, "control_points", PROTO_PROFILE_POINTS, &profile->points,
                            problem) &&
           proto_numbers_decode(value, place, "knots", 2 * PROTO_PROFILE_POINTS, &profile->knots,
                                &profile->knot_count, problem) &&
           (!json_object_get(value, "weights") ||
            proto_numbers_decode(value, place, "weights", PROTO_PROFILE_POINTS, &profile->weights,
                                 &profile->weight_count, problem)) &&
           check_profile(profile, place, problem);
}

static bool decode_revolution(const json_t *value, const char *place, struct gd_parametric **out,
                              struct proto_problem *problem)
{
    struct profile read = {0};
    struct gd_detail detail = {0};
    bool ok = decode_profile(value, place, &read, problem);
    if (ok) {
        const struct gd_profile profile = {.degree = read.degree,
                                           .count = read.points.count,
                                           .knots = read.knots,
                                           .points = (const double(*)[2])read.points.items,
                                           .weights = read.weights};
        ok = finish(gd_parametric_revolution(&profile, out, &detail), &detail, place, problem);
    }
    proto_uvs_free(&read.points);
    free(read.knots);
    free(read.weights);
    return ok;
}

/* --- any of them ------------------------------------------------------------------------------ */

static const struct shape {
    const char *name;
    bool (*decode)(const json_t *value, const char *place, struct gd_parametric **out,
                   struct proto_problem *problem);
} shapes[] = {{"torus", decode_torus},
              {"helicoid", decode_helicoid},
              {"graph", decode_graph},
              {"revolution", decode_revolution}};

bool proto_parametric_decode(const json_t *value, const char *place, struct gd_parametric **out,
                             const char **shape, struct proto_problem *problem)
{
    static const char *const members[] = {"torus", "helicoid", "graph", "revolution", NULL};
    if (!proto_decode_object(value, place, members, problem)) return false;
    if (json_object_size(value) != 1)
        return proto_problem_refuse(
            problem, place,
            "a surface is exactly one of \"torus\", \"helicoid\", \"graph\", \"revolution\"");
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        const json_t *body = json_object_get(value, shapes[i].name);
        char inner[PROTO_PLACE];
        if (!body) continue;
        proto_place_of_member(inner, place, shapes[i].name);
        if (!shapes[i].decode(body, inner, out, problem)) return false;
        *shape = shapes[i].name;
        return true;
    }
    return false; /* not reached: the member is one of them */
}

/* --- the domain ------------------------------------------------------------------------------- */

static void encode_axis(struct proto_writer *writer, const char *key, const struct gd_axis *axis)
{
    proto_member_object(writer, key);
    proto_member_numbers(writer, "range", (double[]){axis->low, axis->high}, 2);
    proto_member_bool(writer, "closed", axis->closed);
    proto_member_uint(writer, "pieces", axis->line_count + UINT64_C(1));
    proto_member_bool(writer, "pole_low", axis->pole_low);
    proto_member_bool(writer, "pole_high", axis->pole_high);
    proto_write_object_end(writer);
}

void proto_domain_encode(struct proto_writer *writer, const struct gd_parametric *surface)
{
    proto_write_object_begin(writer);
    encode_axis(writer, "u", gd_parametric_axis_u(surface));
    encode_axis(writer, "v", gd_parametric_axis_v(surface));
    proto_write_object_end(writer);
}
