/* glTF data: buffers, views (pieces of buffers) and accessors (the types and positions of the
 * numbers in a view). See gltf.h. */
#include "io/gltf.h"

#include <math.h>
#include <string.h>

#include "io/base64.h"
#include "io/endian.h"

/* all whole numbers up to this number are exact in JSON */
#define LARGEST_WHOLE (UINT64_C(1) << 53)

/* --- buffers ---------------------------------------------------------------------------------- */

static enum gd_status fail_external(const struct gd__gltf *gltf, uint32_t uri)
{
    struct gd__word name = {gd__json_at(&gltf->json, uri) + 1, 0};
    while (name.at[name.length] != '"') name.length++;
    return gd__gltf_fail(gltf, uri, GD_UNSUPPORTED,
                         "the buffer refers to another file, '%s'; send a GLB, or a glTF whose "
                         "buffers are data: URIs",
                         gd__excerpt(name).text);
}

/* Returns the text of a data: URI between ";base64," and the closing quote. */
static enum gd_status encoded_part(const struct gd__gltf *gltf, uint32_t uri,
                                   struct gd__gltf_bytes *out)
{
    static const char mark[] = ";base64,";
    const char *at = gd__json_at(&gltf->json, uri) + 1, *end = gltf->json.text + gltf->json.size;
    /* there is a quote, because the string is already parsed */
    const char *quote = memchr(at, '"', (size_t)(end - at));
    if (quote - at < 5 || memcmp(at, "data:", 5) != 0) return fail_external(gltf, uri);
    const char *found = memchr(at, ',', (size_t)(quote - at));
    if (!found || found - at < 12 || memcmp(found + 2 - sizeof mark, mark, sizeof mark - 1) != 0)
        return gd__gltf_fail(gltf, uri, GD_UNSUPPORTED,
                             "the data: URI is not encoded in base64; encode its bytes in base64");
    *out = (struct gd__gltf_bytes){found + 1, (size_t)(quote - found - 1)};
    return GD_OK;
}

static enum gd_status decode_uri(struct gd__gltf *gltf, uint32_t uri, struct gd__gltf_bytes *out)
{
    struct gd__gltf_bytes encoded = {0};
    if (!gd__json_is(&gltf->json, uri, '"'))
        return gd__gltf_fail(gltf, uri, GD_SYNTAX, "'uri' is not a string");
    enum gd_status status = encoded_part(gltf, uri, &encoded);
    if (status != GD_OK) return status;
    char *decoded = gd__arena_take(&gltf->arena, gd__base64_bytes(encoded.size), 1);
    if (!decoded) return gd_fail_status(gltf->scan.detail, gltf->arena.status);
    size_t size;
    if (!gd__base64_read(encoded.at, encoded.size, decoded, &size))
        return gd__gltf_fail(gltf, uri, GD_SYNTAX,
                             "the data: URI contains a character that base64 does not allow");
    *out = (struct gd__gltf_bytes){decoded, size};
    return GD_OK;
}

/* Finds the bytes of a buffer. The first buffer of a GLB is its binary chunk, unless it has a
 * URI. */
static enum gd_status find_bytes(struct gd__gltf *gltf, uint32_t number, struct gd__gltf_bytes *out)
{
    uint32_t buffer = gltf->buffers.values[number],
             uri = gd__json_member(&gltf->json, buffer, "uri");
    if (uri != GD__NO_VALUE) return decode_uri(gltf, uri, out);
    if (number > 0 || !gltf->binary.at)
        return gd__gltf_fail(gltf, buffer, GD_UNSUPPORTED,
                             "the buffer has no bytes; add a data: URI, or put the bytes into the "
                             "binary chunk of a GLB");
    *out = gltf->binary;
    return GD_OK;
}

static enum gd_status load_buffer(struct gd__gltf *gltf, uint32_t number,
                                  struct gd__gltf_bytes *out)
{
    struct gd__gltf_bytes *loaded = &gltf->loaded[number];
    uint32_t buffer = gltf->buffers.values[number];
    uint64_t size = 0;
    enum gd_status status = loaded->at ? GD_OK : find_bytes(gltf, number, loaded);
    if (status == GD_OK)
        status = gd__gltf_whole(gltf, buffer, "byteLength", LARGEST_WHOLE, LARGEST_WHOLE, &size);
    if (status != GD_OK) return status;
    if (size > loaded->size)
        return gd__gltf_fail(gltf, buffer, GD_TRUNCATED,
                             "the buffer's 'byteLength' is %llu, but the buffer has only %zu bytes",
                             (unsigned long long)size, loaded->size);
    *out = (struct gd__gltf_bytes){loaded->at, (size_t)size};
    return GD_OK;
}

