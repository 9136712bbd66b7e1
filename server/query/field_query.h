/* Field query: a query that is answered from the field of a set, which is found in the cache,
 * built, or waited for.
 *
 * A kind's own struct begins with a struct server_field_query; glance, join, solve and release
 * below are its steps, or part of them. Decoding ends with server_field_query_of_set or
 * server_field_query_of_resource, which says what field it takes; `answer` is called when the field
 * is there. */
#ifndef SERVER_QUERY_FIELD_QUERY_H
#define SERVER_QUERY_FIELD_QUERY_H

#include "proto/set.h"
#include "server/surfaces/catalogue.h"
#include "server/query/query.h"

struct server_field_query {
    struct server_query query; /* first */
    /* Makes the answer; `part` is for its long calls. DONE, FAILED, or AGAIN if it has named
     * another field. */
    enum server_query_turn (*answer)(struct server_field_query *query, const struct gd_field *field,
                                     struct server_monitor *part, struct proto_problem *problem);
    bool is_quick;                       /* an answer from a cached field takes no time */
    const struct proto_located_set *set; /* what it is the field of */
    struct gd_field_request request;     /* the set's */
    struct proto_located_set *own_set;   /* `set`, or NULL */
    /* what is to be put on the mesh by a worker, which takes time; empty: nothing */
    struct proto_set pending;
    double max_distance; /* of it */
    bool (*prepare)(struct server_field_query *query,
                    /* by a worker, until `set` is there; NULL: locates `pending` */
                    struct proto_problem *problem);
    bool (*located)(struct server_field_query *query,
                    struct proto_problem *problem); /* when the set is there; may be NULL */
    struct server_resource *resource;               /* whose set it is, a reference; or NULL */
    /* the field, found before there was time to answer; or NULL */
    const struct server_cached *pin;
    /* this query is to build the field; NULL: it is not */
    struct server_pending_build *build;
};

/* The field of a set, which it takes over and puts on the mesh: at once if that takes no time.
 * False with the problem. */
bool server_field_query_of_set(struct server_field_query *query, struct proto_set *set,
                               double max_distance, struct proto_problem *problem);

/* The same of one that is on the mesh already, and stays the caller's. */
void server_field_query_of_located(struct server_field_query *query,
                                   const struct proto_located_set *set, double max_distance);

/* The field that the path of the request names; false: not_found or field_evicted. */
bool server_field_query_of_resource(struct server_field_query *query,
                                    struct proto_problem *problem);

/* The same of an id; what is wrong with it is at the parameter `field`. */
bool server_field_query_of_id(struct server_field_query *query, const char *id,
                              struct proto_problem *problem);

enum server_query_turn server_field_query_glance(struct server_query *query,
                                                 struct proto_problem *problem);
bool server_field_query_join(struct server_query *query);
enum server_query_turn server_field_query_solve(struct server_query *query,
                                                struct proto_problem *problem);
void server_field_query_release(struct server_query *query);

/* The resource of that id on the mesh of that record, retained; NULL: not_found or field_evicted.
 */
struct server_resource *server_find_resource(const struct server_exchange *exchange,
                                             struct server_record *record,
                                             struct proto_problem *problem);

#endif
