#include "io/scan.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "gd/number.h"

struct gd__scan gd__scan_begin(const void *bytes, size_t size, struct gd_detail *detail)
{
    struct gd__scan scan = {.begin = bytes, .at = bytes, .detail = detail};
    /* `bytes` of an empty file may be NULL */
    scan.end = size ? scan.begin + size : scan.begin;
    if (size >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0) scan.at += 3;
    return scan;
}

static uint64_t line_of(const struct gd__scan *scan, const char *at)
{
    uint64_t ends = 0;
    /* excludes the last byte of the input, because the loop also reads the following byte */
    const char *last = at > scan->begin && at == scan->end ? at - 1 : at;
    for (const char *c = scan->begin; c < last; c++)
        ends += (*c == '\n') | ((*c == '\r') & (c[1] != '\n'));
    return 1 + ends + (last < at && gd__is_newline(*last));
}

uint64_t gd__scan_place(const struct gd__scan *scan, const char *at)
{
    return scan->by_byte ? (uint64_t)(at - scan->begin) : line_of(scan, at);
}

bool gd__scan_is_over(struct gd__scan *scan)
{
    if (!scan->deadline_ns || gd_now_ns() < scan->deadline_ns) return false;
    scan->at = scan->end;
    return true;
}

enum gd_status gd__scan_end(const struct gd__scan *scan, enum gd_status status)
{
    if (!scan->deadline_ns || gd_now_ns() < scan->deadline_ns) return status;
    if (scan->detail) *scan->detail = (struct gd_detail){0};
    return GD_DEADLINE;
}

