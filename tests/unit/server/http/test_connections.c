#include "tests/unit/server/support.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/http/connections.h"

#define SECOND UINT64_C(1000000000)

static struct server_connections *connections;
static struct server_connection *connection;
/* element 0 is the daemon's end of the connection, element 1 the client's end */
static int ends[2];

static int set_up(void **state)
{
    (void)state;
    connections = server_connections_create(NULL);
    if (!connections || socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) != 0) return -1;
    connection = server_connection_open(connections, ends[0], NULL);
    /* The first connection wakes the watching thread, which then sleeps for a second. */
    usleep(20000);
    return connection ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    server_connection_close(connection);
    assert_int_equal(server_connections_statistics(connections).open, 0);
    server_connections_destroy(connections);
    close(ends[0]);
    close(ends[1]);
    return 0;
}

/* Advances the clock, and returns whether the connection was cut by then. Asserts that it is cut
 * only once. */
static bool is_cut_after(uint64_t seconds)
{
    uint64_t before = server_connections_statistics(connections).cut;
    server_connections_check(connections, gd_now_ns() + seconds * SECOND);
    return server_connections_statistics(connections).cut > before;
}

/* Advances the clock, and returns whether the connection was closed by then. */
static bool is_closed_after(uint64_t seconds)
{
    char byte;
    server_connections_check(connections, gd_now_ns() + seconds * SECOND);
    return recvfrom(ends[1], &byte, 1, MSG_PEEK | MSG_DONTWAIT, NULL, NULL) == 0;
}

/* Reads from the connection as libmicrohttpd does. Returns "" at the end, or if there is no
 * data. */
static const char *receive(void)
{
    static char bytes[256];
    errno = 0;
    ssize_t size = recv(ends[0], bytes, sizeof bytes - 1, 0);
    bytes[size > 0 ? size : 0] = '\0';
    return bytes;
}

/* --- ends ------------------------------------------------------------------------------------- */

/* Returns whether epoll reports an event since the last call. */
static bool has_news(int epoll)
{
    struct epoll_event event;
    return epoll_wait(epoll, &event, 1, 0) == 1;
}

/* The library reads until a read is short, and then waits for the next event. If the client has
 * closed its side by then, no new event reports this. */
static void an_end_with_the_last_bytes_is_detected(void **state)
{
    (void)state;
    int epoll = epoll_create1(0);
    assert_int_equal(epoll_ctl(epoll, EPOLL_CTL_ADD, ends[0],
                               &(struct epoll_event){.events = EPOLLIN | EPOLLET}),
                     0);
    assert_int_equal(send(ends[1], "GET /", 5, 0), 5);
    server_connections_check(connections, gd_now_ns());
    assert_true(has_news(epoll));
    assert_string_equal(receive(), "GET /");
    server_connections_check(connections, gd_now_ns()); /* the client is still connected */
    assert_false(has_news(epoll));
    assert_int_equal(send(ends[1], " HT", 3, 0), 3);
    shutdown(ends[1], SHUT_WR);
    assert_true(has_news(epoll));
    assert_string_equal(receive(), " HT");
    assert_false(has_news(epoll));
    server_connections_check(connections, gd_now_ns());
    assert_true(has_news(epoll));
    assert_int_equal(send(ends[0], "answer", 6, MSG_NOSIGNAL), 6); /* the other direction is open */
    assert_string_equal(receive(), "");
    assert_int_equal(errno, 0);
    close(epoll);
}

/* --- deadlines -------------------------------------------------------------------------------- */

static void a_first_head_has_a_deadline(void **state)
{
    (void)state;
    assert_false(is_cut_after(29));
    server_connection_ask(connection,
                          /* the request line does not restart the deadline */
                          gd_now_ns() + 20 * SECOND);
    assert_true(is_cut_after(31));
    assert_int_equal(send(ends[1], "x", 1, MSG_NOSIGNAL), -1);
    assert_false(is_cut_after(100));
}

static void a_request_is_under_way_until_its_answer_has_ended(void **state)
{
    (void)state;
    assert_int_equal(server_connections_active(connections), 0);
    server_connection_ask(connection, gd_now_ns());
    assert_int_equal(server_connections_active(connections), 1);
    server_connection_head(connection, false, gd_now_ns());
    server_connection_answer(connection, 100, false, gd_now_ns());
    assert_int_equal(server_connections_active(connections), 1);
    server_connection_end(connection);
    assert_int_equal(server_connections_active(connections), 0);
}