/* --- views ------------------------------------------------------------------------------------ */

/* A view: a piece of a buffer. */
struct view {
    uint32_t value;
    struct gd__gltf_bytes bytes;
    size_t stride; /* 0 means that elements follow each other */
};

static bool is_compressed(const struct gd__gltf *gltf, uint32_t view)
{
    uint32_t extensions = gd__json_member(&gltf->json, view, "extensions");
    return extensions != GD__NO_VALUE &&
           (gd__json_member(&gltf->json, extensions, "EXT_meshopt_compression") != GD__NO_VALUE ||
            gd__json_member(&gltf->json, extensions, "KHR_meshopt_compression") != GD__NO_VALUE);
}

static enum gd_status buffer_of(const struct gd__gltf *gltf, uint32_t view, uint32_t *out)
{
    uint32_t named = gd__json_member(&gltf->json, view, "buffer");
    if (named == GD__NO_VALUE)
        return gd__gltf_fail(gltf, view, GD_SYNTAX, "the buffer view lacks the member 'buffer'");
    if (is_compressed(gltf, view))
        return gd__gltf_fail(
            gltf, view, GD_UNSUPPORTED,
            "the bytes are compressed by meshopt; export the file without compression");
    return gd__gltf_index(gltf, named, &gltf->buffers, out);
}

static enum gd_status open_view(struct gd__gltf *gltf, uint32_t value, struct view *out)
{
    uint32_t buffer;
    struct gd__gltf_bytes bytes = {0};
    uint64_t offset = 0, size = 0, stride = 0;
    enum gd_status status = buffer_of(gltf, value, &buffer);
    if (status == GD_OK) status = load_buffer(gltf, buffer, &bytes);
    if (status == GD_OK)
        status = gd__gltf_whole(gltf, value, "byteOffset", 0, LARGEST_WHOLE, &offset);
    if (status == GD_OK)
        status = gd__gltf_whole(gltf, value, "byteLength", LARGEST_WHOLE, LARGEST_WHOLE, &size);
    if (status == GD_OK) status = gd__gltf_whole(gltf, value, "byteStride", 0, 1 << 16, &stride);
    if (status != GD_OK) return status;
    if (offset > bytes.size || size > bytes.size - offset)
        return gd__gltf_fail(gltf, value, GD_TRUNCATED,
                             "the buffer view ends at byte %llu, but its buffer has %zu bytes",
                             (unsigned long long)(offset + size), bytes.size);
    *out = (struct view){value, {bytes.at + offset, (size_t)size}, (size_t)stride};
    return GD_OK;
}

/* Opens the view that an object refers to. `out->bytes.at` is NULL if the object refers to no
 * view. */
static enum gd_status open_named_view(struct gd__gltf *gltf, uint32_t object, struct view *out)
{
    uint32_t view;
    *out = (struct view){0};
    enum gd_status status = gd__gltf_reference(gltf, object, "bufferView", &gltf->views, &view);
    return status == GD_OK && view != GD__NO_VALUE ? open_view(gltf, view, out) : status;
}

/* --- accessors -------------------------------------------------------------------------------- */

static size_t component_size(uint64_t type)
{
    switch (type) {
    case 5120:
    case 5121:
        return 1;
    case 5122:
    case 5123:
        return 2;
    case 5125:
    case 5126:
        return 4;
    default:
        return 0;
    }
}

static bool is_index_type(uint64_t type)
{
    return type == 5121 || type == 5123 || type == 5125;
}

enum gd_status gd__gltf_accessor_count(const struct gd__gltf *gltf, uint32_t value, uint32_t *out)
{
    uint64_t count = 0;
    enum gd_status status = gd__gltf_whole(gltf, value, "count", 0, UINT32_MAX - 1, &count);
    if (status != GD_OK) return status;
    if (count == 0)
        return gd__gltf_fail(gltf, value, GD_SYNTAX, "the accessor needs a 'count' of at least 1");
    /* Elements without data are zeros. A file must not declare more of them than a file of the same
     * size could hold as data. */
    size_t bytes = (size_t)(gltf->scan.end - gltf->scan.begin) + gltf->binary.size;
    if (count > bytes && gd__json_member(&gltf->json, value, "bufferView") == GD__NO_VALUE)
        return gd__gltf_fail(gltf, value, GD_SYNTAX,
                             "the accessor has no 'bufferView', and more elements than the file "
                             "has bytes; store its data in the file");
    *out = (uint32_t)count;
    return GD_OK;
}

