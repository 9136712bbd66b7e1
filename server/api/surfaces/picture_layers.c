#include "server/api/surfaces/picture_layers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generated/fields.h"
#include "server/query/handlers.h"

#define POINTS_MOST   4000000u /* points of all layers */
#define FRAME_LENGTH  0.04     /* of the vectors of a frame, relative to the surface's diagonal */
#define CONTROL_WIDTH 1.2
#define CONTROL_MARK  2.4
#define FRAME_WIDTH   1.4

/* How a form of layers becomes a part; all zero: it does not. */
struct part_kind {
    const struct server_query_kind *kind;
    const char *const *fields; /* of the operation's answer */
    const char *select;        /* the fields that have lines */
};

static const struct part_kind part_kinds[] = {
    [PROTO_PICTURE_LAYER_PATH] = {&server_query_path, proto_path_fields, "path"},
    [PROTO_PICTURE_LAYER_TRACE] = {&server_query_trace, proto_trace_fields, NULL},
    [PROTO_PICTURE_LAYER_EXP] = {&server_query_exp, proto_exp_fields, NULL},
    [PROTO_PICTURE_LAYER_SPLINE] = {&server_query_spline, proto_spline_fields, NULL},
    [PROTO_PICTURE_LAYER_CURVE] = {&server_query_curve, proto_curve_operation_fields, NULL},
    [PROTO_PICTURE_LAYER_CURVE_DISTANCE] = {&server_query_curve_distance,
                                            proto_curve_distance_fields, NULL},
    [PROTO_PICTURE_LAYER_VORONOI] = {&server_query_voronoi, proto_voronoi_fields, "bisectors"},
    [PROTO_PICTURE_LAYER_POINTS] = {0},
};

/* Moves a problem of the body of layer i into the figure's request. Problems of memory, time and
 * the daemon stay as they are. */
static bool problem_place(const struct server_picture_layers *layers, uint32_t i,
                          struct proto_problem *problem)
{
    char inner[PROTO_PROBLEM_POINTER];
    bool is_clients = problem->status == 400 || problem->status == 413 || problem->status == 422;
    if (!is_clients) return false;
    snprintf(inner, sizeof inner, "%s", problem->has_pointer ? problem->pointer : "");
    problem->parameter[0] = '\0';
    proto_problem_at(problem, layers->wanted->items[i].place);
    proto_problem_descend(problem, proto_picture_layer_name(&layers->wanted->items[i]));
    size_t length = strlen(problem->pointer);
    snprintf(problem->pointer + length, sizeof problem->pointer - length, "%s", inner);
    return false;
}

/* --- drawn layers ----------------------------------------------------------------------------- */

/* Adds a layer with the pen of the request's layer. */
static struct gd_picture_layer *drawn_add(struct server_picture_layers *layers, uint32_t i)
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    struct gd_picture_layer *drawn = &layers->drawn[layers->count++];
    *drawn = (struct gd_picture_layer){.id = i,
                                       .name = wanted->label.text[0] ? wanted->label.text : NULL,
                                       .colour = wanted->has_color ? wanted->color : 0,
                                       .width = wanted->has_width ? wanted->width : 0,
                                       .hidden = (enum gd_hidden)wanted->hidden};
    return drawn;
}

/* Returns room for points, which the figure's query holds. NULL with the problem. */
static struct gd_vec3 *points_allocate(struct server_picture_layers *layers,
                                       struct server_query *query, uint64_t count)
{
    layers->points += count;
    if (layers->points > POINTS_MOST) {
        (void)proto_problem_exceed(
            query->problem, NULL, POINTS_MOST,
            "the lines of this layer and of those before it have %llu points, more than %u; ask "
            "for fewer or shorter lines",
            (unsigned long long)layers->points, POINTS_MOST);
        return NULL;
    }
    struct gd_vec3 *points = server_query_allocate(query, count, sizeof *points);
    if (!points) server_query_refuse(query, GD_BUDGET, "the figure");
    return points;
}

/* --- decoding --------------------------------------------------------------------------------- */

static bool part_decode(struct server_picture_layers *layers, struct server_query *query,
                        uint32_t i, const json_t *body)
{
    const struct part_kind *kind = &part_kinds[layers->wanted->items[i].form];
    struct server_query *part = server_query_create(kind->kind, query->exchange, query->surface);
    if (!part) return proto_problem_from_status(query->problem, GD_NO_MEMORY, NULL);
    layers->parts[i] = part;
    part->problem = query->problem;
    part->options = proto_options_of(kind->fields);
    part->is_drawn = true;
    server_query_keep_arrays(part);
    return (!kind->select ||
            proto_options_select(&part->options, kind->select, NULL, query->problem)) &&
           kind->kind->decode(part, body);
}