static void a_later_head_has_a_deadline_from_its_request_line(void **state)
{
    (void)state;
    server_connection_head(connection, false, gd_now_ns());
    assert_false(is_cut_after(1000)); /* work has its own deadlines */
    server_connection_answer(connection, 100, false, gd_now_ns());
    server_connection_end(connection);
    assert_false(is_closed_after(29));
    server_connection_ask(connection, gd_now_ns() + 20 * SECOND);
    assert_false(is_cut_after(49));
    assert_true(is_cut_after(51));
}

static void a_steady_body_extends_its_deadline(void **state)
{
    uint64_t now_ns = gd_now_ns();
    (void)state;
    server_connection_head(connection, true, now_ns);
    assert_false(is_cut_after(29));
    server_connection_body(connection, 4096, now_ns + 20 * SECOND); /* less than 4 KiB/s */
    assert_false(is_cut_after(30));
    server_connection_body(connection, 4096 * 39, now_ns + 29 * SECOND);
    assert_false(is_cut_after(58));
    /* the client reads no byte for 30 s, although it was fast before */
    assert_true(is_cut_after(60));
}

static void a_slow_body_is_cut(void **state)
{
    uint64_t now_ns = gd_now_ns();
    (void)state;
    server_connection_head(connection, true, now_ns);
    for (unsigned second = 1; second < 30; second++)
        server_connection_body(connection, 1, now_ns + second * SECOND);
    assert_true(is_cut_after(31));
}

static void work_has_no_deadline(void **state)
{
    (void)state;
    server_connection_head(connection, true, gd_now_ns());
    server_connection_work(connection);
    assert_false(is_cut_after(1000));
}

static void idle_connections_are_closed(void **state)
{
    (void)state;
    /* after a short answer, and after a long one */
    for (size_t size = 100; size <= 1000000; size *= 10000) {
        server_connection_head(connection, false, gd_now_ns());
        server_connection_answer(connection, size, false, gd_now_ns());
        server_connection_end(connection);
        assert_false(is_closed_after(29));
    }
    assert_false(is_cut_after(31)); /* not counted as a cut */
    assert_true(is_closed_after(31));
}

static void a_large_answer_has_more_time(void **state)
{
    (void)state;
    server_connection_head(connection, false, gd_now_ns());
    server_connection_answer(connection, 16384 * 100, false, gd_now_ns());
    assert_false(is_cut_after(129));
    assert_true(is_cut_after(131));
}

static void a_stream_has_no_deadline(void **state)
{
    (void)state;
    server_connection_head(connection, false, gd_now_ns());
    server_connection_answer(connection, 0, true, gd_now_ns());
    assert_false(is_cut_after(1000000));
}

/* --- clients that take an answer slowly ------------------------------------------------------- */

/* A client and a TCP connection with small buffers. */
struct tcp {
    struct server_connection *connection;
    int ours, client;
    size_t sent;
};

static struct tcp join_by_tcp(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    int listening = socket(AF_INET, SOCK_STREAM, 0), room = 65536;
    struct tcp tcp = {.client = socket(AF_INET, SOCK_STREAM, 0)};
    setsockopt(tcp.client, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    assert_int_equal(bind(listening, (struct sockaddr *)&address, size), 0);
    assert_int_equal(listen(listening, 1), 0);
    assert_int_equal(getsockname(listening, (struct sockaddr *)&address, &size), 0);
    assert_int_equal(connect(tcp.client, (struct sockaddr *)&address, size), 0);
    tcp.ours = accept4(listening, NULL, NULL, SOCK_NONBLOCK);
    assert_true(tcp.ours >= 0);
    close(listening);
    tcp.connection = server_connection_open(connections, tcp.ours, NULL);
    assert_non_null(tcp.connection);
    return tcp;
}

static void leave(struct tcp *tcp)
{
    server_connection_close(tcp->connection);
    close(tcp->ours);
    close(tcp->client);
}

/* Writes as much as fits, as libmicrohttpd does. */
static void fill(struct tcp *tcp)
{
    static const char zeros[65536];
    for (ssize_t sent; (sent = send(tcp->ours, zeros, sizeof zeros, MSG_NOSIGNAL)) > 0;)
        tcp->sent += (size_t)sent;
}

/* Lets the client read `bytes` bytes and the library write more. */
static void take(struct tcp *tcp, size_t bytes)
{
    static char room[16384];
    while (bytes) {
        ssize_t got = recv(tcp->client, room, bytes < sizeof room ? bytes : sizeof room, 0);
        assert_true(got > 0);
        bytes -= (size_t)got;
        fill(tcp);
    }
}

/* Checks the connection every second; meanwhile the client reads `rate` bytes a second. Returns the
 * number of seconds until the connection was cut, or `most`. */
static unsigned seconds_until_cut(struct tcp *tcp, size_t rate, unsigned most)
{
    uint64_t begun = gd_now_ns(), before = server_connections_statistics(connections).cut;
    for (unsigned second = 1; second <= most; second++) {
        if (rate) take(tcp, rate);
        server_connections_check(connections, begun + second * SECOND);
        if (server_connections_statistics(connections).cut > before) return second;
    }
    return most;
}

static void a_steady_slow_reader_is_not_cut(void **state)
{
    const size_t rates[] = {16384 + 1000, 24000, 50000};
    (void)state;
    server_connection_head(connection, false,
                           /* the fixture's connection, which this test does not use */
                           gd_now_ns());
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++) {
        struct tcp tcp = join_by_tcp();
        server_connection_head(tcp.connection, false, gd_now_ns());
        server_connection_answer(tcp.connection, (size_t)100 << 20, false, gd_now_ns());
        fill(&tcp);
        assert_int_equal(seconds_until_cut(&tcp, rates[i], 400), 400);
        leave(&tcp);
    }
}

