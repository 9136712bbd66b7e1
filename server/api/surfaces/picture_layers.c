#include "server/api/surfaces/picture_layers.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generated/fields.h"
#include "server/query/handlers.h"
#include "server/surfaces/kinds.h"

#define FRAME_LENGTH  0.04 /* length of a frame's vectors, relative to the surface's diagonal */
#define CONTROL_WIDTH 1.2
#define FRAME_WIDTH   1.4
#define POINTS_MOST   4000000u /* points of all layers */

enum { MARKS_MOST = 10000 }; /* points of a layer */

/* The rule by which a kind of surface draws the layers of one form. All zero means that this kind
 * of surface has no such layers. */
struct layer_rule {
    bool is_known;
    const struct server_query_kind *kind; /* operation whose answer is drawn, or NULL */
    const char *const *fields;            /* fields of this answer that are read */
    const char *select;                   /* the fields that have lines; NULL means all */
    const char *wrapped;                  /* operation's member that receives the layer's body */
};

#define OWN                                                                                        \
    {                                                                                              \
        .is_known = true                                                                           \
    }
#define PART(kind, fields, selection)                                                              \
    {                                                                                              \
        true, &server_query_##kind, proto_##fields##_fields, selection, NULL                       \
    }

static const struct layer_rule mesh_rules[] = {
    [PROTO_PICTURE_LAYER_SURFACE] = OWN,
    [PROTO_PICTURE_LAYER_FIELD] = OWN,
    [PROTO_PICTURE_LAYER_ISOLINES] = OWN,
    [PROTO_PICTURE_LAYER_PATH] = PART(path, path, "path"),
    [PROTO_PICTURE_LAYER_TRACE] = PART(trace, trace, NULL),
    [PROTO_PICTURE_LAYER_EXP] = PART(exp, exp, NULL),
    [PROTO_PICTURE_LAYER_SPLINE] = PART(spline, spline, NULL),
    [PROTO_PICTURE_LAYER_CURVE] = PART(curve, curve_operation, NULL),
    [PROTO_PICTURE_LAYER_CURVE_DISTANCE] = PART(curve_distance, curve_distance, NULL),
    [PROTO_PICTURE_LAYER_VORONOI] = PART(voronoi, voronoi, "bisectors"),
    [PROTO_PICTURE_LAYER_CUT_LOCUS] = PART(cut_locus, cut_locus, "lines"),
    [PROTO_PICTURE_LAYER_CUT] = PART(cut, cut, NULL),
    [PROTO_PICTURE_LAYER_POINTS] = OWN,
    [PROTO_PICTURE_LAYER_CONTROL_NET] = {0}};

static const struct layer_rule subdivision_rules[] = {
    [PROTO_PICTURE_LAYER_SURFACE] = OWN,
    [PROTO_PICTURE_LAYER_FIELD] = OWN,
    [PROTO_PICTURE_LAYER_ISOLINES] = OWN,
    [PROTO_PICTURE_LAYER_PATH] = PART(subdivision_path, limit_path, NULL),
    [PROTO_PICTURE_LAYER_TRACE] = PART(subdivision_trace, limit_trace, NULL),
    [PROTO_PICTURE_LAYER_POINTS] = {true, &server_query_subdivision_evaluate,
                                    proto_limit_jet_fields, "xyz", "points"},
    [PROTO_PICTURE_LAYER_CONTROL_NET] = OWN};

static const struct layer_rule nurbs_rules[] = {
    [PROTO_PICTURE_LAYER_SURFACE] = OWN,
    [PROTO_PICTURE_LAYER_FIELD] = OWN,
    [PROTO_PICTURE_LAYER_ISOLINES] = OWN,
    [PROTO_PICTURE_LAYER_PATH] = PART(nurbs_geodesic, geodesic, NULL),
    [PROTO_PICTURE_LAYER_CURVE] = {.is_known = true, .wrapped = "curve"},
    [PROTO_PICTURE_LAYER_CURVE_DISTANCE] = PART(nurbs_curve_distance, geodesic, NULL),
    [PROTO_PICTURE_LAYER_POINTS] = {true, &server_query_nurbs_evaluate, proto_jet_fields, "xyz",
                                    "uv"},
    [PROTO_PICTURE_LAYER_POINT_CURVE_DISTANCE] = PART(nurbs_point_curve_distance, geodesic, NULL),
    [PROTO_PICTURE_LAYER_ISOPARAMETRIC] = OWN,
    [PROTO_PICTURE_LAYER_CONTROL_NET] = OWN};

