/* Field build: one field for an exchange, within the byte budget. */
#ifndef SERVER_FIELD_BUILD_H
#define SERVER_FIELD_BUILD_H

#include "gd/field.h"
#include "server/exchange.h"

/* Builds the field of `source` on behalf of the exchange, whose deadline, drain and client end it early. `flight`: where others
 * may wait for it. On success gd_field_memsize bytes of SERVER_BUDGET_FLIGHT are held for the field, for the caller to pass on.
 * Errors: those of gd_field_build; GD_BUDGET: not even all that could be had was enough. */
GD_MUST_USE enum gd_status server_field_build(struct server_exchange *exchange, struct server_flight *flight,
                                              const struct gd_mesh *mesh, const struct gd_point *source,
                                              struct gd_field **out);

#endif