static enum gd_status read_type(struct gd__gltf_accessor *accessor, bool is_position)
{
    const struct gd__gltf *gltf = accessor->gltf;
    uint64_t type = 0;
    enum gd_status status =
        gd__gltf_whole(gltf, accessor->value, "componentType", 0, UINT16_MAX, &type);
    if (status != GD_OK) return status;
    const char *wanted = is_position ? "VEC3" : "SCALAR";
    uint32_t shape = gd__json_member(&gltf->json, accessor->value, "type");
    bool fits = is_position ? component_size(type) > 0 && type != 5125 : is_index_type(type);
    if (!fits || shape == GD__NO_VALUE || !gd__json_says(&gltf->json, shape, wanted))
        return gd__gltf_fail(gltf, accessor->value, GD_SYNTAX,
                             "the 'type' or 'componentType' of this accessor does not suit %s, "
                             "which need the type %s",
                             is_position ? "positions" : "indices", wanted);
    uint32_t normalized = gd__json_member(&gltf->json, accessor->value, "normalized");
    accessor->is_normalized =
        normalized != GD__NO_VALUE && gd__json_is(&gltf->json, normalized, 't');
    accessor->type = (uint32_t)type;
    accessor->components = is_position ? 3 : 1;
    return GD_OK;
}

/* Finds `count` elements of `size` bytes in a view. The first one lies at the byteOffset of an
 * object. Returns its position in `out`. */
static enum gd_status find_elements(const struct gd__gltf *gltf, uint32_t object,
                                    const struct view *view, uint32_t count, size_t size,
                                    size_t stride, const char **out)
{
    uint64_t offset = 0;
    enum gd_status status = gd__gltf_whole(gltf, object, "byteOffset", 0, LARGEST_WHOLE, &offset);
    if (status != GD_OK) return status;
    if (stride < size)
        return gd__gltf_fail(gltf, view->value, GD_SYNTAX,
                             "'byteStride' is %zu, which is too small for elements of %zu bytes",
                             stride, size);
    uint64_t end = offset + (uint64_t)(count - 1) * stride + size;
    if (end > view->bytes.size)
        return gd__gltf_fail(
            gltf, object, GD_TRUNCATED,
            "the %u elements end at byte %llu, but their buffer view has %zu bytes", count,
            (unsigned long long)end, view->bytes.size);
    *out = view->bytes.at + offset;
    return GD_OK;
}

static enum gd_status find_dense(struct gd__gltf *gltf, struct gd__gltf_accessor *accessor)
{
    size_t size = component_size(accessor->type) * accessor->components;
    struct view view;
    enum gd_status status = open_named_view(gltf, accessor->value, &view);
    if (status != GD_OK || !view.bytes.at) return status;
    accessor->stride = view.stride ? view.stride : size;
    return find_elements(gltf, accessor->value, &view, accessor->count, size, accessor->stride,
                         &accessor->at);
}

/* Finds one of the two lists of a sparse accessor: the list with the name "indices" or "values". */
static enum gd_status find_sparse_list(struct gd__gltf *gltf, uint32_t sparse, const char *name,
                                       uint32_t count, size_t size, const char **out)
{
    uint32_t object = gd__json_member(&gltf->json, sparse, name);
    if (object == GD__NO_VALUE)
        return gd__gltf_fail(gltf, sparse, GD_SYNTAX, "'%s' is missing", name);
    struct view view;
    enum gd_status status = open_named_view(gltf, object, &view);
    if (status == GD_OK && !view.bytes.at)
        status = gd__gltf_fail(gltf, object, GD_SYNTAX, "'bufferView' is missing");
    return status == GD_OK ? find_elements(gltf, object, &view, count, size, size, out) : status;
}

static enum gd_status read_sparse_type(const struct gd__gltf *gltf, uint32_t sparse, uint32_t *out)
{
    uint32_t indices = gd__json_member(&gltf->json, sparse, "indices");
    uint64_t type = 0;
    enum gd_status status = GD_OK;
    if (indices != GD__NO_VALUE)
        status = gd__gltf_whole(gltf, indices, "componentType", 0, UINT16_MAX, &type);
    if (status == GD_OK && !is_index_type(type))
        status =
            gd__gltf_fail(gltf, sparse, GD_SYNTAX,
                          "the 'componentType' of the sparse indices must be 5121, 5123 or 5125");
    *out = (uint32_t)type;
    return status;
}