enum { FORMS = PROTO_PICTURE_LAYER_CONTROL_NET + 1 };
static_assert(sizeof mesh_rules / sizeof *mesh_rules == FORMS &&
                  sizeof subdivision_rules / sizeof *subdivision_rules == FORMS &&
                  sizeof nurbs_rules / sizeof *nurbs_rules == FORMS,
              "each kind of surface has a rule for each form of layers");

static const struct layer_rule *rules_of(const struct server_query *query)
{
    const struct server_kind *kind = query->surface->record->kind;
    if (kind == &server_kind_subdivision) return subdivision_rules;
    return kind == &server_kind_nurbs ? nurbs_rules : mesh_rules;
}

/* Refuses a layer that only other kinds of surfaces have. The sentence of the problem lists the
 * layers of this kind. */
static bool rule_check(const struct server_query *query, const struct proto_picture_layer *layer)
{
    const struct layer_rule *rules = rules_of(query);
    char known[256] = "";
    if (rules[layer->form].is_known) return true;
    for (unsigned form = 0, length = 0; form < FORMS; form++)
        if (rules[form].is_known)
            length += (unsigned)snprintf(known + length, sizeof known - length, "%s%s",
                                         length ? ", " : "", proto_picture_layer_forms[form]);
    const char *name = proto_picture_layer_forms[layer->form];
    return proto_problem_refuse_member(query->problem, layer->place, name,
                                       "this kind of surface has no layer \"%s\"; it has: %s", name,
                                       known);
}

/* Changes the pointer of a problem in the body of layer i to a pointer into the figure's request.
 * Problems of memory, time and the daemon are not changed. */
static bool problem_place(const struct server_picture_layers *layers, uint32_t i,
                          const struct server_query *query)
{
    char inner[PROTO_PROBLEM_POINTER];
    struct proto_problem *problem = query->problem;
    const struct layer_rule *rule = &rules_of(query)[layers->wanted->items[i].form];
    bool is_clients = problem->status == 400 || problem->status == 413 || problem->status == 422;
    if (!is_clients) return false;
    const char *from = problem->has_pointer ? problem->pointer : "";
    if (rule->wrapped && *from == '/') from += 1 + strcspn(from + 1, "/");
    snprintf(inner, sizeof inner, "%s", from);
    problem->parameter[0] = '\0';
    proto_problem_at(problem, layers->wanted->items[i].place);
    proto_problem_descend(problem, proto_picture_layer_forms[layers->wanted->items[i].form]);
    size_t length = strlen(problem->pointer);
    snprintf(problem->pointer + length, sizeof problem->pointer - length, "%s", inner);
    return false;
}

/* --- decoding --------------------------------------------------------------------------------- */

/* Decodes the body of a part. If `wrapped` is set, the operation expects this body as its member
 * `wrapped`. */
static bool body_decode(struct server_query *part, const char *wrapped, json_t *body)
{
    if (!wrapped) return part->kind->decode(part, body);
    json_t *document = json_pack("{s:O}", wrapped, body);
    if (!document) return proto_problem_from_status(part->problem, GD_NO_MEMORY, NULL);
    bool ok = part->kind->decode(part, document);
    json_decref(document);
    return ok;
}

static bool part_decode(struct server_picture_layers *layers, struct server_query *query,
                        uint32_t i, json_t *body)
{
    const struct layer_rule *rule = &rules_of(query)[layers->wanted->items[i].form];
    struct server_query *part = server_query_create(rule->kind, query->exchange, query->surface);
    if (!part) return proto_problem_from_status(query->problem, GD_NO_MEMORY, NULL);
    layers->parts[i] = part;
    part->problem = query->problem;
    part->options = proto_options_of(rule->fields);
    part->is_drawn = true;
    server_query_keep_arrays(part);
    return (!rule->select ||
            proto_options_select(&part->options, rule->select, NULL, query->problem)) &&
           body_decode(part, rule->wrapped, body);
}

