#include "io/json_text.h"

#include <stdio.h>

#include "gd/number.h"

void gd__json_skip_space(struct gd__scan *scan)
{
    for (;;) {
        const char *stop =
            gd__scan_left(scan) < GD__SCAN_LOOK ? scan->end : scan->at + GD__SCAN_LOOK;
        while (scan->at < stop &&
               (*scan->at == ' ' || *scan->at == '\t' || gd__is_newline(*scan->at)))
            scan->at++;
        if (scan->at < stop || stop == scan->end || gd__scan_is_over(scan)) return;
    }
}

bool gd__json_accept(struct gd__scan *scan, char c)
{
    gd__json_skip_space(scan);
    if (scan->at == scan->end || *scan->at != c) return false;
    scan->at++;
    return true;
}

enum gd_status gd__json_expect(struct gd__scan *scan, char c)
{
    return gd__json_accept(scan, c) ? GD_OK
                                    : gd__scan_unexpected(scan, (char[]){'\'', c, '\'', '\0'});
}

static const char *skip_digits(const char *at, const char *end)
{
    while (at < end && *at >= '0' && *at <= '9') at++;
    return at;
}

/* Returns the end of the number at `at`, or `at` if there is no number. JSON allows fewer forms of
 * numbers than the other formats. */
static const char *number_end(const char *at, const char *end)
{
    const char *integer = at < end && *at == '-' ? at + 1 : at;
    const char *next = skip_digits(integer, end);
    if (next == integer || (*integer == '0' && next - integer > 1)) return at;
    if (next < end && *next == '.') {
        const char *fraction = next + 1;
        next = skip_digits(fraction, end);
        if (next == fraction) return at;
    }
    if (next < end && (*next == 'e' || *next == 'E')) {
        const char *exponent = next + 1;
        if (exponent < end && (*exponent == '+' || *exponent == '-')) exponent++;
        next = skip_digits(exponent, end);
        if (next == exponent) return at;
    }
    return next;
}

enum gd_status gd__json_number(struct gd__scan *scan, double *out)
{
    gd__json_skip_space(scan);
    const char *end = number_end(scan->at, gd__scan_number_end(scan));
    if (end == scan->at) return gd__scan_unexpected(scan, "a JSON number");
    scan->at = gd_number_parse(scan->at, end, out);
    return GD_OK;
}

enum gd_status gd__json_string_run(struct gd__scan *scan, const char *what, size_t most)
{
    char rest[64];
    const char *stop = gd__scan_left(scan) < most ? scan->end : scan->at + most;
    while (scan->at < stop && *scan->at != '"') {
        if ((unsigned char)*scan->at < ' ') {
            snprintf(rest, sizeof rest, "the rest of %s", what);
            return gd__scan_unexpected(scan, rest);
        }
        scan->at += *scan->at == '\\' && gd__scan_left(scan) > 1 ? 2 : 1;
    }
    return GD_OK;
}

enum gd_status gd__json_string(struct gd__scan *scan, const char *what, struct gd__word *out)
{
    gd__json_skip_space(scan);
    const char *begin = scan->at;
    if (!gd__json_accept(scan, '"')) return gd__scan_unexpected(scan, what);
    enum gd_status status = gd__json_string_run(scan, what, SIZE_MAX);
    if (status != GD_OK) return status;
    *out = (struct gd__word){begin, (size_t)(scan->at - begin) + 1};
    return gd__json_expect(scan, '"');
}

/* Returns true if the text begins with the escape \u0041 of the character. Reads nothing after the
 * first difference. */
static bool escape_is(const char *at, char character)
{
    static const char digits[] = "0123456789abcdef";
    const char wanted[] = {'\\', 'u', '0', '0', digits[character >> 4], digits[character & 15]};
    for (size_t i = 0; i < sizeof wanted; i++)
        if (at[i] != wanted[i] && !(at[i] >= 'A' && at[i] <= 'F' && at[i] + 'a' - 'A' == wanted[i]))
            return false;
    return true;
}

bool gd__json_string_is(const char *string, const char *text)
{
    const char *at = string + 1;
    for (; *text; text++) {
        if (*at != *text && !escape_is(at, *text)) return false;
        at += *at == *text ? 1 : 6;
    }
    return *at == '"';
}
