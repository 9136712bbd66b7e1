/* Result: an answer as a file of gd/result_file.h, within the byte budget. */
#ifndef SERVER_QUERY_RESULT_H
#define SERVER_QUERY_RESULT_H

#include "gd/path.h"
#include "gd/result_file.h"
#include "server/query/query.h"

/* Writes the result, with the query's mesh if so asked. The bytes are counted as the exchange's
 * `held`. False with the problem. */
bool server_result_write(const struct server_query *query, const struct gd_result *result,
                         bool with_mesh, enum gd_result_format format, char **bytes, size_t *size,
                         struct proto_problem *problem);

/* The formats of lines: the first of an answer's other forms (form.h). */
#define SERVER_RESULT_LINE_FORMS                                                                   \
    {"obj", "model/obj", true}, {"glb", "model/gltf-binary", true},                                \
    {                                                                                              \
        "csv", "text/csv", false                                                                   \
    }
#define SERVER_RESULT_LINE_FORMS_END (SERVER_FORM_FIRST + 3)

/* Paths, borrowed, at least one. */
struct server_result_lines {
    const struct gd_path *paths;
    const double *levels; /* struct gd_result's; NULL: they have none */
    uint32_t count;
};

/* The same of paths, as a line each, in the query's form, which is one of those. */
bool server_result_write_lines(const struct server_query *query,
                               const struct server_result_lines *lines, char **bytes, size_t *size,
                               struct proto_problem *problem);

/* The same of a path and the faces that it runs through, laid flat and drawn (proto/flat_strip.h).
 */
bool server_result_write_strip(const struct server_query *query, const struct gd_path *path,
                               char **bytes, size_t *size, struct proto_problem *problem);

/* Refuses a file of what there is not; `why` begins a sentence. False. */
bool server_result_refuse_nothing(struct proto_problem *problem, const char *why);

#endif
