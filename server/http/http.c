/* See http.h. Only this file includes microhttpd.h.
 *
 * DESIGN. A client is one connection with one request at a time. A request begins with its request
 * line and ends when the library reports its end:
 *     HEAD      the library reads the headers; then `begin` (http.h) checks the request
 *     BODY      the body arrives in pieces; then `end` (http.h) answers or defers the request
 *     PARKED    the connection is suspended while a worker has the exchange; at the end of the
 *               exchange (client_finish) it is resumed, and the answer is queued
 *     ANSWERED  the library sends the answer
 *
 * Each time the library can write, it reads a part of a streamed answer. While there is nothing to
 * read, the connection is suspended (events.h).
 *
 * libmicrohttpd 0.9.75 detects neither hang-ups nor timeouts of suspended connections, and must not
 * be stopped while a connection is suspended. So server.c and connections.h enforce the deadlines,
 * is_gone detects hang-ups, and the server waits for all deferred exchanges before it stops.
 *
 * The library can answer before the body only during its first call for a request. Errors that are
 * detected later are answered after the body. */
#include "server/http/http.h"

#include <microhttpd.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/base/log.h"
#include "server/config/config.h"
#include "server/http/connections.h"
#include "server/exchange/events.h"
#include "server/exchange/metrics.h"
#include "server/exchange/reply.h"
#include "server/http/tls.h"
#include "server/work/thread_priority.h"

/* Bytes that the library uses for a connection, for the head and as a buffer of the body. The
 * library clears them at each request. */
#define CONNECTION_MEMORY  (16 * 1024)
#define SILENCE_SECONDS    30u /* idle timer of unix sockets (see connections.c) */
#define SPARE_DESCRIPTORS  64u /* descriptors of the store, the log and the process */
#define THREAD_DESCRIPTORS 4u  /* descriptors of an HTTP thread or a worker */
#define GONE_INTERVAL_NS   UINT64_C(20000000) /* time between two checks of a client's socket */
#define STREAM_BLOCK       1024               /* bytes that are read from a stream at a time */
#define LARGE_ANSWER       ((size_t)1 << 20)
#define PEER_TEXT          64
#define LARGE_BLOCK        ((size_t)128 << 10) /* bytes of a large answer that are sent at a time */

/* Level 1 refuses HTTP/1.1 without a Host, and blanks in targets. From version 1.0 of the library
 * on, it also refuses bare LFs, folded lines, and more blanks and empty lines than RFC 9112
 * allows. */
#if MHD_VERSION >= 0x01000000
#define DISCIPLINE MHD_OPTION_CLIENT_DISCIPLINE_LVL
#else
#define DISCIPLINE MHD_OPTION_STRICT_FOR_CLIENT
#endif

enum phase { PHASE_HEAD, PHASE_BODY, PHASE_PARKED, PHASE_ANSWERED };

struct client {
    struct server_transport transport; /* must be the first member */
    struct server_exchange exchange;
    const struct server_http *http;
    struct MHD_Connection *connection;
    struct server_connection *deadlines;
    const char *fault;               /* NULL, or the reason why the request line is malformed */
    enum phase phase;                /* written by the connection's HTTP thread only */
    atomic_uint_least64_t looked_ns; /* time at which is_gone last checked the socket */
};

struct server_http {
    struct server_http_parts parts;
    struct MHD_Daemon *daemon;
    int listening; /* the library's descriptor; see server_http_quiesce */
    int silent[2]; /* a pair of sockets without traffic */
};

/* --- the transport ---------------------------------------------------------------------------- */

static struct client *client_of(struct server_exchange *exchange)
{
    return (struct client *)exchange->transport;
}

