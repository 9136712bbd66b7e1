#include "proto/values/mesh.h"

#include <jansson.h>
#include <string.h>

#include "generated/queries.h"
#include "proto/http/accept.h"
#include "proto/http/page.h"
#include "proto/json/decode.h"
#include "proto/json/utf8.h"

/* --- name ------------------------------------------------------------------------------------- */

static bool is_name_character(char character, bool first)
{
    bool letter = (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z');
    bool digit = character >= '0' && character <= '9';
    return letter || digit || character == '_' || character == '-' || (character == '.' && !first);
}

bool proto_mesh_name_check(const char *name, size_t length, struct proto_problem *problem)
{
    bool good = length > 0 && length <= PROTO_MESH_NAME;
    for (size_t i = 0; good && i < length; i++) good = is_name_character(name[i], i == 0);
    return good ||
           proto_problem_set(
               problem, PROTO_PROBLEM_INVALID_REQUEST,
               "a name has 1 to %d characters of A-Z a-z 0-9 . _ - and does not begin with a dot",
               PROTO_MESH_NAME);
}

bool proto_name_decode(const json_t *value, const char *place, struct proto_name *out,
                       struct proto_problem *problem)
{
    if (!json_is_string(value))
        return proto_problem_refuse(problem, place, "expected the name of the mesh, a string");
    size_t length = json_string_length(value);
    if (!proto_mesh_name_check(json_string_value(value), length, problem))
        return proto_problem_at(problem, place);
    memcpy(out->text, json_string_value(value), length + 1);
    return true;
}

void proto_made_of_encode(struct proto_writer *writer, const char *key, const char *name,
                          const char *etag)
{
    proto_member_object(writer, key);
    if (name[0]) proto_member_string(writer, "name", name);
    proto_member_string(writer, "etag", etag);
    proto_write_object_end(writer);
}

/* --- caption ---------------------------------------------------------------------------------- */

static bool is_control(unsigned char first)
{
    return first < 0x20 || first == 0x7f;
}

bool proto_caption_check(const char *text, struct proto_problem *problem)
{
    size_t left = strlen(text), count = 0, length = 1;
    for (; left && length && !is_control((unsigned char)*text); text += length, left -= length) {
        length = proto_utf8_length(text, left);
        count += length > 0;
    }
    return (!left && count <= PROTO_CAPTION) ||
           proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST,
                             "a description has at most %d characters of UTF-8, none of them a "
                             "control character or a line break",
                             PROTO_CAPTION);
}

bool proto_caption_parse(const struct proto_parameters *parameters, const char **out,
                         struct proto_problem *problem)
{
    const char *text = proto_parameters_get(parameters, "description");
    if (text && !proto_caption_check(text, problem))
        return proto_problem_at(problem, "description");
    *out = text;
    return true;
}

bool proto_caption_decode(const json_t *document, const char **out, struct proto_problem *problem)
{
    static const char *const members[] = {"description", NULL};
    const json_t *value = json_object_get(document, "description");
    if (!proto_decode_object(document, "", members, problem)) return false;
    *out = json_is_null(value) ? "" : json_string_value(value);
    if (!value || (*out && proto_caption_check(*out, problem))) return true;
    return *out ? proto_problem_at(problem, "/description")
                : proto_problem_refuse(problem, "/description",
                                       "expected the description, a string, or null for none");
}

void proto_caption_encode(struct proto_writer *writer, const char *text)
{
    if (!*text || writer->failure) return;
    writer->size--; /* removes the closing brace */
    proto_member_string(writer, "description", text);
    proto_write_object_end(writer);
}

/* --- options of an upload --------------------------------------------------------------------- */

