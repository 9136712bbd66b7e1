/* Writes glTF (gltf_write.h). The data is, in this order: positions, indices, colours, distances,
 * points of the lines, data of the moving object (gltf_motion.h), data of the layers
 * (gltf_layers.h). Each kind has one view and one accessor, except that each line and each layer
 * has its own accessor. */
#include "io/gltf_write.h"

#include <math.h>
#include <stdlib.h>

#include "io/base64.h"
#include "io/gltf_layers.h"
#include "io/gltf_motion.h"

#define CHUNK_JSON   UINT32_C(0x4E4F534A)
#define CHUNK_BINARY UINT32_C(0x004E4942)

enum { MOTION_ACCESSORS = 5 }; /* of the moving object, each with one view */

/* Grey, for vertices whose distance is unknown. */
static const struct gd_colour unknown = {0.5, 0.5, 0.5};

/* --- the origin ------------------------------------------------------------------------------- */

static bool are_floats(const double (*positions)[3], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (int axis = 0; axis < 3; axis++)
            if ((double)(float)positions[i][axis] != positions[i][axis]) return false;
    }
    return true;
}

static size_t point_count(const struct gd_result *result)
{
    return result->line_count ? result->first[result->line_count] : 0;
}

static const double (*mesh_positions(const struct gd_result *result))[3]
{
    return (const double(*)[3])(result->mesh ? result->mesh->positions : NULL);
}

static size_t mesh_count(const struct gd_result *result)
{
    return result->mesh ? result->mesh->position_count : 0;
}

/* Returns the centre of the box, rounded to a multiple of a power of two between a quarter and a
 * half of the box's size. So the result has few digits, and is 0 if the box is centred near the
 * origin. */
static double round_centre(double min, double max, double size)
{
    double step = ldexp(1, ilogb(size) - 1), centre = min / 2 + max / 2;
    return step > 0 && isfinite(centre / step) ? rint(centre / step) * step : centre;
}

/* Chooses the origin. It is zero if floats represent all positions exactly, so that a reader gets
 * the same positions. Otherwise it is near the middle of the box. This keeps the coordinates
 * relative to the origin small, so that they lose little by rounding to floats. */
static void find_origin(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    const double(*positions)[3] = mesh_positions(result);
    struct gd__gltf_box box = gd__gltf_empty_box;
    bool are_exact = are_floats(positions, mesh_count(result)) &&
                     are_floats(result->points, point_count(result));
    for (uint32_t i = 0; are_exact && i < result->layer_count; i++)
        are_exact = are_floats(result->layers[i].points, gd__gltf_layer_points(&result->layers[i]));
    if (are_exact) return;
    gd__gltf_widen(&box, positions, mesh_count(result));
    gd__gltf_widen(&box, result->points, point_count(result));
    for (uint32_t i = 0; i < result->layer_count; i++)
        gd__gltf_widen(&box, result->layers[i].points, gd__gltf_layer_points(&result->layers[i]));
    double size = 0;
    for (int axis = 0; axis < 3; axis++) size = fmax(size, box.max[axis] - box.min[axis]);
    for (int axis = 0; axis < 3; axis++)
        writing->origin[axis] = size > 0 && isfinite(size)
                                    ? round_centre(box.min[axis], box.max[axis], size)
                                    : box.min[axis] / 2 + box.max[axis] / 2;
}

/* --- data ------------------------------------------------------------------------------------- */

static void write_indices(const struct gd__gltf_writing *writing)
{
    const struct gd_polygons *mesh = writing->result->mesh;
    for (uint32_t corner = 0; corner < gd_polygons_corner_count(mesh); corner++)
        gd__output_little_endian(writing->binary, mesh->corners[corner], 4);
}

static uint64_t as_short(double component)
{
    return (uint64_t)lrint(component * 65535);
}

