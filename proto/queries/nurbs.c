#include "proto/queries/nurbs.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generated/queries.h"
#include "generated/requests.h"
#include "proto/values/parametric.h"

/* --- trimming loops --------------------------------------------------------------------------- */

/* Trimming loops of a surface file (schema Trims). */

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

/* Replaces *surface by its trimmed surface if the document has the member `trims`. Problems:
 * invalid_request (not JSON of this form), invalid_mesh with the reason `trims` (faulty loops),
 * both at the place of the curve; insufficient_memory, deadline_exceeded. On failure *surface is
 * unchanged. */
static bool trims_apply(const json_t *document, const struct gd_control *control,
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

bool proto_nurbs_options_parse(const struct proto_parameters *parameters,
                               struct proto_nurbs_options *out, struct proto_problem *problem)
{
    struct proto_create_nurbs_query query;
    if (!proto_parameters_check(parameters, proto_create_nurbs_parameters, problem) ||
        !proto_create_nurbs_query_parse(parameters, &query, problem))
        return false;
    *out = (struct proto_nurbs_options){.has_convention =
                                            proto_parameters_get(parameters, "convention") != NULL,
                                        .convention = query.convention};
    return true;
}

/* --- the file --------------------------------------------------------------------------------- */

struct file { /* all zero means empty */
    struct gd_nurbs_data data;
    struct proto_nurbs_surface knots;
    double (*points)[3], *weights;
};

static void file_free(struct file *file)
{
    proto_nurbs_surface_free(&file->knots);
    free(file->points);
    free(file->weights);
}

static bool refuse_data(const char *reason, const char *sentence, struct proto_problem *problem)
{
    proto_problem_set(problem, PROTO_PROBLEM_INVALID_MESH, "%s", sentence);
    problem->reason = reason;
    return false;
}

static bool decode_convention(const json_t *document, const struct proto_nurbs_options *options,
                              struct file *file, struct proto_problem *problem)
{
    const json_t *value = json_object_get(document, "convention");
    const char *word = json_string_value(value);
    file->data.convention = (enum gd_nurbs_convention)options->convention;
    if (!value) return true;
    for (unsigned i = 0; proto_convention_words[i] && word; i++) {
        if (strcmp(word, proto_convention_words[i]) != 0) continue;
        file->data.convention = (enum gd_nurbs_convention)i;
        if (!options->has_convention || options->convention == i) return true;
        return proto_problem_refuse(
            problem, "/convention",
            "the file's convention is \"%s\", and the query string says %s; say one of them", word,
            proto_convention_words[options->convention]);
    }
    return proto_problem_refuse(problem, "/convention",
                                "a convention is \"canonical\", \"three\", \"verb\" or \"rhino\"");
}

/* Refuses the item (i, j) of a member, or the row i if j is SIZE_MAX. */
static bool refuse_at(const char *member, size_t i, size_t j, const char *expected,
                      struct proto_problem *problem)
{
    char index[24];
    proto_problem_refuse(problem, "", "expected %s", expected);
    proto_problem_descend(problem, member);
    snprintf(index, sizeof index, "%zu", i);
    proto_problem_descend(problem, index);
    if (j == SIZE_MAX) return false;
    snprintf(index, sizeof index, "%zu", j);
    return proto_problem_descend(problem, index);
}

/* Returns the member if it consists of non-empty rows of equal length. */
static const json_t *find_rows(const json_t *document, const char *member, uint32_t *rows,
                               uint32_t *columns, struct proto_problem *problem)
{
    const json_t *value = proto_decode_member(document, "", member, problem);
    if (!value) return NULL;
    size_t height = json_array_size(value), width = json_array_size(json_array_get(value, 0));
    if (height == 0 || width == 0 || height > GD_NURBS_COUNT_MAX || width > GD_NURBS_COUNT_MAX) {
        proto_problem_refuse(
            problem, "",
            "expected an array of rows, one for each control point in u, at most %d x %d",
            GD_NURBS_COUNT_MAX, GD_NURBS_COUNT_MAX);
        proto_problem_descend(problem, member);
        return NULL;
    }
    for (size_t i = 1; i < height; i++) {
        if (json_array_size(json_array_get(value, i)) == width) continue;
        refuse_at(member, i, SIZE_MAX, "a row as long as the first one", problem);
        return NULL;
    }
    *rows = (uint32_t)height;
    *columns = (uint32_t)width;
    return value;
}

/* Decodes points, all of them [x, y, z] or all [x, y, z, weight]. */
static bool decode_points(const json_t *document, struct file *file, struct proto_problem *problem)
{
    struct gd_nurbs_data *data = &file->data;
    const json_t *rows =
        find_rows(document, "controlPoints", &data->count_u, &data->count_v, problem);
    if (!rows) return false;
    size_t count = (size_t)data->count_u * data->count_v;
    bool is_weighted = json_array_size(json_array_get(json_array_get(rows, 0), 0)) == 4;
    file->points = malloc(count * sizeof *file->points);
    if (is_weighted) file->weights = malloc(count * sizeof *file->weights);
    if (!file->points || (is_weighted && !file->weights))
        return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (size_t i = 0; i < count; i++) {
        double point[4];
        const json_t *value =
            json_array_get(json_array_get(rows, i / data->count_v), i % data->count_v);
        if (!proto_read_numbers(value, is_weighted ? 4 : 3, point))
            return refuse_at("controlPoints", i / data->count_v, i % data->count_v,
                             is_weighted ? "[x, y, z, weight], as the first one" : "[x, y, z]",
                             problem);
        memcpy(file->points[i], point, sizeof *file->points);
        if (is_weighted) file->weights[i] = point[3];
    }
    data->points = (const double(*)[3])file->points;
    return true;
}

static bool decode_weights(const json_t *document, struct file *file, struct proto_problem *problem)
{
    struct gd_nurbs_data *data = &file->data;
    uint32_t rows, columns;
    data->weights = file->weights;
    if (!json_object_get(document, "weights")) return true;
    if (file->weights)
        return proto_problem_refuse(
            problem, "/weights",
            "the control points have weights of their own; leave one of the two out");
    const json_t *weights = find_rows(document, "weights", &rows, &columns, problem);
    if (!weights) return false;
    if (rows != data->count_u || columns != data->count_v)
        return proto_problem_refuse(problem, "/weights",
                                    "expected %u rows of %u weights, as there are control points",
                                    data->count_u, data->count_v);
    file->weights = malloc((size_t)rows * columns * sizeof *file->weights);
    if (!file->weights) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < rows; i++)
        if (!proto_read_numbers(json_array_get(weights, i), columns,
                                file->weights + (size_t)i * columns))
            return refuse_at("weights", i, SIZE_MAX, "a row of numbers", problem);
    data->weights = file->weights;
    return true;
}

