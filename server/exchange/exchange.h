/* Exchange: one request and its answer, as handlers see them. This header does not expose the HTTP
 * library.
 *
 * DESIGN. An exchange has one owner at a time. The first owner is the HTTP thread that reads the
 * request. If the handler defers the exchange, the next owners are the queue, a worker or a pending
 * build of the cache. The last owner is the HTTP thread again. The exchange passes to a worker
 * under the workers' lock, and back by transport->finish. A thread that has submitted, parked or
 * finished an exchange must not use it any more. The transport of an exchange is a connection
 * (http.c), a job whose answer is stored (job_table.h), an item of a batch (batch_runner.c), or a
 * stream for the rest of an answer (server_exchange_detach). Handlers do not depend on the
 * transport.
 *
 * States: reading -> ready -> answered, or deferred -> answered. An exchange is answered when
 * response.status is set (reply.h). A handler ends with a reply or with server_exchange_defer. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "proto/http/options.h"
#include "proto/http/route.h"
#include "proto/values/mesh.h"
#include "server/access/access.h"
#include "server/work/budget.h"
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
struct server_inflater;
struct server_metrics;
struct server_workspaces;
struct server_pending_build;
struct server_stream;
struct server_surface;

/* --- the body of a request (body.c) ----------------------------------------------------------- */
/* The bytes of a body are collected up to a limit, within the memory budget. */

#define SERVER_BODY_CHUNKED UINT64_MAX

struct server_body {
    struct server_share *share; /* set by server_body_prepare */
    char *bytes;                /* NULL while empty */
    /* `capacity` bytes are taken from the share (SERVER_BUDGET_FLIGHT) */
    size_t size, capacity;
    uint64_t declared;                /* Content-Length; 0 means none; or SERVER_BODY_CHUNKED */
    uint64_t limit;                   /* largest number of bytes that the operation accepts */
    size_t refused;                   /* bytes that the budget refused */
    bool is_share_full;               /* true if the tenant's share refused them */
    struct server_inflater *inflater; /* decompressor of a compressed body, or NULL */
    /* NULL, or a sentence with the reason why decompression failed */
    const char *fault;
    /* problem of an exceeded limit; it is sent at the end of the body, and the remaining bytes are
       dropped */
    enum proto_problem_code failure;
};

/* Refuses a declared length that exceeds the limit, the whole budget or the tenant's share. */
bool server_body_prepare(struct server_body *body, struct server_share *share, uint64_t declared,
                         uint64_t limit, struct proto_problem *problem);

/* Prepares to decompress a gzip body, before its first byte. `size` and `limit` then count
 * decompressed bytes. */
bool server_body_unpack(struct server_body *body, struct proto_problem *problem);

/* Appends bytes. If the limit or the budget is exceeded, sets `failure` and drops the rest. */
void server_body_append(struct server_body *body, const void *bytes, size_t size);

/* Called at the end of the body. Returns false with the problem of `failure`, if there is one. */
bool server_body_check(struct server_body *body, struct proto_problem *problem);

/* Frees the bytes and returns them to the budget. */
void server_body_drop(struct server_body *body);

/* --- the exchange ----------------------------------------------------------------------------- */

struct server_request_header { /* both strings are owned by the transport or the exchange */
    const char *name, *value;
};

struct server_response_header {
    const char *name;
    size_t size; /* bytes of the value, without its NUL */
    char value[SERVER_HEADER_VALUE];
};

/* Bytes in the middle of a response's body. The lender owns these bytes, and counts them in the
 * budget until they are released. */
struct server_lent {
    const void *bytes; /* NULL means `body` is the whole body */
    size_t size;
    const char *tail; /* static text after the lent bytes, or "" */
    void *lender;
    void (*release)(void *lender);
};