static void write_colours(const struct gd__gltf_writing *writing)
{
    for (uint32_t i = 0; i < writing->result->mesh->position_count; i++) {
        double distance = writing->result->distances[i];
        double part = writing->largest > 0 ? distance / writing->largest : 0;
        struct gd_colour colour = isfinite(distance) ? gd_colour_map(part) : unknown;
        gd__output_little_endian(writing->binary,
                                 as_short(colour.red) | as_short(colour.green) << 16 |
                                     as_short(colour.blue) << 32 | UINT64_C(65535) << 48,
                                 8);
    }
}

static void write_distances(const struct gd__gltf_writing *writing)
{
    for (uint32_t i = 0; i < writing->result->mesh->position_count; i++) {
        float distance = (float)writing->result->distances[i];
        gd__output_f32(writing->binary, isfinite(distance) ? distance : -1);
    }
}

/* Returns the number of points that are written for a line. A line becomes a strip, and a strip has
 * at least two points, so the point of a line of one point is written twice. */
static size_t strip_points(const struct gd_result *result, uint32_t line)
{
    size_t count = result->first[line + 1] - result->first[line];
    return count > 1 ? count : 2;
}

static void write_lines(const struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    for (uint32_t line = 0; line < result->line_count; line++) {
        uint32_t begin = result->first[line], count = result->first[line + 1] - begin;
        gd__gltf_write_positions(writing, result->points + begin, count);
        if (count == 1) gd__gltf_write_positions(writing, result->points + begin, 1);
    }
}

static void write_binary(const struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    if (result->mesh) {
        gd__gltf_write_positions(writing, mesh_positions(result), mesh_count(result));
        write_indices(writing);
    }
    if (result->distances) {
        write_colours(writing);
        write_distances(writing);
    }
    write_lines(writing);
    if (writing->keys) gd__motion_write(writing->binary, result, writing->origin);
    gd__gltf_layer_data(writing);
}

/* --- the document ----------------------------------------------------------------------------- */

static void describe_motion_views(struct gd__gltf_writing *writing)
{
    uint64_t keys = writing->keys;
    gd__gltf_view(writing, GD__AXIS_POINTS * GD__POSITION_BYTES, 0, GD__GLTF_VERTICES);
    gd__gltf_view(writing, GD__AXIS_POINTS * GD__COLOUR_BYTES, 0, GD__GLTF_VERTICES);
    gd__gltf_view(writing, keys * GD__TIME_BYTES, 0, 0);
    gd__gltf_view(writing, keys * GD__POSITION_BYTES, 0, 0);
    gd__gltf_view(writing, keys * GD__QUATERNION_BYTES, 0, 0);
}

static void describe_views(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    uint64_t vertices = mesh_count(result), points = 0;
    for (uint32_t line = 0; line < result->line_count; line++) points += strip_points(result, line);
    gd__gltf_text(writing, ",\"bufferViews\":[");
    if (result->mesh) {
        gd__gltf_view(writing, 12 * vertices, 0, GD__GLTF_VERTICES);
        gd__gltf_view(writing, 4 * (uint64_t)gd_polygons_corner_count(result->mesh), 0,
                      GD__GLTF_INDICES);
    }
    if (result->distances) {
        gd__gltf_view(writing, 8 * vertices, 0, GD__GLTF_VERTICES);
        gd__gltf_view(writing, 4 * vertices, 0, GD__GLTF_VERTICES);
    }
    if (points)
        gd__gltf_view(writing, 12 * points, result->line_count > 1 ? 12 : 0, GD__GLTF_VERTICES);
    if (writing->keys) describe_motion_views(writing);
    gd__gltf_layer_views(writing);
    gd__gltf_text(writing, "]");
}

