/* Load: sends HTTP requests as fast as they are answered, or at a fixed rate regardless of the
 * answers (an open loop). It uses one thread: Python would take the processors from the daemon that
 * it measures.
 *
 * usage: gd_load PORT FILE CONNECTIONS RATE WARM SECONDS
 *
 * FILE has the requests, one after another. For each request it has a line with the length in bytes
 * (decimal), then the bytes. RATE 0: each connection sends its next request after each answer.
 * Otherwise requests are due at equal intervals, and are sent on any free connection; a latency
 * counts from the time when the request was due. A further connection requests /livez every ten
 * milliseconds. Answers in the first WARM seconds are not counted.
 *
 * Prints one line of JSON: the numbers of answers by status; latencies {"p50", "p99", "max"} in
 * milliseconds of the answers 2xx, of the answers 503, and of /livez; the number of requests for
 * which no connection was free; and the number of connections that broke. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define HEAD_BYTES 4096
#define PROBE_NS   UINT64_C(10000000)
#define STATUSES   600

struct request {
    const char *bytes;
    size_t size;
};

/* A connection. It is idle or busy. A busy connection first sends its request, and then reads the
 * head and the body of the answer. */
struct client {
    int descriptor;
    bool is_busy, is_probe;
    struct request asked;
    /* number of sent bytes of the request, and of received bytes of the answer's head */
    size_t sent, have;
    uint64_t due_ns, left;
    bool has_head;
    unsigned status;
    char head[HEAD_BYTES + 1];
};

struct latencies {
    double *ms;
    size_t count, capacity;
};

static struct {
    struct sockaddr_in address;
    struct request *requests;
    size_t request_count, next_request;
    struct client *clients; /* the last client sends the probes */
    size_t client_count;
    uint64_t interval_ns, counted_ns, end_ns; /* the interval is 0 in a closed loop */
    int epoll;
    uint64_t statuses[STATUSES], without_connection, broken;
    struct latencies fulfilled, refused, probed;
} load;

static const char probe_text[] = "GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n";
static const struct request probe = {probe_text, sizeof probe_text - 1};

static void fail(const char *what)
{
    perror(what);
    exit(EXIT_FAILURE);
}

static uint64_t now_ns(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * UINT64_C(1000000000) + (uint64_t)time.tv_nsec;
}

/* --- what is counted -------------------------------------------------------------------------- */

static void add(struct latencies *latencies, double ms)
{
    if (latencies->count == latencies->capacity) {
        latencies->capacity = latencies->capacity ? 2 * latencies->capacity : 1024;
        latencies->ms = realloc(latencies->ms, latencies->capacity * sizeof *latencies->ms);
        if (!latencies->ms) fail("realloc");
    }
    latencies->ms[latencies->count++] = ms;
}