static void a_client_that_reads_nothing_is_cut(void **state)
{
    (void)state;
    server_connection_head(connection, false, gd_now_ns());
    for (int is_stream = 0; is_stream < 2; is_stream++) {
        struct tcp tcp = join_by_tcp();
        server_connection_head(tcp.connection, false, gd_now_ns());
        server_connection_answer(tcp.connection, (size_t)100 << 20, is_stream, gd_now_ns());
        fill(&tcp);
        assert_in_range(seconds_until_cut(&tcp, 0, 400), 30, 61);
        leave(&tcp);
        tcp = join_by_tcp();
        server_connection_head(tcp.connection, false, gd_now_ns());
        server_connection_answer(tcp.connection, (size_t)100 << 20, is_stream, gd_now_ns());
        fill(&tcp);
        assert_in_range(seconds_until_cut(&tcp, 1000, 400), 30, 61);
        leave(&tcp);
    }
}

static void a_silent_stream_is_not_cut(void **state)
{
    (void)state;
    struct tcp tcp = join_by_tcp();
    server_connection_head(connection, false, gd_now_ns());
    server_connection_head(tcp.connection, false, gd_now_ns());
    server_connection_answer(tcp.connection, 0, true, gd_now_ns());
    assert_int_equal(send(tcp.ours, "data\n", 5, 0), 5);
    char bytes[8];
    assert_int_equal(recv(tcp.client, bytes, sizeof bytes, 0), 5);
    assert_int_equal(seconds_until_cut(&tcp, 0, 400), 400);
    leave(&tcp);
}

/* Bytes in the kernel have not reached the client, although the answer has ended. */
static void a_connection_is_not_idle_while_the_client_reads(void **state)
{
    (void)state;
    struct tcp tcp = join_by_tcp();
    server_connection_head(connection, false, gd_now_ns());
    server_connection_head(tcp.connection, false, gd_now_ns());
    server_connection_answer(tcp.connection, (size_t)1 << 20, false, gd_now_ns());
    fill(&tcp);
    server_connection_end(tcp.connection);
    uint64_t now = gd_now_ns();
    for (unsigned second = 1; second <= 100; second++) {
        take(&tcp, 24000);
        server_connections_check(connections, now + second * SECOND);
    }
    assert_int_equal(send(tcp.client, "GET", 3, MSG_NOSIGNAL), 3);
    char bytes[4];
    /* the connection was not shut down */
    assert_int_equal(recv(tcp.ours, bytes, sizeof bytes, 0), 3);
    leave(&tcp);
}

/* --- a shortage ------------------------------------------------------------------------------- */

#define MANY 16

struct crowd {
    struct server_connection *all[MANY];
    int ends[MANY][2];
};

/* Opens many connections: the first `heavy` connections from one address, the others from another
 * address. */
static void crowd_in(struct crowd *crowd, int heavy)
{
    struct sockaddr_in client = {.sin_family = AF_INET};
    for (int i = 0; i < MANY; i++) {
        client.sin_addr.s_addr = htonl(INADDR_LOOPBACK + (uint32_t)(i >= heavy));
        assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, crowd->ends[i]), 0);
        crowd->all[i] =
            server_connection_open(connections, crowd->ends[i][0], (struct sockaddr *)&client);
        assert_non_null(crowd->all[i]);
    }
}

/* Calls server_connections_relieve after `seconds`. */
static void relieve_after(unsigned seconds)
{
    server_connections_relieve(connections, gd_now_ns() + seconds * SECOND);
}

static bool is_shut(const struct crowd *crowd, int i)
{
    char byte;
    return recvfrom(crowd->ends[i][1], &byte, 1, MSG_PEEK | MSG_DONTWAIT, NULL, NULL) == 0;
}

static void crowd_out(struct crowd *crowd)
{
    for (int i = 0; i < MANY; i++) {
        server_connection_close(crowd->all[i]);
        close(crowd->ends[i][0]);
        close(crowd->ends[i][1]);
    }
}