struct server_response {
    unsigned status; /* 0 if not answered yet */
    const char *media_type;
    enum proto_problem_code problem; /* PROTO_PROBLEM_NONE means none */
    const void *body;
    void *owned; /* equals `body` if the body must be freed; NULL means that the body is static */
    struct server_lent lent;
    size_t size; /* bytes of the whole body, including the lent bytes */
    size_t held; /* bytes of SERVER_BUDGET_ANSWERS for the body, until it is freed */
    struct server_stream *stream; /* a stream (events.h) that replaces the body; may be NULL */
    bool close;                   /* true if the connection is closed after this answer */
    /* Content-Security-Policy of a page; NULL means that the answer is data */
    const char *policy;
    uint32_t header_count;
    struct server_response_header headers[SERVER_RESPONSE_HEADERS];
};

/* The carrier of an exchange: a connection, a job, or an item of a batch. */
struct server_transport {
    /* Called when a deferred exchange is answered. The exchange belongs to the transport again. */
    void (*finish)(struct server_exchange *exchange);
    /* Returns true if the client of a deferred exchange has closed its connection. Any thread may
       call this function; it is called every millisecond. */
    bool (*is_gone)(struct server_exchange *exchange);
    /* Called when a worker starts or resumes a deferred exchange. May be NULL. */
    void (*begin)(struct server_exchange *exchange);
    /* Receives the progress in [0,1], on any thread. May be NULL. */
    void (*report)(struct server_exchange *exchange, double part);
    bool can_stream; /* true if the answer may be a stream (server_reply_stream) */
};

/* The parts and settings that all requests share. The parts outlive the exchanges. */
struct server_host {
    struct server_budget *budget;
    struct server_workers *workers;
    /* Each of these has one thread, so that its answers do not depend on the workers. `waiters`
       answers requests whose wait for a job has ended. `batch_readers` reads and cancels batches,
       and may block for the database. */
    struct server_workers *waiters, *batch_readers;
    struct server_workspaces *workspaces;
    struct server_events *events;
    struct server_answer_streams *streams;
    struct server_metrics *metrics;
    uint64_t timeout_ms, slow_ms, queue_length;
    bool has_cors_origins;
    char frame_ancestors[256]; /* origins that may frame pages; empty means none */
    /* Sets the deadline and calls the handler of the exchange's route. On return the exchange has a
       reply, or its `work` is set. In the second case the caller submits the exchange. */
    void (*dispatch)(struct server_exchange *exchange);
    /* Starts to watch deadlines. Called when the first exchange is deferred or a stream is
       opened. */
    void (*watch)(void *user);
    void *watcher;
    struct server_thread *spare; /* prepares memory after each field; or NULL */
    atomic_uint deferred;        /* exchanges that connections and jobs have submitted */
    atomic_bool is_draining;
    struct server_api *api; /* the parts that only handlers use (query/api.h) */
};

struct server_exchange {
    struct server_host *host;
    const struct server_transport *transport;
    struct server_job job;

    const char *method; /* as in the request line, for example "GET" */
    bool is_http10;
    bool is_local;       /* true if the connection comes from this host, perhaps through a proxy */
    bool has_body;       /* true if the headers announce a body, which may be empty */
    bool has_conditions; /* true if there is a header If-Match, If-None-Match or another If-… */
    char *target;        /* storage of path and parameters, which are decoded in place */
    size_t target_size;
    const char *authority; /* of a target in absolute form ("http://HOST/v1"), else NULL */
    const char *path;      /* never NULL */
    struct proto_parameters parameters; /* the decoded query string, in `parameter_list` */
    uint32_t header_count;
    char *copies;      /* copies of method and headers; NULL means the transport owns them */
    char *joined;      /* values of headers that stand on several lines (lists_join), or NULL */
    const char *fault; /* NULL, or a sentence with the reason why the request is malformed */
    struct proto_route_match match; /* the route; NULL means no route matches */
    /* the former name that the request uses (server_exchange_rename); may be NULL */
    const struct proto_deprecation *deprecation;
    char request_id[SERVER_REQUEST_ID];
    struct server_grant grant;
    /* tenant of the names in the path (kind.h), borrowed from the grant; or "" */
    const char *tenant;
    struct server_share *share; /* of the tenant, or of all requests without a key */
    const char *cors_origin;    /* the Origin header, if --cors-origin lists it; or NULL */
    struct server_body body;

