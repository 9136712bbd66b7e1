/* Page: a part of a list, by `limit` and `after`; the answer's `next` is the `after` of the next
 * page. */
#ifndef PROTO_PAGE_H
#define PROTO_PAGE_H

#include "proto/http/options.h"
#include "proto/json/writer.h"

#define PROTO_PAGE_DEFAULT 100
#define PROTO_PAGE_MOST    1000
/* after which a page ends, however many items it may have */
#define PROTO_PAGE_BYTES  ((size_t)1 << 20)
#define PROTO_PAGE_NUMBER 24 /* bytes of a number's text */

struct proto_page {
    uint32_t limit; /* 1 to PROTO_PAGE_MOST */
    /* items that follow this one; NULL: from the first. Lives as long as the query string */
    const char *after;
    /* begin of the names of all items; NULL: any name. Lives as long as the query string */
    const char *prefix;
};

/* Reads limit and after, and refuses any other parameter. invalid_request. */
bool proto_page_parse(const struct proto_parameters *parameters, struct proto_page *out,
                      struct proto_problem *problem);

/* The same for a list of names, which has `prefix`, too. */
bool proto_page_parse_names(const struct proto_parameters *parameters, struct proto_page *out,
                            struct proto_problem *problem);

/* The cursor `after` of a list that is numbered: -1 for none. invalid_request. */
bool proto_page_number(const struct proto_page *page, int64_t *out, struct proto_problem *problem);

/* Such a cursor's text, in `text`. */
const char *proto_page_write_number(int64_t number, char text[PROTO_PAGE_NUMBER]);

/* Writes a list: its begin, each item, its end. `name` of the list ("meshes"); `next`: the cursor
 * of the next page; NULL: this is the last. */
void proto_page_begin(struct proto_writer *writer, const char *name);
void proto_page_end(struct proto_writer *writer, const char *next);

#endif