static bool decode_file(const json_t *document, const struct proto_nurbs_options *options,
                        struct file *file, struct proto_problem *problem)
{
    static const char *const others[] = {"trim", "trimming", "trimCurves", "trimmingLoops",
                                         "loops"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (json_object_get(document, others[i]))
            return refuse_data("trimmed",
                               "trimming loops have another form: send them as the member trims, "
                               "{\"outer\": [curves], \"holes\": [[curves]]}",
                               problem);
    const struct proto_object object = {document, "", problem};
    struct proto_nurbs_surface *knots = &file->knots;
    if (!proto_decode_object(document, "", proto_nurbs_surface_members, problem) ||
        !decode_convention(document, options, file, problem) ||
        !proto_nurbs_surface_read(&object, knots))
        return false;
    file->data.degree_u = knots->degree_u;
    file->data.degree_v = knots->degree_v;
    file->data.knots_u = knots->knots_u.items;
    file->data.knots_v = knots->knots_v.items;
    file->data.knot_count_u = knots->knots_u.count;
    file->data.knot_count_v = knots->knots_v.count;
    return decode_points(document, file, problem) && decode_weights(document, file, problem);
}

/* --- the surface ------------------------------------------------------------------------------ */

static bool is_rational(const struct gd_nurbs_data *data)
{
    size_t count = (size_t)data->count_u * data->count_v;
    for (size_t i = 1; i < count && data->weights; i++)
        if (data->weights[i] != data->weights[0]) return true;
    return false;
}

static bool make_nurbs(const struct gd_nurbs_data *data, struct gd_parametric **out,
                       struct proto_nurbs_form *form, struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    enum gd_nurbs_flaw flaw = gd_nurbs_inspect(data, &detail);
    if (flaw) return refuse_data(gd_nurbs_flaw_name(flaw), detail.text, problem);
    enum gd_status status = gd_nurbs_create(data, out, &detail);
    if (status == GD_INVALID_ARGUMENT) return refuse_data("extent", detail.text, problem);
    if (status) return proto_problem_from_status(problem, status, &detail);
    *form = (struct proto_nurbs_form){.shape = "nurbs",
                                      .convention = proto_convention_words[data->convention],
                                      .degree = {data->degree_u, data->degree_v},
                                      .count = {data->count_u, data->count_v},
                                      .is_rational = is_rational(data)};
    return true;
}

static bool read_parametric(const json_t *document, const struct proto_nurbs_options *options,
                            struct gd_parametric **out, struct proto_nurbs_form *form,
                            struct proto_problem *problem)
{
    static const char *const members[] = {"parametric", "trims", NULL};
    struct proto_nurbs_form read = {0};
    if (options->has_convention)
        return proto_problem_refuse(problem, "convention",
                                    "only NURBS have a convention; leave it out");
    if (!proto_decode_object(document, "", members, problem) ||
        !proto_parametric_decode(json_object_get(document, "parametric"), "/parametric", out,
                                 &read.shape, problem))
        return false;
    *form = read;
    return true;
}

static bool read_nurbs(const json_t *document, const struct proto_nurbs_options *options,
                       struct gd_parametric **out, struct proto_nurbs_form *form,
                       struct proto_problem *problem)
{
    struct file file = {0};
    bool ok = decode_file(document, options, &file, problem) &&
              make_nurbs(&file.data, out, form, problem);
    file_free(&file);
    return ok;
}

bool proto_nurbs_read(const void *bytes, size_t size, const struct proto_nurbs_options *options,
                      struct gd_parametric **out, struct proto_nurbs_form *form,
                      struct proto_problem *problem)
{
    json_t *document = proto_decode_document_within(bytes, size, options->control, problem);
    if (!document) return false;
    bool ok = json_object_get(document, "parametric")
                  ? read_parametric(document, options, out, form, problem)
                  : read_nurbs(document, options, out, form, problem);
    if (ok && !trims_apply(document, options->control, out, problem)) {
        gd_parametric_release(*out);
        *out = NULL;
        ok = false;
    }
    json_decref(document);
    return ok;
}
