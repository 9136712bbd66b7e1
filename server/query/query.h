/* Query: a question about a surface, in the steps that a request of its own and a line of a batch
 * have in common.
 *
 * DESIGN. A kind of query is a table of steps. Its own struct begins with a struct server_query and
 * is made all zero. The steps: decode or parse    once: reads the question and puts its points on
 * the mesh glance             once, perhaps by an HTTP thread: answers if that takes no time solve
 * by a worker, as long as the turn is AGAIN or, after the exchange has come back, PARKED encode,
 * bytes or write    once the turn is DONE; a kind whose long answer is written as it is found, as
 * the query's draft, has none release            in the end, at whatever step that is A query
 * belongs to the thread that has its exchange: whoever gets PARKED touches neither any more. */
#ifndef SERVER_QUERY_QUERY_H
#define SERVER_QUERY_QUERY_H

#include <jansson.h>

#include "proto/options.h"
#include "proto/writer.h"
#include "server/http/exchange.h"
#include "server/query/form.h"
#include "server/surfaces/surface.h"

enum server_query_turn {
    SERVER_QUERY_DONE,   /* the answer can be written */
    SERVER_QUERY_FAILED, /* the problem is filled in */
    SERVER_QUERY_AGAIN,  /* solve is to be called, perhaps again */
    SERVER_QUERY_PARKED  /* the exchange waits for something; then solve is to be called */
};

struct server_query {
    const struct server_query_kind *kind;
    struct server_exchange *exchange; /* on whose behalf */
    struct server_surface *surface;   /* a reference */
    struct proto_options options;
    unsigned form;       /* of the answer, form.h */
    bool with_mesh;      /* the form is to have the mesh with it */
    double begun, share; /* of the exchange's work, see struct server_monitor */
    struct proto_writer draft;
    /* bytes of SERVER_BUDGET_FLIGHT, given back when it ends; those of the draft are not among them
     */
    size_t held;
};

struct server_query_kind {
    const char *name;          /* as in the path, and in a batch */
    size_t size;               /* of its own struct */
    const char *const *fields; /* of the JSON answer; NULL: it has another form, see `reply` */
    /* of its GET form besides the options; NULL: there is no such form */
    const char *const *parameters;
    bool (*decode)(struct server_query *query, const json_t *document,
                   struct proto_problem *problem);
    bool (*parse)(struct server_query *query, const struct proto_parameters *parameters,
                  struct proto_problem *problem);
    /* NULL: AGAIN */
    enum server_query_turn (*glance)(struct server_query *query, struct proto_problem *problem);
    bool (*join)(struct server_query *query); /* see server_exchange_defer; may be NULL */
    enum server_query_turn (*solve)(struct server_query *query, struct proto_problem *problem);
    /* NULL: the answer is the draft */
    void (*encode)(const struct server_query *query, struct proto_writer *writer);
    /* instead of encode: the answer is no JSON. NULL: it is */
    void (*reply)(struct server_query *query);
    /* Writes the answer as float64 to `out`, if that is not NULL, and returns its bytes. NULL: it
     * has no such form. */
    size_t (*bytes)(const struct server_query *query, void *out);
    const struct server_form *forms; /* the answer's other forms; NULL: none */
    /* The answer in the query's form, which is one of these, by malloc. Its memory is the
     * exchange's `held`. False with the problem. */
    bool (*write)(const struct server_query *query, char **bytes, size_t *size,
                  struct proto_problem *problem);
    void (*release)(struct server_query *query); /* what its own struct holds; NULL: nothing */
    /* of the answer, its own headers being set; NULL: 200 */
    unsigned (*status)(struct server_query *query);
};

extern const struct server_query_kind server_query_distance, server_query_path; /* pair.c */
extern const struct server_query_kind server_query_nearest;                     /* nearest.c */
extern const struct server_query_kind server_query_matrix;                      /* matrix.c */
extern const struct server_query_kind server_query_distance_to_set;             /* sets.c */
/* curve_distance.c */
extern const struct server_query_kind server_query_curve_distance;

/* A query before its first step, of all of the exchange's work; it retains the surface. NULL
 * without memory. */
struct server_query *server_query_create(const struct server_query_kind *kind,
                                         struct server_exchange *exchange,
                                         struct server_surface *surface);
void server_query_destroy(struct server_query *query); /* NULL is harmless */

/* The glance, and DONE, FAILED or AGAIN. */
enum server_query_turn server_query_glance(struct server_query *query,
                                           struct proto_problem *problem);

/* The monitor of a long call that is the part [begun, begun + share] of the query's work. */
struct server_monitor server_query_monitor(const struct server_query *query, double begun,
                                           double share);

/* The monitor of a part of what another one watches. */
struct server_monitor server_monitor_portion(const struct server_monitor *whole, double begun,
                                             double share);

/* Makes the problem that an engine's failure is, and counts it. `what` needs memory ("the search").
 * FAILED. */
enum server_query_turn server_query_fail(const struct server_query *query, enum gd_status status,
                                         const char *what, struct proto_problem *problem);

/* Counts a failure of the engine if it is a failed self-check. */
void server_query_count(const struct server_query *query, enum gd_status status);

/* Holds so many bytes more. GD_BUDGET. */
GD_MUST_USE enum gd_status server_query_take(struct server_query *query, size_t bytes);
void server_query_give(struct server_query *query, size_t bytes);

typedef enum gd_status server_query_maker(void *user, const struct gd_control *control,
                                          size_t *kept);

/* One long call of the engine (budgeted_call.h) on behalf of a part of the query's work. What its
 * result keeps is held. */
GD_MUST_USE enum gd_status server_query_call(struct server_query *query,
                                             struct server_monitor *part, server_query_maker *make,
                                             void *user, size_t grant);

/* Can more be written to the draft? To be called now and then, so that no work is done in vain.
 * GD_BUDGET. */
GD_MUST_USE enum gd_status server_query_check_draft(const struct server_query *query);

/* The turn when it is written: DONE; or FAILED with the problem that `status` is (then `what` needs
 * memory), or that the draft is too large. */
enum server_query_turn server_query_end_draft(struct server_query *query, enum gd_status status,
                                              const char *what, struct proto_problem *problem);

/* Writes the answer of a query that is DONE, for a batch; who has it counts the copy. */
void server_query_encode(const struct server_query *query, struct proto_writer *writer);

/* A request of its own: the handler of an operation that is a query of that kind. */
void server_query_handle(struct server_exchange *exchange, const struct server_query_kind *kind);

#endif
