/* Parse: text to a JSON document by jansson, whose parser does not stand want of memory: its lexer
 * looks at no failure of its buffer, so that characters are lost in silence, or an assertion of its
 * own ends the process. Here it is left at the first block that it does not get, and what it has
 * taken is given back. Thread-safe. */
#ifndef PROTO_PARSE_H
#define PROTO_PARSE_H

#include <stddef.h>

#include <jansson.h>

#include "gd/control.h"

#define PROTO_PARSE_DEPTH 32 /* deepest nesting of arrays and objects */

/* Why there is no document. */
struct proto_parse_end {
    /* GD_NO_MEMORY, GD_DEADLINE, GD_CANCELLED; GD_OK: the text is at fault */
    enum gd_status status;
    size_t deep_at;     /* offset of the bracket that nests too deep, and 1; 0: none does */
    json_error_t error; /* else */
};

/* The document, owned by the caller; no member twice, all numbers are json_real. `control` may be
 * NULL. */
json_t *proto_parse(const char *text, size_t size, const struct gd_control *control,
                    struct proto_parse_end *end);

#endif
