#include "io/gltf_layers.h"

enum { INDEX_BYTES = 4, POSITION_BYTES = 12 };

size_t gd__gltf_layer_points(const struct gd_result_layer *layer)
{
    return layer->first ? layer->first[layer->count] : layer->count;
}

static uint32_t line_points(const struct gd_result_layer *layer, uint32_t line)
{
    return layer->first[line + 1] - layer->first[line];
}

/* Returns the number of indices of the layer's lines: two for each segment. */
static size_t index_count(const struct gd_result_layer *layer)
{
    size_t segments = 0;
    for (uint32_t i = 0; layer->first && i < layer->count; i++)
        segments += line_points(layer, i) ? line_points(layer, i) - 1 : 0;
    return 2 * segments;
}

static bool has_content(const struct gd_result_layer *layer)
{
    return layer->first ? index_count(layer) > 0 : layer->count > 0;
}

uint32_t gd__gltf_layer_count(const struct gd_result *result)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < result->layer_count; i++) count += has_content(&result->layers[i]);
    return count;
}

/* --- the document ----------------------------------------------------------------------------- */

/* Writes printable ASCII as a JSON string. */
static void write_string(struct gd__gltf_writing *writing, const char *text)
{
    gd__gltf_text(writing, "\"");
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') gd__gltf_text(writing, "\\");
        gd__output_bytes(writing->json, text, 1);
    }
    gd__gltf_text(writing, "\"");
}

void gd__gltf_layer_nodes(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    for (uint32_t i = 0; i < result->layer_count; i++) {
        if (!has_content(&result->layers[i])) continue;
        gd__gltf_text(writing, ",{\"name\":");
        write_string(writing, result->layers[i].name);
        gd__gltf_member(writing, ",\"mesh\":", writing->nodes++);
        gd__gltf_text(writing, "}");
    }
}

void gd__gltf_layer_materials(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    for (uint32_t i = 0; i < result->layer_count; i++) {
        const struct gd_colour *colour = &result->layers[i].colour;
        if (!has_content(&result->layers[i])) continue;
        gd__gltf_text(writing, ",{\"pbrMetallicRoughness\":{");
        gd__gltf_colour(writing, colour);
        gd__gltf_text(writing, ",\"metallicFactor\":0}}");
    }
}

static void write_labels(struct gd__gltf_writing *writing, const struct gd_result_layer *layer)
{
    gd__gltf_text(writing, "\"labels\":[");
    for (uint32_t k = 0; k < layer->count; k++) {
        if (k) gd__gltf_text(writing, ",");
        if (layer->labels[k])
            write_string(writing, layer->labels[k]);
        else
            gd__gltf_text(writing, "null");
    }
    gd__gltf_text(writing, "]");
}

static void write_extras(struct gd__gltf_writing *writing, const struct gd_result_layer *layer)
{
    if (!layer->label && !layer->labels) return;
    gd__gltf_text(writing, ",\"extras\":{");
    if (layer->label) gd__gltf_text(writing, "\"label\":");
    if (layer->label) write_string(writing, layer->label);
    if (layer->label && layer->labels) gd__gltf_text(writing, ",");
    if (layer->labels) write_labels(writing, layer);
    gd__gltf_text(writing, "}");
}

void gd__gltf_layer_meshes(struct gd__gltf_writing *writing, uint32_t material, uint32_t accessor)
{
    const struct gd_result *result = writing->result;
    for (uint32_t i = 0; i < result->layer_count; i++) {
        const struct gd_result_layer *layer = &result->layers[i];
        if (!has_content(layer)) continue;
        gd__gltf_member(writing, ",{\"primitives\":[{\"attributes\":{\"POSITION\":", accessor++);
        gd__gltf_text(writing, "}");
        if (layer->first) gd__gltf_member(writing, ",\"indices\":", accessor++);
        gd__gltf_text(writing, layer->first ? ",\"mode\":1" : ",\"mode\":0");
        gd__gltf_member(writing, ",\"material\":", material++);
        gd__gltf_text(writing, "}]");
        write_extras(writing, layer);
        gd__gltf_text(writing, "}");
    }
}

void gd__gltf_layer_views(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    uint64_t points = 0, indices = 0;
    for (uint32_t i = 0; i < result->layer_count; i++) {
        if (!has_content(&result->layers[i])) continue;
        points += gd__gltf_layer_points(&result->layers[i]);
        indices += index_count(&result->layers[i]);
    }
    if (points) gd__gltf_view(writing, POSITION_BYTES * points, POSITION_BYTES, GD__GLTF_VERTICES);
    if (indices) gd__gltf_view(writing, INDEX_BYTES * indices, 0, GD__GLTF_INDICES);
}

bool gd__gltf_layer_accessors(struct gd__gltf_writing *writing, uint32_t view)
{
    const struct gd_result *result = writing->result;
    uint64_t positions = 0, indices = 0; /* bytes so far */
    for (uint32_t i = 0; i < result->layer_count; i++) {
        const struct gd_result_layer *layer = &result->layers[i];
        size_t points = gd__gltf_layer_points(layer), count = index_count(layer);
        if (!has_content(layer)) continue;
        if (!gd__gltf_positions(writing, view, positions, layer->points, points, points))
            return false;
        positions += POSITION_BYTES * points;
        if (!count) continue;
        gd__gltf_accessor_begin(writing, view + 1, indices, GD__GLTF_INT, count);
        gd__gltf_text(writing, ",\"type\":\"SCALAR\"}");
        indices += INDEX_BYTES * count;
    }
    return true;
}

/* --- data ------------------------------------------------------------------------------------- */

static void write_indices(struct gd__output *output, const struct gd_result_layer *layer)
{
    for (uint32_t line = 0; layer->first && line < layer->count; line++)
        for (uint32_t k = layer->first[line] + 1; k < layer->first[line + 1]; k++) {
            gd__output_little_endian(output, k - 1, INDEX_BYTES);
            gd__output_little_endian(output, k, INDEX_BYTES);
        }
}

void gd__gltf_layer_data(const struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    for (uint32_t i = 0; i < result->layer_count; i++)
        if (has_content(&result->layers[i]))
            gd__gltf_write_positions(writing, result->layers[i].points,
                                     gd__gltf_layer_points(&result->layers[i]));
    for (uint32_t i = 0; i < result->layer_count; i++)
        write_indices(writing->binary, &result->layers[i]);
}
