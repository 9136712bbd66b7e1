/* Fuzzes the daemon through its socket. The first byte of the input selects how the client ends,
 * and the client sends the other bytes. One kind of client then shuts its side down at once. The
 * other kind sends one more request, after which the daemon closes the connection. It shuts its
 * side down only if the daemon sends nothing for a while. For any input the daemon closes the
 * connection in the end, and continues to answer /livez. Its output begins with a line of HTTP/1.1
 * and never has status 500. This covers the library, checks, router, handlers, workers and
 * engine. */
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/server.h"
#include "tests/fuzz/promise.h"

enum {
    ANSWER_BYTES = 1 << 16,
    REFRESH = 128,   /* the mesh is uploaded again after this number of inputs */
    SILENCE_MS = 10, /* after this silence the daemon is assumed to wait for more bytes */
    NO_LIMIT = -1,   /* for complete requests: the daemon drops them if the client shuts down */
    TRIES = 600,     /* number of attempts to connect, or to upload the mesh */
};

static const char last[] = "GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static struct server *server;
static uint64_t inputs;

/* --- the daemon ------------------------------------------------------------------------------- */

static void stop(void)
{
    server_stop(server);
}

static void start(void)
{
    static char *const flags[] = {"geodesicd",   "--listen",
                                  "127.0.0.1:0", "--store",
                                  "memory",      "--workers",
                                  "1",           "--http-threads",
                                  "1",           "--memory-budget",
                                  "64MiB",       "--max-body",
                                  "64KiB",       "--max-faces",
                                  "2000",        "--timeout-ms",
                                  "200",         "--landmarks",
                                  "0",           "--log-level",
                                  "error",       "--max-jobs",
                                  "50",          "--drain-ms",
                                  "100",         NULL};
    struct server_config config;
    char error[SERVER_ERROR];
    promise(server_config_load(&config, flags, stdout, stderr) == SERVER_CONFIG_RUN);
    server_log_set_level(config.log_level);
    int listening = server_address_bind(&config.listen, error);
    promise(listening >= 0);
    server = server_start(&config, listening, error);
    promise(server != NULL);
    atexit(stop);
}

/* --- a client --------------------------------------------------------------------------------- */

/* Connects with a socket that closes by a reset. Otherwise each input would leave a socket in
 * TIME_WAIT, and these sockets would use up the ports. */
static int join(void)
{
    const struct sockaddr *address = (const struct sockaddr *)&server->config.listen.socket;
    int client = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), on = 1, tries = 0;
    promise(client >= 0);
    while (connect(client, address, server->config.listen.size) != 0) {
        promise((errno == EADDRNOTAVAIL || errno == EINTR) &&
                tries++ < TRIES); /* other programs on this machine may use all ports */
        usleep(100000);
    }
    setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    setsockopt(client, SOL_SOCKET, SO_LINGER, &(struct linger){.l_onoff = 1},
               sizeof(struct linger));
    return client;
}

/* Sends the bytes in two pieces, and one more request unless `silence_ms` is 0. Reads until the
 * daemon closes the connection, and shuts the client's side down after each silence of that length.
 * Returns the size of the answer in `answer`. */
static size_t exchange(const char *bytes, size_t size, int silence_ms,
                       char answer[ANSWER_BYTES + 1])
{
    struct pollfd poll_of = {.fd = join(), .events = POLLIN};
    const int client = poll_of.fd;
    size_t first = size / 2, have = 0;
    ssize_t got = 0;
    if (send(client, bytes, first, MSG_NOSIGNAL) == (ssize_t)first)
        (void)!send(client, bytes + first, size - first, MSG_NOSIGNAL);
    if (silence_ms != 0) (void)!send(client, last, sizeof last - 1, MSG_NOSIGNAL);
    while (have < ANSWER_BYTES) {
        if (poll(&poll_of, 1, silence_ms) == 0) shutdown(client, SHUT_WR);
        if ((got = read(client, answer + have, ANSWER_BYTES - have)) <= 0) break;
        have += (size_t)got;
    }
    answer[have] = '\0';
    close(client);
    return have;
}

static void upload(void)
{
    static const char request[] =
        "PUT /v1/meshes/m HTTP/1.1\r\nHost: localhost\r\nContent-Length: 64\r\n\r\n"
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    static char answer[ANSWER_BYTES + 1];
    int tries = 0;
    do {
        promise(tries++ < TRIES && exchange(request, sizeof request - 1, NO_LIMIT, answer) > 0);
        /* on a busy machine the upload may miss its deadline */
    } while (strncmp(answer, "HTTP/1.1 504 ", 13) == 0);
    promise(strncmp(answer, "HTTP/1.1 20", 11) == 0);
}

static void require_life(void)
{
    static char answer[ANSWER_BYTES + 1];
    promise(exchange("", 0, NO_LIMIT, answer) > 0 && strncmp(answer, "HTTP/1.1 200 ", 13) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char answer[ANSWER_BYTES + 1];
    if (!server) start();
    if (size == 0) return 0;
    if (inputs++ % REFRESH == 0) {
        require_life();
        upload();
    }
    size_t length =
        exchange((const char *)data + 1, size - 1, data[0] & 1 ? SILENCE_MS : 0, answer);
    promise(length == 0 || strncmp(answer, "HTTP/1.1 ", 9) == 0);
    /* no body of an answer contains CR LF */
    promise(strstr(answer, "HTTP/1.1 500 Internal Server Error\r\n") == NULL);
    return 0;
}
