/* Bulk points: reads lists of points from the text of a request, without a document. A document
 * would take a hundred times as much memory, and most of the request's time.
 *
 * Only plain text is read: {"from": […], "to": […]} with points in one of the forms {"vertex": 1},
 * {"face": 1, "barycentric": [0.2, 0.3, 0.5]} and {"xyz": [1, 2, 3]}. If the text is anything else,
 * the functions return false, and the caller parses the document. The document's parser accepts the
 * other forms, too, and reports faults. Both parsers must give the same result for plain text. */
#pragma once

#include "generated/values.h"

/* A range of the text. */
struct proto_bulk_text {
    const char *at, *end;
};

/* Removes from the text the opening brace or the comma before the next member, the member's name,
 * and the bracket that opens its list. Returns the index of the name in `names` (NULL-terminated),
 * or -1 if the text is not plain. */
int proto_bulk_open(struct proto_bulk_text *text, const char *const *names, bool is_first);

/* Finds the next `most` points of a list, or the rest of it if that is less. Sets *points to their
 * text, which ends with the comma or the closing bracket after the last point, and removes this
 * text from `*text`. Returns the number of points, or 0 if the text is not plain. */
uint32_t proto_bulk_split(struct proto_bulk_text *text, uint32_t most,
                          struct proto_bulk_text *points, bool *is_last);

/* Reads the next point and the comma or bracket after it. The place of the point stays empty. */
bool proto_bulk_point(struct proto_bulk_text *points, struct proto_point *out);

/* Returns true if nothing but the closing brace is left. */
bool proto_bulk_end(struct proto_bulk_text *text);
