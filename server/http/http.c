/* See http.h. The only file that includes microhttpd.h.
 *
 * DESIGN. A call is one request on one connection, begun when its request line has been read and
 * ended when the library says that it is over; the next one has its memory. HEAD    the library
 * shows the headers: the router begins BODY    the library brings the body, piece by piece; then
 * the router ends PARKED  the connection is suspended, a worker has the exchange; its transport's
 * finish resumes the connection, and then the answer is queued DONE    the answer is with the
 * library
 *
 * A body that comes as it happens is read when the library can write; when there is nothing to
 * read, the connection is suspended until there is (events.h).
 *
 * libmicrohttpd 0.9.75 notices neither a hang-up nor a timeout of a suspended connection and must
 * not be stopped while one is: deadlines are the timekeeper's, hang-ups are looked for by is_gone,
 * and the server ends all streams and waits for all deferred exchanges before it stops.
 *
 * It can answer during an upload only in the first call, before any byte of the body: what is found
 * out later is answered after it. */
#include "server/http/http.h"

#include <microhttpd.h>
#include <poll.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/http/connections.h"
#include "server/base/date.h"
#include "server/http/events.h"
#include "server/http/header_block.h"
#include "server/base/log.h"
#include "server/work/thread_affinity.h"
#include "server/http/reply.h"
#include "server/http/request_log.h"
#include "server/router.h"
#include "server/server.h"
#include "server/http/tls.h"

/* headers, and the buffer that bodies pass through; cleared at each request */
#define CONNECTION_MEMORY (16 * 1024)
/* without a byte, in the middle of a body; on a unix socket of a long answer, too */
#define SILENCE_SECONDS 30u
#define LONG_ANSWER                                                                                \
    65536 /* bytes: shorter ones are in the kernel's buffers at once, and need no timer of the     \
             library's */
#define SPARE_DESCRIPTORS 64u
#define GONE_INTERVAL_NS  UINT64_C(20000000)  /* between two looks at a client's socket */
#define STREAM_BLOCK      1024                /* bytes of a stream that are asked for at a time */
#define LARGE_ANSWER      ((size_t)1 << 20)   /* bytes, */
#define LARGE_BLOCK       ((size_t)128 << 10) /* which are handed on so many at a time */

enum phase { PHASE_HEAD, PHASE_BODY, PHASE_PARKED, PHASE_DONE };

struct call {
    struct server_transport transport; /* first: an exchange finds its call by it */
    struct server_exchange *exchange;  /* the line's */
    struct MHD_Connection *connection;
    struct server_http *http;
    struct server_connection *wire;  /* what came in on the connection */
    uint64_t number;                 /* which of the connection's requests this is, from 0 on */
    enum phase phase;                /* written by the connection's HTTP thread only */
    bool is_watched;                 /* see watch_silence */
    atomic_uint_least64_t looked_ns; /* when the client was last looked at */
};

/* A connection, and the one call that it has at a time. */
struct line {
    struct server_connection *wire;
    struct call call;
    struct server_exchange exchange;
};

struct server_http {
    struct server *server;
    struct MHD_Daemon *daemon;
    int listening; /* the library's own, whose number is known here: see server_http_quiesce */
    int silent[2]; /* a pair of sockets on which nothing is ever said */
    uint32_t threads;
};

/* --- the transport ---------------------------------------------------------------------------- */

static struct call *call_of(struct server_exchange *exchange)
{
    return (struct call *)exchange->transport;
}

static void finish(struct server_exchange *exchange)
{
    server_reply_seal(exchange);
    MHD_resume_connection(call_of(exchange)->connection);
}

static int socket_of(struct MHD_Connection *connection)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    return info ? info->connect_fd : -1;
}

static const struct sockaddr *peer_of(struct MHD_Connection *connection)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    return info ? info->client_addr : NULL;
}

/* A client that has closed its side has gone: nobody who waits for an answer does that. */
static bool has_hung_up(const struct call *call)
{
    struct pollfd state = {.fd = socket_of(call->connection), .events = POLLRDHUP};
    return poll(&state, 1, 0) == 1 && (state.revents & (POLLRDHUP | POLLHUP | POLLERR));
}