/* Makes an array of the labels. Empty labels become NULL. Returns false with a problem if there are
 * more labels than points. */
static bool labels_list(struct server_query *query, const struct proto_picture_layer *wanted,
                        struct gd_picture_layer *drawn)
{
    const struct proto_picture_label_list *labels = &wanted->labels;
    const char **texts;
    if (!labels->count) return true;
    if (labels->count > drawn->count) {
        char place[PROTO_KEPT_PLACE + sizeof "/labels"];
        snprintf(place, sizeof place, "%s/labels", wanted->place);
        return proto_problem_refuse(query->problem, place, "the layer has %u points, but %u labels",
                                    drawn->count, labels->count);
    }
    texts = server_query_allocate(query, drawn->count, sizeof *texts);
    if (!texts) return server_query_refuse(query, GD_BUDGET, "the figure");
    for (uint32_t k = 0; k < labels->count; k++)
        if (labels->items[k].text[0]) texts[k] = labels->items[k].text;
    drawn->labels = texts;
    return true;
}

/* Locates the points of a layer on a mesh. */
static bool points_decode(struct server_picture_layers *layers, struct server_query *query,
                          uint32_t i, const json_t *body)
{
    char place[PROTO_KEPT_PLACE + sizeof "/points"];
    struct proto_points points = {0};
    snprintf(place, sizeof place, "%s/points", layers->wanted->items[i].place);
    bool ok =
        proto_points_decode(&points, body, place, MARKS_MOST, query->problem) &&
        (points.count > 0 ||
         proto_problem_refuse(query->problem, place, "expected an array of at least one point")) &&
        proto_points_locate(query->surface->mesh, &points, &layers->located[i], query->problem);
    proto_points_free(&points);
    return ok;
}

/* Names the set of the layer `field` on a mesh. */
static bool set_decode(struct server_picture_layers *layers, struct server_query *query, uint32_t i,
                       const json_t *body)
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    char place[PROTO_KEPT_PLACE + sizeof "/field"];
    struct proto_set set;
    snprintf(place, sizeof place, "%s/field", wanted->place);
    layers->has_set = true;
    return proto_set_decode(body, place, &set, query->problem) &&
           server_field_query_of_set(query, &set,
                                     wanted->has_max_distance ? wanted->max_distance : 0);
}

static bool field_decode(struct server_picture_layers *layers, struct server_query *query,
                         uint32_t i, const json_t *body)
{
    if (rules_of(query) == mesh_rules) return set_decode(layers, query, i, body);
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    layers->surface->max_distance = wanted->has_max_distance ? wanted->max_distance : 0;
    return server_picture_surface_decode(layers->surface, query, body) ||
           problem_place(layers, i, query);
}

/* Decodes a curve in the domain of a NURBS surface. */
static bool curve_decode(struct server_picture_layers *layers, struct server_query *query,
                         uint32_t i, json_t *body)
{
    json_t *document = json_pack("{s:O}", "curve", body);
    if (!document) return proto_problem_from_status(query->problem, GD_NO_MEMORY, NULL);
    bool ok =
        proto_domain_curve_decode_member(document, "curve", &layers->curves[i], query->problem);
    json_decref(document);
    return ok || problem_place(layers, i, query);
}

static bool layer_decode(struct server_picture_layers *layers, struct server_query *query,
                         uint32_t i, json_t *body)
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    if (!rule_check(query, wanted)) return false;
    if (rules_of(query)[wanted->form].kind)
        return part_decode(layers, query, i, body) || problem_place(layers, i, query);
    if (wanted->form == PROTO_PICTURE_LAYER_FIELD) return field_decode(layers, query, i, body);
    if (wanted->form == PROTO_PICTURE_LAYER_CURVE) return curve_decode(layers, query, i, body);
    return wanted->form != PROTO_PICTURE_LAYER_POINTS || points_decode(layers, query, i, body);
}

bool server_picture_layers_decode(struct server_picture_layers *layers, struct server_query *query,
                                  const json_t *document)
{
    const json_t *list = json_object_get(document, "layers");
    for (uint32_t i = 0; i < layers->wanted->count; i++) {
        const char *name = proto_picture_layer_forms[layers->wanted->items[i].form];
        json_t *body = json_object_get(json_array_get(list, i), name);
        if (!layer_decode(layers, query, i, body)) return false;
    }
    return true;
}