static bool describe_mesh(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    size_t count = mesh_count(result);
    if (!gd__gltf_positions(writing, 0, 0, mesh_positions(result), count, count)) return false;
    gd__gltf_accessor_begin(writing, 1, 0, GD__GLTF_INT, gd_polygons_corner_count(result->mesh));
    gd__gltf_text(writing, ",\"type\":\"SCALAR\"}");
    if (!result->distances) return true;
    gd__gltf_accessor_begin(writing, 2, 0, GD__GLTF_SHORT, count);
    gd__gltf_text(writing, ",\"normalized\":true,\"type\":\"VEC4\"}");
    gd__gltf_accessor_begin(writing, 3, 0, GD__GLTF_FLOAT, count);
    gd__gltf_text(writing, ",\"type\":\"SCALAR\"}");
    return true;
}

/* `view` is the first view of the moving object. */
static void describe_motion_accessors(struct gd__gltf_writing *writing, uint32_t view)
{
    double length = (double)gd__motion_axis(writing->result);
    gd__gltf_accessor_begin(writing, view, 0, GD__GLTF_FLOAT, GD__AXIS_POINTS);
    gd__gltf_triple(writing, ",\"type\":\"VEC3\",\"min\":", (const double[]){0, 0, 0});
    gd__gltf_triple(writing, ",\"max\":", (const double[]){length, length, length});
    gd__gltf_text(writing, "}");
    gd__gltf_accessor_begin(writing, view + 1, 0, GD__GLTF_SHORT, GD__AXIS_POINTS);
    gd__gltf_text(writing, ",\"normalized\":true,\"type\":\"VEC4\"}");
    gd__gltf_accessor_begin(writing, view + 2, 0, GD__GLTF_FLOAT, writing->keys);
    gd__gltf_member(writing, ",\"type\":\"SCALAR\",\"min\":[0],\"max\":[", GD_RESULT_SECONDS);
    gd__gltf_text(writing, "]}");
    gd__gltf_accessor_begin(writing, view + 3, 0, GD__GLTF_FLOAT, writing->keys);
    gd__gltf_text(writing, ",\"type\":\"VEC3\"}");
    gd__gltf_accessor_begin(writing, view + 4, 0, GD__GLTF_FLOAT, writing->keys);
    gd__gltf_text(writing, ",\"type\":\"VEC4\"}");
}

static bool describe_accessors(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    uint32_t lines = (result->mesh ? 2 : 0) + (result->distances ? 2 : 0),
             motion = lines + (result->line_count > 0),
             layers = motion + (writing->keys ? MOTION_ACCESSORS : 0);
    bool fits = true;
    uint64_t offset = 0;
    gd__gltf_text(writing, ",\"accessors\":[");
    if (result->mesh) fits = describe_mesh(writing);
    for (uint32_t line = 0; fits && line < result->line_count; line++) {
        uint32_t begin = result->first[line], count = result->first[line + 1] - begin;
        size_t written = strip_points(result, line);
        fits = gd__gltf_positions(writing, lines, offset, result->points + begin, count, written);
        offset += 12 * written;
    }
    if (fits && writing->keys) describe_motion_accessors(writing, motion);
    if (fits) fits = gd__gltf_layer_accessors(writing, layers);
    gd__gltf_text(writing, "]");
    return fits;
}

static void write_level(struct gd__gltf_writing *writing, double level)
{
    gd__gltf_text(writing, ",\"extras\":{\"level\":");
    gd__output_double(writing->json, level);
    gd__gltf_text(writing, "}");
}

/* Writes the mesh of the moving object. `accessor` is its first one. */
static void describe_object(struct gd__gltf_writing *writing, uint32_t accessor)
{
    gd__gltf_member(writing, ",{\"primitives\":[{\"attributes\":{\"POSITION\":", accessor);
    gd__gltf_member(writing, ",\"COLOR_0\":", accessor + UINT64_C(1));
    gd__gltf_text(writing, "},\"mode\":1,\"material\":2}]}");
}

static void describe_sampler(struct gd__gltf_writing *writing, uint32_t input, uint32_t output)
{
    gd__gltf_member(writing, "{\"interpolation\":\"LINEAR\",\"input\":", input);
    gd__gltf_member(writing, ",\"output\":", output);
    gd__gltf_text(writing, "}");
}

