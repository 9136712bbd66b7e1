/* Query: a question about a surface. Single requests and lines of a batch run the same steps.
 *
 * DESIGN. A kind of query is a table of steps. A kind's own struct begins with a struct
 * server_query. The struct is initialised with zeros. `try_inline` and `solve` return a *turn*,
 * which names the next action. The steps, in their order:
 * - `decode` or `parse` reads the question and locates its points.
 * - `try_inline` runs once, perhaps on an HTTP thread. It answers if the answer takes only
 *   microseconds. A kind whose decoding does all the work needs no `try_inline` and no `solve`.
 * - `solve` runs on a worker. It runs again after the turn AGAIN. After PARKED it runs again when
 *   the exchange is resumed.
 * - `encode`, `bytes`, `write` or `reply` writes the answer when the turn is DONE. If a kind has
 *   none of them, `solve` has already written the answer to the *draft*, a text that grows from
 *   step to step.
 * - `release` frees the members of the kind's own struct. It is called after the last step, also
 *   when a step fails.
 *
 * A kind with the step `answer` is answered from the field of a set. Its decoding ends with a
 * server_field_query_of_… function, which names the set. field_query.c finds the field in the
 * cache, builds it, or waits for another request that builds it. Then `answer` runs. Such a kind
 * needs no `try_inline`, `join` and `solve`.
 *
 * A query belongs to the thread that has its exchange. After PARKED the caller must not use the
 * query or the exchange. */
#pragma once

#include <stdatomic.h>

#include <jansson.h>

#include "gd/query.h"
#include "generated/requests.h"
#include "proto/http/options.h"
#include "proto/values/points.h"
#include "proto/values/set.h"
#include "proto/json/writer.h"
#include "server/exchange/exchange.h"
#include "server/query/arrays.h"
#include "server/surfaces/catalogue.h"
#include "server/surfaces/surface.h"
#include "server/work/budgeted_call.h"

enum server_query_turn {
    SERVER_QUERY_DONE,   /* the answer can be written */
    SERVER_QUERY_FAILED, /* the problem is filled in */
    SERVER_QUERY_AGAIN,  /* call solve, even if it was called before */
    SERVER_QUERY_FLUSH,  /* send the draft to the client, then call solve again */
    SERVER_QUERY_PARKED  /* the exchange waits for an event; solve is called afterwards */
};

/* A form of an answer other than JSON: a file, selected by ?format= or Accept. */
struct server_form {
    /* name in ?format= and in the entity tag, and the file's suffix; NULL ends a list */
    const char *name;
    const char *media_type;
    bool has_mesh; /* ?mesh=true adds the mesh */
};

struct server_answer_file {
    char *bytes; /* allocated by malloc */
    size_t size;
};

/* SERVER_FORM_FIRST + i: forms[i]; then the forms of arrays, if the kind lists arrays */
enum { SERVER_FORM_JSON, SERVER_FORM_BYTES, SERVER_FORM_FIRST };

/* The field from which a query is answered. All zero means that no field is named. */
struct server_field_query {
    const struct proto_located_set *set; /* NULL means that a worker has to locate it */
    struct gd_field_request request;     /* request for the field of the set */
    /* true if an answer from a cached field takes microseconds */
    bool is_quick;
    struct proto_set pending;           /* set to be located */
    double max_distance;                /* limit of the field of `pending` */
    struct proto_located_set *own_set;  /* `set`, or NULL */
    struct server_resource *resource;   /* a reference to the owner of `set`, or NULL */
    const struct server_cached *pin;    /* the field if it was found but not yet used, or NULL */
    struct server_pending_build *build; /* the build that this query must do, or NULL */
    /* the set whose complete field the query names next, or NULL; if both fields must be built,
       they are built at the same time */
    const struct proto_located_set *next;
};