    uint64_t started_ns;
    bool (*work)(struct server_exchange *exchange); /* NULL if not deferred */
    bool (*join)(struct server_exchange *exchange);
    /* a reference to the surface in the path, once the handler has found it; freed with `state` */
    struct server_surface *surface;
    void (*release_surface)(struct server_surface *surface); /* set with `surface` */
    size_t held;   /* bytes of SERVER_BUDGET_FLIGHT that the exchange holds until it ends */
    size_t parsed; /* part of `held` for the document being decoded (request.h) */
    void *state;   /* the handler's data; freed when the exchange is answered */
    void (*free_state)(void *state);

    struct server_response response;

    /* In these arrays and in the response's array of headers, only the items below the count are
     * initialized. To clear all items would take longer than the rest of a short request. */
    struct proto_parameter parameter_list[SERVER_EXCHANGE_PARAMETERS];
    struct server_request_header headers[SERVER_EXCHANGE_HEADERS];
    char name[PROTO_MESH_NAME + 1]; /* name in the key of server_request_key */
};

/* --- for the transport (http.c) and the router ------------------------------------------------ */

/* Begins an exchange for a raw target ("/v1/meshes?limit=3"), in memory that the caller may reuse
 * after the exchange has ended. Returns false if out of memory. A malformed target sets `fault`. */
bool server_exchange_begin(struct server_exchange *exchange, struct server_host *host,
                           const struct server_transport *transport, const char *target);
void server_exchange_end(struct server_exchange *exchange);

/* Allocates and begins an exchange. Returns NULL if out of memory. */
struct server_exchange *server_exchange_create(struct server_host *host,
                                               const struct server_transport *transport,
                                               const char *target);
void server_exchange_destroy(struct server_exchange *exchange); /* NULL is allowed */

/* Free the handler's state and release its surface; or free the answer's body and release lent
 * bytes. */
void server_exchange_drop_state(struct server_exchange *exchange);
void server_exchange_drop_body(struct server_exchange *exchange);

/* Adds a request header; borrows the strings. If there are too many, sets `fault`. */
void server_exchange_add_header(struct server_exchange *exchange, const char *name,
                                const char *value);

/* If a proxy and the daemon disagree on where a request ends, an attacker can make them see
 * different requests (request smuggling). So these functions refuse heads that HTTP implementations
 * are known to parse differently: RFC 9112, 3.2, 5.1, 6 and 11.2; RFC 9110, 5.5 and 5.6.2;
 * server/doc/019-http-library.md. The first function checks the target. The second one checks
 * method, version and headers, and sets is_http10, has_body and body.declared. Both return NULL, or
 * a static sentence with the reason for the refusal. O(bytes). */
const char *server_exchange_check_target(const char *target);
const char *server_exchange_read_head(struct server_exchange *exchange, const char *version);

/* Moves the request to a new exchange, whose transport outlives that of `exchange`. Moves body and
 * target, and copies the rest. `exchange` can still be answered. Returns NULL if out of memory. */
struct server_exchange *server_exchange_detach(struct server_exchange *exchange,
                                               const struct server_transport *transport);

/* These functions are for transports without a connection. server_exchange_run dispatches the
 * exchange. The transport's `finish` is called at the end, possibly before server_exchange_run
 * returns. server_exchange_is_unwanted is the `is_gone` of such a transport. */
void server_exchange_run(struct server_exchange *exchange);
bool server_exchange_is_unwanted(struct server_exchange *exchange);

