/* Smooth surfaces: code shared by the queries on NURBS and on subdivision surfaces. */
#pragma once

#include <jansson.h>

#include "server/query/query.h"

/* Like server_query_fail, but adds the engine's detail to the problem. Where control points
 * coincide, a surface may have no normal. This is the client's error invalid_mesh, not an internal
 * error. The place of too_large is the member `level`. Returns FAILED. */
enum server_query_turn server_smooth_fail(const struct server_query *query, enum gd_status status,
                                          const struct gd_detail *detail, const char *what);

/* The form of the parameters `from` and `to`. */
struct server_smooth_ends {
    /* Sets *out to the value for the body, or to NULL if out of memory. Returns false if the text
       has another form. */
    bool (*read)(const char *text, json_t **out);
    const char *form; /* name of the form in a problem, such as "two numbers" */
};

/* The first function parses u,v. The second one parses f:FACE:u,v and f:FACE:CORNER:u,v. */
bool server_smooth_uv(const char *text, json_t **out);
bool server_smooth_place(const char *text, json_t **out);

/* Parses a query string. Makes a body whose members are the parameters, except those that all
 * queries share. Decodes this body. A problem names the parameter. */
bool server_smooth_parse(struct server_query *query, const struct proto_parameters *parameters,
                         const struct server_smooth_ends *ends);
