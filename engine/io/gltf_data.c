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

static void fail_external(struct gd__gltf *gltf, uint32_t uri)
{
    struct gd__word name = {gd__json_at(&gltf->json, uri) + 1, 0};
    while (name.at[name.length] != '"') name.length++;
    gd__gltf_fail(
        gltf, uri, GD_UNSUPPORTED,
        "the buffer refers to another file, '%s'; send a GLB, or a glTF whose buffers are "
        "data: URIs",
        gd__excerpt(name).text);
}

/* Returns the text of a data: URI between ";base64," and the closing quote. */
static struct gd__gltf_bytes encoded_part(struct gd__gltf *gltf, uint32_t uri)
{
    static const char mark[] = ";base64,";
    const char *at = gd__json_at(&gltf->json, uri) + 1, *end = gltf->json.text + gltf->json.size;
    /* there is a quote, because the string is already parsed */
    const char *quote = memchr(at, '"', (size_t)(end - at));
    const char *found = memchr(at, ',', (size_t)(quote - at));
    if (quote - at < 5 || memcmp(at, "data:", 5) != 0)
        fail_external(gltf, uri);
    else if (!found || found - at < 12 ||
             memcmp(found + 2 - sizeof mark, mark, sizeof mark - 1) != 0)
        gd__gltf_fail(gltf, uri, GD_UNSUPPORTED,
                      "the data: URI is not encoded in base64; encode its bytes in base64");
    else
        return (struct gd__gltf_bytes){found + 1, (size_t)(quote - found - 1)};
    return (struct gd__gltf_bytes){0};
}

static struct gd__gltf_bytes decode_uri(struct gd__gltf *gltf, uint32_t uri)
{
    struct gd__gltf_bytes encoded = {0};
    if (gd__json_is(&gltf->json, uri, '"'))
        encoded = encoded_part(gltf, uri);
    else
        gd__gltf_fail(gltf, uri, GD_SYNTAX, "'uri' is not a string");
    if (gltf->status) return encoded;
    char *decoded = gd__arena_take(&gltf->arena, gd__base64_bytes(encoded.size), 1);
    size_t size = 0;
    if (!decoded)
        gltf->status = gd_fail_status(gltf->scan.detail, gltf->arena.status);
    else if (!gd__base64_read(encoded.at, encoded.size, decoded, &size))
        gd__gltf_fail(gltf, uri, GD_SYNTAX,
                      "the data: URI contains a character that base64 does not allow");
    return (struct gd__gltf_bytes){decoded, size};
}

/* Finds the bytes of a buffer. The first buffer of a GLB is its binary chunk, unless it has a
 * URI. */
static struct gd__gltf_bytes find_bytes(struct gd__gltf *gltf, uint32_t number)
{
    uint32_t buffer = gltf->buffers.values[number],
             uri = gd__json_member(&gltf->json, buffer, "uri");
    if (uri != GD__NO_VALUE) return decode_uri(gltf, uri);
    if (number > 0 || !gltf->binary.at)
        gd__gltf_fail(gltf, buffer, GD_UNSUPPORTED,
                      "the buffer has no bytes; add a data: URI, or put the bytes into the binary "
                      "chunk of a GLB");
    return gltf->binary;
}