static void client_finish(struct server_exchange *exchange)
{
    server_reply_seal(exchange);
    MHD_resume_connection(client_of(exchange)->connection);
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

static bool peer_is_local(const struct sockaddr *peer)
{
    if (peer && peer->sa_family == AF_INET6) {
        const struct in6_addr *address = &((const struct sockaddr_in6 *)peer)->sin6_addr;
        return IN6_IS_ADDR_LOOPBACK(address) ||
               (IN6_IS_ADDR_V4MAPPED(address) && address->s6_addr[12] == IN_LOOPBACKNET);
    }
    return peer && peer->sa_family == AF_INET &&
           ntohl(((const struct sockaddr_in *)peer)->sin_addr.s_addr) >> 24 == IN_LOOPBACKNET;
}

/* Returns true if the client has closed its side. The daemon then assumes that the client does not
 * wait for the answer. */
static bool client_has_hung_up(void *user)
{
    const struct client *client = user;
    struct pollfd state = {.fd = socket_of(client->connection), .events = POLLRDHUP};
    return poll(&state, 1, 0) == 1 && (state.revents & (POLLRDHUP | POLLHUP | POLLERR));
}

static bool client_is_gone(struct server_exchange *exchange)
{
    struct client *client = client_of(exchange);
    uint64_t now_ns = gd_now_ns();
    uint64_t looked_ns = atomic_load_explicit(&client->looked_ns, memory_order_relaxed);
    if (now_ns - looked_ns < GONE_INTERVAL_NS) return false;
    if (client_has_hung_up(client)) return true;
    atomic_store_explicit(&client->looked_ns, now_ns, memory_order_relaxed);
    return false;
}

/* --- connections ------------------------------------------------------------------------------ */

static struct client *client_open(const struct server_http *http, struct MHD_Connection *connection)
{
    struct client *client = calloc(1, sizeof *client);
    if (!client) return NULL;
    client->transport = (struct server_transport){
        .finish = client_finish, .is_gone = client_is_gone, .can_stream = true};
    client->http = http;
    client->connection = connection;
    client->deadlines =
        server_connection_open(http->parts.connections, socket_of(connection), peer_of(connection));
    if (client->deadlines) return client;
    free(client);
    return NULL;
}

static void on_connection(void *user, struct MHD_Connection *connection, void **context,
                          enum MHD_ConnectionNotificationCode code)
{
    struct client *client = *context;
    if (code == MHD_CONNECTION_NOTIFY_STARTED) {
        *context = client_open(user, connection);
    } else if (client) {
        server_connection_close(client->deadlines);
        free(client);
    }
}

/* --- from the library to the exchange --------------------------------------------------------- */

/* Receives the raw target, before the library splits it. The result is the request's context. */
static void *on_target(void *user, const char *target, struct MHD_Connection *connection)
{
    const struct server_http_parts *parts = &((const struct server_http *)user)->parts;
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    struct client *client = info ? info->socket_context : NULL;
    if (!client || !target) return NULL;
    struct server_exchange *exchange = &client->exchange;
    if (!server_exchange_begin(exchange, parts->host, &client->transport, target)) return NULL;
    client->phase = PHASE_HEAD;
    client->fault = server_exchange_check_target(target);
    server_thread_place((uint32_t)parts->config->http_threads,
                        server_workers_are_busy(parts->host->workers), exchange->started_ns);
    server_connection_ask(client->deadlines, exchange->started_ns);
    return client;
}

/* Leaves escapes undecoded, because the exchange has decoded its own copy of the target. */
static size_t on_escapes(void *user, struct MHD_Connection *connection, char *text)
{
    (void)user, (void)connection;
    return strlen(text);
}

static void on_completed(void *user, struct MHD_Connection *connection, void **context,
                         enum MHD_RequestTerminationCode code)
{
    struct client *client = *context;
    (void)user, (void)connection;
    if (!client) return;
    bool is_answered = client->phase == PHASE_PARKED || client->phase == PHASE_ANSWERED;
    if (!is_answered && code == MHD_REQUEST_TERMINATED_COMPLETED_OK) {
        /* the library has answered the request by itself */
        server_connection_refuse(client->deadlines);
        server_log_message(SERVER_LOG_INFO, "malformed", "the %s of a request of %s is malformed",
                           client->phase == PHASE_HEAD ? "head" : "body", client->exchange.path);
    }
    server_exchange_end(&client->exchange);
    server_connection_end(client->deadlines);
    *context = NULL;
}

static enum MHD_Result on_header(void *user, enum MHD_ValueKind kind, const char *name,
                                 const char *value)
{
    (void)kind;
    server_exchange_add_header(user, name, value);
    return MHD_YES;
}

/* --- the log ---------------------------------------------------------------------------------- */

static const char *print_peer(const struct sockaddr *peer, char text[PEER_TEXT])
{
    if (!peer || (peer->sa_family != AF_INET && peer->sa_family != AF_INET6)) return NULL;
    socklen_t size =
        peer->sa_family == AF_INET6 ? sizeof(struct sockaddr_in6) : sizeof(struct sockaddr_in);
    return getnameinfo(peer, size, text, PEER_TEXT, NULL, 0, NI_NUMERICHOST) == 0 ? text : NULL;
}

/* Logs an answered exchange with the name of the client's key. Logs the client's address only if
 * the request was refused. */
static void client_log(const struct client *client, uint64_t nanoseconds)
{
    const struct server_exchange *exchange = &client->exchange;
    const struct server_response *response = &exchange->response;
    uint64_t slow_ms = exchange->host->slow_ms;
    bool is_slow = slow_ms && nanoseconds >= slow_ms * 1000000, is_error = response->status == 500;
    struct server_log_line line;
    char text[PEER_TEXT];
    if (!server_log_begin(&line,
                          is_error  ? SERVER_LOG_ERROR
                          : is_slow ? SERVER_LOG_WARN
                                    : SERVER_LOG_INFO,
                          is_slow && !is_error ? "slow_request" : "request"))
        return;
    server_exchange_log(exchange, &line, nanoseconds);
    if (response->status == 400 || response->status == 401 || response->status == 403 ||
        response->status == 429)
        server_log_text(&line, "peer", print_peer(peer_of(client->connection), text));
    server_log_text(&line, "lane", exchange->work ? "worker" : "inline");
    server_log_end_soon(&line);
}

/* --- from the exchange to the library --------------------------------------------------------- */

static void client_pause(void *user)
{
    MHD_suspend_connection(((const struct client *)user)->connection);
}

static void client_resume(void *user)
{
    MHD_resume_connection(((const struct client *)user)->connection);
}

static ssize_t on_read(void *user, uint64_t position, char *bytes, size_t size)
{
    struct client *client = user;
    (void)position;
    ptrdiff_t read = server_stream_read(client->exchange.response.stream, bytes, size);
    if (read == SERVER_STREAM_CUT) return MHD_CONTENT_READER_END_WITH_ERROR;
    return read < 0 ? MHD_CONTENT_READER_END_OF_STREAM : read;
}

/* Copies the body from `position` on. The body consists of its own text, the lent bytes and their
 * tail. */
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

/* Sends a large body in blocks, because a system call that copies several MiB delays the thread's
 * other connections by milliseconds. The exchange then keeps the body. */
static struct MHD_Response *response_create(struct client *client)
{
    struct server_response *reply = &client->exchange.response;
    if (reply->stream) {
        server_stream_attach(
            reply->stream,
            (struct server_stream_reader){client_pause, client_resume, client_has_hung_up, client});
        return MHD_create_response_from_callback(reply->size ? reply->size : MHD_SIZE_UNKNOWN,
                                                 reply->size ? LARGE_BLOCK : STREAM_BLOCK, on_read,
                                                 client, NULL);
    }
    if (reply->lent.bytes || reply->size >= LARGE_ANSWER)
        return MHD_create_response_from_callback(reply->size, LARGE_BLOCK, on_body, reply, NULL);
    struct MHD_Response *response =
        reply->owned
            ? MHD_create_response_from_buffer_with_free_callback(reply->size, reply->owned, free)
            : MHD_create_response_from_buffer(reply->size, (void *)reply->body,
                                              MHD_RESPMEM_PERSISTENT);
    if (response) reply->owned = NULL; /* the library has taken ownership */
    return response;
}

static bool response_add_headers(struct MHD_Response *response, const struct server_response *reply)
{
    bool is_added = !reply->close || MHD_add_response_header(response, MHD_HTTP_HEADER_CONNECTION,
                                                             "close") == MHD_YES;
    for (uint32_t i = 0; is_added && i < reply->header_count; i++)
        is_added = MHD_add_response_header(response, reply->headers[i].name,
                                           reply->headers[i].value) == MHD_YES;
    return is_added;
}

static enum MHD_Result client_answer(struct client *client)
{
    struct server_exchange *exchange = &client->exchange;
    const struct server_response *reply = &exchange->response;
    uint64_t now_ns = gd_now_ns(), nanoseconds = now_ns - exchange->started_ns;
    client->phase = PHASE_ANSWERED;
    struct MHD_Response *response = response_create(client);
    if (!response || !response_add_headers(response, reply)) {
        if (response) MHD_destroy_response(response);
        return MHD_NO;
    }
    server_metrics_count(exchange->host->metrics, exchange->match.route, reply->status,
                         reply->problem, nanoseconds);
    client_log(client, nanoseconds);
    server_connection_answer(client->deadlines, reply->size, reply->stream && !reply->size, now_ns);
    enum MHD_Result result = MHD_queue_response(client->connection, reply->status, response);
    MHD_destroy_response(response);
    return result;
}

/* --- the phases ------------------------------------------------------------------------------- */

static enum MHD_Result client_begin(struct client *client, const char *method, const char *version)
{
    struct server_exchange *exchange = &client->exchange;
    exchange->method = method;
    exchange->is_local = peer_is_local(peer_of(client->connection));
    MHD_get_connection_values(client->connection, MHD_HEADER_KIND, on_header, exchange);
    const char *fault = server_exchange_read_head(exchange, version);
    if (client->fault) fault = client->fault;
    if (fault) {
        exchange->fault = fault;
        server_connection_refuse(client->deadlines);
    }
    server_connection_head(client->deadlines, exchange->body.declared != 0, exchange->started_ns);
    client->phase = PHASE_BODY;
    client->http->parts.begin(exchange);
    if (!exchange->response.close) return MHD_YES;
    server_reply_seal(exchange);
    return client_answer(client);
}

static enum MHD_Result client_end(struct client *client)
{
    client->http->parts.end(&client->exchange);
    if (client->exchange.response.status) {
        server_reply_seal(&client->exchange);
        return client_answer(client);
    }
    client->phase = PHASE_PARKED;
    server_connection_work(client->deadlines);
    atomic_store_explicit(&client->looked_ns, gd_now_ns(), memory_order_relaxed);
    MHD_suspend_connection(client->connection);
    server_exchange_submit(&client->exchange); /* another thread may now free it */
    return MHD_YES;
}

static enum MHD_Result on_request(void *user, struct MHD_Connection *connection, const char *url,
                                  const char *method, const char *version, const char *upload,
                                  size_t *upload_size, void **context)
{
    (void)user, (void)connection, (void)url;
    struct client *client = *context;
    size_t size = *upload_size;
    if (!client) return MHD_NO; /* out of memory */
    *upload_size = 0;
    switch (client->phase) {
    case PHASE_HEAD:
        return client_begin(client, method, version);
    case PHASE_BODY:
        if (!size) return client_end(client);
        server_connection_body(client->deadlines, size, gd_now_ns());
        server_body_append(&client->exchange.body, upload, size);
        break;
    case PHASE_PARKED:
        return client_answer(client);
    case PHASE_ANSWERED:
        break;
    }
    return MHD_YES;
}

/* --- limits ----------------------------------------------------------------------------------- */

/* Returns the limit of open connections. The configured number bounds their memory. The limit is
 * lower if the other parts of the daemon would lack descriptors. */
static unsigned connection_limit(const struct server_config *config)
{
    struct rlimit limit;
    unsigned wanted = (unsigned)config->max_connections;
    /* there are as many spare workers (work/workers.h) as workers */
    unsigned threads = (unsigned)(config->http_threads + 2 * config->workers);
    unsigned own = SPARE_DESCRIPTORS + threads * THREAD_DESCRIPTORS;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted + own) return wanted;
    unsigned all = (unsigned)limit.rlim_cur, most = all > 2 * own ? all - own : all / 2;
    server_log_message(
        SERVER_LOG_WARN, "descriptors",
        "at most %u connections at a time: the limit of open files is %u; raise it with ulimit -n",
        most, all);
    return most;
}