static bool is_gone(struct server_exchange *exchange)
{
    struct call *call = call_of(exchange);
    uint64_t now = gd_now_ns();
    if (now - atomic_load_explicit(&call->looked_ns, memory_order_relaxed) < GONE_INTERVAL_NS)
        return false;
    if (has_hung_up(call)) return true;
    atomic_store_explicit(&call->looked_ns, now, memory_order_relaxed);
    return false;
}

/* --- from the library to the exchange --------------------------------------------------------- */

static struct line *line_of(struct MHD_Connection *connection)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    return info ? info->socket_context : NULL;
}

static struct line *open_line(const struct server_http *http, struct MHD_Connection *connection)
{
    bool is_encrypted = http->server->tls != NULL;
    struct line *line = malloc(sizeof *line);
    if (!line) return NULL;
    line->wire = server_connections_open(http->server->connections, socket_of(connection),
                                         peer_of(connection), is_encrypted);
    if (line->wire) return line;
    free(line);
    return NULL;
}

static void close_line(struct line *line)
{
    if (!line) return;
    server_connections_close(line->wire);
    free(line);
}

static void on_connection(void *user, struct MHD_Connection *connection, void **context,
                          enum MHD_ConnectionNotificationCode what)
{
    if (what == MHD_CONNECTION_NOTIFY_STARTED) {
        *context = open_line(user, connection);
    } else {
        close_line(*context);
        *context = NULL;
    }
}

/* The raw target, before the library takes it apart; what this returns comes back as `*context`. */
static void *on_target(void *user, const char *target, struct MHD_Connection *connection)
{
    struct server_http *http = user;
    struct line *line = line_of(connection);
    if (!line) return NULL;
    line->call =
        (struct call){.transport = {.finish = finish, .is_gone = is_gone, .can_stream = true},
                      .exchange = &line->exchange,
                      .connection = connection,
                      .http = http,
                      .wire = line->wire,
                      .number = line->wire->requests++};
    if (!server_exchange_begin(&line->exchange, &http->server->host, &line->call.transport, target))
        return NULL;
    server_thread_place(http->threads, server_workers_are_busy(http->server->workers),
                        line->exchange.started_ns);
    server_connection_ask(line->wire);
    return &line->call;
}

/* Escapes stay as they are: the target was taken apart before the library does it. */
static size_t on_escapes(void *user, struct MHD_Connection *connection, char *text)
{
    (void)user, (void)connection;
    return strlen(text);
}

/* The library's timer for silence, which it sets anew with every byte, is on only in bodies and, on
 * unix sockets, in long answers: whether a client takes one is looked at elsewhere (connections.h),
 * since the library writes nothing for as long as the kernel's buffers are full. */
static void watch_silence(struct call *call, bool is_on)
{
    if (call->is_watched == is_on) return;
    MHD_set_connection_option(call->connection, MHD_CONNECTION_OPTION_TIMEOUT,
                              is_on ? SILENCE_SECONDS : 0u);
    call->is_watched = is_on;
}

static void log_broken_body(const struct call *call)
{
    server_log_message(SERVER_LOG_INFO, "malformed", "the body of %s %s: %s",
                       call->exchange->method, call->exchange->path, call->wire->grammar.fault);
}

/* The library has answered it, or hung up. */
static void on_completed(void *user, struct MHD_Connection *connection, void **context,
                         enum MHD_RequestTerminationCode why)
{
    struct call *call = *context;
    (void)user, (void)connection;
    if (!call) return;
    if (call->phase == PHASE_BODY && call->wire->grammar.fault) log_broken_body(call);
    if (why == MHD_REQUEST_TERMINATED_COMPLETED_OK) watch_silence(call, false);
    server_exchange_end(call->exchange);
    server_connection_end(call->wire);
    *context = NULL;
}

/* What the grammar found out about the request, or a request that it has not seen: then the library
 * reads in a way that is not watched (wire.h), and nothing it says can be trusted. */
static const char *find_fault(const struct call *call)
{
    const struct server_grammar *grammar = &call->wire->grammar;
    if (call->number < grammar->heads) return NULL;
    return grammar->fault ? grammar->fault
                          : "the request came in on a way that is not watched; tell the operator";
}