struct server_query {
    const struct server_query_kind *kind;
    struct server_exchange *exchange;
    struct server_surface *surface; /* a reference */
    struct proto_problem
        /* receives the problem of a step that fails; the step's caller sets this pointer */
        *problem;
    struct proto_options options;
    unsigned form;  /* form of the answer, see the enum above */
    bool with_mesh; /* true if the answer includes the mesh */
    /* the query's part of the exchange's progress, see struct server_monitor */
    double begun, share;
    struct proto_writer draft;
    /* bytes of SERVER_BUDGET_FLIGHT, without those of the draft */
    size_t held;
    void *blocks;                       /* allocations of server_query_allocate */
    struct proto_located_points points; /* points of server_query_locate */
    struct server_field_query field;
    /* monitor of a call that is all of the query's progress */
    struct server_monitor whole;
    struct server_landmark_set *landmarks; /* result of server_query_landmarks */
    /* arrays of the answer, if its form is a form of arrays */
    struct server_arrays arrays;
    struct server_lines lines;  /* lines of server_query_list_lines */
    struct gd_path line;        /* line of server_query_list_line */
    struct server_relay *relay; /* relay of an answer that is sent while it is computed, or NULL */
    bool is_whole;              /* true if the whole answer was written to the relay */
    bool is_drawn; /* the arrays are for a figure: list_arrays lists all that can be drawn */
};

struct server_query_kind {
    const char *name; /* name in the path, and in a batch */
    size_t size;      /* bytes of the kind's own struct */
    const void *own;  /* the constants of a kind that shares steps with other kinds, or NULL */
    const struct server_form *forms; /* the answer's own forms, or NULL */
    bool has_bare_points;            /* geometry is xyz by default, not full */
    bool (*decode)(struct server_query *query, const json_t *document);
    /* Reads a large request directly from its text. Returns false if the text must be parsed as a
     * document for `decode`, which also reports faults. May be NULL. */
    bool (*read_text)(struct server_query *query, const char *bytes, size_t size);
    bool (*parse)(struct server_query *query, const struct proto_parameters *parameters);
    /* Names of the arrays of a request (arrays.h), and the function that reads them. If both
       members are NULL, requests are JSON only. */
    const char *const *array_names;
    bool (*read_arrays)(struct server_query *query, const struct server_arrays *arrays);
    /* may be NULL for the default, see above */
    enum server_query_turn (*try_inline)(struct server_query *query);
    bool (*join)(struct server_query *query); /* see server_exchange_defer; may be NULL */
    enum server_query_turn (*solve)(struct server_query *query);
    /* Names the set, if the query has not named it yet because a set takes time to locate. Runs on
       a worker. If this member is NULL, the pending set is located. */
    bool (*prepare)(struct server_query *query);
    /* Runs after the pending set is located. May be NULL. */
    bool (*located)(struct server_query *query);
    /* Answers from the field. If the step names another field and returns AGAIN, it is called again
       with that field. */
    enum server_query_turn (*answer)(struct server_query *query, const struct gd_field *field);
    void (*encode)(const struct server_query *query, struct proto_writer *writer);
    void (*reply)(struct server_query *query); /* writes an answer in a form other than JSON */
    /* form in the entity tag of such an answer, such as "png" */
    const char *reply_form;
    bool has_bytes; /* true if application/octet-stream selects the first array without a head */
    /* Writes the answer in the query's form; the exchange's `held` counts it. */
    bool (*write)(struct server_query *query, struct server_answer_file *out);
    /* Lists the arrays of an answer that is DONE, for the forms of arrays.h. The arrays must stay
       valid as long as the query. On failure, returns false with the problem. NULL means that the
       answer has no such forms. */
    bool (*list_arrays)(struct server_query *query);
    void (*release)(struct server_query *query);
    /* Returns the answer's status and adds headers; NULL means 200. */
    unsigned (*status)(struct server_query *query);
};

/* Creates a query whose work is all of the exchange's progress. The query retains the surface.
 * Returns NULL if out of memory. */
struct server_query *server_query_create(const struct server_query_kind *kind,
                                         struct server_exchange *exchange,
                                         struct server_surface *surface);
void server_query_destroy(struct server_query *query); /* NULL is allowed */