bool proto_mesh_options_parse(const struct proto_parameters *parameters,
                              struct proto_mesh_options *out, struct proto_problem *problem)
{
    struct proto_create_mesh_query query;
    if (!proto_parameters_check(parameters, proto_create_mesh_parameters, problem) ||
        !proto_create_mesh_query_parse(parameters, &query, problem))
        return false;
    *out = (struct proto_mesh_options){
        .format = query.has_format ? gd_format_by_name(proto_upload_format_words[query.format])
                                   : GD_FORMAT_ANY,
        .build = {.weld = query.has_weld,
                  .weld_tolerance = query.weld,
                  .repair_split = query.repair == PROTO_REPAIR_SPLIT,
                  .refuse_polygons = !query.triangulate}};
    return true;
}

enum gd_format proto_mesh_upload_format(const struct proto_mesh_options *options, const void *bytes,
                                        size_t size, const char *content_type)
{
    if (options->format != GD_FORMAT_ANY) return options->format;
    enum gd_format format = gd_format_recognise(bytes, size);
    if (format != GD_FORMAT_ANY || !content_type) return format;
    return gd_format_by_media_type(content_type);
}

/* --- format of a download --------------------------------------------------------------------- */

/* The formats of a download. Among formats of equal quality, the first one is chosen. */
static const enum gd_format content_formats[] = {GD_FORMAT_OBJ, GD_FORMAT_PLY, GD_FORMAT_OFF,
                                                 GD_FORMAT_STL, GD_FORMAT_GLB, GD_FORMAT_GLTF};
#define CONTENT_FORMATS (sizeof content_formats / sizeof content_formats[0])

static bool negotiate(const char *accept, enum gd_format *out, struct proto_problem *problem)
{
    unsigned best = 0;
    for (size_t i = 0; i < CONTENT_FORMATS; i++) {
        unsigned quality = proto_accept_quality(accept, gd_format_media_type(content_formats[i]));
        if (quality <= best) continue;
        best = quality;
        *out = content_formats[i];
    }
    return best > 0 || proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                                         "a mesh is available as model/obj, application/x-ply, "
                                         "text/x-off, model/stl, model/gltf-binary or "
                                         "model/gltf+json; see Accept");
}

bool proto_mesh_content_format(const struct proto_parameters *parameters, const char *accept,
                               enum gd_format *out, struct proto_problem *problem)
{
    struct proto_get_mesh_content_query query;
    if (!proto_parameters_check(parameters, proto_get_mesh_content_parameters, problem) ||
        !proto_get_mesh_content_query_parse(parameters, &query, problem))
        return false;
    if (!query.has_format) return negotiate(accept, out, problem);
    *out = gd_format_by_name(proto_content_format_words[query.format]);
    return true;
}

/* --- description ------------------------------------------------------------------------------ */

static void encode_boundary(struct proto_writer *writer, const struct gd_mesh *mesh, uint32_t loop)
{
    const struct gd_boundary boundary = gd_mesh_boundary(mesh, loop);
    proto_boundary_loop_encode(writer, &boundary);
}

void proto_mesh_encode_boundaries(struct proto_writer *writer,
                                  const struct proto_mesh_description *description)
{
    uint32_t count = gd_mesh_summary(description->mesh)->boundaries;
    proto_write_array_begin(writer);
    for (uint32_t loop = 0; loop < count && loop < PROTO_MESH_BOUNDARIES; loop++)
        encode_boundary(writer, description->mesh, loop);
    proto_write_array_end(writer);
}

void proto_boundaries_encode(struct proto_writer *writer, const struct gd_mesh *mesh, int64_t after,
                             uint32_t limit)
{
    uint32_t count = gd_mesh_summary(mesh)->boundaries;
    uint32_t first = after < (int64_t)count ? (uint32_t)(after + 1) : count;
    uint32_t end = count - first > limit ? first + limit : count;
    char next[PROTO_PAGE_NUMBER];
    proto_page_begin(writer, "boundaries");
    for (uint32_t loop = first; loop < end; loop++) encode_boundary(writer, mesh, loop);
    proto_page_end(writer, end < count ? proto_page_write_number(end - 1, next) : NULL);
}