static enum gd_status find_sparse(struct gd__gltf *gltf, struct gd__gltf_accessor *accessor)
{
    uint32_t sparse = gd__json_member(&gltf->json, accessor->value, "sparse");
    if (sparse == GD__NO_VALUE) return GD_OK;
    size_t size = component_size(accessor->type) * accessor->components;
    uint64_t count = 0;
    enum gd_status status = gd__gltf_whole(gltf, sparse, "count", 0, accessor->count, &count);
    if (status != GD_OK || count == 0) return status;
    accessor->sparse_count = (uint32_t)count;
    status = read_sparse_type(gltf, sparse, &accessor->sparse_type);
    if (status == GD_OK)
        status = find_sparse_list(gltf, sparse, "indices", accessor->sparse_count,
                                  component_size(accessor->sparse_type), &accessor->sparse_indices);
    if (status == GD_OK)
        status = find_sparse_list(gltf, sparse, "values", accessor->sparse_count, size,
                                  &accessor->sparse_values);
    return status;
}

enum gd_status gd__gltf_accessor_open(struct gd__gltf *gltf, uint32_t value, bool is_position,
                                      struct gd__gltf_accessor *out)
{
    struct gd__gltf_accessor accessor = {.gltf = gltf, .value = value};
    enum gd_status status = gd__gltf_accessor_count(gltf, value, &accessor.count);
    if (status == GD_OK) status = read_type(&accessor, is_position);
    if (status == GD_OK) status = find_dense(gltf, &accessor);
    if (status == GD_OK) status = find_sparse(gltf, &accessor);
    if (status == GD_OK) *out = accessor;
    return status;
}

/* --- elements --------------------------------------------------------------------------------- */

static double load(const char *at, uint32_t type)
{
    switch (type) {
    case 5120:
        return (int8_t)*at;
    case 5121:
        return (uint8_t)*at;
    case 5122:
        return (int16_t)gd__load_unsigned(at, 2, false);
    case 5123:
        return (uint16_t)gd__load_unsigned(at, 2, false);
    case 5125:
        return gd__load_u32(at, false);
    default:
        return gd__load_f32(at, false);
    }
}

/* Converts a normalised whole number (glTF 2.0, 3.6.2.2 and the table of 3.11). */
static double normalized(double value, uint32_t type)
{
    switch (type) {
    case 5120:
        return fmax(value / 127, -1);
    case 5121:
        return value / 255;
    case 5122:
        return fmax(value / 32767, -1);
    case 5123:
        return value / 65535;
    default:
        return value;
    }
}

/* Returns the position of the next element, which is in the sparse list or in the accessor's view.
 * NULL means that the element is zero. */
static enum gd_status find_next(struct gd__gltf_accessor *accessor, const char **out)
{
    uint32_t place = accessor->next++, sparse = accessor->sparse_next;
    size_t size = component_size(accessor->type) * accessor->components;
    *out = accessor->at ? accessor->at + (size_t)place * accessor->stride : NULL;
    if (sparse == accessor->sparse_count) return GD_OK;
    size_t index_size = component_size(accessor->sparse_type);
    double index =
        load(accessor->sparse_indices + (size_t)sparse * index_size, accessor->sparse_type);
    if (index < place || index >= accessor->count)
        return gd__gltf_fail(accessor->gltf, accessor->value, GD_SYNTAX,
                             "sparse indices must increase and be less than 'count', but sparse "
                             "index number %u is %g",
                             sparse, index);
    if (index > place) return GD_OK;
    *out = accessor->sparse_values + (size_t)sparse * size;
    accessor->sparse_next++;
    return GD_OK;
}

enum gd_status gd__gltf_accessor_next(struct gd__gltf_accessor *accessor, double out[3])
{
    const char *at;
    size_t size = component_size(accessor->type);
    enum gd_status status = find_next(accessor, &at);
    for (unsigned i = 0; i < accessor->components && status == GD_OK; i++) {
        double value = at ? load(at + i * size, accessor->type) : 0;
        out[i] = accessor->is_normalized ? normalized(value, accessor->type) : value;
    }
    return status;
}