/* Makes an array of the labels, of which empty ones become NULL. */
static bool labels_list(struct server_query *query, const struct proto_picture_layer *wanted,
                        struct gd_picture_layer *drawn)
{
    const struct proto_picture_label_list *labels = &wanted->labels;
    const char **texts;
    if (!labels->count) return true;
    texts = server_query_allocate(query, drawn->count, sizeof *texts);
    if (!texts) return server_query_refuse(query, GD_BUDGET, "the figure");
    for (uint32_t k = 0; k < labels->count && k < drawn->count; k++)
        if (labels->items[k].text[0]) texts[k] = labels->items[k].text;
    drawn->labels = texts;
    return true;
}

static bool points_list(struct server_picture_layers *layers, struct server_query *query,
                        uint32_t i)
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    const struct gd_mesh *mesh = query->surface->mesh;
    struct proto_located_points located;
    if (!proto_points_locate(mesh, &wanted->points, &located, query->problem)) return false;
    struct gd_vec3 *points = points_allocate(layers, query, located.count);
    for (uint32_t k = 0; points && k < located.count; k++)
        points[k] = gd_point_position(mesh, &located.points[k]);
    struct gd_picture_layer *drawn = drawn_add(layers, i);
    drawn->points = points;
    drawn->count = points ? located.count : 0;
    drawn->width = wanted->radius;
    proto_located_points_free(&located);
    return points && labels_list(query, wanted, drawn);
}

bool server_picture_layers_decode(struct server_picture_layers *layers, struct server_query *query,
                                  const json_t *document)
{
    const json_t *list = json_object_get(document, "layers");
    for (uint32_t i = 0; i < layers->wanted->count; i++) {
        const struct proto_picture_layer *wanted = &layers->wanted->items[i];
        const json_t *body =
            json_object_get(json_array_get(list, i), proto_picture_layer_name(wanted));
        if (part_kinds[wanted->form].kind && !part_decode(layers, query, i, body))
            return problem_place(layers, i, query->problem);
    }
    return true;
}

/* --- lines of an answer ----------------------------------------------------------------------- */

/* Copies rows of numbers. */
static void rows_copy(const struct server_array *array, void *out)
{
    size_t row = array->columns * sizeof(double);
    if (array->read) {
        array->read(array->source, 0, array->rows, out);
        return;
    }
    for (uint64_t i = 0; i < array->rows; i++)
        memcpy((char *)out + i * row,
               (const char *)array->source + i * (array->stride ? array->stride : row), row);
}

/* Sets the layer's lines from two arrays of the part's answer. */
static bool lines_take(struct server_picture_layers *layers, struct server_query *query,
                       const struct server_array *points, const struct server_array *first,
                       struct gd_picture_layer *drawn)
{
    struct gd_vec3 *positions = points_allocate(layers, query, points->rows);
    uint32_t *begin = server_query_allocate(query, first->rows, sizeof *begin);
    if (!positions) return false;
    if (!begin) return server_query_refuse(query, GD_BUDGET, "the figure");
    rows_copy(points, positions);
    memcpy(begin, first->source, first->rows * sizeof *begin);
    drawn->points = positions;
    drawn->first = begin;
    drawn->count = (uint32_t)first->rows - 1;
    return true;
}

/* Adds the control vectors of a spline as lines, and the control points as marks. The lines are
 * pairs: from a point to its control point, and from the next control point to the next point. */
static bool controls_draw(struct server_picture_layers *layers, struct server_query *query,
                          uint32_t i, const struct server_arrays *arrays)
{
    struct gd_picture_layer *lines = drawn_add(layers, i);
    *lines = (struct gd_picture_layer){.id = i,
                                       .colour = GD_PICTURE_RGB(0x3d4552),
                                       .width = CONTROL_WIDTH,
                                       .hidden = lines->hidden};
    if (!lines_take(layers, query, server_arrays_find(arrays, "controls"),
                    server_arrays_find(arrays, "controls_first"), lines))
        return false;
    struct gd_vec3 *ends = points_allocate(layers, query, lines->count);
    if (!ends) return false;
    for (uint32_t k = 0; k < lines->count; k++)
        ends[k] = lines->points[k % 2 ? lines->first[k] : lines->first[k + 1] - 1];
    struct gd_picture_layer *marks = drawn_add(layers, i);
    *marks = *lines;
    marks->points = ends;
    marks->first = NULL;
    marks->width = CONTROL_MARK;
    return true;
}