static enum MHD_Result on_header(void *user, enum MHD_ValueKind kind, const char *name,
                                 const char *value)
{
    (void)kind;
    server_exchange_add_header(user, name, value);
    return MHD_YES;
}

/* --- from the exchange to the library --------------------------------------------------------- */

static void pause_call(void *user)
{
    const struct call *call = user;
    MHD_suspend_connection(call->connection);
}

static void resume_call(void *user)
{
    const struct call *call = user;
    MHD_resume_connection(call->connection);
}

static bool is_call_gone(void *user)
{
    return has_hung_up(user);
}

static ssize_t on_read(void *user, uint64_t position, char *bytes, size_t size)
{
    struct call *call = user;
    (void)position;
    ptrdiff_t read = server_stream_read(call->exchange->response.stream, bytes, size);
    if (read == SERVER_STREAM_CUT) return MHD_CONTENT_READER_END_WITH_ERROR;
    return read < 0 ? MHD_CONTENT_READER_END_OF_STREAM : read;
}

static struct MHD_Response *make_streamed(struct call *call)
{
    server_stream_attach(
        call->exchange->response.stream,
        (struct server_stream_reader){pause_call, resume_call, is_call_gone, call});
    return MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, STREAM_BLOCK, on_read, call, NULL);
}

/* Copies the body from `position` on: its own text, then the lent bytes, then their tail. */
static ssize_t on_body(void *user, uint64_t position, char *bytes, size_t size)
{
    const struct server_response *reply = user;
    const struct server_lent *lent = &reply->lent;
    size_t tail = lent->bytes ? strlen(lent->tail) : 0;
    const struct {
        const char *bytes;
        size_t size;
    } parts[] = {{reply->body, reply->size - lent->size - tail},
                 {lent->bytes, lent->size},
                 {lent->tail, tail}};
    for (int i = 0; i < 3; i++) {
        size_t left = position < parts[i].size ? parts[i].size - (size_t)position : 0;
        if (left) {
            size_t copied = size < left ? size : left;
            memcpy(bytes, parts[i].bytes + position, copied);
            return (ssize_t)copied;
        }
        position -= parts[i].size;
    }
    return MHD_CONTENT_READER_END_OF_STREAM;
}

/* A large body goes to the kernel in blocks: a system call that copies several MiB would delay the
 * thread's other connections by milliseconds. The exchange keeps the body. */
static struct MHD_Response *make_large(struct server_response *reply)
{
    return MHD_create_response_from_callback(reply->size, LARGE_BLOCK, on_body, reply, NULL);
}

static struct MHD_Response *make_whole(struct server_response *reply)
{
    if (reply->lent.bytes || reply->size >= LARGE_ANSWER) return make_large(reply);
    struct MHD_Response *response =
        reply->owned
            ? MHD_create_response_from_buffer_with_free_callback(reply->size, reply->owned, free)
            : MHD_create_response_from_buffer(reply->size, (void *)reply->body,
                                              MHD_RESPMEM_PERSISTENT);
    if (response) reply->owned = NULL; /* the library's now */
    return response;
}

static enum MHD_Result on_response_header(void *user, enum MHD_ValueKind kind, const char *name,
                                          const char *value)
{
    (void)kind;
    if (strcmp(name, MHD_HTTP_HEADER_DATE) == 0) /* the library's copy, which it writes as it is */
        server_header_block_break(user, (char *)value);
    return MHD_YES;
}

static bool add_headers(struct MHD_Response *response, const struct server_response *reply)
{
    struct server_header_block block;
    server_header_block_join(&block, reply, server_date());
    return MHD_add_response_header(response, MHD_HTTP_HEADER_DATE, block.value) == MHD_YES &&
           MHD_get_response_headers(response, on_response_header, &block) > 0;
}