static struct gd__gltf_bytes load_buffer(struct gd__gltf *gltf, uint32_t number)
{
    struct gd__gltf_bytes *loaded = &gltf->loaded[number];
    uint32_t buffer = gltf->buffers.values[number];
    if (!loaded->at) *loaded = find_bytes(gltf, number);
    uint64_t size = gd__gltf_whole(gltf, buffer, "byteLength", LARGEST_WHOLE, LARGEST_WHOLE);
    if (size > loaded->size)
        gd__gltf_fail(gltf, buffer, GD_TRUNCATED,
                      "the buffer's 'byteLength' is %llu, but the buffer has only %zu bytes",
                      (unsigned long long)size, loaded->size);
    return (struct gd__gltf_bytes){loaded->at, (size_t)size};
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

/* Returns the number of a view's buffer. */
static uint32_t buffer_of(struct gd__gltf *gltf, uint32_t view)
{
    uint32_t named = gd__json_member(&gltf->json, view, "buffer");
    if (named == GD__NO_VALUE)
        gd__gltf_fail(gltf, view, GD_SYNTAX, "the buffer view lacks the member 'buffer'");
    if (is_compressed(gltf, view))
        gd__gltf_fail(gltf, view, GD_UNSUPPORTED,
                      "the bytes are compressed by meshopt; export the file without compression");
    return gltf->status ? GD__NO_VALUE : gd__gltf_index(gltf, named, &gltf->buffers);
}

static struct view open_view(struct gd__gltf *gltf, uint32_t value)
{
    struct gd__gltf_bytes bytes = {0};
    uint32_t buffer = buffer_of(gltf, value);
    if (!gltf->status) bytes = load_buffer(gltf, buffer);
    uint64_t offset = gd__gltf_whole(gltf, value, "byteOffset", 0, LARGEST_WHOLE),
             size = gd__gltf_whole(gltf, value, "byteLength", LARGEST_WHOLE, LARGEST_WHOLE),
             stride = gd__gltf_whole(gltf, value, "byteStride", 0, 1 << 16);
    if (offset > bytes.size || size > bytes.size - offset)
        gd__gltf_fail(gltf, value, GD_TRUNCATED,
                      "the buffer view ends at byte %llu, but its buffer has %zu bytes",
                      (unsigned long long)(offset + size), bytes.size);
    if (gltf->status) return (struct view){0};
    return (struct view){value, {bytes.at + offset, (size_t)size}, (size_t)stride};
}

/* Opens the view that an object refers to. `bytes.at` of the result is NULL if the object refers to
 * no view. */
static struct view open_named_view(struct gd__gltf *gltf, uint32_t object)
{
    uint32_t view = gd__gltf_reference(gltf, object, "bufferView", &gltf->views);
    return view == GD__NO_VALUE ? (struct view){0} : open_view(gltf, view);
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

uint32_t gd__gltf_accessor_count(struct gd__gltf *gltf, uint32_t value)
{
    uint64_t count = gd__gltf_whole(gltf, value, "count", 0, UINT32_MAX - 1);
    if (count == 0)
        gd__gltf_fail(gltf, value, GD_SYNTAX, "the accessor needs a 'count' of at least 1");
    /* Elements without data are zeros. A file must not declare more of them than a file of the same
     * size could hold as data. */
    size_t bytes = (size_t)(gltf->scan.end - gltf->scan.begin) + gltf->binary.size;
    if (count > bytes && gd__json_member(&gltf->json, value, "bufferView") == GD__NO_VALUE)
        gd__gltf_fail(
            gltf, value, GD_SYNTAX,
            "the accessor has no 'bufferView', and more elements than the file has bytes; "
            "store its data in the file");
    return (uint32_t)count;
}

static void read_type(struct gd__gltf_accessor *accessor, bool is_position)
{
    struct gd__gltf *gltf = accessor->gltf;
    uint64_t type = gd__gltf_whole(gltf, accessor->value, "componentType", 0, UINT16_MAX);
    const char *wanted = is_position ? "VEC3" : "SCALAR";
    uint32_t shape = gd__json_member(&gltf->json, accessor->value, "type");
    bool fits = is_position ? component_size(type) > 0 && type != 5125 : is_index_type(type);
    if (!fits || shape == GD__NO_VALUE || !gd__json_says(&gltf->json, shape, wanted))
        gd__gltf_fail(gltf, accessor->value, GD_SYNTAX,
                      "the 'type' or 'componentType' of this accessor does not suit %s, which need "
                      "the type %s",
                      is_position ? "positions" : "indices", wanted);
    uint32_t normalized = gd__json_member(&gltf->json, accessor->value, "normalized");
    accessor->is_normalized =
        normalized != GD__NO_VALUE && gd__json_is(&gltf->json, normalized, 't');
    accessor->type = (uint32_t)type;
    accessor->components = is_position ? 3 : 1;
}

/* Returns the position of `count` elements of `size` bytes in a view. The first one lies at the
 * byteOffset of an object. */
static const char *find_elements(struct gd__gltf *gltf, uint32_t object, const struct view *view,
                                 uint32_t count, size_t size)
{
    uint64_t offset = gd__gltf_whole(gltf, object, "byteOffset", 0, LARGEST_WHOLE);
    size_t stride = view->stride ? view->stride : size;
    if (stride < size)
        gd__gltf_fail(gltf, view->value, GD_SYNTAX,
                      "'byteStride' is %zu, which is too small for elements of %zu bytes", stride,
                      size);
    uint64_t end = offset + (uint64_t)(count - 1) * stride + size;
    if (end > view->bytes.size)
        gd__gltf_fail(gltf, object, GD_TRUNCATED,
                      "the %u elements end at byte %llu, but their buffer view has %zu bytes",
                      count, (unsigned long long)end, view->bytes.size);
    return gltf->status ? NULL : view->bytes.at + offset;
}

static void find_dense(struct gd__gltf_accessor *accessor)
{
    size_t size = component_size(accessor->type) * accessor->components;
    struct view view = open_named_view(accessor->gltf, accessor->value);
    if (!view.bytes.at) return;
    accessor->stride = view.stride ? view.stride : size;
    accessor->at = find_elements(accessor->gltf, accessor->value, &view, accessor->count, size);
}

/* Finds one of the two lists of a sparse accessor: the list with the name "indices" or "values". */
static const char *find_sparse_list(struct gd__gltf_accessor *accessor, uint32_t sparse,
                                    const char *name, size_t size)
{
    struct gd__gltf *gltf = accessor->gltf;
    uint32_t object = gd__json_member(&gltf->json, sparse, name);
    if (object == GD__NO_VALUE) {
        gd__gltf_fail(gltf, sparse, GD_SYNTAX, "'%s' is missing", name);
        return NULL;
    }
    struct view view = open_named_view(gltf, object);
    if (!view.bytes.at) gd__gltf_fail(gltf, object, GD_SYNTAX, "'bufferView' is missing");
    view.stride = 0; /* the elements of both lists follow each other */
    return gltf->status ? NULL : find_elements(gltf, object, &view, accessor->sparse_count, size);
}

static uint32_t read_sparse_type(struct gd__gltf *gltf, uint32_t sparse)
{
    uint32_t indices = gd__json_member(&gltf->json, sparse, "indices");
    uint64_t type = 0;
    if (indices != GD__NO_VALUE)
        type = gd__gltf_whole(gltf, indices, "componentType", 0, UINT16_MAX);
    if (!is_index_type(type))
        gd__gltf_fail(gltf, sparse, GD_SYNTAX,
                      "the 'componentType' of the sparse indices must be 5121, 5123 or 5125");
    return (uint32_t)type;
}

static void find_sparse(struct gd__gltf_accessor *accessor)
{
    struct gd__gltf *gltf = accessor->gltf;
    uint32_t sparse = gd__json_member(&gltf->json, accessor->value, "sparse");
    if (sparse == GD__NO_VALUE) return;
    accessor->sparse_count = (uint32_t)gd__gltf_whole(gltf, sparse, "count", 0, accessor->count);
    if (accessor->sparse_count == 0) return;
    accessor->sparse_type = read_sparse_type(gltf, sparse);
    accessor->sparse_indices =
        find_sparse_list(accessor, sparse, "indices", component_size(accessor->sparse_type));
    accessor->sparse_values = find_sparse_list(
        accessor, sparse, "values", component_size(accessor->type) * accessor->components);
}

struct gd__gltf_accessor gd__gltf_accessor_open(struct gd__gltf *gltf, uint32_t value,
                                                bool is_position)
{
    struct gd__gltf_accessor accessor = {.gltf = gltf, .value = value};
    accessor.count = gd__gltf_accessor_count(gltf, value);
    read_type(&accessor, is_position);
    if (!gltf->status) find_dense(&accessor);
    if (!gltf->status) find_sparse(&accessor);
    return accessor;
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
static const char *find_next(struct gd__gltf_accessor *accessor)
{
    uint32_t place = accessor->next++, sparse = accessor->sparse_next;
    size_t size = component_size(accessor->type) * accessor->components;
    const char *at = accessor->at ? accessor->at + (size_t)place * accessor->stride : NULL;
    if (sparse == accessor->sparse_count) return at;
    size_t index_size = component_size(accessor->sparse_type);
    double index =
        load(accessor->sparse_indices + (size_t)sparse * index_size, accessor->sparse_type);
    if (index < place || index >= accessor->count)
        gd__gltf_fail(accessor->gltf, accessor->value, GD_SYNTAX,
                      "sparse indices must increase and be less than 'count', but sparse index "
                      "number %u is %g",
                      sparse, index);
    if (index != place) return at;
    accessor->sparse_next++;
    return accessor->sparse_values + (size_t)sparse * size;
}

void gd__gltf_accessor_next(struct gd__gltf_accessor *accessor, double out[3])
{
    const char *at = find_next(accessor);
    size_t size = component_size(accessor->type);
    for (unsigned i = 0; i < accessor->components; i++) {
        double value = at ? load(at + i * size, accessor->type) : 0;
        out[i] = accessor->is_normalized ? normalized(value, accessor->type) : value;
    }
}