/* All 17 places are taken: 16 by the crowd, one by the fixture's connection. The reserve is 3
 * places. Four connections are cut, to free the reserve and half as many places in addition. */
static void the_oldest_heads_go_first(void **state)
{
    struct crowd crowd;
    (void)state;
    crowd_in(&crowd, MANY);
    server_connection_head(connection, false, gd_now_ns());
    for (int i = 0; i < MANY; i += 2)
        server_connection_head(crowd.all[i], false, gd_now_ns()); /* busy connections stay */
    server_connections_limit(connections, 17);
    relieve_after(2);
    for (int i = 0; i < MANY; i++) assert_int_equal(is_shut(&crowd, i), i % 2 && i < 8);
    assert_int_equal(server_connections_statistics(connections).cut, 4);
    crowd_out(&crowd);
}

static void idle_connections_are_cut_after_heads(void **state)
{
    struct crowd crowd;
    (void)state;
    crowd_in(&crowd, MANY);
    server_connection_head(connection, false, gd_now_ns());
    for (int i = 0; i < MANY; i++) server_connection_head(crowd.all[i], false, gd_now_ns());
    uint64_t now = gd_now_ns();
    for (int i = MANY; i--;) { /* the last one has been idle longest */
        if (i == 7) continue;
        server_connection_answer(crowd.all[i], 10, false, now - (uint64_t)(i + 1) * SECOND);
        server_connection_end(crowd.all[i]);
    }
    server_connections_limit(connections, 17);
    server_connections_relieve(connections, now);
    for (int i = 0; i < MANY; i++) assert_int_equal(is_shut(&crowd, i), i >= MANY - 4);
    assert_int_equal(server_connections_statistics(connections).cut, 0); /* not counted as a cut */
    crowd_out(&crowd);
}

static void addresses_with_few_connections_are_spared(void **state)
{
    struct crowd crowd;
    (void)state;
    crowd_in(&crowd, 10); /* ten connections from one address, six from another */
    server_connection_head(connection, false, gd_now_ns());
    /* of the second address, only connections 10 and 11 are idle */
    for (int i = 12; i < MANY; i++) server_connection_head(crowd.all[i], false, gd_now_ns());
    server_connection_head(crowd.all[0], false, gd_now_ns());
    server_connection_answer(crowd.all[0], 10, false, gd_now_ns() - 20 * SECOND);
    server_connection_end(crowd.all[0]);
    server_connections_limit(connections, 17);
    relieve_after(2);
    for (int i = 0; i < MANY; i++) assert_int_equal(is_shut(&crowd, i), i >= 1 && i <= 4);
    crowd_out(&crowd);
}

/* New connections use the reserve. They are cut only when the reserve is nearly used up. */
static void young_heads_are_spared(void **state)
{
    struct crowd crowd;
    (void)state;
    crowd_in(&crowd, MANY);
    server_connections_limit(connections, 18);
    relieve_after(0);
    for (int i = 0; i < MANY; i++) assert_false(is_shut(&crowd, i));
    server_connections_limit(connections, 17); /* nothing is free */
    relieve_after(0);
    for (int i = 0; i < MANY; i++) assert_int_equal(is_shut(&crowd, i), i < 2);
    crowd_out(&crowd);
}

static void connections_stay_while_the_reserve_is_free(void **state)
{
    struct crowd crowd;
    (void)state;
    crowd_in(&crowd, MANY);
    server_connections_limit(connections, 20);
    relieve_after(2);
    for (int i = 0; i < MANY; i++) assert_false(is_shut(&crowd, i));
    crowd_out(&crowd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(an_end_with_the_last_bytes_is_detected, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_first_head_has_a_deadline, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_request_is_under_way_until_its_answer_has_ended, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(a_later_head_has_a_deadline_from_its_request_line, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(idle_connections_are_closed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_steady_body_extends_its_deadline, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_slow_body_is_cut, set_up, tear_down),
        cmocka_unit_test_setup_teardown(work_has_no_deadline, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_large_answer_has_more_time, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_stream_has_no_deadline, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_steady_slow_reader_is_not_cut, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_client_that_reads_nothing_is_cut, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_silent_stream_is_not_cut, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_connection_is_not_idle_while_the_client_reads, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(the_oldest_heads_go_first, set_up, tear_down),
        cmocka_unit_test_setup_teardown(idle_connections_are_cut_after_heads, set_up, tear_down),
        cmocka_unit_test_setup_teardown(addresses_with_few_connections_are_spared, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(young_heads_are_spared, set_up, tear_down),
        cmocka_unit_test_setup_teardown(connections_stay_while_the_reserve_is_free, set_up,
                                        tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