static struct MHD_Response *make_response(struct call *call)
{
    struct server_response *reply = &call->exchange->response;
    struct MHD_Response *response = reply->stream ? make_streamed(call) : make_whole(reply);
    if (!response) return NULL;
    /* in this order: 0.9.75 forgets that there is a Date when it gets a Connection, and adds
     * another */
    if (reply->close) MHD_add_response_header(response, MHD_HTTP_HEADER_CONNECTION, "close");
    if (add_headers(response, reply)) return response;
    MHD_destroy_response(response);
    return NULL;
}

/* Unix sockets do not tell what a client has taken; their buffers are small. */
static bool is_local(const struct call *call)
{
    return call->http->server->config.listen.socket.ss_family == AF_UNIX;
}

static enum MHD_Result answer(struct call *call)
{
    struct server_exchange *exchange = call->exchange;
    const struct server_response *reply = &exchange->response;
    uint64_t now = gd_now_ns(), nanoseconds = now - exchange->started_ns;
    call->phase = PHASE_DONE;
    struct MHD_Response *response = make_response(call);
    if (!response) return MHD_NO;
    server_metrics_count(exchange->host->metrics, exchange->match.route, reply->status,
                         nanoseconds);
    server_metrics_count_problem(exchange->host->metrics, reply->problem);
    server_request_log(exchange, peer_of(call->connection), nanoseconds);
    server_connection_answer(call->wire, reply->size, reply->stream != NULL, now);
    watch_silence(call, is_local(call) && (reply->stream || reply->size > LONG_ANSWER));
    enum MHD_Result result = MHD_queue_response(call->connection, reply->status, response);
    MHD_destroy_response(response);
    return result;
}

/* --- the phases ------------------------------------------------------------------------------- */

static enum MHD_Result begin(struct call *call, const char *method, const char *version)
{
    struct server_exchange *exchange = call->exchange;
    exchange->method = method;
    exchange->is_http10 = strcmp(version, MHD_HTTP_VERSION_1_0) == 0;
    call->phase = PHASE_BODY;
    const char *fault = find_fault(call);
    server_connection_begin(call->wire);
    if (fault) exchange->fault = fault;
    MHD_get_connection_values(call->connection, MHD_HEADER_KIND, on_header, exchange);
    server_router_begin(exchange);
    watch_silence(call, server_connection_is_in_body(call->wire));
    if (!exchange->response.close) return MHD_YES;
    server_reply_seal(exchange);
    return answer(call);
}

static enum MHD_Result end(struct call *call)
{
    server_router_end(call->exchange);
    if (call->exchange->response.status) {
        server_reply_seal(call->exchange);
        return answer(call);
    }
    call->phase = PHASE_PARKED;
    atomic_store_explicit(&call->looked_ns, gd_now_ns(), memory_order_relaxed);
    MHD_suspend_connection(call->connection);
    server_exchange_submit(call->exchange); /* from here on it is another thread's */
    return MHD_YES;
}

static enum MHD_Result on_request(void *user, struct MHD_Connection *connection, const char *url,
                                  const char *method, const char *version, const char *upload,
                                  size_t *upload_size, void **context)
{
    (void)user, (void)connection, (void)url;
    struct call *call = *context;
    if (!call) return MHD_NO; /* no memory for one */
    switch (call->phase) {
    case PHASE_HEAD:
        return begin(call, method, version);
    case PHASE_BODY:
        if (!*upload_size) return end(call);
        if (!server_body_append(&call->exchange->body, &call->http->server->budget, upload,
                                *upload_size))
            return MHD_NO;
        *upload_size = 0;
        return MHD_YES;
    case PHASE_PARKED:
        return answer(call);
    case PHASE_DONE:
        break;
    }
    return MHD_YES;
}

/* --- life ------------------------------------------------------------------------------------- */

/* As many connections as descriptors allow, up to the configured limit, which bounds their memory.
 */
static unsigned connection_limit(const struct server_config *config)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 ||
        limit.rlim_cur >= config->max_connections + SPARE_DESCRIPTORS)
        return (unsigned)config->max_connections;
    unsigned descriptors = (unsigned)limit.rlim_cur, most = descriptors > 2 * SPARE_DESCRIPTORS
                                                                ? descriptors - SPARE_DESCRIPTORS
                                                                : descriptors / 2;
    server_log_message(
        SERVER_LOG_WARN, "descriptors",
        "%u connections at once at most: the limit of open files is %u; raise it by ulimit -n",
        most, descriptors);
    return most;
}

