/* Batch: queries and their answers as lines of NDJSON.
 *
 *     size_t begin = proto_batch_begin(&writer);
 *     if (proto_batch_decode(&line, &query, &problem))
 *         ... solve; write the answer, an object; proto_batch_end(&writer, begin) ...
 *     else
 *         proto_batch_refuse(&writer, begin, &line, &problem);
 *
 * A line is the body of a query, with the query's name as "query", and optionally "select"
 * (formerly "fields") and "geometry". An answer's line has "status" and the members of the query's
 * answer or problem. */
#pragma once

#include <jansson.h>

#include "proto/http/options.h"
#include "proto/http/route.h"
#include "proto/json/writer.h"

#define PROTO_BATCH_LINE   (256 << 10) /* most bytes of a line */
#define PROTO_BATCH_SELECT 256         /* most bytes of "select", its NUL included */

struct proto_batch_line { /* all zero means before the first line */
    const char *text;     /* points into the batch; without the line end */
    size_t size;
    size_t end;      /* offset in the batch where the next line begins */
    uint32_t number; /* number of the line, from 1; blank lines count */
};

/* Advances to the next line that is not blank. Returns false at the end. */
bool proto_batch_next(const char *text, size_t size, struct proto_batch_line *line);

#define PROTO_BATCH_NAME 64 /* including the NUL */

struct proto_batch_query { /* all zero means empty */
    json_t *document;      /* the query's own body, without the line's members */
    char name[PROTO_BATCH_NAME];
    char select[PROTO_BATCH_SELECT]; /* written as in a query string */
    char geometry[PROTO_BATCH_NAME];
    bool has_select, has_geometry;
    bool is_former; /* true if the line has "fields" instead of "select" */
};

/* Problems: invalid_request, with pointers into the line; too_large. The caller frees the result by
 * proto_batch_query_free. */
bool proto_batch_decode(const struct proto_batch_line *line, struct proto_batch_query *out,
                        struct proto_problem *problem);
void proto_batch_query_free(struct proto_batch_query *query); /* may be called repeatedly */

/* Reads the options of a line. The batch's query string, which is already checked, gives the
 * defaults. `route` is the route of the line's query as a single request. Problem:
 * invalid_request. */
bool proto_batch_options(const struct proto_batch_query *query,
                         const struct proto_parameters *defaults, const struct proto_route *route,
                         struct proto_options *out, struct proto_problem *problem);

/* Begins an answer's line with the status 200. Returns the line's offset. */
size_t proto_batch_begin(struct proto_writer *writer);

/* Ends the line that began at `begin`, after the caller has written the answer, which is one
 * object. */
void proto_batch_end(struct proto_writer *writer, size_t begin);

/* Replaces all text since `begin` by a problem's line, even if the writer failed within that
 * text. */
void proto_batch_refuse(struct proto_writer *writer, size_t begin,
                        const struct proto_batch_line *line, struct proto_problem *problem);
