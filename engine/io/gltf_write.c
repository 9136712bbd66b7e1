/* Writes glTF (gltf_write.h). The data is, in this order: positions, indices, colours, distances,
 * points of the lines, data of the moving object (gltf_motion.h). Each kind has one view and one
 * accessor, except that each line has its own accessor. */
#include "io/gltf_write.h"

#include <math.h>
#include <stdlib.h>

#include "gd/colour_map.h"
#include "io/base64.h"
#include "io/gltf_motion.h"

#define CHUNK_JSON   UINT32_C(0x4E4F534A)
#define CHUNK_BINARY UINT32_C(0x004E4942)

enum { TYPE_SHORT = 5123, TYPE_INT = 5125, TYPE_FLOAT = 5126 };
enum { TARGET_VERTICES = 34962, TARGET_INDICES = 34963 };
enum { MOTION_VIEWS = 5 }; /* of the moving object, each with one accessor */

/* Grey, for vertices whose distance is unknown. */
static const struct gd_colour unknown = {0.5, 0.5, 0.5};

struct box {
    double min[3], max[3];
};

struct writing {
    const struct gd_result *result;
    double origin[3];                      /* the origin, which is subtracted from all positions */
    double largest;                        /* largest distance */
    uint32_t keys;                         /* of the moving object; 0 if there is none */
    uint32_t views, accessors, primitives; /* written so far */
    uint64_t bytes;                        /* total bytes of the views written so far */
    struct gd__output *json, *binary;
};

/* --- the origin ------------------------------------------------------------------------------- */

static const struct box empty_box = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};

static void widen(struct box *box, const double (*positions)[3], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            box->min[axis] = fmin(box->min[axis], positions[i][axis]);
            box->max[axis] = fmax(box->max[axis], positions[i][axis]);
        }
    }
}

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
static void find_origin(struct writing *writing)
{
    const struct gd_result *result = writing->result;
    const double(*positions)[3] = mesh_positions(result);
    struct box box = empty_box;
    if (are_floats(positions, mesh_count(result)) &&
        are_floats(result->points, point_count(result)))
        return;
    widen(&box, positions, mesh_count(result));
    widen(&box, result->points, point_count(result));
    double size = 0;
    for (int axis = 0; axis < 3; axis++) size = fmax(size, box.max[axis] - box.min[axis]);
    for (int axis = 0; axis < 3; axis++)
        writing->origin[axis] = size > 0 && isfinite(size)
                                    ? round_centre(box.min[axis], box.max[axis], size)
                                    : box.min[axis] / 2 + box.max[axis] / 2;
}

static float from_origin(const struct writing *writing, const double position[3], int axis)
{
    return (float)(position[axis] - writing->origin[axis]);
}

/* Computes the box of the positions after they are rounded to floats. Returns false if a position
 * is beyond the range of floats. */
static bool float_box(const struct writing *writing, const double (*positions)[3], size_t count,
                      struct box *out)
{
    struct box box = empty_box;
    for (size_t i = 0; i < count; i++) {
        double written[1][3];
        for (int axis = 0; axis < 3; axis++) {
            written[0][axis] = (double)from_origin(writing, positions[i], axis);
            if (!isfinite(written[0][axis] + writing->origin[axis])) return false;
        }
        widen(&box, (const double(*)[3])written, 1);
    }
    *out = box;
    return true;
}

/* --- data ------------------------------------------------------------------------------------- */

static void write_positions(const struct writing *writing, const double (*positions)[3],
                            size_t count)
{
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            gd__output_f32(writing->binary, from_origin(writing, positions[i], axis));
}

static void write_indices(const struct writing *writing)
{
    const struct gd_polygons *mesh = writing->result->mesh;
    for (uint32_t corner = 0; corner < gd_polygons_corner_count(mesh); corner++)
        gd__output_little_endian(writing->binary, mesh->corners[corner], 4);
}

static uint64_t as_short(double component)
{
    return (uint64_t)lrint(component * 65535);
}

static void write_colours(const struct writing *writing)
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

