/* Scan: a bounded cursor over the bytes of a file, and the places that errors name.
 *
 * Invariant: begin <= at <= end; nothing outside is read. Lines end with LF, CR LF or CR; a place's
 * line is counted only when an error names it. Blanks separate words within a line, space is blanks
 * and line ends and, where a format has them, comments. */
#ifndef GD_IO_SCAN_H
#define GD_IO_SCAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/status.h"

struct gd__scan {
    const char *begin, *at, *end;
    struct gd_detail *detail; /* may be NULL */
    /* errors name bytes, not lines: binary data, and JSON, which is often one long line */
    bool by_byte;
    bool comments;  /* '#' begins a comment that runs to the end of its line */
    bool continued; /* a backslash at the end of a line joins the next one to it */
    /* of the reading, as a gd_control's: looked at where much is skipped; 0: none */
    uint64_t deadline_ns;
};

/* A word of the input, not NUL-terminated. */
struct gd__word {
    const char *at;
    size_t length;
};

/* The beginning of a word, fit to be shown: what is not printable ASCII is '?'. */
struct gd__excerpt {
    char text[32];
};

struct gd__excerpt gd__excerpt(struct gd__word word);

/* At the beginning of `bytes`, or behind the UTF-8 byte order mark that some editors put there. */
struct gd__scan gd__scan_begin(const void *bytes, size_t size, struct gd_detail *detail);

/* Returns `status` with "line 17: <sentence>" or "byte 99: <sentence>" in the detail, and that
 * place as its element. */
enum gd_status gd__scan_fail(const struct gd__scan *scan, const char *at, enum gd_status status,
                             const char *format, ...) __attribute__((format(printf, 4, 5)));

/* GD_TRUNCATED at the end of the input, GD_SYNTAX elsewhere: "found 'x' where <expected> should
 * be". */
enum gd_status gd__scan_unexpected(const struct gd__scan *scan, const char *expected);

#define GD__SCAN_LOOK 65536 /* bytes that are skipped between two looks at the deadline */

/* When the deadline has passed, goes to the end of the input and returns true. A reader that may
 * have skipped something ends by gd__scan_end. */
bool gd__scan_is_over(struct gd__scan *scan);

/* GD_DEADLINE when the deadline has passed, since then the end that was read may not have been the
 * input's; else `status`. */
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

/* At the end of the line, of what counts of it (a comment follows), or of the input. */
static inline bool gd__scan_at_line_end(const struct gd__scan *scan)
{
    return scan->at == scan->end || gd__is_newline(*scan->at) ||
           (scan->comments && *scan->at == '#');
}

/* Past the blanks, and past line ends that are `continued`. */
void gd__scan_skip_blanks(struct gd__scan *scan);

/* To the beginning of the next line. */
void gd__scan_skip_line(struct gd__scan *scan);

/* Past blanks, line ends and comments. */
void gd__scan_skip_space(struct gd__scan *scan);

/* Past blanks and the word behind them; length 0 at the end of the line. */
struct gd__word gd__scan_word(struct gd__scan *scan);

bool gd__word_is(struct gd__word word, const char *text);

/* As gd__word_is, letters of either case. */
bool gd__word_resembles(struct gd__word word, const char *text);

/* Past blanks and a decimal number; it may be infinite or NaN. GD_SYNTAX, GD_TRUNCATED. */
GD_MUST_USE enum gd_status gd__scan_number(struct gd__scan *scan, double *out);

/* Past blanks and three numbers. */
GD_MUST_USE enum gd_status gd__scan_xyz(struct gd__scan *scan, double xyz[3]);

/* Past blanks and a whole number without point and exponent, saturated at +-INT64_MAX. GD_SYNTAX,
 * GD_TRUNCATED. */
GD_MUST_USE enum gd_status gd__scan_integer(struct gd__scan *scan, int64_t *out);

#endif
