/* Field build: one field for an exchange, within the byte budget. */
#ifndef SERVER_QUERY_FIELD_BUILD_H
#define SERVER_QUERY_FIELD_BUILD_H

#include "gd/field.h"
#include "server/http/exchange.h"

/* Bytes that building one takes, of most meshes. */
size_t server_field_build_grant(const struct gd_mesh *mesh);

/* Builds the field of a request on behalf of the part's exchange, whose deadline, drain and client
 * end it early; resumes it, where the part has a pending build, from what the cache has of its
 * seeds. On success gd_field_memsize bytes of SERVER_BUDGET_FLIGHT are held for the field, for the
 * caller to pass on. Errors: those of gd_field_build; GD_BUDGET: not even all that could be had was
 * enough.
 */
GD_MUST_USE enum gd_status server_field_build_request(struct server_monitor *part,
                                                      const struct gd_mesh *mesh,
                                                      const struct gd_field_request *request,
                                                      struct gd_field **out);

#endif