static void write_distances(const struct writing *writing)
{
    for (uint32_t i = 0; i < writing->result->mesh->position_count; i++) {
        float distance = (float)writing->result->distances[i];
        gd__output_f32(writing->binary, isfinite(distance) ? distance : -1);
    }
}

/* Returns the number of points of a line as a strip. The point of a line of one point is written
 * twice, because a strip has at least two points. */
static size_t strip_points(const struct gd_result *result, uint32_t line)
{
    size_t count = result->first[line + 1] - result->first[line];
    return count > 1 ? count : 2;
}

static void write_lines(const struct writing *writing)
{
    const struct gd_result *result = writing->result;
    for (uint32_t line = 0; line < result->line_count; line++) {
        uint32_t begin = result->first[line], count = result->first[line + 1] - begin;
        write_positions(writing, result->points + begin, count);
        if (count == 1) write_positions(writing, result->points + begin, 1);
    }
}

static void write_binary(const struct writing *writing)
{
    const struct gd_result *result = writing->result;
    if (result->mesh) {
        write_positions(writing, mesh_positions(result), mesh_count(result));
        write_indices(writing);
    }
    if (result->distances) {
        write_colours(writing);
        write_distances(writing);
    }
    write_lines(writing);
    if (writing->keys) gd__motion_write(writing->binary, result, writing->origin);
}

/* --- the document ----------------------------------------------------------------------------- */

static void text(struct writing *writing, const char *text)
{
    gd__output_text(writing->json, text);
}

/* Writes a number with its key. `key` includes its quotes, its colon and the separator before
 * it. */
static void member(struct writing *writing, const char *key, uint64_t value)
{
    text(writing, key);
    gd__output_integer(writing->json, value);
}

static void triple(struct writing *writing, const char *key, const double values[3])
{
    text(writing, key);
    for (int axis = 0; axis < 3; axis++) {
        text(writing, axis ? "," : "[");
        gd__output_double(writing->json, values[axis]);
    }
    text(writing, "]");
}

/* Writes a view. `stride` is the number of bytes from element to element, required if several
 * accessors share the view; 0 if not written. `target` is 0 for data of an animation. */
static void describe_view(struct writing *writing, uint64_t size, unsigned stride, unsigned target)
{
    text(writing, writing->views++ ? ",{\"buffer\":0" : "{\"buffer\":0");
    member(writing, ",\"byteOffset\":", writing->bytes);
    member(writing, ",\"byteLength\":", size);
    if (stride) member(writing, ",\"byteStride\":", stride);
    if (target) member(writing, ",\"target\":", target);
    text(writing, "}");
    writing->bytes += size;
}

static void describe_motion_views(struct writing *writing)
{
    uint64_t keys = writing->keys;
    describe_view(writing, GD__AXIS_POINTS * GD__POSITION_BYTES, 0, TARGET_VERTICES);
    describe_view(writing, GD__AXIS_POINTS * GD__COLOUR_BYTES, 0, TARGET_VERTICES);
    describe_view(writing, keys * GD__TIME_BYTES, 0, 0);
    describe_view(writing, keys * GD__POSITION_BYTES, 0, 0);
    describe_view(writing, keys * GD__QUATERNION_BYTES, 0, 0);
}

static void describe_views(struct writing *writing)
{
    const struct gd_result *result = writing->result;
    uint64_t vertices = mesh_count(result), points = 0;
    for (uint32_t line = 0; line < result->line_count; line++) points += strip_points(result, line);
    text(writing, ",\"bufferViews\":[");
    if (result->mesh) {
        describe_view(writing, 12 * vertices, 0, TARGET_VERTICES);
        describe_view(writing, 4 * (uint64_t)gd_polygons_corner_count(result->mesh), 0,
                      TARGET_INDICES);
    }
    if (result->distances) {
        describe_view(writing, 8 * vertices, 0, TARGET_VERTICES);
        describe_view(writing, 4 * vertices, 0, TARGET_VERTICES);
    }
    if (points)
        describe_view(writing, 12 * points, result->line_count > 1 ? 12 : 0, TARGET_VERTICES);
    if (writing->keys) describe_motion_views(writing);
    text(writing, "]");
}

