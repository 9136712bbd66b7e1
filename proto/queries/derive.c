#include "proto/queries/derive.h"

#include <string.h>

#include "generated/queries.h"

/* --- operations ------------------------------------------------------------------------------- */

/* Reads and writes the operations of one kind, without their name. */
struct operation {
    const char *name;
    const char *const *members;
    bool (*read)(const struct proto_object *object, struct gd_edit_step *out);
    void (*write)(struct proto_writer *writer, const struct gd_edit_step *step);
};

/* Names of the schemes, in the order of enum gd_subdivide_scheme. */
static const char *const subdivide_schemes[] = {"midpoint", "loop", "sqrt3", NULL};

static bool simplify_read(const struct proto_object *object, struct gd_edit_step *out)
{
    struct proto_simplify_request request;
    if (!proto_simplify_request_read(object, &request)) return false;
    if (!request.has_faces && !request.has_max_distance)
        return proto_problem_refuse(object->problem, object->place,
                                    "send faces (the most faces of the result), max_distance "
                                    "(its largest distance from the mesh), or both");
    out->simplify = (struct gd_simplify_options){
        request.has_faces ? request.faces : 0, request.has_max_distance ? request.max_distance : 0,
        request.keep_boundary};
    return true;
}

static void simplify_write(struct proto_writer *writer, const struct gd_edit_step *step)
{
    const struct gd_simplify_options *options = &step->simplify;
    if (options->faces) proto_member_uint(writer, "faces", options->faces);
    if (options->max_distance > 0)
        proto_member_number(writer, "max_distance", options->max_distance);
    if (options->keep_boundary) proto_member_bool(writer, "keep_boundary", true);
}

static bool components_read(const struct proto_object *object, struct gd_edit_step *out)
{
    struct proto_components_request request;
    if (!proto_components_request_read(object, &request)) return false;
    out->components = (struct gd_components_options){request.keep, request.skip};
    return true;
}

static void components_write(struct proto_writer *writer, const struct gd_edit_step *step)
{
    proto_member_uint(writer, "keep", step->components.keep);
    if (step->components.skip) proto_member_uint(writer, "skip", step->components.skip);
}

static bool subdivide_read(const struct proto_object *object, struct gd_edit_step *out)
{
    struct proto_subdivide_request request;
    unsigned scheme = GD_SUBDIVIDE_LOOP;
    const struct proto_rule rule = {.name = "scheme", .words = subdivide_schemes};
    if (!proto_subdivide_request_read(object, &request) || !proto_take_word(object, &rule, &scheme))
        return false;
    out->subdivide =
        (struct gd_subdivide_options){(enum gd_subdivide_scheme)scheme, request.levels};
    return true;
}

static void subdivide_write(struct proto_writer *writer, const struct gd_edit_step *step)
{
    proto_member_string(writer, "scheme", subdivide_schemes[step->subdivide.scheme]);
    proto_member_uint(writer, "levels", step->subdivide.levels);
}

#define DEGREE (3.14159265358979323846 / 180)

static bool smooth_read(const struct proto_object *object, struct gd_edit_step *out)
{
    struct proto_smooth_request request;
    if (!proto_smooth_request_read(object, &request)) return false;
    out->smooth =
        (struct gd_smooth_options){request.iterations, (enum gd_smooth_direction)request.along,
                                   request.feature_angle * DEGREE};
    return true;
}

static void smooth_write(struct proto_writer *writer, const struct gd_edit_step *step)
{
    proto_member_uint(writer, "iterations", step->smooth.iterations);
    proto_member_string(writer, "along", proto_along_words[step->smooth.direction]);
    proto_member_number(writer, "feature_angle", step->smooth.feature_angle / DEGREE);
}

static bool fill_read(const struct proto_object *object, struct gd_edit_step *out)
{
    struct proto_fill_request request;
    if (!proto_fill_request_read(object, &request)) return false;
    out->fill = (struct gd_fill_options){request.max_edges};
    return true;
}

static void fill_write(struct proto_writer *writer, const struct gd_edit_step *step)
{
    proto_member_uint(writer, "max_edges", step->fill.max_edges);
}

static const struct operation operations[] = {
    [GD_EDIT_SIMPLIFY] = {"simplify", proto_simplify_request_members, simplify_read,
                          simplify_write},
    [GD_EDIT_COMPONENTS] = {"components", proto_components_request_members, components_read,
                            components_write},
    [GD_EDIT_SUBDIVIDE] = {"subdivide", proto_subdivide_request_members, subdivide_read,
                           subdivide_write},
    [GD_EDIT_SMOOTH] = {"smooth", proto_smooth_request_members, smooth_read, smooth_write},
    [GD_EDIT_FILL] = {"fill", proto_fill_request_members, fill_read, fill_write},
};

#define OPERATIONS (sizeof operations / sizeof *operations)

