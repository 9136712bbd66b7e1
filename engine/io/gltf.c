/* glTF 2.0 and its binary form GLB: reads the container, the lists of the document, and the meshes
 * of the scene. See gltf.h. */
#include "io/gltf.h"

#include <math.h>
#include <string.h>

#include "io/endian.h"
#include "io/json_text.h"
#include "io/readers.h"

#define GLB_HEADER   12
#define CHUNK_HEADER 8
#define CHUNK_JSON   UINT32_C(0x4E4F534A)
#define CHUNK_BINARY UINT32_C(0x004E4942)

/* --- recognition ------------------------------------------------------------------------------ */

bool gd__glb_recognise(struct gd__scan scan)
{
    return scan.end - scan.begin >= 4 && memcmp(scan.begin, "glTF", 4) == 0;
}

/* Recognises the format by the first key of the document. A mesh in the JSON format of json.c
 * begins with another key. */
bool gd__gltf_recognise(struct gd__scan scan)
{
    static const char *const keys[] = {"asset",
                                       "scene",
                                       "scenes",
                                       "nodes",
                                       "meshes",
                                       "accessors",
                                       "bufferViews",
                                       "buffers",
                                       "materials",
                                       "textures",
                                       "images",
                                       "samplers",
                                       "skins",
                                       "animations",
                                       "cameras",
                                       "extensions",
                                       "extras",
                                       "extensionsUsed",
                                       "extensionsRequired"};
    struct gd__word key;
    scan.detail = NULL;
    if (!gd__json_accept(&scan, '{')) return false;
    if (gd__json_string(&scan, "a key", &key) != GD_OK) return false;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (gd__json_string_is(key.at, keys[i])) return true;
    }
    return false;
}

/* --- members of objects ----------------------------------------------------------------------- */

uint64_t gd__gltf_whole(struct gd__gltf *gltf, uint32_t object, const char *name,
                        uint64_t otherwise, uint64_t most)
{
    uint32_t value = gd__json_member(&gltf->json, object, name);
    double number = (double)otherwise;
    if (value != GD__NO_VALUE && !gd__json_real(&gltf->json, value, &number)) number = -1;
    if (number >= 0 && number <= (double)most && number == floor(number)) return (uint64_t)number;
    gd__gltf_fail(gltf, value, GD_SYNTAX, "'%s' must be a whole number from 0 to %llu", name,
                  (unsigned long long)most);
    return 0;
}

uint32_t gd__gltf_index(struct gd__gltf *gltf, uint32_t value, const struct gd__gltf_list *list)
{
    double number = -1;
    if (!gd__json_real(&gltf->json, value, &number) || !(number >= 0) || number != floor(number))
        gd__gltf_fail(gltf, value, GD_SYNTAX, "this is not a number of one of the '%s'",
                      list->name);
    else if (number >= list->count)
        gd__gltf_fail(gltf, value, GD_SYNTAX,
                      "the file refers to number %.0f of the '%s', but it has only %u", number,
                      list->name, list->count);
    return gltf->status ? GD__NO_VALUE : (uint32_t)number;
}

uint32_t gd__gltf_reference(struct gd__gltf *gltf, uint32_t object, const char *name,
                            const struct gd__gltf_list *list)
{
    uint32_t value = gd__json_member(&gltf->json, object, name);
    uint32_t number = value == GD__NO_VALUE ? GD__NO_VALUE : gd__gltf_index(gltf, value, list);
    return number == GD__NO_VALUE ? GD__NO_VALUE : list->values[number];
}

void gd__gltf_reals(struct gd__gltf *gltf, uint32_t object, const char *name, unsigned count,
                    double *out)
{
    uint32_t list = gd__json_member(&gltf->json, object, name);
    if (list == GD__NO_VALUE) return;
    uint32_t value = list + 1,
             end = gd__json_is(&gltf->json, list, '[') ? gd__json_next(&gltf->json, list) : 0;
    unsigned read = 0;
    for (; value < end && read < count; value = gd__json_next(&gltf->json, value)) {
        if (!gd__json_real(&gltf->json, value, &out[read++])) break;
    }
    if (read != count || value != end)
        gd__gltf_fail(gltf, list, GD_SYNTAX, "'%s' must have %u numbers", name, count);
}