/* server_exchange_submit passes a deferred exchange to the workers (reply.c). The caller must not
 * use the exchange any more. If the queue is full, the reply is the problem `overloaded`.
 * server_exchange_queue moves an exchange from the thread `batch_readers` to the workers. Returns
 * false with the reply `overloaded` if the queue is full.
 * server_exchange_count_deferred counts one more deferred exchange. */
void server_exchange_submit(struct server_exchange *exchange);
bool server_exchange_queue(struct server_exchange *exchange);
void server_exchange_count_deferred(struct server_host *host);
void server_exchange_job_run(struct server_job *job);
void server_exchange_job_refuse(struct server_job *job, enum server_refusal why);

/* Renames parameters that have former names in the contract, so that handlers see only the new
 * names. The answer to a former path or name has a header Deprecation (RFC 9745; reply.c adds it).
 * Returns false with invalid_request if a former name is sent twice or together with its
 * replacement. */
bool server_exchange_rename(struct server_exchange *exchange, struct proto_problem *problem);

/* Returns the name under which the client sent a parameter. */
const char *server_exchange_sent_name(const struct server_exchange *exchange,
                                      const char *parameter);

/* --- for handlers ----------------------------------------------------------------------------- */

/* Returns the host and port that the client asks for: the authority of an absolute target, or else
 * the Host header, or NULL (RFC 9112, 3.2.2). */
const char *server_exchange_host(const struct server_exchange *exchange);

/* Returns the value of the first header of that name, ignoring case, or NULL if there is none. */
const char *server_exchange_header(const struct server_exchange *exchange, const char *name);
uint32_t server_exchange_count_headers(const struct server_exchange *exchange, const char *name);

/* Returns true if a Prefer header (RFC 7240) lists `preference`, without a value and ignoring
 * case. */
bool server_exchange_prefers(const struct server_exchange *exchange, const char *preference);

/* Adds the members that all log lines about answered exchanges contain. */
void server_exchange_log(const struct server_exchange *exchange, struct server_log_line *line,
                         uint64_t nanoseconds);

bool server_exchange_is(const struct server_exchange *exchange, const char *method);

/* Shortens the deadline to `timeout_ms` after the start of the work; 0 does not change it. */
void server_exchange_shorten(struct server_exchange *exchange, uint64_t timeout_ms);

/* Sets the handler's state. It is freed with the exchange, or when a deferred exchange is
 * answered. */
void server_exchange_keep(struct server_exchange *exchange, void *state,
                          void (*free_state)(void *state));

/* Makes a worker call `work`. The handler must return after this call. `work` returns true after it
 * has replied or deferred the exchange again. It returns false after it has parked the exchange at
 * a pending build; when the build ends, `work` is called again. `join` (may be NULL) is called
 * first, without a worker; it returns true if it has parked the exchange at a pending build. */
void server_exchange_defer(struct server_exchange *exchange,
                           bool (*work)(struct server_exchange *exchange),
                           bool (*join)(struct server_exchange *exchange));

/* Returns the exchange that contains the job. */
struct server_exchange *server_exchange_of(struct server_job *job);

/* Controls a long call for the exchange. The call ends early at the exchange's deadline, when the
 * workers are cancelled, or when the client has closed the connection and no other job waits for
 * `build`. Each thread that works for the exchange has its own monitor. */
struct server_monitor {
    struct server_exchange *exchange;
    struct server_pending_build *build; /* the build whose field the call computes; may be NULL */
    bool (*is_awaited)(struct server_pending_build *build); /* set with `build` */
    /* the call is the part [begun, begun + share] of the exchange's progress; share 0 means all */
    double begun, share;
    uint64_t limit_ns; /* an earlier deadline, for this call only; 0 means none */
    /* The call ends early when the processor time of its thread exceeds this limit; 0 means none.
     * `is_over_limit` is then set. */
    uint64_t cpu_limit_ns;
    bool is_over_limit;
};
struct gd_control server_exchange_control(struct server_monitor *monitor);
