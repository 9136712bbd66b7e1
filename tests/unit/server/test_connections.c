#include "support.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/connections.h"

#define SECOND UINT64_C(1000000000)

static struct server_connections *connections;
static struct server_connection *connection;
static int ends[2]; /* ours, the client's */

static int set_up(void **state)
{
    (void)state;
    connections = server_connections_create();
    if (!connections || socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) != 0) return -1;
    connection = server_connections_open(connections, ends[0], false);
    return connection ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    server_connections_close(connection);
    assert_int_equal(server_connections_statistics(connections).open, 0);
    server_connections_destroy(connections);
    close(ends[0]);
    close(ends[1]);
    return 0;
}

/* Was the connection cut by now, or will it be after so many seconds? It is not cut twice. */
static bool is_cut_after(uint64_t seconds)
{
    uint64_t before = server_connections_statistics(connections).cut;
    server_connections_cut(connections, gd_now_ns() + seconds * SECOND);
    return server_connections_statistics(connections).cut > before;
}

/* Is the connection closed by now, or will it be after so many seconds? */
static bool is_closed_after(uint64_t seconds)
{
    char byte;
    server_connections_cut(connections, gd_now_ns() + seconds * SECOND);
    return recvfrom(ends[1], &byte, 1, MSG_PEEK | MSG_DONTWAIT, NULL, NULL) == 0;
}

/* What the library's recv gives it; "" and errno EAGAIN: nothing for now. */
static const char *receive(void)
{
    static char bytes[256];
    errno = 0;
    ssize_t size = recv(ends[0], bytes, sizeof bytes - 1, 0);
    bytes[size > 0 ? size : 0] = '\0';
    return bytes;
}

static const char *pass(const char *text)
{
    assert_int_equal(send(ends[1], text, strlen(text), 0), strlen(text));
    return receive();
}

#define REQUEST "GET / HTTP/1.1\r\nHost: a\r\n\r\n"

/* --- ends --------------------------------------------------------------------------------------------------------- */

/* Is there news of the socket since it was asked last, as the library asks? */
static bool has_news(int epoll)
{
    struct epoll_event event;
    return epoll_wait(epoll, &event, 1, 0) == 1;
}

/* The library reads until less comes than it has room for, and waits for the next event: an end that had come by then is not one. */
static void an_end_that_came_with_the_last_bytes_is_told_again(void **state)
{
    (void)state;
    int epoll = epoll_create1(0);
    assert_int_equal(epoll_ctl(epoll, EPOLL_CTL_ADD, ends[0], &(struct epoll_event){.events = EPOLLIN | EPOLLET}), 0);
    assert_int_equal(send(ends[1], "GET /", 5, 0), 5);
    server_connections_remind(connections);
    assert_true(has_news(epoll));
    assert_string_equal(receive(), "GET /");
    server_connections_remind(connections); /* the client is still there */
    assert_false(has_news(epoll));
    assert_int_equal(send(ends[1], " HT", 3, 0), 3);
    shutdown(ends[1], SHUT_WR);
    assert_true(has_news(epoll));
    assert_string_equal(receive(), " HT");
    assert_false(has_news(epoll));
    server_connections_remind(connections);
    assert_true(has_news(epoll));
    assert_int_equal(send(ends[0], "answer", 6, MSG_NOSIGNAL), 6); /* the other way is open */
    assert_string_equal(receive(), "");
    assert_int_equal(errno, 0);
    close(epoll);
}

/* --- deadlines ---------------------------------------------------------------------------------------------------- */

static void a_first_head_has_its_time(void **state)
{
    (void)state;
    assert_false(is_cut_after(29));
    assert_string_equal(pass("GET /"), "GET /");
    assert_false(is_cut_after(29));
    assert_true(is_cut_after(31));
    assert_int_equal(send(ends[1], "x", 1, MSG_NOSIGNAL), -1);
    assert_false(is_cut_after(100));
}

static void a_request_is_under_way_until_its_answer_has_ended(void **state)
{
    (void)state;
    assert_int_equal(server_connections_under_way(connections), 0);
    server_connection_ask(connection);
    assert_int_equal(server_connections_under_way(connections), 1);
    server_connection_begin(connection);
    server_connection_answer(connection, 100, false, gd_now_ns());
    assert_int_equal(server_connections_under_way(connections), 1);
    server_connection_end(connection);
    assert_int_equal(server_connections_under_way(connections), 0);
}

static void later_heads_have_theirs_from_their_first_byte_on(void **state)
{
    (void)state;
    pass(REQUEST);
    server_connection_begin(connection);
    assert_false(is_cut_after(1000)); /* bodies and work have limits of their own */
    server_connection_answer(connection, 100, false, gd_now_ns());
    server_connection_end(connection);
    assert_false(is_closed_after(29));
    pass("G");
    assert_false(is_cut_after(29));
    assert_true(is_cut_after(31));
}

