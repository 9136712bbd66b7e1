/* Parse: text to a JSON document by jansson, whose parser does not stand want of memory: its lexer looks at no failure of its buffer, so that characters
 * are lost in silence, or an assertion of its own ends the process. Here it is left at the first block that it does not get, and what it has taken
 * is given back. Thread-safe. */
#ifndef PROTO_PARSE_H
#define PROTO_PARSE_H

#include <stdbool.h>
#include <stddef.h>

#include <jansson.h>

/* The document, owned by the caller; no member twice, all numbers are json_real. NULL: `*error` says what is wrong with the text, or `*is_starved`
 * that there was no memory. */
json_t *proto_parse(const char *text, size_t size, json_error_t *error, bool *is_starved);

#endif
