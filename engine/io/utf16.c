#include "io/utf16.h"

#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "io/endian.h"

#define LOOK_UNITS  65536 /* units between two checks of the control */
#define REPLACEMENT 0xFFFD

bool gd__is_utf16(const void *bytes, size_t size)
{
    return size >= 2 && (memcmp(bytes, "\xFF\xFE", 2) == 0 || memcmp(bytes, "\xFE\xFF", 2) == 0);
}

/* Reads the next character: one unit, or the two of a surrogate pair. */
static uint32_t next_character(const char **at, const char *end, bool big_endian)
{
    uint32_t unit = (uint32_t)gd__load_unsigned(*at, 2, big_endian);
    *at += 2;
    if (unit < 0xD800 || unit > 0xDFFF) return unit;
    if (unit > 0xDBFF || end - *at < 2) return REPLACEMENT;
    uint32_t low = (uint32_t)gd__load_unsigned(*at, 2, big_endian);
    if (low < 0xDC00 || low > 0xDFFF) return REPLACEMENT;
    *at += 2;
    return 0x10000 + ((unit - 0xD800) << 10) + (low - 0xDC00);
}

static char *put_utf8(char *out, uint32_t character)
{
    if (character < 0x80) {
        *out++ = (char)character;
        return out;
    }
    int more = character < 0x800 ? 1 : character < 0x10000 ? 2 : 3;
    static const unsigned char marks[] = {0, 0xC0, 0xE0, 0xF0};
    *out++ = (char)(marks[more] | character >> 6 * more);
    for (; more > 0; more--) *out++ = (char)(0x80 | (character >> 6 * (more - 1) & 0x3F));
    return out;
}

enum gd_status gd__utf16_decode(const void *bytes, size_t size, const struct gd_control *control,
                                char **out, size_t *out_size)
{
    const char *at = bytes, *end = at + size / 2 * 2;
    bool big_endian = *at == '\xFE';
    char *text = gd__large_array(size / 2 + 1, 3), *next = text;
    enum gd_status status = text ? GD_OK : GD_NO_MEMORY;
    at += 2;
    for (size_t unit = 1; status == GD_OK && at < end; unit++) {
        next = put_utf8(next, next_character(&at, end, big_endian));
        if (unit % LOOK_UNITS == 0) status = gd_control_check(control, 0);
    }
    if (status != GD_OK) {
        free(text);
        return status;
    }
    *out = text;
    *out_size = (size_t)(next - text);
    return GD_OK;
}
