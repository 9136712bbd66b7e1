#include "support.h"

#include <errno.h>
#include <fcntl.h>
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

static void later_heads_have_theirs_from_their_first_byte_on(void **state)
{
    (void)state;
    pass(REQUEST);
    server_connection_begin(connection);
    assert_false(is_cut_after(1000)); /* bodies and work have limits of their own */
    server_connection_answer(connection, 100, false);
    server_connection_end(connection);
    assert_false(is_cut_after(1000)); /* idle: the library's timer counts */
    pass("G");
    assert_false(is_cut_after(29));
    assert_true(is_cut_after(31));
}

static void a_head_that_came_while_the_last_was_answered_has_its_time(void **state)
{
    (void)state;
    pass(REQUEST "GET /");
    server_connection_begin(connection);
    server_connection_answer(connection, 100, false);
    server_connection_end(connection);
    assert_true(is_cut_after(31));
}

static void an_answer_has_time_for_its_size(void **state)
{
    (void)state;
    server_connection_begin(connection);
    server_connection_answer(connection, 16384 * 100, false);
    assert_false(is_cut_after(129));
    assert_true(is_cut_after(131));
}

static void a_stream_has_no_end(void **state)
{
    (void)state;
    server_connection_begin(connection);
    server_connection_answer(connection, 0, true);
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
        cmocka_unit_test_setup_teardown(a_first_head_has_its_time, set_up, tear_down),
        cmocka_unit_test_setup_teardown(later_heads_have_theirs_from_their_first_byte_on, set_up, tear_down),
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
