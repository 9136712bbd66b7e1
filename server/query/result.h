/* Result: writes an answer as a file in a format of gd/result_file.h. The memory counts against
 * the budget. On failure the functions return false and set the problem. */
#pragma once

#include "gd/path.h"
#include "gd/result_file.h"
#include "server/query/query.h"

/* Writes the result, with the mesh if query->with_mesh is set. The exchange's `held` counts the
 * bytes. */
bool server_result_write(const struct server_query *query, const struct gd_result *result,
                         enum gd_result_format format, struct server_answer_file *out);

/* The forms of an answer that consists of lines. They precede the answer's other forms. */
#define SERVER_RESULT_LINE_FORMS                                                                   \
    {"obj", "model/obj", true}, {"glb", "model/gltf-binary", true},                                \
    {                                                                                              \
        "csv", "text/csv", false                                                                   \
    }
#define SERVER_RESULT_LINE_FORMS_END (SERVER_FORM_FIRST + 3)
#define SERVER_RESULT_LINE_FORM_GLB  (SERVER_FORM_FIRST + 1)

/* The forms of queries whose only forms are those of lines. The second list is for surfaces without
 * a mesh. */
extern const struct server_form server_result_line_forms[], server_result_smooth_line_forms[];

/* Like server_result_write, but the result consists of the lines in the query's arrays "points" and
 * "first", of their levels in the array "level", if there is one, and of `count` poses (NULL means
 * none). The query's form must be one of SERVER_RESULT_LINE_FORMS. This also works on surfaces
 * without a mesh. */
bool server_result_write_poses(struct server_query *query, const struct gd_pose *poses,
                               uint32_t count, struct server_answer_file *out);

/* Like server_result_write_poses, without poses. */
bool server_result_write_listed(struct server_query *query, struct server_answer_file *out);

/* Unfolds a path, and the faces that it crosses, into the plane, and writes them as a drawing
 * (proto/values/flat_strip.h). */
bool server_result_write_strip(const struct server_query *query, const struct gd_path *path,
                               struct server_answer_file *out);

/* Sets the problem not_acceptable, because the answer has nothing to draw, and returns false. `why`
 * is the beginning of the problem's text. */
bool server_result_refuse_nothing(struct proto_problem *problem, const char *why);
