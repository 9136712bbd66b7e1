/* Page: a part of a list, selected by `limit` and `after`. The answer's `next` is the `after` of
 * the next page. */
#pragma once

#include "proto/http/options.h"
#include "proto/json/writer.h"

#define PROTO_PAGE_DEFAULT 100
#define PROTO_PAGE_MOST    1000
/* a page ends after the item with which it exceeds this size, even if it has fewer than `limit`
 * items */
#define PROTO_PAGE_BYTES  ((size_t)1 << 20)
#define PROTO_PAGE_NUMBER 24 /* bytes of a number's text */

struct proto_page {
    uint32_t limit; /* 1 to PROTO_PAGE_MOST */
    /* the page starts after this item, or with the first item if this is NULL. Lives as long as the
       query string */
    const char *after;
    /* prefix of the names of all items; NULL means any name. Lives as long as the query string */
    const char *prefix;
};

/* Reads limit and after, and rejects any other parameter with invalid_request. */
bool proto_page_parse(const struct proto_parameters *parameters, struct proto_page *out,
                      struct proto_problem *problem);

/* Like proto_page_parse, but also accepts `prefix`, for a list of names. */
bool proto_page_parse_names(const struct proto_parameters *parameters, struct proto_page *out,
                            struct proto_problem *problem);

/* Reads the cursor `after` of a numbered list, or -1 if there is none. Problem: invalid_request. */
bool proto_page_number(const struct proto_page *page, int64_t *out, struct proto_problem *problem);

/* Writes the cursor of a numbered list into `text` and returns it. */
const char *proto_page_write_number(int64_t number, char text[PROTO_PAGE_NUMBER]);

/* Begin and end a page; the caller writes the items in between. `name` is the list's name
 * ("meshes"). `next` is the cursor of the next page; NULL means that this page is the last. */
void proto_page_begin(struct proto_writer *writer, const char *name);
void proto_page_end(struct proto_writer *writer, const char *next);
