/* Writes glTF: one scene, as binary (GLB) or as JSON with embedded data. The contents are described
 * in gd/result_file.h. The data is, in this order: positions, indices, colours, distances, points
 * of the lines, data of the moving object, data of the layers. Each kind has one view and one
 * accessor, except that each line and each layer has its own accessor. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "io/base64.h"
#include "io/gltf_document.h"
#include "io/writers.h"

#define CHUNK_JSON   UINT32_C(0x4E4F534A)
#define CHUNK_BINARY UINT32_C(0x004E4942)

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

static void widen(struct gd__gltf_box *box, const double (*positions)[3], size_t count)
{
    for (size_t i = 0; i < count; i++) gd__gltf_widen(box, positions[i]);
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
    widen(&box, positions, mesh_count(result));
    widen(&box, result->points, point_count(result));
    for (uint32_t i = 0; i < result->layer_count; i++)
        widen(&box, result->layers[i].points, gd__gltf_layer_points(&result->layers[i]));
    double size = 0;
    for (int axis = 0; axis < 3; axis++) size = fmax(size, box.max[axis] - box.min[axis]);
    writing->fits = size == 0 || size >= (double)FLT_MIN;
    for (int axis = 0; axis < 3; axis++)
        writing->origin[axis] = size > 0 && isfinite(size)
                                    ? round_centre(box.min[axis], box.max[axis], size)
                                    : box.min[axis] / 2 + box.max[axis] / 2;
}

/* --- the mesh and the lines ------------------------------------------------------------------- */

static uint64_t as_short(double component)
{
    return (uint64_t)lrint(component * 65535);
}

static double largest_distance(const struct gd_result *result)
{
    double largest = 0;
    for (size_t i = 0; result->distances && i < mesh_count(result); i++)
        if (isfinite(result->distances[i])) largest = fmax(largest, result->distances[i]);
    return largest;
}

static void add_colours(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    double largest = largest_distance(result);
    size_t begin = writing->binary.size;
    for (uint32_t i = 0; i < result->mesh->position_count; i++) {
        double distance = result->distances[i], part = largest > 0 ? distance / largest : 0;
        struct gd_colour colour = isfinite(distance) ? gd_colour_map(part) : unknown;
        gd__output_little_endian(&writing->binary,
                                 as_short(colour.red) | as_short(colour.green) << 16 |
                                     as_short(colour.blue) << 32 | UINT64_C(65535) << 48,
                                 8);
    }
    gd__gltf_accessor(writing, writing->views, 0, GD__GLTF_SHORT, mesh_count(result),
                      ",\"normalized\":true,\"type\":\"VEC4\"}");
    gd__gltf_view(writing, begin, 0, GD__GLTF_VERTICES);
}

static void add_distances(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    size_t begin = writing->binary.size;
    for (uint32_t i = 0; i < result->mesh->position_count; i++) {
        float distance = (float)result->distances[i];
        gd__output_f32(&writing->binary, isfinite(distance) ? distance : -1);
    }
    gd__gltf_accessor(writing, writing->views, 0, GD__GLTF_FLOAT, mesh_count(result),
                      ",\"type\":\"SCALAR\"}");
    gd__gltf_view(writing, begin, 0, GD__GLTF_VERTICES);
}

/* Adds the mesh, whose accessors are the first ones. */
static void add_mesh(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    struct gd__output *json = &writing->primitives;
    uint32_t corners = gd_polygons_corner_count(result->mesh);
    gd__gltf_positions(writing, 0, mesh_positions(result), mesh_count(result), 0);
    gd__gltf_view(writing, 0, 0, GD__GLTF_VERTICES);
    size_t begin = writing->binary.size;
    for (uint32_t corner = 0; corner < corners; corner++)
        gd__output_little_endian(&writing->binary, result->mesh->corners[corner], 4);
    gd__gltf_accessor(writing, writing->views, 0, GD__GLTF_INT, corners, ",\"type\":\"SCALAR\"}");
    gd__gltf_view(writing, begin, 0, GD__GLTF_INDICES);
    if (result->distances) add_colours(writing);
    if (result->distances) add_distances(writing);
    gd__output_text(json, "{\"attributes\":{\"POSITION\":0");
    if (result->distances) gd__output_text(json, ",\"COLOR_0\":2,\"_DISTANCE\":3");
    gd__output_text(json, "},\"indices\":1,\"material\":0}");
}

/* Adds the lines as strips. A strip needs at least two points. So if a line has only one point,
 * this point is written twice. */
static void add_lines(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    struct gd__output *json = &writing->primitives;
    size_t begin = writing->binary.size;
    for (uint32_t line = 0; line < result->line_count; line++) {
        uint32_t first = result->first[line], count = result->first[line + 1] - first;
        gd__gltf_member(
            json, json->size ? ",{\"attributes\":{\"POSITION\":" : "{\"attributes\":{\"POSITION\":",
            writing->accessors);
        gd__output_text(json, "},\"mode\":3,\"material\":1");
        if (result->levels) {
            gd__output_text(json, ",\"extras\":{\"level\":");
            gd__output_double(json, result->levels[line]);
            gd__output_text(json, "}");
        }
        gd__output_text(json, "}");
        gd__gltf_positions(writing, begin, result->points + first, count, 2);
    }
    if (result->line_count)
        gd__gltf_view(writing, begin, result->line_count > 1 ? 12 : 0, GD__GLTF_VERTICES);
}