/* Runs the steps up to try_inline. Returns DONE, FAILED or AGAIN. */
enum server_query_turn server_query_try_inline(struct server_query *query);
enum server_query_turn server_query_solve(struct server_query *query);

/* Appends the answer of a query that is DONE, for a batch. */
void server_query_encode(const struct server_query *query, struct proto_writer *writer);

/* Handles a single request. Most routes name their kind of query and have the handler
 * server_handle_query (handlers.h). */
void server_query_handle(struct server_exchange *exchange, const struct server_query_kind *kind);

/* --- for the steps ---------------------------------------------------------------------------- */

/* Returns the monitor of a long call, which is the part [begun, begun + share] of the query's
 * progress. */
struct server_monitor server_query_monitor(const struct server_query *query, double begun,
                                           double share);

/* Ends the first part of the query's progress. Later calls refer to the rest. */
void server_query_pass(struct server_query *query, double part);

/* Sets the problem of an engine failure. `what` names the work ("the search"). Returns FAILED. */
enum server_query_turn server_query_fail(const struct server_query *query, enum gd_status status,
                                         const char *what);

/* Like server_query_fail, for a step that writes a file: GD_EXTENT means that the surface does not
 * fit the floats of the format. */
enum server_query_turn server_query_fail_file(const struct server_query *query,
                                              enum gd_status status, const char *what);

/* Like server_query_fail, but returns false, for steps that return bool. */
bool server_query_refuse(const struct server_query *query, enum gd_status status, const char *what);

/* Returns the last turn of a query: DONE, or FAILED with the problem of `status` or of a draft that
 * is too large. */
enum server_query_turn server_query_end_draft(struct server_query *query, enum gd_status status,
                                              const char *what);

/* Returns GD_BUDGET if the draft is full. Otherwise checks deadline and cancellation of the control
 * (may be NULL), and returns the result. Call this function from time to time during long work. */
GD_MUST_USE enum gd_status server_query_pause(const struct server_query *query,
                                              const struct gd_control *control, double fraction);

/* Returns true if FLUSH is useful: the client already reads the answer while it is computed, or the
 * draft is long enough to begin a stream. A failure after the first FLUSH truncates the answer. */
bool server_query_can_flush(const struct server_query *query);

/* Returns the answer's form of arrays, or SERVER_ARRAYS_NONE. */
enum server_arrays_form server_query_arrays_form(const struct server_query *query);

/* Makes the query keep its answer as arrays, for a caller that lists them. */
void server_query_keep_arrays(struct server_query *query);

/* Adds `count` borrowed paths, `stride` bytes apart, to the arrays. On failure, returns false with
 * the problem. */
bool server_query_list_lines(struct server_query *query, const struct gd_path *paths, size_t stride,
                             uint32_t count);

/* Like server_query_list_lines, but adds one borrowed line of points. NULL means that there is no
 * line. */
bool server_query_list_line(struct server_query *query, const struct gd_point *points,
                            uint32_t count);

/* Takes bytes from the budget. The query holds them until server_query_give or until its end.
 * Error: GD_BUDGET. */
GD_MUST_USE enum gd_status server_query_take(struct server_query *query, size_t bytes);
void server_query_give(struct server_query *query, size_t bytes);

/* Locates points of the request, stores the result in query->points, and frees `points`. On
 * failure, returns false with the problem. */
bool server_query_locate(struct server_query *query, struct proto_points *points);

/* Returns an array of zeros, which the query holds until it ends. If the result is NULL, the caller
 * reports GD_BUDGET. */
void *server_query_allocate(struct server_query *query, size_t count, size_t size);

/* Begins one long call of the engine (budgeted_call.h). `part` is its part of the query's progress;
 * NULL means all of it. The query holds the bytes of the call's result. */
struct server_budgeted_call server_query_begin_call(struct server_query *query,
                                                    struct server_monitor *part, size_t grant);

/* The parallel tasks of a query. */
struct server_tasks {
    enum gd_status (*run)(void *user, uint32_t number);
    void *user;
    atomic_int failure; /* the status of the first task that failed */
};

/* Runs `count` tasks, in parallel if the query is on a worker. After the first failure no further
 * task begins. Returns this failure. */
