#include "io/gltf_document.h"

enum { INDEX_BYTES = 4, POSITION_BYTES = 12 };

size_t gd__gltf_layer_points(const struct gd_result_layer *layer)
{
    return layer->first ? layer->first[layer->count] : layer->count;
}

/* Returns the number of indices of the layer's lines: two for each segment. */
static size_t index_count(const struct gd_result_layer *layer)
{
    size_t segments = 0;
    for (uint32_t i = 0; layer->first && i < layer->count; i++) {
        uint32_t points = layer->first[i + 1] - layer->first[i];
        segments += points ? points - 1 : 0;
    }
    return 2 * segments;
}

/* Writes printable ASCII as a JSON string. */
static void write_string(struct gd__output *json, const char *text)
{
    gd__output_text(json, "\"");
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') gd__output_text(json, "\\");
        gd__output_bytes(json, text, 1);
    }
    gd__output_text(json, "\"");
}

static void write_labels(struct gd__output *json, const struct gd_result_layer *layer)
{
    gd__output_text(json, "\"labels\":[");
    for (uint32_t k = 0; k < layer->count; k++) {
        if (k) gd__output_text(json, ",");
        if (layer->labels[k])
            write_string(json, layer->labels[k]);
        else
            gd__output_text(json, "null");
    }
    gd__output_text(json, "]");
}

static void write_extras(struct gd__output *json, const struct gd_result_layer *layer)
{
    if (!layer->label && !layer->labels) return;
    gd__output_text(json, ",\"extras\":{");
    if (layer->label) gd__output_text(json, "\"label\":");
    if (layer->label) write_string(json, layer->label);
    if (layer->label && layer->labels) gd__output_text(json, ",");
    if (layer->labels) write_labels(json, layer);
    gd__output_text(json, "}");
}

static void describe_node(struct gd__gltf_writing *writing, const struct gd_result_layer *layer)
{
    gd__output_text(&writing->node_list, ",{\"name\":");
    write_string(&writing->node_list, layer->name);
    gd__gltf_member(&writing->node_list, ",\"mesh\":", writing->nodes++);
    gd__output_text(&writing->node_list, "}");
    gd__output_text(&writing->material_list, ",{\"pbrMetallicRoughness\":{");
    gd__gltf_colour(&writing->material_list, &layer->colour);
    gd__output_text(&writing->material_list, ",\"metallicFactor\":0}}");
}

static void describe_mesh(struct gd__gltf_writing *writing, const struct gd_result_layer *layer)
{
    struct gd__output *json = &writing->mesh_list;
    uint32_t accessor = writing->accessors;
    gd__gltf_member(json, ",{\"primitives\":[{\"attributes\":{\"POSITION\":", accessor);
    gd__output_text(json, "}");
    if (layer->first) gd__gltf_member(json, ",\"indices\":", accessor + UINT64_C(1));
    gd__output_text(json, layer->first ? ",\"mode\":1" : ",\"mode\":0");
    gd__gltf_member(json, ",\"material\":", writing->materials++);
    gd__output_text(json, "}]");
    write_extras(json, layer);
    gd__output_text(json, "}");
}

static void write_indices(struct gd__output *output, const struct gd_result_layer *layer)
{
    for (uint32_t line = 0; layer->first && line < layer->count; line++)
        for (uint32_t k = layer->first[line] + 1; k < layer->first[line + 1]; k++) {
            gd__output_little_endian(output, k - 1, INDEX_BYTES);
            gd__output_little_endian(output, k, INDEX_BYTES);
        }
}

/* Adds the positions of a layer to the next view, and its indices to the view after it. */
static void add_layer(struct gd__gltf_writing *writing, const struct gd_result_layer *layer,
                      size_t begin, size_t *indices)
{
    size_t count = index_count(layer);
    if (layer->first ? !count : !layer->count) return;
    describe_node(writing, layer);
    describe_mesh(writing, layer);
    gd__gltf_positions(writing, begin, layer->points, gd__gltf_layer_points(layer), 0);
    if (count)
        gd__gltf_accessor(writing, writing->views + 1, *indices, GD__GLTF_INT, count,
                          ",\"type\":\"SCALAR\"}");
    *indices += INDEX_BYTES * count;
}

void gd__gltf_layers(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    size_t begin = writing->binary.size, indices = 0;
    for (uint32_t i = 0; i < result->layer_count; i++)
        add_layer(writing, &result->layers[i], begin, &indices);
    if (writing->binary.size > begin)
        gd__gltf_view(writing, begin, POSITION_BYTES, GD__GLTF_VERTICES);
    begin = writing->binary.size;
    for (uint32_t i = 0; i < result->layer_count; i++)
        write_indices(&writing->binary, &result->layers[i]);
    if (indices) gd__gltf_view(writing, begin, 0, GD__GLTF_INDICES);
}
