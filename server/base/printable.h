/* Printable: eight bytes at a time that need no closer look. */
#ifndef SERVER_BASE_PRINTABLE_H
#define SERVER_BASE_PRINTABLE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Each byte the same. */
#define SERVER_EIGHT(byte) (UINT64_C(0x0101010101010101) * (byte))

/* Is one of the bytes, all below 0x80, this one? */
static inline bool server_eight_have(uint64_t bytes, unsigned char byte)
{
    uint64_t zeros = bytes ^ SERVER_EIGHT(byte);
    return ((zeros + SERVER_EIGHT(0x7f)) & SERVER_EIGHT(0x80)) != SERVER_EIGHT(0x80);
}

/* Are the eight bytes visible ASCII characters, '!' to '~', and neither of these two? */
static inline bool server_eight_are_visible(const char *text, unsigned char but, unsigned char nor)
{
    uint64_t bytes;
    memcpy(&bytes, text, sizeof bytes);
    if (bytes & SERVER_EIGHT(0x80)) return false;
    bool are_least =
        ((bytes + SERVER_EIGHT(0x80 - '!')) & SERVER_EIGHT(0x80)) == SERVER_EIGHT(0x80);
    bool are_most = !((bytes + SERVER_EIGHT(0x7f - '~')) & SERVER_EIGHT(0x80));
    return are_least && are_most && !server_eight_have(bytes, but) &&
           !server_eight_have(bytes, nor);
}

#endif