struct gd__gltf_items gd__gltf_items(struct gd__gltf *gltf, uint32_t object, const char *name)
{
    uint32_t list = gd__json_member(&gltf->json, object, name);
    if (list == GD__NO_VALUE) return (struct gd__gltf_items){0};
    if (gd__json_is(&gltf->json, list, '['))
        return (struct gd__gltf_items){list + 1, gd__json_next(&gltf->json, list)};
    gd__gltf_fail(gltf, list, GD_SYNTAX, "'%s' is not an array", name);
    return (struct gd__gltf_items){0};
}

/* --- the document ----------------------------------------------------------------------------- */

/* Returns true if the extension does not change the shape of the meshes. */
static bool leaves_shape(const struct gd__json *json, uint32_t name)
{
    static const char *const beginnings[] = {"KHR_materials_", "KHR_technique", "KHR_texture_",
                                             "KHR_lights_",    "KHR_xmp",       "EXT_texture_",
                                             "EXT_lights_",    "MSFT_texture",  "KHR_animation_"};
    if (gd__json_says(json, name, "KHR_mesh_quantization")) return true;
    for (size_t i = 0; i < sizeof beginnings / sizeof beginnings[0]; i++) {
        if (strncmp(gd__json_at(json, name) + 1, beginnings[i], strlen(beginnings[i])) == 0)
            return true;
    }
    return false;
}

static void refuse_extension(struct gd__gltf *gltf, uint32_t name)
{
    if (gd__json_says(&gltf->json, name, "KHR_draco_mesh_compression"))
        gd__gltf_fail(gltf, name, GD_UNSUPPORTED,
                      "the file is compressed by Draco: store it without compression");
    if (gd__json_says(&gltf->json, name, "EXT_meshopt_compression") ||
        gd__json_says(&gltf->json, name, "KHR_meshopt_compression"))
        gd__gltf_fail(gltf, name, GD_UNSUPPORTED,
                      "the file is compressed by meshopt: store it without compression");
    const char *at = gd__json_at(&gltf->json, name) + 1;
    size_t length = 0;
    while (at[length] != '"') length++;
    gd__gltf_fail(gltf, name, GD_UNSUPPORTED,
                  "the file needs the extension '%s', which is not supported: "
                  "export it without this extension",
                  gd__excerpt((struct gd__word){at, length}).text);
}

static void check_extensions(struct gd__gltf *gltf)
{
    uint32_t list = gd__json_member(&gltf->json, 0, "extensionsRequired");
    if (list == GD__NO_VALUE || !gd__json_is(&gltf->json, list, '[')) return;
    uint32_t end = gd__json_next(&gltf->json, list);
    for (uint32_t name = list + 1; name < end; name = gd__json_next(&gltf->json, name)) {
        if (!gd__json_is(&gltf->json, name, '"'))
            gd__gltf_fail(gltf, name, GD_SYNTAX, "the name of an extension is not a string");
        else if (!leaves_shape(&gltf->json, name))
            refuse_extension(gltf, name);
    }
}

static void check_version(struct gd__gltf *gltf)
{
    uint32_t asset = gd__json_member(&gltf->json, 0, "asset");
    uint32_t version =
        asset == GD__NO_VALUE ? GD__NO_VALUE : gd__json_member(&gltf->json, asset, "version");
    if (version == GD__NO_VALUE) {
        gd__gltf_fail(gltf, 0, GD_SYNTAX,
                      "the document is not glTF: it has no 'asset' with a 'version'");
        return;
    }
    uint32_t least = gd__json_member(&gltf->json, asset, "minVersion");
    if (strncmp(gd__json_at(&gltf->json, version), "\"2.", 3) != 0 ||
        (least != GD__NO_VALUE && !gd__json_says(&gltf->json, least, "2.0")))
        gd__gltf_fail(gltf, version, GD_UNSUPPORTED,
                      "the file needs another version than version 2.0 of glTF: convert it");
}

static void read_list(struct gd__gltf *gltf, const char *name, struct gd__gltf_list *list)
{
    struct gd__gltf_items items = gd__gltf_items(gltf, 0, name);
    uint32_t count = 0;
    list->name = name;
    for (uint32_t item = items.begin; item < items.end; count++)
        item = gd__json_next(&gltf->json, item);
    list->values = gd__arena_take(&gltf->arena, count, sizeof *list->values);
    for (uint32_t item = items.begin; list->values && item < items.end;
         item = gd__json_next(&gltf->json, item))
        list->values[list->count++] = item;
}