/* --- life ------------------------------------------------------------------------------------- */

static void on_library_log(void *user, const char *format, va_list arguments)
{
    char sentence[512];
    (void)user;
    vsnprintf(sentence, sizeof sentence, format, arguments);
    sentence[strcspn(sentence, "\n")] = '\0';
    server_log_message(SERVER_LOG_DEBUG, "http", "%s", sentence);
}

static void http_destroy(struct server_http *http)
{
    close(http->silent[0]);
    close(http->silent[1]);
    free(http);
}

static struct MHD_Daemon *http_start_library(struct server_http *http)
{
    const struct server_config *config = http->parts.config;
    const struct MHD_OptionItem encrypted[] = {
        {MHD_OPTION_HTTPS_PRIORITIES, 0, SERVER_TLS_PRIORITIES},
        {MHD_OPTION_HTTPS_CERT_CALLBACK, 0, server_tls_retrieve()},
        {MHD_OPTION_END, 0, NULL},
    };
    const struct MHD_OptionItem plain[] = {{MHD_OPTION_END, 0, NULL}};
    unsigned flags = MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ITC |
                     MHD_USE_ERROR_LOG | (http->parts.tls ? MHD_USE_TLS : 0);
    unsigned most = connection_limit(config), threads = (unsigned)config->http_threads;
    /* at most three quarters of all connections for one address, so that other clients can connect;
       0 means no limit */
    unsigned own = (unsigned)config->max_address_connections, all_but_some = most - most / 4;
    unsigned silence = config->listen.socket.ss_family == AF_UNIX ? SILENCE_SECONDS : 0;
    server_connections_limit(http->parts.connections, most);
    return MHD_start_daemon(
        flags, 0, NULL, NULL, on_request, http, MHD_OPTION_EXTERNAL_LOGGER, on_library_log, NULL,
        MHD_OPTION_LISTEN_SOCKET, http->listening, MHD_OPTION_THREAD_POOL_SIZE,
        threads > 1 ? threads : 0u, DISCIPLINE, 1, MHD_OPTION_CONNECTION_LIMIT, most,
        MHD_OPTION_PER_IP_CONNECTION_LIMIT, own < all_but_some ? own : all_but_some,
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)CONNECTION_MEMORY,
        MHD_OPTION_CONNECTION_TIMEOUT, silence, MHD_OPTION_NOTIFY_CONNECTION, on_connection, http,
        MHD_OPTION_URI_LOG_CALLBACK, on_target, http, MHD_OPTION_UNESCAPE_CALLBACK, on_escapes,
        NULL, MHD_OPTION_NOTIFY_COMPLETED, on_completed, http, MHD_OPTION_ARRAY,
        http->parts.tls ? encrypted : plain, MHD_OPTION_END);
}

struct server_http *server_http_start(const struct server_http_parts *parts, int listening,
                                      char error[SERVER_ERROR])
{
    struct server_http *http = calloc(1, sizeof *http);
    if (http && socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, http->silent) == 0) {
        http->parts = *parts;
        http->listening = listening;
        http->daemon = http_start_library(http);
        if (http->daemon) return http;
        http_destroy(http);
    } else {
        free(http);
    }
    snprintf(error, SERVER_ERROR,
             "the HTTP library could not be started; --log-level debug shows its message");
    close(listening);
    return NULL;
}

/* Does not use MHD_quiesce_daemon, because that removes the listening socket from the epoll set of
 * each thread. A thread that wakes at that moment also removes it, and the second removal aborts
 * the program (version 0.9.75, one stop in three thousand). Instead dup2 replaces the socket, under
 * the same descriptor number, by a socket without a peer. The kernel removes the closed socket from
 * each epoll set. */
void server_http_quiesce(struct server_http *http)
{
    (void)dup2(http->silent[0], http->listening);
}

void server_http_stop(struct server_http *http)
{
    if (!http) return;
    MHD_stop_daemon(http->daemon);
    http_destroy(http);
}
