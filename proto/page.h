/* Page: a part of a list, by `limit` and `after`; the answer's `next` is the `after` of the next page. */
#ifndef PROTO_PAGE_H
#define PROTO_PAGE_H

#include "proto/options.h"
#include "proto/writer.h"

#define PROTO_PAGE_DEFAULT 100
#define PROTO_PAGE_MOST    1000

struct proto_page {
    uint32_t limit;    /* 1 to PROTO_PAGE_MOST */
    const char *after; /* items that follow this one; NULL: from the first. Lives as long as the query string */
};

/* Reads limit and after, and refuses any other parameter. invalid_request. */
bool proto_page_parse(const struct proto_parameters *parameters, struct proto_page *out, struct proto_problem *problem);

/* Writes a list: its begin, each item, its end. `name` of the list ("meshes"); `next`: the cursor of the next page; NULL: this
 * is the last. */
void proto_page_begin(struct proto_writer *writer, const char *name);
void proto_page_end(struct proto_writer *writer, const char *next);

#endif
