#include "proto/queries/nurbs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generated/queries.h"
#include "generated/requests.h"
#include "proto/json/writer.h"
#include "proto/queries/trims.h"
#include "proto/values/parametric.h"

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
    if (ok && !proto_trims_apply(document, options->control, out, problem)) {
        gd_parametric_release(*out);
        *out = NULL;
        ok = false;
    }
    json_decref(document);
    return ok;
}
