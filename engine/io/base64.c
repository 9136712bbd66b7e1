#include "io/base64.h"

#include <stdint.h>
#include <string.h>

static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

#define NO_DIGIT 64

static void fill_digits(uint8_t digits[256])
{
    memset(digits, NO_DIGIT, 256);
    for (uint8_t i = 0; i < NO_DIGIT; i++) digits[(unsigned char)alphabet[i]] = i;
}

bool gd__base64_read(const char *text, size_t length, char *out, size_t *size)
{
    uint8_t digits[256];
    uint32_t bits = 0;
    unsigned count = 0;
    char *at = out;
    fill_digits(digits);
    while (length > 0 && text[length - 1] == '=') length--;
    for (size_t i = 0; i < length; i++) {
        if (text[i] == '\\' && i + 1 < length && text[i + 1] == '/') continue;
        uint8_t digit = digits[(unsigned char)text[i]];
        if (digit == NO_DIGIT) return false;
        bits = bits << 6 | digit;
        if (++count % 4 != 0) continue;
        *at++ = (char)(bits >> 16);
        *at++ = (char)(bits >> 8);
        *at++ = (char)bits;
    }
    unsigned rest = count % 4; /* 2 digits encode one byte, 3 digits encode two bytes */
    if (rest == 1) return false;
    if (rest >= 2) *at++ = (char)(bits >> (rest == 2 ? 4 : 10));
    if (rest == 3) *at++ = (char)(bits >> 2);
    *size = (size_t)(at - out);
    return true;
}

void gd__base64_write(const char *bytes, size_t size, char *out)
{
    for (size_t i = 0; i < size; i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; k++)
            bits = bits << 8 | (i + k < size ? (unsigned char)bytes[i + k] : 0);
        for (size_t k = 0; k < 4; k++)
            *out++ = i + k <= size ? alphabet[bits >> (18 - 6 * k) & 63] : '=';
    }
}
