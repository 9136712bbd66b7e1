/* Bare: libmicrohttpd without the daemon. Answers every request with the same body, with the
 * daemon's flags and number of threads; throughput.py compares the daemon's requests a second with
 * this program's.
 *
 * usage: gd_http_bare THREADS BYTES [NAME VALUE]...
 *
 * Each NAME and VALUE is a header of the answer.
 *
 * Listens on a free port of 127.0.0.1, prints its number, and serves until its standard input
 * ends. */
#include <arpa/inet.h>
#include <microhttpd.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BYTES_MOST (1 << 24)

/* libmicrohttpd calls this twice for a request; the first call has only the headers. Like the
 * daemon, queues the answer in the second call. */
static enum MHD_Result on_request(void *user, struct MHD_Connection *connection, const char *url,
                                  const char *method, const char *version, const char *upload,
                                  size_t *upload_size, void **context)
{
    static int seen;
    (void)url, (void)method, (void)version, (void)upload;
    if (!*context) {
        *context = &seen;
        return MHD_YES;
    }
    *upload_size = 0;
    return MHD_queue_response(connection, MHD_HTTP_OK, user);
}

static struct MHD_Daemon *start(unsigned threads, struct MHD_Response *response)
{
    unsigned flags =
        MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ITC | MHD_USE_ERROR_LOG;
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    return MHD_start_daemon(flags, 0, NULL, NULL, on_request, response, MHD_OPTION_SOCK_ADDR,
                            &address, MHD_OPTION_THREAD_POOL_SIZE, threads > 1 ? threads : 0u,
                            MHD_OPTION_CONNECTION_TIMEOUT, 30u, MHD_OPTION_END);
}

/* `headers` are pairs of name and value; NULL ends them. */
static struct MHD_Response *make_response(size_t bytes, char **headers)
{
    char *body = malloc(bytes);
    if (!body) return NULL;
    memset(body, 'x', bytes);
    struct MHD_Response *response =
        MHD_create_response_from_buffer(bytes, body, MHD_RESPMEM_MUST_FREE);
    for (; response && *headers; headers += 2)
        if (MHD_add_response_header(response, headers[0], headers[1]) != MHD_YES) return NULL;
    return response;
}

static void serve(struct MHD_Daemon *daemon)
{
    char ignored[64];
    printf("%u\n", MHD_get_daemon_info(daemon, MHD_DAEMON_INFO_BIND_PORT)->port);
    fflush(stdout);
    while (read(STDIN_FILENO, ignored, sizeof ignored) > 0) continue;
}

int main(int argc, char **argv)
{
    bool is_complete = argc >= 3 && argc % 2 == 1; /* each name has a value */
    long threads = is_complete ? strtol(argv[1], NULL, 10) : 0,
         bytes = is_complete ? strtol(argv[2], NULL, 10) : 0;
    if (threads < 1 || threads > 1024 || bytes < 1 || bytes > BYTES_MOST) {
        fprintf(stderr, "usage: gd_http_bare THREADS BYTES [NAME VALUE]...\n");
        return 2;
    }
    struct MHD_Response *response = make_response((size_t)bytes, argv + 3);
    struct MHD_Daemon *daemon = response ? start((unsigned)threads, response) : NULL;
    if (!daemon) {
        fprintf(stderr, "gd_http_bare: the HTTP library could not be started\n");
        return 1;
    }
    serve(daemon);
    MHD_stop_daemon(daemon);
    MHD_destroy_response(response);
    return 0;
}