/* However few connections there can be, one address leaves a quarter of them to others; 0: no
 * limit. */
static unsigned address_limit(const struct server_config *config, unsigned most)
{
    unsigned wanted = (unsigned)config->max_address_connections, all_but_some = most - most / 4;
    return wanted < all_but_some ? wanted : all_but_some;
}

static void on_library_log(void *user, const char *format, va_list arguments)
{
    char sentence[512];
    (void)user;
    vsnprintf(sentence, sizeof sentence, format, arguments);
    sentence[strcspn(sentence, "\n")] = '\0';
    server_log_message(SERVER_LOG_DEBUG, "http", "%s", sentence);
}

static struct server_http *create(struct server *server, int listening, uint32_t threads)
{
    struct server_http *http = calloc(1, sizeof *http);
    if (!http) return NULL;
    http->server = server;
    http->listening = listening;
    http->threads = threads;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, http->silent) == 0) return http;
    free(http);
    return NULL;
}

static void destroy(struct server_http *http)
{
    if (!http) return;
    close(http->silent[0]);
    close(http->silent[1]);
    free(http);
}

static struct MHD_Daemon *start_library(struct server_http *http)
{
    const struct server_config *config = &http->server->config;
    const struct MHD_OptionItem encrypted[] = {
        {MHD_OPTION_HTTPS_PRIORITIES, 0, SERVER_TLS_PRIORITIES},
        {MHD_OPTION_HTTPS_CERT_CALLBACK, 0, server_tls_retrieve()},
        {MHD_OPTION_END, 0, NULL},
    };
    const struct MHD_OptionItem plain[] = {{MHD_OPTION_END, 0, NULL}};
    unsigned most = connection_limit(config);
    server_connections_limit(http->server->connections, most);
    unsigned flags =
        MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ITC | MHD_USE_ERROR_LOG;
    if (http->server->tls) flags |= MHD_USE_TLS;
    return MHD_start_daemon(
        flags, 0, NULL, NULL, on_request, http, MHD_OPTION_EXTERNAL_LOGGER, on_library_log, NULL,
        MHD_OPTION_LISTEN_SOCKET, http->listening, MHD_OPTION_THREAD_POOL_SIZE,
        http->threads > 1 ? http->threads : 0u, MHD_OPTION_CONNECTION_LIMIT, most,
        MHD_OPTION_PER_IP_CONNECTION_LIMIT, address_limit(config, most),
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)CONNECTION_MEMORY, MHD_OPTION_NOTIFY_CONNECTION,
        on_connection, http, MHD_OPTION_URI_LOG_CALLBACK, on_target, http,
        MHD_OPTION_UNESCAPE_CALLBACK, on_escapes, NULL, MHD_OPTION_NOTIFY_COMPLETED, on_completed,
        http, MHD_OPTION_ARRAY, http->server->tls ? encrypted : plain, MHD_OPTION_END);
}

struct server_http *server_http_start(struct server *server, int listening, uint32_t threads,
                                      char *error, size_t error_size)
{
    struct server_http *http = create(server, listening, threads);
    if (http) http->daemon = start_library(http);
    if (http && http->daemon) return http;
    snprintf(error, error_size, "the HTTP library could not be started");
    destroy(http);
    close(listening);
    return NULL;
}

/* MHD_quiesce_daemon and a thread of the library that wakes at that moment both take the listening
 * socket out of the thread's epoll set, and the second of the two aborts the program (0.9.75; one
 * stop in three thousand, as measured). So the socket is closed under the library's number for it,
 * where a silent one takes its place: the kernel itself takes a closed socket out of every set. */
void server_http_quiesce(struct server_http *http)
{
    (void)dup2(http->silent[0], http->listening);
}

uint32_t server_http_active(struct server_http *http)
{
    return server_connections_under_way(http->server->connections);
}

void server_http_stop(struct server_http *http)
{
    if (!http) return;
    MHD_stop_daemon(http->daemon);
    destroy(http);
}