static void count(const struct client *client)
{
    uint64_t now = now_ns();
    double ms = (double)(now - client->due_ns) / 1e6;
    if (client->due_ns < load.counted_ns && now < load.counted_ns) return;
    if (client->is_probe) {
        add(&load.probed, ms);
        return;
    }
    load.statuses[client->status]++;
    if (client->status / 100 == 2) add(&load.fulfilled, ms);
    if (client->status == 503) add(&load.refused, ms);
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_latencies(const char *name, struct latencies *latencies)
{
    size_t n = latencies->count;
    if (n) qsort(latencies->ms, n, sizeof *latencies->ms, compare);
    printf(", \"%s\": {\"count\": %zu, \"p50\": %.3f, \"p99\": %.3f, \"max\": %.3f}", name, n,
           n ? latencies->ms[n / 2] : 0, n ? latencies->ms[(n * 99 + 99) / 100 - 1] : 0,
           n ? latencies->ms[n - 1] : 0);
}

static void print_results(void)
{
    printf("{\"seconds\": %.3f, \"no_connection\": %llu, \"broken\": %llu, \"statuses\": {",
           (double)(load.end_ns - load.counted_ns) / 1e9,
           (unsigned long long)load.without_connection, (unsigned long long)load.broken);
    const char *comma = "";
    for (unsigned status = 0; status < STATUSES; status++) {
        if (!load.statuses[status]) continue;
        printf("%s\"%u\": %llu", comma, status, (unsigned long long)load.statuses[status]);
        comma = ", ";
    }
    printf("}");
    print_latencies("fulfilled", &load.fulfilled);
    print_latencies("refused", &load.refused);
    print_latencies("livez", &load.probed);
    printf("}\n");
}

/* --- connections ------------------------------------------------------------------------------ */

static void join(struct client *client)
{
    int on = 1;
    client->descriptor = socket(AF_INET, SOCK_STREAM, 0);
    if (client->descriptor < 0) fail("socket");
    if (connect(client->descriptor, (const struct sockaddr *)&load.address, sizeof load.address) !=
        0)
        fail("connect");
    fcntl(client->descriptor, F_SETFL, O_NONBLOCK);
    setsockopt(client->descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    struct epoll_event event = {.events = EPOLLIN | EPOLLOUT | EPOLLET, .data.ptr = client};
    if (epoll_ctl(load.epoll, EPOLL_CTL_ADD, client->descriptor, &event) != 0) fail("epoll_ctl");
}

static void rejoin(struct client *client)
{
    load.broken += client->is_busy;
    client->is_busy = false;
    close(client->descriptor);
    join(client);
}

static void send_rest(struct client *client)
{
    while (client->is_busy && client->sent < client->asked.size) {
        ssize_t size = send(client->descriptor, client->asked.bytes + client->sent,
                            client->asked.size - client->sent, MSG_NOSIGNAL);
        if (size < 0 && errno == EAGAIN) return;
        if (size < 0) {
            rejoin(client);
            return;
        }
        client->sent += (size_t)size;
    }
}

static void ask(struct client *client, struct request request, uint64_t due_ns)
{
    client->asked = request;
    client->is_busy = true;
    client->sent = client->have = 0;
    client->has_head = false;
    client->due_ns = due_ns;
    send_rest(client);
}

static struct request next_request(void)
{
    return load.requests[load.next_request++ % load.request_count];
}

/* Reads status and length of the body from a complete head. */
static void read_head(struct client *client, const char *end)
{
    const char *length = NULL;
    client->status =
        client->have > 12 ? (unsigned)strtoul(client->head + 9, NULL, 10) % STATUSES : 0;
    for (const char *line = client->head; (line = strstr(line, "\r\n")) != NULL && line < end;) {
        line += 2;
        if (strncasecmp(line, "Content-Length:", 15) == 0) length = line + 15;
    }
    size_t body = client->have - (size_t)(end + 4 - client->head);
    client->left = (length ? strtoull(length, NULL, 10) : 0) - body;
    client->has_head = true;
}

static void finish(struct client *client)
{
    client->is_busy = false;
    count(client);
    if (!load.interval_ns && !client->is_probe) ask(client, next_request(), now_ns());
}

/* Reads available bytes. Returns false if there are no more at the moment. */
static bool take(struct client *client)
{
    static char body[1 << 16];
    ssize_t size;
    if (client->is_busy && !client->has_head) {
        size = recv(client->descriptor, client->head + client->have, HEAD_BYTES - client->have, 0);
    } else {
        size_t wanted = client->is_busy && client->left < sizeof body ? client->left : sizeof body;
        size = recv(client->descriptor, body, wanted, 0);
    }
    if (size < 0 && errno == EAGAIN) return false;
    if (size <= 0) {
        rejoin(client);
        return false;
    }
    if (!client->is_busy) return true;
    if (client->has_head) {
        client->left -= (uint64_t)size;
    } else {
        client->have += (size_t)size;
        client->head[client->have] = '\0';
        const char *end = strstr(client->head, "\r\n\r\n");
        if (end) read_head(client, end);
    }
    if (client->has_head && client->left == 0) finish(client);
    return true;
}

static void serve(struct client *client, uint32_t events)
{
    if (events & EPOLLOUT) send_rest(client);
    while (take(client)) continue;
}

/* --- the loops -------------------------------------------------------------------------------- */

static struct client *find_idle(void)
{
    static size_t at;
    for (size_t i = 0; i < load.client_count - 1; i++) {
        at = (at + 1) % (load.client_count - 1);
        if (!load.clients[at].is_busy) return &load.clients[at];
    }
    return NULL;
}

/* Sends the requests that are due. Returns the time at which the next one is due. */
static uint64_t ask_due(uint64_t *due_ns, uint64_t *probe_ns)
{
    struct client *prober = &load.clients[load.client_count - 1];
    uint64_t now = now_ns();
    for (; load.interval_ns && *due_ns <= now; *due_ns += load.interval_ns) {
        struct client *client = find_idle();
        if (client)
            ask(client, next_request(), *due_ns);
        else
            load.without_connection++;
    }
    if (*probe_ns <= now && !prober->is_busy) {
        ask(prober, probe, *probe_ns);
        *probe_ns += PROBE_NS;
    }
    uint64_t probe_next = prober->is_busy ? UINT64_MAX : *probe_ns;
    return load.interval_ns && *due_ns < probe_next ? *due_ns : probe_next;
}

static void run(void)
{
    struct epoll_event events[256];
    uint64_t due_ns = now_ns(), probe_ns = due_ns;
    for (size_t i = 0; !load.interval_ns && i + 1 < load.client_count; i++)
        ask(&load.clients[i], next_request(), due_ns);
    for (uint64_t now; (now = now_ns()) < load.end_ns;) {
        uint64_t next = ask_due(&due_ns, &probe_ns);
        if (next > load.end_ns) next = load.end_ns;
        uint64_t wait = next > now ? next - now : 0;
        struct timespec time = {(time_t)(wait / UINT64_C(1000000000)),
                                (long)(wait % UINT64_C(1000000000))};
        int count = epoll_pwait2(load.epoll, events, 256, &time, NULL);
        for (int i = 0; i < count; i++) serve(events[i].data.ptr, events[i].events);
    }
}

static void read_requests(const char *path)
{
    FILE *file = fopen(path, "rb");
    size_t capacity = 0, size;
    if (!file) fail(path);
    while (fscanf(file, "%zu", &size) == 1 && fgetc(file) == '\n') {
        char *bytes = malloc(size);
        if (load.request_count == capacity) {
            capacity = capacity ? 2 * capacity : 256;
            load.requests = realloc(load.requests, capacity * sizeof *load.requests);
        }
        if (!bytes || !load.requests || fread(bytes, 1, size, file) != size) fail(path);
        load.requests[load.request_count++] = (struct request){bytes, size};
    }
    fclose(file);
    if (!load.request_count) fail(path);
}

int main(int argc, char *argv[])
{
    if (argc != 7) {
        fprintf(stderr, "usage: gd_load PORT FILE CONNECTIONS RATE WARM SECONDS\n");
        return 2;
    }
    load.address = (struct sockaddr_in){.sin_family = AF_INET,
                                        .sin_port = htons((uint16_t)atoi(argv[1])),
                                        .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    read_requests(argv[2]);
    load.client_count = (size_t)atoi(argv[3]) + 1;
    load.clients = calloc(load.client_count, sizeof *load.clients);
    load.epoll = epoll_create1(0);
    double rate = atof(argv[4]);
    if (!load.clients || load.epoll < 0) fail("start");
    for (size_t i = 0; i < load.client_count; i++) join(&load.clients[i]);
    load.clients[load.client_count - 1].is_probe = true;
    load.interval_ns = rate > 0 ? (uint64_t)(1e9 / rate) : 0;
    load.counted_ns = now_ns() + (uint64_t)(1e9 * atof(argv[5]));
    load.end_ns = load.counted_ns + (uint64_t)(1e9 * atof(argv[6]));
    run();
    print_results();
    return EXIT_SUCCESS;
}