/* `input` is the accessor of times. */
static void describe_animation(struct gd__gltf_writing *writing, uint32_t input)
{
    gd__gltf_text(writing,
                  ",\"animations\":[{\"name\":\"motion\",\"channels\":["
                  "{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"translation\"}},"
                  "{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"rotation\"}}],\"samplers\":[");
    describe_sampler(writing, input, input + 1);
    gd__gltf_text(writing, ",");
    describe_sampler(writing, input, input + 2);
    gd__gltf_text(writing, "]}]");
}

/* Writes the scene. The moving object is a child of the first node, so that its translations, which
 * are floats, are relative to the origin. */
static void describe_nodes(struct gd__gltf_writing *writing)
{
    gd__gltf_triple(
        writing,
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"geodesicd\"},\"scene\":0,\"scenes\":[{"
        "\"nodes\":[0]}],"
        "\"nodes\":[{\"mesh\":0,\"translation\":",
        writing->origin);
    uint32_t children = (writing->keys > 0) + gd__gltf_layer_count(writing->result);
    for (uint32_t i = 1; i <= children; i++)
        gd__gltf_member(writing, i > 1 ? "," : ",\"children\":[", i);
    gd__gltf_text(writing, children ? "]}" : "}");
    if (writing->keys) gd__gltf_text(writing, ",{\"name\":\"object\",\"mesh\":1}");
    writing->nodes = 1 + (writing->keys > 0);
    gd__gltf_layer_nodes(writing);
    gd__gltf_text(writing, "]");
}

static void describe_materials(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    gd__gltf_text(writing, ",\"materials\":[{\"name\":\"surface\",\"doubleSided\":true,"
                           "\"pbrMetallicRoughness\":{");
    if (result->colour && !result->distances) {
        gd__gltf_colour(writing, result->colour);
        gd__gltf_text(writing, ",");
    }
    gd__gltf_text(writing, "\"metallicFactor\":0,\"roughnessFactor\":0.9}},{\"name\":\"line\","
                           "\"pbrMetallicRoughness\":"
                           "{\"baseColorFactor\":[0.64,0.006,0.013,1],\"metallicFactor\":0}}");
    if (writing->keys)
        gd__gltf_text(writing,
                      ",{\"name\":\"axes\",\"pbrMetallicRoughness\":{\"metallicFactor\":0}}");
    gd__gltf_layer_materials(writing);
    gd__gltf_text(writing, "]");
}

static void describe_scene(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    uint32_t accessor = 0, primitives = 0;
    describe_nodes(writing);
    describe_materials(writing);
    gd__gltf_text(writing, ",\"meshes\":[{\"primitives\":[");
    if (result->mesh) {
        gd__gltf_text(writing, "{\"attributes\":{\"POSITION\":0");
        if (result->distances) gd__gltf_text(writing, ",\"COLOR_0\":2,\"_DISTANCE\":3");
        gd__gltf_text(writing, "},\"indices\":1,\"material\":0}");
        accessor = result->distances ? 4 : 2;
        primitives++;
    }
    for (uint32_t line = 0; line < result->line_count; line++) {
        gd__gltf_member(writing,
                        primitives++ ? ",{\"attributes\":{\"POSITION\":"
                                     : "{\"attributes\":{\"POSITION\":",
                        accessor++);
        gd__gltf_text(writing, "},\"mode\":3,\"material\":1");
        if (result->levels) write_level(writing, result->levels[line]);
        gd__gltf_text(writing, "}");
    }
    gd__gltf_text(writing, "]}");
    if (writing->keys) describe_object(writing, accessor);
    gd__gltf_layer_meshes(writing, 2 + (writing->keys > 0),
                          accessor + (writing->keys ? MOTION_ACCESSORS : 0));
    gd__gltf_text(writing, "]");
    if (writing->keys) describe_animation(writing, accessor + 2);
}

