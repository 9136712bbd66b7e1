/* Evaluation: the results of many points, from the field of a set: what distance-to-set and a
 * field's evaluate have in common. */
#ifndef SERVER_QUERY_EVALUATION_H
#define SERVER_QUERY_EVALUATION_H

#include "proto/evaluation.h"
#include "server/query/field_query.h"

struct server_evaluation {
    struct server_field_query field; /* first */
    struct proto_located_points points;
    uint32_t wanted; /* fields of each result */
};

/* Puts the points on the mesh. */
bool server_evaluation_locate(struct server_evaluation *evaluation,
                              const struct proto_evaluation *wanted, struct proto_problem *problem);

/* A step of the kind, besides those of field_query.h; the answer is the draft. */
void server_evaluation_release(struct server_query *query);

#endif
