#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "io/readers.h"
#include "io/utf16.h"

static const struct {
    enum gd_format format;
    const char *name, *media_type;
} formats[] = {
#define FORMAT_ENTRY(NAME, name, media) {GD_FORMAT_##NAME, #name, media},
    GD_FORMAT_MAP(FORMAT_ENTRY)
#undef FORMAT_ENTRY
};

#define FORMAT_COUNT (sizeof formats / sizeof formats[0])

enum gd_format gd_format_by_name(const char *name)
{
    for (size_t i = 0; name && i < FORMAT_COUNT; i++) {
        if (strcmp(name, formats[i].name) == 0) return formats[i].format;
    }
    return GD_FORMAT_ANY;
}

enum gd_format gd_format_by_media_type(const char *media_type)
{
    if (!media_type) return GD_FORMAT_ANY;
    media_type += strspn(media_type, " \t");
    size_t length = strcspn(media_type, "; \t");
    for (size_t i = 0; i < FORMAT_COUNT; i++) {
        const char *known = formats[i].media_type;
        if (length == strlen(known) && strncasecmp(media_type, known, length) == 0)
            return formats[i].format;
    }
    return GD_FORMAT_ANY;
}

const char *gd_format_name(enum gd_format format)
{
    for (size_t i = 0; i < FORMAT_COUNT; i++) {
        if (formats[i].format == format) return formats[i].name;
    }
    return "any";
}

const char *gd_format_media_type(enum gd_format format)
{
    for (size_t i = 0; i < FORMAT_COUNT; i++) {
        if (formats[i].format == format) return formats[i].media_type;
    }
    return "application/octet-stream";
}

/* Signatures, the most reliable ones first. GLB begins with a magic number of four bytes. glTF and
 * the JSON format are distinguished by their first key. OBJ has no signature, so it is tried
 * last. */
static const struct {
    enum gd_format format;
    bool (*recognise)(struct gd__scan scan);
} signatures[] = {
    {GD_FORMAT_GLB, gd__glb_recognise},   {GD_FORMAT_3MF, gd__3mf_recognise},
    {GD_FORMAT_STL, gd__stl_recognise},   {GD_FORMAT_PLY, gd__ply_recognise},
    {GD_FORMAT_OFF, gd__off_recognise},   {GD_FORMAT_GLTF, gd__gltf_recognise},
    {GD_FORMAT_JSON, gd__json_recognise}, {GD_FORMAT_OBJ, gd__obj_recognise},
};

#define UTF16_BEGINNING ((size_t)1 << 16) /* bytes of UTF-16 that are searched for a signature */

/* Number of bytes of text that are searched for a signature. Blanks and comments may precede the
 * signature. */
#define TEXT_BEGINNING ((size_t)1 << 20)

static enum gd_format recognise_beginning(struct gd__scan beginning)
{
    for (size_t i = 0; i < sizeof signatures / sizeof signatures[0]; i++) {
        if (signatures[i].recognise(beginning)) return signatures[i].format;
    }
    return GD_FORMAT_ANY;
}

/* Returns GD_FORMAT_ANY also if there is no memory. */
static enum gd_format recognise_utf16(const void *bytes, size_t size)
{
    char *text;
    size_t length;
    enum gd_status status = gd__utf16_decode(bytes, size < UTF16_BEGINNING ? size : UTF16_BEGINNING,
                                             NULL, &text, &length);
    if (status != GD_OK) return GD_FORMAT_ANY;
    enum gd_format format =
        length ? recognise_beginning(gd__scan_begin(text, length, NULL)) : GD_FORMAT_ANY;
    free(text);
    return format;
}

enum gd_format gd_format_recognise(const void *bytes, size_t size)
{
    struct gd__scan whole = gd__scan_begin(bytes, size, NULL), beginning = whole;
    if (size > TEXT_BEGINNING) beginning.end = beginning.begin + TEXT_BEGINNING;
    if (size == 0) return GD_FORMAT_ANY;
    if (gd__stl_has_binary_size(&whole) && !gd__glb_recognise(beginning) &&
        !gd__3mf_recognise(beginning))
        return GD_FORMAT_STL;
    return gd__is_utf16(bytes, size) ? recognise_utf16(bytes, size)
                                     : recognise_beginning(beginning);
}