enum gd_status gd__scan_fail(const struct gd__scan *scan, const char *at, enum gd_status status,
                             const char *format, ...)
{
    /* After the deadline the line number is not computed, because gd__scan_end replaces the
       status. */
    if (!scan->detail || gd__scan_end(scan, GD_OK)) return status;
    char sentence[GD_DETAIL_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    uint64_t place = gd__scan_place(scan, at);
    gd_fail(scan->detail, status, "%s %llu: %s", scan->by_byte ? "byte" : "line",
            (unsigned long long)place, sentence);
    gd_detail_add(scan->detail, scan->by_byte ? GD_ELEMENT_BYTE : GD_ELEMENT_LINE, place, 0);
    return status;
}

struct gd__excerpt gd__excerpt(struct gd__word word)
{
    struct gd__excerpt excerpt = {{0}};
    for (size_t i = 0; i < word.length && i + 1 < sizeof excerpt.text; i++) {
        unsigned char c = (unsigned char)word.at[i];
        excerpt.text[i] = c > ' ' && c < 0x7F ? (char)c : '?';
    }
    return excerpt;
}

enum gd_status gd__scan_unexpected(const struct gd__scan *scan, const char *expected)
{
    if (scan->at == scan->end) {
        return gd__scan_fail(scan, scan->at, GD_TRUNCATED, "the input ends where %s should be",
                             expected);
    }
    if (gd__scan_at_line_end(scan)) {
        return gd__scan_fail(scan, scan->at, GD_SYNTAX, "the line ends where %s should be",
                             expected);
    }
    struct gd__scan ahead = *scan;
    struct gd__excerpt found = gd__excerpt(gd__scan_word(&ahead));
    return gd__scan_fail(scan, scan->at, GD_SYNTAX, "found '%s' where %s should be", found.text,
                         expected);
}

/* Skips one line end, if the cursor is at one. */
static void skip_newline(struct gd__scan *scan)
{
    char c = scan->at < scan->end ? *scan->at : '\0';
    if (gd__is_newline(c)) scan->at++;
    if (c == '\r' && scan->at < scan->end && *scan->at == '\n') scan->at++;
}

/* Returns true at a backslash that continues the line on the next one. */
static bool at_joint(const struct gd__scan *scan)
{
    return scan->continued && gd__scan_left(scan) > 1 && *scan->at == '\\' &&
           gd__is_newline(scan->at[1]);
}

/* Skips the characters for which `is_of_kind` returns true. */
static inline void skip_run(struct gd__scan *scan, bool (*is_of_kind)(char c))
{
    for (;;) {
        const char *stop =
            gd__scan_left(scan) < GD__SCAN_LOOK ? scan->end : scan->at + GD__SCAN_LOOK;
        while (scan->at < stop && is_of_kind(*scan->at)) scan->at++;
        if (scan->at < stop || stop == scan->end || gd__scan_is_over(scan)) return;
    }
}

/* Called for each skipped byte. Checks the deadline at intervals. */
static inline bool is_to_end(struct gd__scan *scan)
{
    return ((uintptr_t)scan->at & (GD__SCAN_LOOK - 1)) == 0 && gd__scan_is_over(scan);
}

static bool is_space(char c)
{
    return gd__is_blank(c) || gd__is_newline(c);
}

void gd__scan_skip_all_blanks(struct gd__scan *scan)
{
    for (;;) {
        skip_run(scan, gd__is_blank);
        if (!at_joint(scan)) return;
        scan->at++;
        skip_newline(scan);
    }
}

void gd__scan_skip_line(struct gd__scan *scan)
{
    bool joined = true;
    while (joined) {
        const char *line = scan->at;
        while (!gd__scan_at_line_end(scan) && !is_to_end(scan)) scan->at++;
        bool commented = scan->at < scan->end && !gd__is_newline(*scan->at);
        joined = scan->continued && !commented && scan->at > line && scan->at[-1] == '\\';
        while (scan->at < scan->end && !gd__is_newline(*scan->at) && !is_to_end(scan)) scan->at++;
        skip_newline(scan);
    }
}

void gd__scan_skip_space(struct gd__scan *scan)
{
    for (;;) {
        skip_run(scan, is_space);
        if (scan->at == scan->end || !scan->comments || *scan->at != '#') return;
        gd__scan_skip_line(scan);
    }
}

struct gd__word gd__scan_word(struct gd__scan *scan)
{
    gd__scan_skip_blanks(scan);
    const char *begin = scan->at;
    while (!gd__scan_at_line_end(scan) && !gd__is_blank(*scan->at) && !at_joint(scan) &&
           !is_to_end(scan))
        scan->at++;
    return (struct gd__word){begin, (size_t)(scan->at - begin)};
}

bool gd__word_resembles(struct gd__word word, const char *text)
{
    return word.length == strlen(text) && strncasecmp(word.at, text, word.length) == 0;
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Returns true if the number that ends at `at` is part of a longer word, such as 0x1p3, 1.5.2 or
 * 1,5. */
static bool runs_on(const struct gd__scan *scan, const char *at)
{
    if (at == scan->end) return false;
    unsigned char c = (unsigned char)*at;
    bool is_letter = (c | 32) >= 'a' && (c | 32) <= 'z';
    return is_letter || is_digit(*at) || c == '.' || c == ',' || c == '_' || c == '-' || c == '+';
}

/* Rejects infinities and NaNs in the form that C libraries of Windows print, such as 1.#INF,
 * -1.#IND, 1.#QNAN. */
static enum gd_status refuse_nan(const struct gd__scan *scan, const char *hash)
{
    size_t length = (size_t)(hash - scan->at);
    while (scan->at + length < scan->end && isgraph((unsigned char)scan->at[length]) &&
           length < sizeof(struct gd__excerpt))
        length++;
    return gd__scan_fail(scan, scan->at, GD_NON_FINITE, "'%s' is not a finite number",
                         gd__excerpt((struct gd__word){scan->at, length}).text);
}

enum gd_status gd__scan_number(struct gd__scan *scan, double *out)
{
    gd__scan_skip_blanks(scan);
    const char *end = gd_number_parse(scan->at, gd__scan_number_end(scan), out);
    if (end && end < scan->end && *end == '#' && end[-1] == '.') return refuse_nan(scan, end);
    if (!end || runs_on(scan, end)) return gd__scan_unexpected(scan, "a number");
    scan->at = end;
    return GD_OK;
}

enum gd_status gd__scan_xyz(struct gd__scan *scan, double xyz[3])
{
    enum gd_status status = GD_OK;
    for (int axis = 0; axis < 3 && status == GD_OK; axis++)
        status = gd__scan_number(scan, &xyz[axis]);
    return status;
}

#define SHORT_DIGITS 18 /* decimal digits that always fit into 64 bits */

enum gd_status gd__scan_integer(struct gd__scan *scan, int64_t *out)
{
    gd__scan_skip_blanks(scan);
    const char *at = scan->at, *end = gd__scan_number_end(scan);
    bool negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) at++;
    const char *digits = at, *short_end = end - at > SHORT_DIGITS ? at + SHORT_DIGITS : end;
    int64_t value = 0;
    for (; at < short_end && is_digit(*at); at++) value = 10 * value + (*at - '0');
    for (; at < end && is_digit(*at); at++) {
        bool fits = value <= (INT64_MAX - 9) / 10;
        value = fits ? 10 * value + (*at - '0') : INT64_MAX;
    }
    if (at == digits || runs_on(scan, at)) return gd__scan_unexpected(scan, "a whole number");
    scan->at = at;
    *out = negative ? -value : value;
    return GD_OK;
}