/* --- the document ----------------------------------------------------------------------------- */

static void join(struct gd__output *json, const char *before, const struct gd__output *list,
                 const char *after)
{
    gd__output_text(json, before);
    if (list->size) gd__output_bytes(json, list->bytes, list->size);
    gd__output_text(json, after);
}

/* Writes the document up to the length of its one buffer. The other nodes are children of the first
 * one, so that their positions, which are floats, are relative to the origin. */
static void describe(const struct gd__gltf_writing *writing, struct gd__output *json)
{
    const struct gd_result *result = writing->result;
    gd__gltf_triple(
        json,
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"geodesicd\"},\"scene\":0,\"scenes\":[{"
        "\"nodes\":[0]}],"
        "\"nodes\":[{\"mesh\":0,\"translation\":",
        writing->origin);
    for (uint32_t i = 1; i < writing->nodes; i++)
        gd__gltf_member(json, i > 1 ? "," : ",\"children\":[", i);
    join(json, writing->nodes > 1 ? "]}" : "}", &writing->node_list,
         "],\"materials\":[{\"name\":\"surface\",\"doubleSided\":true,"
         "\"pbrMetallicRoughness\":{");
    if (result->colour && !result->distances) {
        gd__gltf_colour(json, result->colour);
        gd__output_text(json, ",");
    }
    join(json,
         "\"metallicFactor\":0,\"roughnessFactor\":0.9}},{\"name\":\"line\","
         "\"pbrMetallicRoughness\":"
         "{\"baseColorFactor\":[0.64,0.006,0.013,1],\"metallicFactor\":0}}",
         &writing->material_list, "],\"meshes\":[{\"primitives\":[");
    join(json, "", &writing->primitives, "]}");
    join(json, "", &writing->mesh_list, "]");
    join(json, "", &writing->animations, ",\"bufferViews\":[");
    join(json, "", &writing->view_list, "],\"accessors\":[");
    join(json, "", &writing->accessor_list, "]");
    gd__gltf_member(json, ",\"buffers\":[{\"byteLength\":", writing->binary.size);
}

/* Adds all contents. Errors: those of gd__glb_write, and GD_NO_MEMORY. */
static enum gd_status add_all(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    if ((!result->mesh && !result->line_count) || (result->distances && !result->mesh))
        return GD_INVALID_ARGUMENT;
    if (result->mesh && !gd_polygons_are_triangles(result->mesh)) return GD_NOT_TRIANGLES;
    find_origin(writing);
    if (result->mesh) add_mesh(writing);
    add_lines(writing);
    gd__gltf_motion(writing);
    gd__gltf_layers(writing);
    if (!writing->fits) return GD_EXTENT;
    const struct gd__output *lists[] = {&writing->node_list,  &writing->material_list,
                                        &writing->primitives, &writing->mesh_list,
                                        &writing->animations, &writing->view_list,
                                        &writing->binary,     &writing->accessor_list};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        if (lists[i]->failed) return GD_NO_MEMORY;
    return GD_OK;
}

static struct gd__gltf_writing begin_writing(const struct gd_result *result)
{
    return (struct gd__gltf_writing){.result = result, .fits = true, .nodes = 1, .materials = 2};
}

static void end_writing(struct gd__gltf_writing *writing)
{
    free(writing->node_list.bytes);
    free(writing->material_list.bytes);
    free(writing->primitives.bytes);
    free(writing->mesh_list.bytes);
    free(writing->animations.bytes);
    free(writing->view_list.bytes);
    free(writing->accessor_list.bytes);
    free(writing->binary.bytes);
}

/* --- files ------------------------------------------------------------------------------------ */

static void write_chunk(struct gd__output *output, const struct gd__output *data, uint32_t type)
{
    gd__output_little_endian(output, data->size, 4);
    gd__output_little_endian(output, type, 4);
    if (data->size) gd__output_bytes(output, data->bytes, data->size);
}

static enum gd_status join_glb(struct gd__output *json, const struct gd__output *binary,
                               struct gd__output *output)
{
    gd__output_text(json, "}]}");
    while (!json->failed && json->size % 4) gd__output_text(json, " ");
    if (json->failed) return GD_NO_MEMORY;
    uint64_t length = 12 + 8 + json->size + 8 + binary->size;
    if (length > UINT32_MAX) return GD_TOO_LARGE;
    gd__output_text(output, "glTF");
    gd__output_little_endian(output, 2, 4);
    gd__output_little_endian(output, length, 4);
    write_chunk(output, json, CHUNK_JSON);
    write_chunk(output, binary, CHUNK_BINARY);
    return GD_OK;
}

enum gd_status gd__glb_write(struct gd__output *output, const struct gd_result *result)
{
    struct gd__gltf_writing writing = begin_writing(result);
    struct gd__output json = {0};
    enum gd_status status = add_all(&writing);
    if (!status) describe(&writing, &json);
    if (!status) status = join_glb(&json, &writing.binary, output);
    free(json.bytes);
    end_writing(&writing);
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
    struct gd__gltf_writing writing = begin_writing(result);
    enum gd_status status = add_all(&writing);
    if (!status) {
        describe(&writing, output);
        gd__output_text(output, ",\"uri\":\"data:application/octet-stream;base64,");
        write_base64(output, &writing.binary);
        gd__output_text(output, "\"}]}\n");
    }
    end_writing(&writing);
    return status;
}
