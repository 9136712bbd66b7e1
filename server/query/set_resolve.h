/* Set resolve: a set put on its mesh by a worker, where its curves take searches. */
#ifndef SERVER_QUERY_SET_RESOLVE_H
#define SERVER_QUERY_SET_RESOLVE_H

#include "proto/set.h"
#include "server/query/query.h"

/* proto_set_locate on behalf of a part of the query's work, with the mesh's landmarks, within the
 * byte budget: the set's bytes are held by the query. To be freed by free(). False with the
 * problem. */
bool server_set_resolve(struct server_query *query, struct server_monitor *part,
                        const struct proto_set *set, struct proto_located_set **out,
                        struct proto_problem *problem);

#endif