/* Adds three layers of arrows: the tangents, normals and binormals at every `every`-th sample. */
static bool frames_draw(struct server_picture_layers *layers, struct server_query *query,
                        uint32_t i, const struct server_array *frames)
{
    enum { NUMBERS = 14, VECTORS = 3 };
    static const uint32_t colours[VECTORS] = {0xc62828, 0x1a5fb4, 0x1b7f3b};
    uint32_t every = layers->wanted->items[i].frames,
             count = (uint32_t)((frames->rows + every - 1) / every);
    double(*rows)[NUMBERS] = server_query_allocate(query, frames->rows, sizeof *rows);
    uint32_t *first = server_query_allocate(query, count + (size_t)1, sizeof *first);
    if (!rows || !first) return server_query_refuse(query, GD_BUDGET, "the figure");
    const struct gd_mesh_summary *summary = gd_mesh_summary(query->surface->mesh);
    double length = FRAME_LENGTH * gd_vec3_length(gd_vec3_sub(summary->max, summary->min));
    frames->read(frames->source, 0, frames->rows, rows);
    for (uint32_t k = 0; k <= count; k++) first[k] = 2 * k;
    for (int v = 0; v < VECTORS; v++) {
        struct gd_vec3 *points = points_allocate(layers, query, 2 * (uint64_t)count);
        if (!points) return false;
        for (uint32_t k = 0; k < count; k++) {
            const double *at = rows[(size_t)k * every], *along = at + 4 + 3 * (ptrdiff_t)v;
            points[2 * k] = (struct gd_vec3){at[1], at[2], at[3]};
            points[2 * k + 1] = gd_vec3_along(points[2 * k], length,
                                              (struct gd_vec3){along[0], along[1], along[2]});
        }
        struct gd_picture_layer *drawn = drawn_add(layers, i);
        *drawn = (struct gd_picture_layer){.id = i,
                                           .points = points,
                                           .first = first,
                                           .count = count,
                                           .colour = GD_PICTURE_RGB(colours[v]),
                                           .width = FRAME_WIDTH,
                                           .hidden = drawn->hidden,
                                           .ends = GD_LINE_ENDS_ARROWS};
    }
    return true;
}

static bool part_draw(struct server_picture_layers *layers, struct server_query *query, uint32_t i)
{
    struct server_query *part = layers->parts[i];
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    if (!part->kind->list_arrays(part)) return false;
    const struct server_arrays *arrays = &part->arrays;
    struct gd_picture_layer *drawn = drawn_add(layers, i);
    if (!lines_take(layers, query, server_arrays_find(arrays, "points"),
                    server_arrays_find(arrays, "first"), drawn))
        return false;
    if (wanted->form == PROTO_PICTURE_LAYER_PATH && !drawn->count)
        return proto_problem_refuse(
            query->problem, "/to",
            "no path leads there: the points lie in different components of the surface");
    if (wanted->form == PROTO_PICTURE_LAYER_PATH && wanted->ends) drawn->ends = GD_LINE_ENDS_MARKS;
    return (!wanted->controls || controls_draw(layers, query, i, arrays)) &&
           (!wanted->frames || frames_draw(layers, query, i, server_arrays_find(arrays, "frames")));
}

/* --- solving ---------------------------------------------------------------------------------- */

/* Takes one turn of a part. Its share of the work is that of one of all layers. */
static enum server_query_turn part_solve(struct server_picture_layers *layers,
                                         struct server_query *query, double share)
{
    struct server_query *part = layers->parts[layers->next];
    part->exchange = query->exchange;
    part->problem = query->problem;
    part->share = share / layers->wanted->count;
    part->begun = layers->next * part->share;
    if (layers->is_begun) return server_query_solve(part);
    layers->is_begun = true;
    return server_query_try_inline(part);
}

/* Ends the current layer, whose part is DONE. */
static bool part_end(struct server_picture_layers *layers, struct server_query *query)
{
    uint32_t i = layers->next++;
    bool ok = part_draw(layers, query, i);
    if (!ok) problem_place(layers, i, query->problem);
    server_query_destroy(layers->parts[i]);
    layers->parts[i] = NULL;
    layers->is_begun = false;
    return ok;
}

enum server_query_turn server_picture_layers_solve(struct server_picture_layers *layers,
                                                   struct server_query *query, double share)
{
    while (layers->wanted && layers->next < layers->wanted->count) {
        uint32_t i = layers->next;
        if (layers->wanted->items[i].form == PROTO_PICTURE_LAYER_POINTS) {
            if (!points_list(layers, query, i)) return SERVER_QUERY_FAILED;
            layers->next++;
        } else if (!layers->parts[i]) {
            layers->next++;
        } else {
            enum server_query_turn turn = part_solve(layers, query, share);
            if (turn == SERVER_QUERY_FAILED) problem_place(layers, i, query->problem);
            if (turn == SERVER_QUERY_AGAIN) continue;
            if (turn != SERVER_QUERY_DONE) return turn;
            if (!part_end(layers, query)) return SERVER_QUERY_FAILED;
        }
    }
    return SERVER_QUERY_DONE;
}

void server_picture_layers_free(struct server_picture_layers *layers)
{
    for (uint32_t i = 0; i < PROTO_PICTURE_REQUEST_LAYERS_MOST; i++) {
        server_query_destroy(layers->parts[i]);
        layers->parts[i] = NULL;
    }
}
