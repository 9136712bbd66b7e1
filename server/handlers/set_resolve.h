/* Set resolve: a set put on its mesh by a worker, where its curves take searches. */
#ifndef SERVER_HANDLERS_SET_RESOLVE_H
#define SERVER_HANDLERS_SET_RESOLVE_H

#include "proto/set.h"
#include "server/handlers/query.h"

/* proto_set_locate on behalf of a part of the query's work, with the mesh's landmarks, within the byte budget: on success the set's bytes are held of
 * SERVER_BUDGET_FLIGHT. False with the problem. */
bool server_set_resolve(struct server_query *query, struct server_monitor *part, const struct proto_set *set,
                        struct proto_located_set **out, struct proto_problem *problem);

/* Frees a located set (NULL is harmless) and gives back what is held for it. */
void server_set_release(const struct server_query *query, struct proto_located_set *set, size_t held);

#endif
