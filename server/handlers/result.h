/* Result: an answer as a file of gd/result_file.h, within the byte budget. */
#ifndef SERVER_HANDLERS_RESULT_H
#define SERVER_HANDLERS_RESULT_H

#include "gd/path.h"
#include "gd/result_file.h"
#include "server/handlers/query.h"

/* Writes the result, with the query's mesh if so asked. The bytes are counted as the exchange's `held`. False with the problem. */
bool server_result_write(const struct server_query *query, const struct gd_result *result, bool with_mesh,
                         enum gd_result_format format, char **bytes, size_t *size, struct proto_problem *problem);

/* The same of a path as the one line. */
bool server_result_write_path(const struct server_query *query, const struct gd_path *path,
                              enum gd_result_format format, char **bytes, size_t *size, struct proto_problem *problem);

/* The same of a path and the faces that it runs through, laid flat and drawn (proto/flat_strip.h). */
bool server_result_write_strip(const struct server_query *query, const struct gd_path *path, char **bytes, size_t *size,
                               struct proto_problem *problem);

/* Refuses a file of a path that there is not. */
bool server_result_refuse_no_path(struct proto_problem *problem);

#endif
