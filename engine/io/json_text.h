/* JSON text (RFC 8259): its words, for readers that know what they expect, and for the tree of a
 * document (json_tree.h). Errors are those of gd__scan_unexpected. */
#ifndef GD_IO_JSON_TEXT_H
#define GD_IO_JSON_TEXT_H

#include "io/scan.h"

void gd__json_skip_space(struct gd__scan *scan);

/* Past space and `c`, if that comes next. */
bool gd__json_accept(struct gd__scan *scan, char c);
GD_MUST_USE enum gd_status gd__json_expect(struct gd__scan *scan, char c);

/* Past space and a number, which may be too large for a double: then it is infinite. */
GD_MUST_USE enum gd_status gd__json_number(struct gd__scan *scan, double *out);

/* Within a string: past some `most` bytes, or to the quote that ends it. */
GD_MUST_USE enum gd_status gd__json_string_run(struct gd__scan *scan, const char *what,
                                               size_t most);

/* Past a string; `*out` is what is written, quotes included and nothing unescaped. `what` is called
 * for if there is none ("a key"). */
GD_MUST_USE enum gd_status gd__json_string(struct gd__scan *scan, const char *what,
                                           struct gd__word *out);

#endif
