#include "proto/json/number.h"

#include <math.h>
#include <string.h>

#include "gd/number.h"

static const char digit_pairs[] = "0001020304050607080910111213141516171819202122232425262728293031"
                                  "3233343536373839404142434445464748"
                                  "4950515253545556575859606162636465666768697071727374757677787980"
                                  "818283848586878889909192939495969798"
                                  "99";

size_t proto_integer_print(uint64_t value, char *out)
{
    char digits[PROTO_INTEGER_SIZE];
    size_t at = sizeof digits;
    for (; value >= 100; value /= 100)
        memcpy(digits + (at -= 2), digit_pairs + 2 * (value % 100), 2);
    if (value >= 10)
        memcpy(digits + (at -= 2), digit_pairs + 2 * value, 2);
    else
        digits[--at] = (char)('0' + value);
    memcpy(out, digits + at, sizeof digits - at);
    return sizeof digits - at;
}

static size_t digits_at(const char *text)
{
    size_t count = 0;
    while (text[count] >= '0' && text[count] <= '9') count++;
    return count;
}

/* Returns the length of a JSON number (RFC 8259, 6) at the start of the text, or 0. */
static size_t number_length(const char *text)
{
    const char *at = text;
    if (*at == '-') at++;
    size_t whole = digits_at(at);
    if (whole == 0 || (whole > 1 && *at == '0')) return 0;
    at += whole;
    if (*at == '.') {
        size_t fraction = digits_at(++at);
        if (fraction == 0) return 0;
        at += fraction;
    }
    if (*at == 'e' || *at == 'E') {
        at++;
        if (*at == '+' || *at == '-') at++;
        size_t exponent = digits_at(at);
        if (exponent == 0) return 0;
        at += exponent;
    }
    /* rejects "0x10", of which only the 0 is a number */
    if (*at == 'x' || *at == 'X') return 0;
    return (size_t)(at - text);
}

size_t proto_number_parse(const char *text, double *out)
{
    size_t length = number_length(text);
    if (length == 0) return 0;
    double value;
    if (!gd_number_parse(text, text + length, &value) || !isfinite(value)) return 0;
    *out = value;
    return length;
}

size_t proto_integer_parse(const char *text, uint64_t *out)
{
    size_t length = digits_at(text);
    if (length == 0 || (length > 1 && text[0] == '0')) return 0;
    uint64_t value = 0;
    for (size_t i = 0; i < length; i++) {
        uint64_t digit = (uint64_t)(text[i] - '0');
        if (value > (UINT64_MAX - digit) / 10) return 0;
        value = 10 * value + digit;
    }
    *out = value;
    return length;
}