/* --- drawing ---------------------------------------------------------------------------------- */

struct gd_picture_layer *server_drawn_add(struct server_picture_layers *layers, uint32_t i)
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    struct gd_picture_layer *drawn = &layers->drawn[layers->count++];
    *drawn = (struct gd_picture_layer){.id = i,
                                       .name = wanted->label.text[0] ? wanted->label.text : NULL,
                                       .colour = wanted->has_color ? wanted->color : 0,
                                       .width = wanted->has_width ? wanted->width : 0,
                                       .hidden = wanted->has_hidden ? (enum gd_hidden)wanted->hidden
                                                                    : GD_HIDDEN_FAINT};
    return drawn;
}

/* Allocates points that are freed with the figure's query. On failure, sets the problem and returns
 * NULL. */
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

uint32_t *server_drawn_reserve(struct server_picture_layers *layers, struct server_query *query,
                               uint32_t count, uint64_t points, struct gd_picture_layer *drawn)
{
    drawn->points = points_allocate(layers, query, points);
    uint32_t *first = server_query_allocate(query, count + (size_t)1, sizeof *first);
    if (drawn->points && !first) server_query_refuse(query, GD_BUDGET, "the figure");
    drawn->first = first;
    drawn->count = count;
    return drawn->points ? first : NULL;
}

struct gd_vec3 *server_drawn_lines(struct server_picture_layers *layers, struct server_query *query,
                                   const uint32_t shape[2], struct gd_picture_layer *drawn)
{
    uint32_t *first =
        server_drawn_reserve(layers, query, shape[0], (uint64_t)shape[0] * shape[1], drawn);
    for (uint32_t k = 0; first && k <= shape[0]; k++) first[k] = k * shape[1];
    return first ? (struct gd_vec3 *)drawn->points : NULL;
}

/* --- lines of an answer ----------------------------------------------------------------------- */

/* Sets the layer's lines from two arrays of the part's answer. */
static bool lines_take(struct server_picture_layers *layers, struct server_query *query,
                       const struct server_array *points, const struct server_array *first,
                       struct gd_picture_layer *drawn)
{
    uint32_t *begin =
        server_drawn_reserve(layers, query, (uint32_t)first->rows - 1, points->rows, drawn);
    if (!begin) return false;
    server_array_copy(points, (struct gd_vec3 *)drawn->points);
    memcpy(begin, first->source, first->rows * sizeof *begin);
    return true;
}

/* Adds the control vectors of a spline as lines, and the control points as marks. The lines are
 * pairs: from a point to its control point, and from the next control point to the next point. */
static bool controls_draw(struct server_picture_layers *layers, struct server_query *query,
                          uint32_t i, const struct server_arrays *arrays)
{
    struct gd_picture_layer *lines = server_drawn_add(layers, i);
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
    struct gd_picture_layer *marks = server_drawn_add(layers, i);
    *marks = *lines;
    marks->points = ends;
    marks->first = NULL;
    marks->width = SERVER_DRAWN_MARK;
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
    if (!rows) return server_query_refuse(query, GD_BUDGET, "the figure");
    const struct gd_mesh_summary *summary = gd_mesh_summary(query->surface->mesh);
    double length = FRAME_LENGTH * gd_vec3_length(gd_vec3_sub(summary->max, summary->min));
    frames->read(frames->source, 0, frames->rows, rows);
    for (int v = 0; v < VECTORS; v++) {
        struct gd_picture_layer *drawn = server_drawn_add(layers, i);
        *drawn = (struct gd_picture_layer){.id = i,
                                           .colour = GD_PICTURE_RGB(colours[v]),
                                           .width = FRAME_WIDTH,
                                           .hidden = drawn->hidden,
                                           .ends = GD_LINE_ENDS_ARROWS};
        struct gd_vec3 *points =
            server_drawn_lines(layers, query, (const uint32_t[]){count, 2}, drawn);
        if (!points) return false;
        for (uint32_t k = 0; k < count; k++) {
            const double *at = rows[(size_t)k * every], *along = at + 4 + 3 * (ptrdiff_t)v;
            points[2 * k] = (struct gd_vec3){at[1], at[2], at[3]};
            points[2 * k + 1] = gd_vec3_along(points[2 * k], length,
                                              (struct gd_vec3){along[0], along[1], along[2]});
        }
    }
    return true;
}