GD_MUST_USE enum gd_status server_query_run_tasks(const struct server_query *query,
                                                  struct server_tasks *tasks, uint32_t count);

/* Returns the landmarks of the mesh, valid as long as the query; NULL means that there are none. */
const struct gd_landmarks *server_query_landmarks(struct server_query *query);

/* --- pairs of points -------------------------------------------------------------------------- */

struct server_pair {
    const struct gd_point *from, *to;
    enum gd_pair_output output;
};

/* Searches for the shortest path of a pair, with the mesh's landmarks and within the memory budget.
 * `part` is the monitor of the exchange. The distance is INFINITY if there is no path. Errors:
 * those of gd_pair_solve. Thread-safe. */
GD_MUST_USE enum gd_status server_pair_search(struct server_monitor *part,
                                              struct server_surface *surface,
                                              const struct server_pair *pair,
                                              struct gd_pair_answer *out);

/* Pins and returns the cached field of one of the two points, or returns NULL. */
const struct server_cached *server_pair_find_field(struct server_surface *surface,
                                                   const struct server_pair *pair);

/* Answers from the cached field of one of the two points if there is one, otherwise by a search. */
GD_MUST_USE enum gd_status server_pair_solve(struct server_monitor *part,
                                             struct server_surface *surface,
                                             const struct server_pair *pair,
                                             struct gd_pair_answer *out);

/* Appends a leg to a route (all zero at first): adds distances and lengths, and joins the
 * polylines. The leg must begin where the route ends. The function frees the leg. If the leg has no
 * path (INFINITY), the route then has no path. Error: GD_NO_MEMORY. O(points of the leg). */
GD_MUST_USE enum gd_status server_pair_append(struct gd_pair_answer *route,
                                              struct gd_pair_answer *leg);

/* --- for kinds that are answered from a field (field_query.c) --------------------------------- */

/* Names the field of a set. The query takes over the set. Locates the set immediately if this takes
 * little time. */
bool server_field_query_of_set(struct server_query *query, struct proto_set *set,
                               double max_distance);

/* Like server_field_query_of_set, but the set is located, and the caller still owns it. */
void server_field_query_of_located(struct server_query *query, const struct proto_located_set *set,
                                   double max_distance);

/* Like server_field_query_of_set, but the set is that of a field resource. The first function takes
 * the resource from the request's path, the second finds it by an id. Problems of the id refer to
 * the parameter `field`. On failure, return false with not_found or field_evicted. */
bool server_field_query_of_resource(struct server_query *query);
bool server_field_query_of_id(struct server_query *query, const char *id);

/* The default steps, for kinds that replace one of them. */
enum server_query_turn server_field_query_try_inline(struct server_query *query);
bool server_field_query_join(struct server_query *query);
enum server_query_turn server_field_query_solve(struct server_query *query);
void server_field_query_release(struct server_query *query);

/* Retains and returns the resource of the path. On failure, returns NULL with not_found or
 * field_evicted. */
struct server_resource *server_find_resource(const struct server_exchange *exchange,
                                             struct server_record *record,
                                             struct proto_problem *problem);

/* Locates a set on a worker, because curves need searches. The query holds the bytes of the result,
 * which the caller frees by free(). */
bool server_query_locate_set(struct server_query *query, struct server_monitor *part,
                             const struct proto_set *set, struct proto_located_set **out);

/* Returns the bytes that building a field needs on most meshes. */
size_t server_field_build_grant(const struct gd_mesh *mesh);

/* Returns the bytes that gd_field_distances_only needs on most meshes. */
size_t server_distances_only_grant(const struct gd_mesh *mesh);

/* Builds the field of query->field.request, and publishes it as the result of query->field.build.
 * The pending build ends in any case. `*out` is pinned. Errors: those of gd_field_build; GD_BUDGET
 * (memory is short, or the time limit of `part` was reached). */
GD_MUST_USE enum gd_status server_query_build_field(struct server_query *query,
                                                    struct server_monitor part,
                                                    const struct server_cached **out);
