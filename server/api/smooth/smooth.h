/* Smooth: what the queries of NURBS and of subdivisions share: places that are evaluated, and the
 * place nearest to a point of space.
 *
 * A kind's own struct begins with one of those below, whose functions are its steps; decoding fills
 * it in. */
#ifndef SERVER_API_SMOOTH_SMOOTH_H
#define SERVER_API_SMOOTH_SMOOTH_H

#include "server/query/query.h"

/* --- evaluate: {"points": [one each]} --------------------------------------------------------- */

struct server_smooth_evaluation {
    struct server_query query; /* first */
    uint32_t count;            /* of the places, which are the kind's own */
    uint32_t quick;            /* as many as an HTTP thread may evaluate */
    uint32_t round;            /* as many as are written between two looks at clock and budget, */
    enum gd_status (*write)(struct server_smooth_evaluation *evaluation, uint32_t first,
                            uint32_t count,
                            /* and what writes some to the draft */
                            const struct gd_control *control);
    /* of its failure, if it has something to say */
    struct gd_detail detail;
};

enum server_query_turn server_smooth_evaluation_glance(struct server_query *query,
                                                       struct proto_problem *problem);
enum server_query_turn server_smooth_evaluation_solve(struct server_query *query,
                                                      struct proto_problem *problem);

/* --- nearest: {"xyz": …} ---------------------------------------------------------------------- */

struct server_smooth_approach {
    struct server_query query; /* first */
    struct gd_vec3 xyz;
    enum gd_status (*find)(struct server_smooth_approach *approach,
                           const struct gd_control *control);
    struct gd_detail detail; /* of its failure, if it has something to say */
};

bool server_smooth_approach_decode(struct server_smooth_approach *approach, const json_t *document,
                                   struct proto_problem *problem);
enum server_query_turn server_smooth_approach_solve(struct server_query *query,
                                                    struct proto_problem *problem);

/* --- failures --------------------------------------------------------------------------------- */

/* As server_query_fail, with what the engine says. A surface whose control points coincide, so that
 * it has no normal somewhere, is the client's: invalid_mesh. FAILED. */
enum server_query_turn server_smooth_fail(const struct server_query *query, enum gd_status status,
                                          const struct gd_detail *detail, const char *what,
                                          struct proto_problem *problem);

#endif