/* Writes the document up to the length of its one buffer, which the caller writes. */
static bool describe(struct gd__gltf_writing *writing)
{
    describe_scene(writing);
    describe_views(writing);
    bool fits = describe_accessors(writing);
    gd__gltf_member(writing, ",\"buffers\":[{\"byteLength\":", writing->bytes);
    return fits;
}

/* --- files ------------------------------------------------------------------------------------ */

static double largest_distance(const struct gd_result *result)
{
    double largest = 0;
    for (size_t i = 0; result->distances && i < mesh_count(result); i++)
        if (isfinite(result->distances[i])) largest = fmax(largest, result->distances[i]);
    return largest;
}

static enum gd_status begin(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    if ((!result->mesh && !result->line_count) || (result->distances && !result->mesh))
        return GD_INVALID_ARGUMENT;
    if (result->mesh && !gd_polygons_are_triangles(result->mesh)) return GD_NOT_TRIANGLES;
    writing->largest = largest_distance(result);
    find_origin(writing);
    writing->keys = gd__motion_count(result);
    if (writing->keys && !gd__motion_fits(result, writing->origin)) return GD_NON_FINITE;
    return describe(writing) ? GD_OK : GD_NON_FINITE;
}

static void write_chunk_header(struct gd__output *output, uint64_t size, uint32_t type)
{
    gd__output_little_endian(output, size, 4);
    gd__output_little_endian(output, type, 4);
}

static enum gd_status join_glb(struct gd__gltf_writing *writing)
{
    struct gd__output *json = writing->json, *output = writing->binary;
    gd__output_text(json, "}]}");
    while (!json->failed && json->size % 4) gd__output_text(json, " ");
    uint64_t length = 12 + 8 + json->size + 8 + writing->bytes;
    if (length > UINT32_MAX) return GD_TOO_LARGE;
    gd__output_text(output, "glTF");
    gd__output_little_endian(output, 2, 4);
    gd__output_little_endian(output, length, 4);
    write_chunk_header(output, json->size, CHUNK_JSON);
    gd__output_bytes(output, json->bytes, json->size);
    write_chunk_header(output, writing->bytes, CHUNK_BINARY);
    write_binary(writing);
    return GD_OK;
}

enum gd_status gd__glb_write(struct gd__output *output, const struct gd_result *result)
{
    struct gd__output json = {0};
    struct gd__gltf_writing writing = {.result = result, .json = &json, .binary = output};
    enum gd_status status = begin(&writing);
    if (status == GD_OK && json.failed) status = GD_NO_MEMORY;
    if (status == GD_OK) status = join_glb(&writing);
    free(json.bytes);
    return status;
}

static void write_base64(struct gd__output *output, const struct gd__output *binary)
{
    char encoded[4096];
    enum { PORTION = sizeof encoded / 4 * 3 };
    for (size_t begin = 0; begin < binary->size; begin += PORTION) {
        size_t size = binary->size - begin < PORTION ? binary->size - begin : PORTION;
        gd__base64_write(binary->bytes + begin, size, encoded);
        gd__output_bytes(output, encoded, gd__base64_characters(size));
    }
}

enum gd_status gd__gltf_write(struct gd__output *output, const struct gd_result *result)
{
    struct gd__output binary = {0};
    struct gd__gltf_writing writing = {.result = result, .json = output, .binary = &binary};
    enum gd_status status = begin(&writing);
    if (status != GD_OK) return status;
    write_binary(&writing);
    if (!binary.failed) {
        gd__output_text(output, ",\"uri\":\"data:application/octet-stream;base64,");
        write_base64(output, &binary);
        gd__output_text(output, "\"}]}\n");
    }
    status = binary.failed ? GD_NO_MEMORY : GD_OK;
    free(binary.bytes);
    return status;
}