char *proto_mesh_shorten(const char *description)
{
    json_t *document = json_loads(description, 0, NULL),
           *boundaries = json_object_get(document, "boundaries");
    json_int_t count = (json_int_t)json_array_size(boundaries);
    struct proto_writer writer;
    size_t size = 0;
    proto_writer_init(&writer, strlen(description));
    if (count > PROTO_MESH_BOUNDARIES &&
        !json_object_set_new(document, "boundary_count", json_integer(count))) {
        while (json_array_size(boundaries) > PROTO_MESH_BOUNDARIES)
            (void)json_array_remove(boundaries, json_array_size(boundaries) - 1);
        proto_write_document(&writer, document);
        proto_append(&writer, "", 1); /* the NUL */
    }
    json_decref(document);
    char *shortened = proto_writer_take(&writer, &size);
    proto_writer_free(&writer);
    return shortened;
}

#define COPIES_LISTED 64

/* Writes the first vertices that repair appended, each with the vertex that it copies. */
static void encode_copies(struct proto_writer *writer, const struct gd_mesh *mesh, uint32_t copies)
{
    uint32_t first = gd_mesh_summary(mesh)->index_count - copies;
    proto_member_uint(writer, "vertices_copied", copies);
    proto_member_array(writer, "copies");
    for (uint32_t i = first; i < first + copies && i < first + COPIES_LISTED; i++) {
        const uint32_t pair[] = {i, gd_mesh_original(mesh, (struct gd_vertex){i}).index};
        proto_write_indices(writer, pair, 2);
    }
    proto_write_array_end(writer);
}

/* Changes of one kind that a repair made. */
struct kind {
    const char *key;
    const struct gd_mended *mended;
    bool single; /* true if an element is one number instead of two */
};

static void encode_elements(struct proto_writer *writer, const struct kind *kind)
{
    if (kind->mended->count == 0) return;
    proto_member_array(writer, kind->key);
    for (uint32_t i = 0; i < kind->mended->listed; i++) {
        const uint32_t *element = kind->mended->elements[i];
        if (kind->single)
            proto_write_uint(writer, element[0]);
        else
            proto_write_indices(writer, element, 2);
    }
    proto_write_array_end(writer);
}

void proto_mesh_encode_repair(struct proto_writer *writer,
                              const struct proto_mesh_description *description)
{
    const struct gd_mesh_repair *repair = gd_mesh_repair(description->mesh);
    const struct kind kinds[] = {
        {"edges_split", &repair->edges_split, false},
        {"vertices_split", &repair->vertices_split, false},
        {"vertices_welded", &repair->vertices_welded, false},
        {"vertices_merged", &repair->vertices_merged, false},
        {"duplicate_faces", &repair->duplicate_faces, false},
        {"degenerate_faces", &repair->degenerate_faces, true},
        {"edges_flipped", &repair->edges_flipped, false},
        {"faces_cut", &repair->faces_cut, false},
        {"lines_skipped", &repair->lines_skipped, true},
    };
    proto_write_object_begin(writer);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        proto_member_uint(writer, kinds[i].key, kinds[i].mended->count);
    proto_member_number(writer, "largest_shift", repair->largest_shift);
    encode_copies(writer, description->mesh, repair->copies);
    proto_member_object(writer, "first");
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) encode_elements(writer, &kinds[i]);
    proto_write_object_end(writer);
    proto_write_object_end(writer);
}

void proto_mesh_encode_derived_from(struct proto_writer *writer,
                                    const struct proto_mesh_description *description)
{
    const char *operations = description->derived.operations;
    proto_write_object_begin(writer);
    if (description->derived.mesh[0])
        proto_member_string(writer, "mesh", description->derived.mesh);
    proto_member_string(writer, "etag", description->derived.etag);
    proto_member_number(writer, "largest_distance", description->derived.largest_distance);
    proto_write_key(writer, "operations");
    proto_write_raw(writer, operations, strlen(operations));
    proto_write_object_end(writer);
}