/* Adds the layer's points as marks, with their labels. */
static bool marks_draw(struct server_picture_layers *layers, struct server_query *query, uint32_t i,
                       const struct gd_vec3 *points, uint32_t count)
{
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    struct gd_picture_layer *drawn = server_drawn_add(layers, i);
    drawn->points = points;
    drawn->count = count;
    drawn->width = wanted->radius;
    return labels_list(query, wanted, drawn);
}

static bool located_draw(struct server_picture_layers *layers, struct server_query *query,
                         uint32_t i)
{
    const struct proto_located_points *located = &layers->located[i];
    struct gd_vec3 *points = points_allocate(layers, query, located->count);
    for (uint32_t k = 0; points && k < located->count; k++)
        points[k] = gd_point_position(located->mesh, &located->points[k]);
    return points && marks_draw(layers, query, i, points, located->count);
}

static bool part_draw(struct server_picture_layers *layers, struct server_query *query, uint32_t i)
{
    struct server_query *part = layers->parts[i];
    const struct proto_picture_layer *wanted = &layers->wanted->items[i];
    if (!part->kind->list_arrays(part)) return false;
    const struct server_arrays *arrays = &part->arrays;
    if (wanted->form == PROTO_PICTURE_LAYER_POINTS) {
        const struct server_array *xyz = server_arrays_find(arrays, "xyz");
        struct gd_vec3 *points = points_allocate(layers, query, xyz->rows);
        if (points) server_array_copy(xyz, points);
        return points && marks_draw(layers, query, i, points, (uint32_t)xyz->rows);
    }
    if (wanted->form == PROTO_PICTURE_LAYER_CUT)
        return server_pieces_draw(layers, query, i, arrays);
    struct gd_picture_layer *drawn = server_drawn_add(layers, i);
    if (!lines_take(layers, query, server_arrays_find(arrays, "points"),
                    server_arrays_find(arrays, "first"), drawn))
        return false;
    if (wanted->form == PROTO_PICTURE_LAYER_PATH && !drawn->count)
        return proto_problem_refuse(query->problem, "/to",
                                    "no path leads there: the points lie in different components "
                                    "of the surface; name points of one component");
    if (wanted->form == PROTO_PICTURE_LAYER_PATH && wanted->ends) drawn->ends = GD_LINE_ENDS_MARKS;
    return (!wanted->controls || controls_draw(layers, query, i, arrays)) &&
           (!wanted->frames || frames_draw(layers, query, i, server_arrays_find(arrays, "frames")));
}

/* Draws a layer whose content is not the answer of an operation. */
static bool own_draw(struct server_picture_layers *layers, struct server_query *query, uint32_t i)
{
    bool ok = true;
    switch (layers->wanted->items[i].form) {
    case PROTO_PICTURE_LAYER_POINTS:
        return located_draw(layers, query, i);
    case PROTO_PICTURE_LAYER_CURVE:
        ok = server_domain_curve_draw(layers, query, i);
        break;
    case PROTO_PICTURE_LAYER_ISOPARAMETRIC:
        ok = server_isoparametric_draw(layers, query, i);
        break;
    case PROTO_PICTURE_LAYER_CONTROL_NET:
        ok = server_control_net_draw(layers, query, i);
        break;
    default: /* layers of the surface itself */
        return true;
    }
    return ok || problem_place(layers, i, query);
}

/* --- solving ---------------------------------------------------------------------------------- */

/* Runs try_inline or solve of the current part. All layers have equal shares of the work. */
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
    if (!ok) problem_place(layers, i, query);
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
        if (!layers->parts[i]) {
            if (!own_draw(layers, query, i)) return SERVER_QUERY_FAILED;
            layers->next++;
        } else {
            enum server_query_turn turn = part_solve(layers, query, share);
            if (turn == SERVER_QUERY_FAILED) problem_place(layers, i, query);
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
        proto_located_points_free(&layers->located[i]);
        proto_domain_curve_free(&layers->curves[i]);
    }
}
