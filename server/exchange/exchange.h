/* Exchange: one request and its answer, as handlers see them. No HTTP library shows here.
 *
 * DESIGN. An exchange belongs to one thread at a time: the HTTP thread that reads it, then, if the
 * handler deferred it, the queue, a worker or a pending build of the cache, then the HTTP thread
 * again. The workers' lock hands it over one way and transport->finish the other: a thread that
 * has submitted, parked or finished an exchange does not touch it any more. Its transport is a
 * connection (http.c), or a job whose answer is stored (job_table.h); handlers need not know which.
 *
 * States: reading -> ready -> answered, or deferred -> answered. Answered means response.status is
 * set (reply.h). A handler ends with a reply or with server_exchange_defer. */
#ifndef SERVER_EXCHANGE_EXCHANGE_H
#define SERVER_EXCHANGE_EXCHANGE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "proto/http/options.h"
#include "proto/http/route.h"
#include "server/access/access.h"
#include "server/exchange/body.h"
#include "server/work/workers.h"

#define SERVER_EXCHANGE_HEADERS    64
#define SERVER_EXCHANGE_PARAMETERS 32
#define SERVER_RESPONSE_HEADERS    16
#define SERVER_HEADER_VALUE        256
#define SERVER_REQUEST_ID          65

struct server_api;
struct server_events;
struct server_answer_streams;
struct server_exchange;
struct server_metrics;
struct server_workspaces;
struct server_pending_build;
struct server_stream;
struct server_surface;

struct server_named_value { /* of strings that the transport or the exchange owns */
    const char *name, *value;
};

struct server_response_header {
    const char *name;
    size_t size; /* of the value, without its NUL */
    char value[SERVER_HEADER_VALUE];
};

/* The middle of a body: bytes of the lender, which counts them and stays until its release. */
struct server_lent {
    const void *bytes; /* NULL: there is none, and `body` is all */
    size_t size;
    const char *tail; /* static text behind them; "" */
    void *lender;
    void (*release)(void *lender);
};

struct server_response {
    unsigned status; /* 0: not answered yet */
    const char *media_type;
    enum proto_problem_code problem; /* PROTO_PROBLEM_NONE: none */
    const void *body;
    void *owned; /* `body` when it is to be freed, else NULL: it outlives the server */
    struct server_lent lent;
    size_t size; /* of all of it, with what is lent */
    size_t held; /* bytes of SERVER_BUDGET_ANSWERS for the body, until it is freed */
    struct server_stream *stream; /* instead of a body (events.h); NULL: none */
    bool close;                   /* the connection ends with this answer */
    const char *policy;           /* Content-Security-Policy of a page; NULL: the answer is data */
    uint32_t header_count;
    struct server_response_header headers[SERVER_RESPONSE_HEADERS];
};

/* What carries an exchange: a connection, a job, an item of a batch. */
struct server_transport {
    /* A deferred exchange is answered: it is the transport's again. */
    void (*finish)(struct server_exchange *exchange);
    /* The client of a deferred exchange has gone. Called every millisecond, by any thread. */
    bool (*is_gone)(struct server_exchange *exchange);
    /* A worker starts to work on a deferred exchange, perhaps again. May be NULL. */
    void (*begin)(struct server_exchange *exchange);
    /* Progress in [0,1], by any thread. May be NULL. */
    void (*report)(struct server_exchange *exchange, double part);
    bool can_stream; /* the answer may be a stream (server_reply_stream) */
};

/* What the requests of a daemon have in common. The composition root fills it in; all that it
 * points to outlives the exchanges. */
struct server_host {
    struct server_budget *budget;
    struct server_workers *workers;
    struct server_workspaces *workspaces;
    struct server_events *events;
    struct server_answer_streams *streams;
    struct server_metrics *metrics;
    uint64_t timeout_ms, slow_ms, queue_length;
    bool has_cors_origins;
    /* Calls the handler of the exchange's route, with a deadline from now on. Returns with a reply,
     * or with `work` set: then the exchange is to be submitted. */
    void (*dispatch)(struct server_exchange *exchange);
    /* The first exchange was deferred, or a stream was opened: deadlines have to be watched. */
    void (*watch)(void *user);
    void *watcher;
    atomic_uint deferred; /* exchanges that connections and jobs have submitted */
    atomic_bool is_draining;
    struct server_api *api; /* what handlers use besides (query/api.h) */
};

struct server_exchange {
    struct server_host *host;
    const struct server_transport *transport;
    struct server_job job;

    const char *method; /* as in the request line */
    bool is_http10;
    bool has_body;       /* one is announced, even if empty */
    bool has_conditions; /* If-Match, If-None-Match or the like is among the headers */
    char *target;        /* storage of path and parameters, which are decoded in place */
    size_t target_size;
    const char *path; /* never NULL */
    uint32_t parameter_count, header_count;
    char *copies;      /* of method and headers; NULL: they are the transport's */
    const char *fault; /* why the request could not be read, a sentence; NULL: it could */
    struct proto_route_match match; /* route NULL: none found */
    /* the former name that the request uses (deprecation.h); NULL: none */
    const struct proto_deprecation *deprecation;
    char request_id[SERVER_REQUEST_ID];
    struct server_grant grant;
    const char *tenant;      /* whose names it is about (kind.h), borrowed from the grant; or "" */
    const char *cors_origin; /* the Origin header, if --cors-origin lists it; or NULL */
    struct server_body body;

