/* Batch: queries as lines of NDJSON, and their answers as lines of NDJSON.
 *
 *     struct proto_batch_line line = {0};
 *     while (proto_batch_next(text, size, &line)) {
 *         struct proto_batch_query query;
 *         size_t begin = proto_batch_begin(&writer);
 *         if (!proto_batch_decode(&line, &query, &problem)) {
 *             proto_batch_refuse(&writer, begin, &line, &problem);
 *             continue;
 *         }
 *         ... solve; write the answer, an object; proto_batch_query_free(&query) ...
 *         proto_batch_end(&writer, begin);
 *     }
 *
 * A line is the body of a query with its name, {"query": "distance", …}, and perhaps "select" (a
 * string as in the query string, or an array of names; formerly "fields") and "geometry". Its answer is {"status":
 * 200, …the answer} or {"status": 4xx, …the problem}, which names the line. */
#ifndef PROTO_BATCH_H
#define PROTO_BATCH_H

#include <jansson.h>

#include "proto/http/options.h"
#include "proto/json/writer.h"

#define PROTO_BATCH_LINE   (256 << 10) /* most bytes of a line */
#define PROTO_BATCH_SELECT 256         /* most bytes of "select", its NUL included */

struct proto_batch_line { /* all zero stands before the first line */
    const char *text;     /* within the batch; without its end of line */
    size_t size;
    size_t end;      /* where the next line begins in the batch */
    uint32_t number; /* from 1; blank lines count */
};

/* Goes to the next line that is not blank; false when there is none. */
bool proto_batch_next(const char *text, size_t size, struct proto_batch_line *line);

#define PROTO_BATCH_NAME 64 /* with its NUL */

struct proto_batch_query { /* all zero is an empty one */
    json_t *document;      /* the query's own body: what was not the line's */
    char name[PROTO_BATCH_NAME];
    char select[PROTO_BATCH_SELECT]; /* as in the query string */
    char geometry[PROTO_BATCH_NAME];
    bool has_select, has_geometry;
    bool is_former; /* the line says "fields" instead of "select" */
};

/* invalid_request, with pointers into the line; too_large. Freed by proto_batch_query_free. */
bool proto_batch_decode(const struct proto_batch_line *line, struct proto_batch_query *out,
                        struct proto_problem *problem);
void proto_batch_query_free(struct proto_batch_query *query); /* a second time is harmless */

/* The options of the batch's query string, but for the fields: what fields there are is known by
 * line. invalid_request. */
bool proto_batch_parse(const struct proto_parameters *parameters, struct proto_options *out,
                       struct proto_problem *problem);

/* The options of a line: its own, and those of the batch's query string for what it does not say.
 * `fields`: the names of its answer's fields. invalid_request. */
bool proto_batch_options(const struct proto_batch_query *query,
                         const struct proto_parameters *defaults, const char *const *fields,
                         struct proto_options *out, struct proto_problem *problem);

/* Begins a line of the answer, whose status is 200; returns where. */
size_t proto_batch_begin(struct proto_writer *writer);

/* Ends the line that began there, behind which an answer was written: one object. */
void proto_batch_end(struct proto_writer *writer, size_t begin);

/* Makes the line that began there a problem, whatever was written behind, even if the writer failed
 * by it. */
void proto_batch_refuse(struct proto_writer *writer, size_t begin,
                        const struct proto_batch_line *line, struct proto_problem *problem);

#endif
