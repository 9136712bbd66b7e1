/* Form: what an answer can be had as besides JSON: a file for another program. By ?format=, or else
 * by Accept. */
#ifndef SERVER_QUERY_FORM_H
#define SERVER_QUERY_FORM_H

#include <stdbool.h>

#include "proto/options.h"
#include "server/http/exchange.h"

struct server_form {
    const char *name; /* in ?format=, and how the file's name ends; NULL ends a list */
    const char *media_type;
    bool has_mesh; /* it can have the mesh with it, by ?mesh=true */
};

enum { SERVER_FORM_JSON, SERVER_FORM_BYTES, SERVER_FORM_FIRST }; /* and on: forms[0], … */

/* The form that the request wants; JSON at a tie. `forms` may be NULL; `has_bytes`: float64 is one,
 * by Accept alone. False with the problem. */
bool server_form_choose(struct server_exchange *exchange, const struct server_form *forms,
                        bool has_bytes, unsigned *out, struct proto_problem *problem);

/* Reads ?mesh=, which only forms that have it take. */
bool server_form_wants_mesh(const struct proto_parameters *parameters,
                            const struct server_form *forms, unsigned form, bool *out,
                            struct proto_problem *problem);

/* Names of query-string parameters with those of forms behind them; `forms` NULL: `names`
 * themselves. `out` has room for `most`. */
const char *const *server_form_parameters(const char *const *names, const struct server_form *forms,
                                          const char **out, unsigned most);

#endif