/* Writes an accessor up to its type, which the caller writes. */
static void begin_accessor(struct writing *writing, uint32_t view, uint64_t offset, unsigned type,
                           uint64_t count)
{
    text(writing, writing->accessors++ ? ",{" : "{");
    member(writing, "\"bufferView\":", view);
    if (offset) member(writing, ",\"byteOffset\":", offset);
    member(writing, ",\"componentType\":", type);
    member(writing, ",\"count\":", count);
}

/* Writes the accessor of positions. Returns false if a position is beyond the range of floats. */
static bool describe_positions(struct writing *writing, uint32_t view, uint64_t offset,
                               const double (*positions)[3], size_t count, size_t written)
{
    struct box box;
    if (!float_box(writing, positions, count, &box)) return false;
    begin_accessor(writing, view, offset, TYPE_FLOAT, written);
    text(writing, ",\"type\":\"VEC3\"");
    triple(writing, ",\"min\":", box.min);
    triple(writing, ",\"max\":", box.max);
    text(writing, "}");
    return true;
}

static bool describe_mesh(struct writing *writing)
{
    const struct gd_result *result = writing->result;
    size_t count = mesh_count(result);
    if (!describe_positions(writing, 0, 0, mesh_positions(result), count, count)) return false;
    begin_accessor(writing, 1, 0, TYPE_INT, gd_polygons_corner_count(result->mesh));
    text(writing, ",\"type\":\"SCALAR\"}");
    if (!result->distances) return true;
    begin_accessor(writing, 2, 0, TYPE_SHORT, count);
    text(writing, ",\"normalized\":true,\"type\":\"VEC4\"}");
    begin_accessor(writing, 3, 0, TYPE_FLOAT, count);
    text(writing, ",\"type\":\"SCALAR\"}");
    return true;
}

/* `view` is the first view of the moving object. */
static void describe_motion_accessors(struct writing *writing, uint32_t view)
{
    double length = (double)gd__motion_axis(writing->result);
    begin_accessor(writing, view, 0, TYPE_FLOAT, GD__AXIS_POINTS);
    triple(writing, ",\"type\":\"VEC3\",\"min\":", (const double[]){0, 0, 0});
    triple(writing, ",\"max\":", (const double[]){length, length, length});
    text(writing, "}");
    begin_accessor(writing, view + 1, 0, TYPE_SHORT, GD__AXIS_POINTS);
    text(writing, ",\"normalized\":true,\"type\":\"VEC4\"}");
    begin_accessor(writing, view + 2, 0, TYPE_FLOAT, writing->keys);
    member(writing, ",\"type\":\"SCALAR\",\"min\":[0],\"max\":[", GD_RESULT_SECONDS);
    text(writing, "]}");
    begin_accessor(writing, view + 3, 0, TYPE_FLOAT, writing->keys);
    text(writing, ",\"type\":\"VEC3\"}");
    begin_accessor(writing, view + 4, 0, TYPE_FLOAT, writing->keys);
    text(writing, ",\"type\":\"VEC4\"}");
}

static bool describe_accessors(struct writing *writing)
{
    const struct gd_result *result = writing->result;
    uint32_t lines = writing->views - 1 - (writing->keys ? MOTION_VIEWS : 0);
    bool fits = true;
    uint64_t offset = 0;
    text(writing, ",\"accessors\":[");
    if (result->mesh) fits = describe_mesh(writing);
    for (uint32_t line = 0; fits && line < result->line_count; line++) {
        uint32_t begin = result->first[line], count = result->first[line + 1] - begin;
        size_t written = strip_points(result, line);
        fits = describe_positions(writing, lines, offset, result->points + begin, count, written);
        offset += 12 * written;
    }
    if (fits && writing->keys) describe_motion_accessors(writing, lines + 1);
    text(writing, "]");
    return fits;
}

