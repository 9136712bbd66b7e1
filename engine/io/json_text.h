/* JSON text (RFC 8259): parses tokens, for readers that expect a fixed structure, and for
 * json_tree.h. Errors are those of gd__scan_unexpected. */
#pragma once

#include "io/scan.h"

void gd__json_skip_space(struct gd__scan *scan);

/* Skips space. Returns true if the next character is `c`, and skips `c` then. */
bool gd__json_accept(struct gd__scan *scan, char c);
GD_MUST_USE enum gd_status gd__json_expect(struct gd__scan *scan, char c);

/* Skips space and parses a number. A number that is too large for a double becomes infinite. */
GD_MUST_USE enum gd_status gd__json_number(struct gd__scan *scan, double *out);

/* Advances within a string by about `most` bytes, or to the quote that ends the string. */
GD_MUST_USE enum gd_status gd__json_string_run(struct gd__scan *scan, const char *what,
                                               size_t most);

/* Skips space and parses a string. `*out` is the raw text with its quotes and escapes. `what`
 * names the expected string in an error ("a key"). */
GD_MUST_USE enum gd_status gd__json_string(struct gd__scan *scan, const char *what,
                                           struct gd__word *out);

/* Returns true if the parsed string, which begins at its opening quote, means `text`. Any character
 * may be escaped as \u0041. `text` is ASCII without quotes, backslashes and control characters. */
bool gd__json_string_is(const char *string, const char *text);