/* Reads the document from the scan's cursor to its end. */
static void read_document(struct gd__gltf *gltf)
{
    gltf->status = gd__json_parse(&gltf->scan, gltf->control, &gltf->json);
    if (gltf->status) return;
    check_version(gltf);
    check_extensions(gltf);
#define READ_LIST(member, text) read_list(gltf, text, &gltf->member);
    GD__GLTF_LISTS(READ_LIST)
#undef READ_LIST
    if (gltf->buffers.count > GD__GLTF_BUFFERS)
        gd__gltf_fail(gltf, 0, GD_UNSUPPORTED, "the file has more than %d buffers",
                      GD__GLTF_BUFFERS);
    gltf->loaded = gd__arena_zeroed(&gltf->arena, gltf->buffers.count, sizeof *gltf->loaded);
    if (!gltf->loaded && !gltf->status)
        gltf->status = gd_fail_status(gltf->scan.detail, gltf->arena.status);
}

static void free_document(struct gd__gltf *gltf)
{
    gd__json_free(&gltf->json);
    gd__arena_free(&gltf->arena);
}

/* --- the container ---------------------------------------------------------------------------- */

/* Reads the next chunk of a GLB, which ends at scan->end. */
static enum gd_status read_chunk(struct gd__scan *scan, uint32_t *type, struct gd__gltf_bytes *out)
{
    if (gd__scan_left(scan) < CHUNK_HEADER)
        return gd__scan_fail(scan, scan->at, GD_TRUNCATED, "the GLB ends where a chunk should be");
    uint32_t size = gd__load_u32(scan->at, false);
    *type = gd__load_u32(scan->at + 4, false);
    if (size > gd__scan_left(scan) - CHUNK_HEADER)
        return gd__scan_fail(
            scan, scan->at, GD_TRUNCATED,
            "a chunk of %u bytes is declared, but only %zu follow; send the whole file", size,
            gd__scan_left(scan) - CHUNK_HEADER);
    *out = (struct gd__gltf_bytes){scan->at + CHUNK_HEADER, size};
    scan->at += CHUNK_HEADER + (size_t)size;
    return GD_OK;
}

/* Reads the header of a GLB. Ignores bytes after the declared length. */
static enum gd_status read_header(struct gd__scan *scan)
{
    size_t size = (size_t)(scan->end - scan->begin);
    scan->at = scan->begin;
    if (size < GLB_HEADER || memcmp(scan->at, "glTF", 4) != 0)
        return gd__scan_fail(scan, scan->at, size < GLB_HEADER ? GD_TRUNCATED : GD_SYNTAX,
                             "a GLB begins with 'glTF', its version and its length");
    uint32_t version = gd__load_u32(scan->at + 4, false),
             length = gd__load_u32(scan->at + 8, false);
    if (version != 2)
        return gd__scan_fail(scan, scan->at + 4, GD_UNSUPPORTED,
                             "the GLB is of version %u of glTF, only 2.0 is read: convert it",
                             version);
    if (length > size || length < GLB_HEADER)
        return gd__scan_fail(scan, scan->at + 8, GD_TRUNCATED,
                             "the GLB declares %u bytes, but has %zu; send the whole file", length,
                             size);
    scan->at += GLB_HEADER;
    scan->end = scan->begin + length;
    return GD_OK;
}

static void open_glb(struct gd__gltf *gltf)
{
    struct gd__scan *scan = &gltf->scan;
    struct gd__gltf_bytes document = {0}, chunk = {0};
    uint32_t type = 0;
    enum gd_status status = read_header(scan);
    if (!status) status = read_chunk(scan, &type, &document);
    if (!status && type != CHUNK_JSON)
        status = gd__scan_fail(scan, document.at - CHUNK_HEADER, GD_SYNTAX,
                               "the first chunk of a GLB must be JSON");
    while (!status && !gltf->binary.at && gd__scan_left(scan) > 0) {
        status = read_chunk(scan, &type, &chunk);
        if (!status && type == CHUNK_BINARY) gltf->binary = chunk;
    }
    gltf->status = status;
    if (status) return;
    scan->at = document.at;
    scan->end = document.at + document.size;
    read_document(gltf);
}

