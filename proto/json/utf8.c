#include "proto/json/utf8.h"

#include <stdint.h>

size_t proto_utf8_length(const char *text, size_t size)
{
    /* For each number of bytes, the smallest character that needs so many bytes. If a smaller
       character is encoded in that many bytes, the encoding is overlong. */
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    unsigned char first = (unsigned char)text[0];
    if (first < 0x80) return 1;
    size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc0 || first >= 0xf8 || length > size) return 0;
    uint32_t character = first & (0xffu >> (length + 1));
    for (size_t i = 1; i < length; i++) {
        if (((unsigned char)text[i] & 0xc0) != 0x80) return 0; /* not a continuation byte */
        character = character << 6 | ((unsigned char)text[i] & 0x3f);
    }
    if (character < least[length] || character > 0x10ffff) return 0;
    return character >= 0xd800 && character < 0xe000 ? 0 : length;
}