    uint64_t started_ns;
    bool (*work)(struct server_exchange *exchange); /* NULL: not deferred */
    bool (*join)(struct server_exchange *exchange);
    struct server_surface *surface; /* a reference; loaded for this exchange, or NULL */
    void (*release_surface)(struct server_surface *surface); /* set with `surface` */
    size_t held;   /* bytes of SERVER_BUDGET_FLIGHT until the exchange ends */
    size_t parsed; /* of them, for a document that is being decoded (request.h) */
    void *state;   /* the handler's own, kept over a deferral, until the answer is there */
    void (*free_state)(void *state);

    struct server_response response;

    /* From the response's headers on nothing is initialized but what is counted: clearing it takes
     * longer than the rest of a short request. */
    struct server_named_value parameters[SERVER_EXCHANGE_PARAMETERS],
        headers[SERVER_EXCHANGE_HEADERS];
};

/* --- for the transport (http.c) and the router ------------------------------------------------ */

/* Begins an exchange of a raw target ("/v1/meshes?limit=3") in memory that may be used again when
 * it has ended. False without memory: then it has not begun. A target that can't be read is a fault
 * of the request. */
bool server_exchange_begin(struct server_exchange *exchange, struct server_host *host,
                           const struct server_transport *transport, const char *target);
void server_exchange_end(struct server_exchange *exchange);

/* The same in memory of its own; NULL without memory. */
struct server_exchange *server_exchange_create(struct server_host *host,
                                               const struct server_transport *transport,
                                               const char *target);
void server_exchange_destroy(struct server_exchange *exchange); /* NULL is harmless */

/* Free the handler's state; the answer's body, or return it to its lender. */
void server_exchange_drop_state(struct server_exchange *exchange);
void server_exchange_drop_body(struct server_exchange *exchange);

/* Adds a request header; strings are borrowed until the exchange ends. One too many is a fault of
 * the request. */
void server_exchange_add_header(struct server_exchange *exchange, const char *name,
                                const char *value);

/* Two readers that disagree on where a request ends can be made to see different requests (request
 * smuggling). So a head that readers are known to understand differently is refused: RFC 9112, 3.2,
 * 5.1, 6 and 11.2; RFC 9110, 5.5 and 5.6.2; server/doc/019-http-library.md. The first function
 * checks the target of the request line; the second one method, version and headers, and sets
 * is_http10, has_body and body.declared. Return why the head is refused, static; NULL: it is not.
 * O(bytes). */
const char *server_exchange_check_target(const char *target);
const char *server_exchange_read_head(struct server_exchange *exchange, const char *version);

/* The same request for a transport that outlives this one's, or NULL without memory. It takes over
 * body and target, and copies the rest. What is left of `exchange` can be answered. */
struct server_exchange *server_exchange_detach(struct server_exchange *exchange,
                                               const struct server_transport *transport);

/* For a transport without a connection: dispatches the exchange, which ends in the transport's
 * `finish`, perhaps before this returns. is_unwanted: such a transport's `is_gone`. */
void server_exchange_run(struct server_exchange *exchange);
bool server_exchange_is_unwanted(struct server_exchange *exchange);

/* Hands a deferred exchange to the workers (reply.c); it is not the caller's any more. A full queue
 * answers it with overloaded. The exchange counts as deferred before that. */
void server_exchange_submit(struct server_exchange *exchange);
void server_exchange_count_deferred(struct server_host *host);
void server_exchange_job_run(struct server_job *job);
void server_exchange_job_refuse(struct server_job *job, enum server_refusal why);

/* --- for handlers ----------------------------------------------------------------------------- */

/* Value of the first header of that name, any case; NULL: none. */
const char *server_exchange_header(const struct server_exchange *exchange, const char *name);
uint32_t server_exchange_count_headers(const struct server_exchange *exchange, const char *name);

/* True when a Prefer header (RFC 7240) lists `preference`, any case, without a value or with an
 * empty one. */
bool server_exchange_prefers(const struct server_exchange *exchange, const char *preference);

/* View of the query string for proto's decoders; lives as long as the exchange. */
struct proto_parameters server_exchange_parameters(struct server_exchange *exchange);

/* Adds what all log lines about an answered exchange say. */
void server_exchange_log(const struct server_exchange *exchange, struct server_log_line *line,
                         uint64_t nanoseconds);

bool server_exchange_is(const struct server_exchange *exchange, const char *method);

/* Shortens the deadline to `timeout_ms` after the start of the work; 0: leaves it. */
void server_exchange_shorten(struct server_exchange *exchange, uint64_t timeout_ms);

/* Gives the exchange a state of the handler's own, freed when a deferred exchange is answered, else
 * with the exchange. */
void server_exchange_keep(struct server_exchange *exchange, void *state,
                          void (*free_state)(void *state));

/* Has `work` done by a worker; the handler's last act. `work` returns true when it has replied or
 * deferred again, false when the exchange is parked in a pending build of the cache, which will
 * have `work` called again. `join` (may be NULL) is tried first, without a worker: true when it has
 * parked the exchange in a pending build that is under way. */
void server_exchange_defer(struct server_exchange *exchange,
                           bool (*work)(struct server_exchange *exchange),
                           bool (*join)(struct server_exchange *exchange));

/* The exchange that has the job. */
struct server_exchange *server_exchange_of(struct server_job *job);

/* Control of a long call on behalf of the exchange: its deadline, the daemon's drain, and that
 * nobody wants the answer any more unless others wait for `build` (may be NULL). Calls of
 * several threads for one exchange have one monitor each. */
struct server_monitor {
    struct server_exchange *exchange;
    struct server_pending_build *build; /* the call makes its field; NULL: it makes none */
    bool (*is_awaited)(struct server_pending_build *build); /* set with `build` */
    /* the call is the part [begun, begun + share] of the work; share 0: it is all of it */
    double begun, share;
};
struct gd_control server_exchange_control(struct server_monitor *monitor);

#endif
