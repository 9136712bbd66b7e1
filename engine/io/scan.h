/* Scan: a bounded cursor over the bytes of a file. Errors name lines or bytes of the file.
 *
 * Invariant: begin <= at <= end; nothing outside is read. Lines end with LF, CR LF or CR. Line
 * numbers are counted only when an error needs one. Blanks separate words within a line. Space
 * consists of blanks, line ends and, in formats that have them, comments. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "gd/control.h"
#include "gd/status.h"

struct gd__scan {
    const char *begin, *at, *end;
    struct gd_detail *detail; /* may be NULL */
    /* true if errors name bytes instead of lines; for binary data, and for JSON, which is often one
       long line */
    bool by_byte;
    bool comments; /* true if '#' begins a comment, which ends at the end of the line */
    /* true if a backslash at the end of a line continues the line on the next one */
    bool continued;
    /* deadline as in struct gd_control; checked at intervals while input is skipped; 0 means
       none */
    uint64_t deadline_ns;
};

/* A word of the input, not NUL-terminated. */
struct gd__word {
    const char *at;
    size_t length;
};

/* The beginning of a word for an error text. Bytes that are not printable ASCII are replaced by
 * '?'. */
struct gd__excerpt {
    char text[32];
};

struct gd__excerpt gd__excerpt(struct gd__word word);

/* Returns a scan at the beginning of `bytes`, or after a UTF-8 byte order mark. */
struct gd__scan gd__scan_begin(const void *bytes, size_t size, struct gd_detail *detail);

/* Returns the line of the position `at`, counted from 1. If errors name bytes, returns its byte
 * instead. */
uint64_t gd__scan_place(const struct gd__scan *scan, const char *at);

/* Writes "line 17: <sentence>" or "byte 99: <sentence>" to the detail, and stores the line or byte
 * as the detail's element. Returns `status`. */
enum gd_status gd__scan_fail(const struct gd__scan *scan, const char *at, enum gd_status status,
                             const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Fails with GD_TRUNCATED at the end of the input, or GD_SYNTAX elsewhere: "found 'x' where
 * <expected> should be". */
enum gd_status gd__scan_unexpected(const struct gd__scan *scan, const char *expected);

#define GD__SCAN_LOOK 65536 /* bytes between two checks of the deadline */

/* Returns the end of the text that may be parsed as a number at the cursor. A longer number is an
 * error. The limit keeps the time for one number short. */
static inline const char *gd__scan_number_end(const struct gd__scan *scan)
{
    return scan->end - scan->at < GD__SCAN_LOOK ? scan->end : scan->at + GD__SCAN_LOOK;
}

/* If the deadline has passed, moves the cursor to the end of the input and returns true. So a
 * reader that may have skipped input must call gd__scan_end at its end. */
bool gd__scan_is_over(struct gd__scan *scan);

/* If the deadline has passed, clears the detail and returns GD_DEADLINE, because the input may not
 * have been read to its end. Otherwise returns `status`. */
enum gd_status gd__scan_end(const struct gd__scan *scan, enum gd_status status);

static inline size_t gd__scan_left(const struct gd__scan *scan)
{
    return (size_t)(scan->end - scan->at);
}

static inline bool gd__is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static inline bool gd__is_newline(char c)
{
    return c == '\n' || c == '\r';
}

/* Returns true at the end of the line or of the input, or at a comment. */
static inline bool gd__scan_at_line_end(const struct gd__scan *scan)
{
    return scan->at == scan->end || gd__is_newline(*scan->at) ||
           (scan->comments && *scan->at == '#');
}

/* Skips blanks and continued line ends, of any number. */
void gd__scan_skip_all_blanks(struct gd__scan *scan);

/* Skips blanks and continued line ends. Most words follow a single blank. */
static inline void gd__scan_skip_blanks(struct gd__scan *scan)
{
    size_t blanks = scan->at < scan->end && gd__is_blank(*scan->at);
    if (gd__scan_left(scan) > blanks && !gd__is_blank(scan->at[blanks]) && scan->at[blanks] != '\\')
        scan->at += blanks;
    else
        gd__scan_skip_all_blanks(scan);
}

/* Advances to the beginning of the next line. */
void gd__scan_skip_line(struct gd__scan *scan);

/* Skips blanks, line ends and comments. */
void gd__scan_skip_space(struct gd__scan *scan);

/* Skips blanks and returns the next word; its length is 0 at the end of the line. */
struct gd__word gd__scan_word(struct gd__scan *scan);

static inline bool gd__word_is(struct gd__word word, const char *text)
{
    size_t length = strlen(text);
    return word.length == length && memcmp(word.at, text, length) == 0;
}

/* Like gd__word_is, but ignores the case of letters. */
bool gd__word_resembles(struct gd__word word, const char *text);

/* Skips blanks and parses a decimal number, which may be infinite or NaN. Errors: GD_SYNTAX,
 * GD_TRUNCATED. */
GD_MUST_USE enum gd_status gd__scan_number(struct gd__scan *scan, double *out);

/* Skips blanks and parses three numbers. */
GD_MUST_USE enum gd_status gd__scan_xyz(struct gd__scan *scan, double xyz[3]);

/* Skips blanks and parses a whole number without point and exponent, saturated at +-INT64_MAX.
 * Errors: GD_SYNTAX, GD_TRUNCATED. */
GD_MUST_USE enum gd_status gd__scan_integer(struct gd__scan *scan, int64_t *out);