static void write_level(struct writing *writing, double level)
{
    text(writing, ",\"extras\":{\"level\":");
    gd__output_double(writing->json, level);
    text(writing, "}");
}

/* Writes the mesh of the moving object. `accessor` is its first one. */
static void describe_object(struct writing *writing, uint32_t accessor)
{
    member(writing, ",{\"primitives\":[{\"attributes\":{\"POSITION\":", accessor);
    member(writing, ",\"COLOR_0\":", accessor + UINT64_C(1));
    text(writing, "},\"mode\":1,\"material\":2}]}");
}

static void describe_sampler(struct writing *writing, uint32_t input, uint32_t output)
{
    member(writing, "{\"interpolation\":\"LINEAR\",\"input\":", input);
    member(writing, ",\"output\":", output);
    text(writing, "}");
}

/* `input` is the accessor of times. */
static void describe_animation(struct writing *writing, uint32_t input)
{
    text(writing, ",\"animations\":[{\"name\":\"motion\",\"channels\":["
                  "{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"translation\"}},"
                  "{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"rotation\"}}],\"samplers\":[");
    describe_sampler(writing, input, input + 1);
    text(writing, ",");
    describe_sampler(writing, input, input + 2);
    text(writing, "]}]");
}

/* Writes the scene. The moving object is a child of the first node, so that its translations, which
 * are floats, are relative to the origin. */
static void describe_nodes(struct writing *writing)
{
    triple(writing,
           "{\"asset\":{\"version\":\"2.0\",\"generator\":\"geodesicd\"},\"scene\":0,\"scenes\":[{"
           "\"nodes\":[0]}],"
           "\"nodes\":[{\"mesh\":0,\"translation\":",
           writing->origin);
    text(writing, writing->keys ? ",\"children\":[1]},{\"name\":\"object\",\"mesh\":1}]" : "}]");
}

static void describe_scene(struct writing *writing)
{
    const struct gd_result *result = writing->result;
    uint32_t accessor = 0, primitives = 0;
    describe_nodes(writing);
    text(writing,
         ",\"materials\":[{\"name\":\"surface\",\"doubleSided\":true,\"pbrMetallicRoughness\":"
         "{\"metallicFactor\":0,\"roughnessFactor\":0.9}},{\"name\":\"line\","
         "\"pbrMetallicRoughness\":"
         "{\"baseColorFactor\":[0.64,0.006,0.013,1],\"metallicFactor\":0}}");
    if (writing->keys)
        text(writing, ",{\"name\":\"axes\",\"pbrMetallicRoughness\":{\"metallicFactor\":0}}");
    text(writing, "],\"meshes\":[{\"primitives\":[");
    if (result->mesh) {
        text(writing, "{\"attributes\":{\"POSITION\":0");
        if (result->distances) text(writing, ",\"COLOR_0\":2,\"_DISTANCE\":3");
        text(writing, "},\"indices\":1,\"material\":0}");
        accessor = result->distances ? 4 : 2;
        primitives++;
    }
    for (uint32_t line = 0; line < result->line_count; line++) {
        member(writing,
               primitives++ ? ",{\"attributes\":{\"POSITION\":" : "{\"attributes\":{\"POSITION\":",
               accessor++);
        text(writing, "},\"mode\":3,\"material\":1");
        if (result->levels) write_level(writing, result->levels[line]);
        text(writing, "}");
    }
    text(writing, "]}");
    if (writing->keys) describe_object(writing, accessor);
    text(writing, "]");
    if (writing->keys) describe_animation(writing, accessor + 2);
}

/* Writes the document up to the length of its one buffer, which the caller writes. */
static bool describe(struct writing *writing)
{
    describe_scene(writing);
    describe_views(writing);
    bool fits = describe_accessors(writing);
    member(writing, ",\"buffers\":[{\"byteLength\":", writing->bytes);
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

static enum gd_status begin(struct writing *writing)
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

static enum gd_status join_glb(struct writing *writing)
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
    struct writing writing = {.result = result, .json = &json, .binary = output};
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
    struct writing writing = {.result = result, .json = output, .binary = &binary};
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