static bool operation_refuse(const char *place, struct proto_problem *problem)
{
    char names[PROTO_PROBLEM_DETAIL] = "";
    for (size_t i = 0; i < OPERATIONS; i++) {
        strcat(names, " ");
        strcat(names, operations[i].name);
    }
    return proto_problem_refuse(problem, place, "an operation is one of:%s", names);
}

static bool operation_decode(const json_t *value, const char *place, struct gd_edit_step *out,
                             struct proto_problem *problem)
{
    char at[PROTO_PLACE];
    const struct proto_object object = {value, place, problem};
    proto_place_of_member(at, place, "operation");
    const char *name = json_string_value(json_object_get(value, "operation"));
    for (size_t i = 0; name && i < OPERATIONS; i++) {
        if (strcmp(name, operations[i].name)) continue;
        out->kind = (enum gd_edit_kind)i;
        return proto_decode_object(value, place, operations[i].members, problem) &&
               operations[i].read(&object, out);
    }
    return operation_refuse(json_is_object(value) ? at : place, problem);
}

/* Decodes the operations. A split is recorded as an additional operation. */
static bool operations_decode(const json_t *document, bool is_split, struct proto_edits *out,
                              struct proto_problem *problem)
{
    const json_t *list = json_object_get(document, "operations");
    size_t count = json_array_size(list), most = GD_EDIT_STEPS_MOST - is_split;
    if (!count || count > most)
        return proto_problem_refuse(problem, "/operations",
                                    "operations is an array of 1 to %zu operations%s", most,
                                    is_split ? " with split" : "");
    for (; out->count < count; out->count++) {
        char place[PROTO_PLACE];
        proto_place_of_element(place, "/operations", out->count);
        if (!operation_decode(json_array_get(list, out->count), place, &out->steps[out->count],
                              problem))
            return false;
    }
    return true;
}

static bool format_decode(const json_t *document, enum gd_format *out,
                          struct proto_problem *problem)
{
    const char *name = json_string_value(json_object_get(document, "format"));
    *out = name ? gd_format_by_name(name) : GD_FORMAT_ANY;
    return (*out != GD_FORMAT_ANY && *out != GD_FORMAT_JSON && *out != GD_FORMAT_3MF) ||
           proto_problem_refuse(problem, "/format", "expected one of: obj ply off stl glb gltf");
}

bool proto_derive_decode(const json_t *document, struct proto_derive *out,
                         struct proto_problem *problem)
{
    struct proto_derive_request request;
    struct proto_derive derive = {0};
    if (!proto_derive_request_decode(document, &request, problem) ||
        !operations_decode(document, request.split, &derive.edits, problem))
        return false;
    if (request.split && !request.has_mesh)
        return proto_problem_refuse(problem, "/split",
                                    "split makes several meshes; give mesh, the beginning of "
                                    "their names, in place of format");
    if (request.split && strlen(request.mesh.text) + strlen("-99") > PROTO_MESH_NAME)
        return proto_problem_refuse(problem, "/mesh", "the name is too long to be numbered");
    derive.mesh = request.mesh;
    derive.is_split = request.split;
    if (!request.has_mesh && !format_decode(document, &derive.format, problem)) return false;
    *out = derive;
    return true;
}

/* --- edits of an upload ----------------------------------------------------------------------- */

bool proto_edits_parse(const struct proto_parameters *parameters, struct proto_edits *out,
                       struct proto_problem *problem)
{
    struct proto_create_mesh_query query;
    struct gd_edit_step *next = out->steps;
    if (!proto_create_mesh_query_parse(parameters, &query, problem)) return false;
    if (query.has_components)
        *next++ = (struct gd_edit_step){.kind = GD_EDIT_COMPONENTS,
                                        .components = {.keep = (uint32_t)query.components}};
    if (query.has_fill)
        *next++ = (struct gd_edit_step){.kind = GD_EDIT_FILL,
                                        .fill = {.max_edges = (uint32_t)query.fill}};
    if (query.has_smooth)
        *next++ =
            (struct gd_edit_step){.kind = GD_EDIT_SMOOTH,
                                  .smooth = {(uint32_t)query.smooth, GD_SMOOTH_BOTH, 45 * DEGREE}};
    if (query.has_subdivide)
        *next++ = (struct gd_edit_step){
            .kind = GD_EDIT_SUBDIVIDE, .subdivide = {GD_SUBDIVIDE_LOOP, (uint32_t)query.subdivide}};
    if (query.has_simplify)
        *next++ = (struct gd_edit_step){.kind = GD_EDIT_SIMPLIFY,
                                        .simplify = {.faces = (uint32_t)query.simplify}};
    out->count = (uint32_t)(next - out->steps);
    return true;
}

/* --- operations as text ----------------------------------------------------------------------- */

void proto_edits_encode(struct proto_writer *writer, const struct proto_edits *edits)
{
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < edits->count; i++) {
        const struct operation *operation = &operations[edits->steps[i].kind];
        proto_write_object_begin(writer);
        proto_member_string(writer, "operation", operation->name);
        operation->write(writer, &edits->steps[i]);
        proto_write_object_end(writer);
    }
    proto_write_array_end(writer);
}