static void idle_connections_are_closed(void **state)
{
    (void)state;
    for (size_t size = 100; size <= 1000000; size *= 10000) { /* after a short answer, and after a long one */
        pass(REQUEST);
        server_connection_begin(connection);
        server_connection_answer(connection, size, false, gd_now_ns());
        server_connection_end(connection);
        assert_false(is_closed_after(29));
    }
    assert_false(is_cut_after(31)); /* no incident */
    assert_true(is_closed_after(31));
}

static void a_body_is_waited_for_where_there_is_one(void **state)
{
    (void)state;
    connection->requests = 1;
    pass("PUT / HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\n");
    assert_true(server_connection_is_in_body(connection));
    pass("x");
    assert_true(server_connection_is_in_body(connection));
    pass("y");
    assert_false(server_connection_is_in_body(connection));
    pass("G");
    assert_false(server_connection_is_in_body(connection));
    pass("ET / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n1");
    assert_false(server_connection_is_in_body(connection)); /* it is the next request's */
    connection->requests = 2;
    assert_true(server_connection_is_in_body(connection));
    pass("\r\nx\r\n0\r\n\r");
    assert_true(server_connection_is_in_body(connection));
    pass("\n");
    assert_false(server_connection_is_in_body(connection));
}

static void a_head_that_came_while_the_last_was_answered_has_its_time(void **state)
{
    (void)state;
    pass(REQUEST "GET /");
    server_connection_begin(connection);
    server_connection_answer(connection, 100, false, gd_now_ns());
    server_connection_end(connection);
    assert_true(is_cut_after(31));
}

static void an_answer_has_time_for_its_size(void **state)
{
    (void)state;
    server_connection_begin(connection);
    server_connection_answer(connection, 16384 * 100, false, gd_now_ns());
    assert_false(is_cut_after(129));
    assert_true(is_cut_after(131));
}

static void a_stream_has_no_end(void **state)
{
    (void)state;
    server_connection_begin(connection);
    server_connection_answer(connection, 0, true, gd_now_ns());
    assert_false(is_cut_after(1000000));
}

/* --- the wire ----------------------------------------------------------------------------------------------------- */

static void what_is_right_passes(void **state)
{
    (void)state;
    assert_string_equal(pass(REQUEST), REQUEST);
    assert_string_equal(pass(REQUEST REQUEST "PUT"), REQUEST REQUEST "PUT");
    assert_int_equal(connection->grammar.heads, 3);
    assert_string_equal(receive(), "");
    assert_int_equal(errno, EAGAIN);
    close(ends[1]);
    ends[1] = dup(ends[0]);
    assert_string_equal(receive(), "");
    assert_int_equal(errno, 0); /* the end */
}

static void a_fault_is_ended_and_nothing_follows(void **state)
{
    (void)state;
    assert_string_equal(pass("GET /a HT"), "GET /a HT");
    assert_string_equal(pass("TP/1.1\r\nX : y\r\n\r\n" REQUEST), "TP/1.1\r\nX-:\r\n\r\n");
    assert_string_equal(pass(REQUEST), "");
    assert_int_equal(errno, EAGAIN);
    assert_int_equal(server_connections_statistics(connections).faults, 1);
    assert_int_equal(connection->grammar.heads, 0);
}

static void an_ending_comes_in_pieces_if_it_has_to(void **state)
{
    (void)state;
    char bytes[64], *at = bytes;
    assert_int_equal(send(ends[1], "\n", 1, 0), 1);
    for (ssize_t size; (size = recv(ends[0], at, 3, 0)) > 0; at += size) continue;
    *at = '\0';
    assert_string_equal(bytes, "GET / HTTP/1.1\r\n\r\n");
}

static void what_nothing_ends_is_the_end(void **state)
{
    (void)state;
    pass("PUT / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n");
    assert_string_equal(pass("5;a\n"), "5;a");
    assert_string_equal(receive(), "");
    assert_int_equal(errno, 0);
}

static void other_sockets_are_not_watched(void **state)
{
    (void)state;
    char bytes[8];
    assert_int_equal(send(ends[0], "\n\n\n", 3, 0), 3);
    assert_int_equal(recv(ends[1], bytes, sizeof bytes, 0), 3);
    assert_memory_equal(bytes, "\n\n\n", 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(an_end_that_came_with_the_last_bytes_is_told_again, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_first_head_has_its_time, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_request_is_under_way_until_its_answer_has_ended, set_up, tear_down),
        cmocka_unit_test_setup_teardown(later_heads_have_theirs_from_their_first_byte_on, set_up, tear_down),
        cmocka_unit_test_setup_teardown(idle_connections_are_closed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_body_is_waited_for_where_there_is_one, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_head_that_came_while_the_last_was_answered_has_its_time, set_up, tear_down),
        cmocka_unit_test_setup_teardown(an_answer_has_time_for_its_size, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_stream_has_no_end, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_is_right_passes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_fault_is_ended_and_nothing_follows, set_up, tear_down),
        cmocka_unit_test_setup_teardown(an_ending_comes_in_pieces_if_it_has_to, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_nothing_ends_is_the_end, set_up, tear_down),
        cmocka_unit_test_setup_teardown(other_sockets_are_not_watched, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