/* The caller must free `*out` even after a failure. */
static void open_file(const struct gd__scan *scan, const struct gd_control *control, bool is_glb,
                      struct gd__gltf *out)
{
    *out = (struct gd__gltf){.scan = *scan, .control = control};
    out->scan.by_byte = true;
    if (is_glb)
        open_glb(out);
    else
        read_document(out);
}

/* --- the scene -------------------------------------------------------------------------------- */

static void make_scene(struct gd__gltf *gltf, struct gd__builder *builder,
                       const struct gd__gltf_sum *sum)
{
    struct gd__gltf_making making = {
        .gltf = gltf,
        .builder = builder,
        .accessor = GD__NO_VALUE,
        .weld = gd__weld_begin(builder),
        .vertices = gd__arena_take(&gltf->arena, sum->largest, sizeof *making.vertices),
        .all = 2 * sum->primitives + sum->vertices + 3 * sum->triangles};
    if (making.vertices)
        gd__gltf_walk(gltf, gd__gltf_make_mesh, &making);
    else
        gltf->status = gd_fail_status(gltf->scan.detail, gltf->arena.status);
    gd__weld_free(&making.weld);
}

static enum gd_status read_file(const struct gd__scan *scan, struct gd__builder *builder,
                                bool is_glb)
{
    struct gd__gltf gltf;
    struct gd__gltf_sum sum = {0};
    open_file(scan, builder->limits.control, is_glb, &gltf);
    builder->scan = &gltf.scan;
    builder->next_look = gltf.scan.end; /* the conversion checks the control itself */
    gd__gltf_walk(&gltf, gd__gltf_count_mesh, &sum);
    if (!gltf.status && sum.triangles == 0)
        gltf.status = gd_fail(gltf.scan.detail, GD_EMPTY,
                              "the scene has no triangles; %llu primitives are points or lines, or "
                              "have no positions",
                              (unsigned long long)sum.skipped);
    uint64_t most = builder->limits.max_vertices,
             vertices = sum.vertices < most ? sum.vertices : most;
    if (!gltf.status) gltf.status = gd__builder_reserve(builder, vertices, sum.triangles);
    if (!gltf.status) make_scene(&gltf, builder, &sum);
    free_document(&gltf);
    builder->scan = scan;
    return gltf.status;
}

enum gd_status gd__gltf_read(struct gd__scan *scan, struct gd__builder *builder)
{
    scan->by_byte = true;
    return read_file(scan, builder, false);
}

enum gd_status gd__glb_read(struct gd__scan *scan, struct gd__builder *builder)
{
    scan->by_byte = true;
    return read_file(scan, builder, true);
}

/* --- memory ----------------------------------------------------------------------------------- */

/* Memory of a position, and of its slots in the hash table of weld.h. A position takes at most four
 * slots. */
#define VERTEX_BYTES (sizeof(double[3]) + 4 * sizeof(uint32_t))

/* Bytes of memory per byte of text. The JSON tree takes at most four (json_tree.h). The lists and
 * the marks of nodes take at most half as much as the tree. */
#define TREE_FACTOR 6

static size_t cost_of(const struct gd__gltf_sum *sum, const struct gd_read_options *limits)
{
    struct gd_read_options most = limits ? *limits : (struct gd_read_options){0};
    uint64_t vertices = sum->vertices;
    if (most.max_faces && sum->triangles > most.max_faces) return 0;
    if (most.max_vertices && vertices > most.max_vertices) vertices = most.max_vertices;
    return (size_t)(vertices * VERTEX_BYTES + sum->triangles * sizeof(uint32_t[3]) +
                    sum->largest * sizeof(uint32_t));
}

size_t gd__gltf_cost(const void *bytes, size_t size, bool is_glb,
                     const struct gd_read_options *limits)
{
    struct gd__scan scan = gd__scan_begin(bytes, size, NULL);
    scan.deadline_ns = limits && limits->control ? limits->control->deadline_ns : 0;
    struct gd__gltf gltf;
    struct gd__gltf_sum sum = {0};
    open_file(&scan, limits ? limits->control : NULL, is_glb, &gltf);
    gd__gltf_walk(&gltf, gd__gltf_count_mesh, &sum);
    size_t cost = gltf.status ? 0 : cost_of(&sum, limits),
           document = TREE_FACTOR * gltf.json.size + size;
    free_document(&gltf);
    return cost ? cost + document : 0;
}
