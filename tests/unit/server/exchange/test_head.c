#include "tests/unit/server/support.h"

#include <stdio.h>

#include "server/exchange/exchange.h"

#define TARGET "/v1/meshes/x"

/* Returns the reason for which a head of "Name: value" lines is refused, or NULL if it is
 * accepted. */
static const char *fault_of(const char *version, const char *lines,
                            struct server_exchange *exchange)
{
    static char copy[20000], target[sizeof TARGET];
    char *rest = copy;
    snprintf(copy, sizeof copy, "%s", lines);
    *exchange = (struct server_exchange){.method = "PUT", .target = strcpy(target, TARGET)};
    exchange->target_size = sizeof TARGET;
    for (char *line; *rest && (line = strsep(&rest, "\n"));) {
        char *value = strchr(line, ':');
        assert_non_null(value);
        *value = '\0';
        server_exchange_add_header(exchange, line, value + 2);
        if (!rest) break;
    }
    return server_exchange_read_head(exchange, version);
}

static void a_body_ends_where_its_head_says(void **state)
{
    static const struct {
        const char *lines;
        bool has_body;
        uint64_t declared;
    } heads[] = {{"Host: a", false, 0},
                 {"Host: a\nContent-Length: 0", true, 0},
                 {"Host: a\ncontent-length: 0017", true, 17},
                 {"Host: a\nTransfer-Encoding: Chunked", true, SERVER_BODY_CHUNKED},
                 {"Host: \nX: \t\xe9 \nContent-Lengths: x", false, 0}};
    (void)state;
    for (size_t i = 0; i < COUNT(heads); i++) {
        struct server_exchange exchange;
        assert_null(fault_of("HTTP/1.1", heads[i].lines, &exchange));
        assert_int_equal(exchange.has_body, heads[i].has_body);
        assert_int_equal(exchange.body.declared, heads[i].declared);
        assert_false(exchange.is_http10);
    }
}

static void heads_that_readers_disagree_on_are_refused(void **state)
{
    static const struct {
        const char *version, *lines, *words;
    } heads[] = {
        {"HTTP/1.1", "", "Host is missing"},
        {"HTTP/1.1", "Host: a\nhost: a", "Host stands twice"},
        {"HTTP/1.1", "Host: a\nContent-Length: 5\nContent-Length: 5", "twice"},
        {"HTTP/1.1", "Host: a\nContent-Length: 5\nTransfer-Encoding: chunked", "not both"},
        {"HTTP/1.1", "Host: a\nTransfer-Encoding: chunked\nTransfer-Encoding: chunked", "twice"},
        {"HTTP/1.1", "Host: a\nTransfer-Encoding: chunked ", "only Transfer-Encoding"},
        {"HTTP/1.1", "Host: a\nTransfer-Encoding: gzip, chunked", "only Transfer-Encoding"},
        {"HTTP/1.0", "Transfer-Encoding: chunked", "only Transfer-Encoding"},
        {"HTTP/1.1", "Host: a\nContent-Length: ", "decimal"},
        {"HTTP/1.1", "Host: a\nContent-Length: 5 ", "decimal"},
        {"HTTP/1.1", "Host: a\nContent-Length: 18446744073709551615", "decimal"},
        {"HTTP/1.1", "Host: a\nContent-Length: 18446744073709551616", "decimal"},
        {"HTTP/1.1", "Host: a\nX : y", "colon"},
        {"HTTP/1.1", "Host: a\n: y", "not allowed"},
        {"HTTP/1.1", "Host: a\nX(: y", "not allowed"},
        {"HTTP/1.1", "Host: a\nX\xe9: y", "not allowed"},
        {"HTTP/1.1", "Host: a\nX: \x01", "control"},
        {"HTTP/1.1", "Host: a\nX: y\rz", "control"},
        {"HTTP/1.1", "Host: a\nX: \x7f", "control"},
        {"HTTP/1.2", "Host: a", "version"},
        {"", "Host: a", "version"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(heads); i++) {
        struct server_exchange exchange;
        const char *fault = fault_of(heads[i].version, heads[i].lines, &exchange);
        assert_non_null(fault);
        if (!strstr(fault, heads[i].words)) fail_msg("%s: %s", heads[i].lines, fault);
    }
}

static void a_method_is_a_token(void **state)
{
    static const char *const methods[] = {"", "G T", "G(T", "G\x01T", "G\xe9T"};
    (void)state;
    for (size_t i = 0; i < COUNT(methods); i++) {
        struct server_exchange exchange = {.method = methods[i]};
        assert_non_null(strstr(server_exchange_read_head(&exchange, "HTTP/1.0"), "method"));
    }
}

static void a_head_has_a_size_limit(void **state)
{
    struct server_exchange exchange;
    char lines[13000] = "X: ";
    (void)state;
    size_t most = 12288 - sizeof TARGET - strlen("PUT") - strlen("X");
    memset(lines + 3, 'y', most);
    assert_null(fault_of("HTTP/1.0", lines, &exchange));
    lines[3 + most] = 'y';
    assert_non_null(strstr(fault_of("HTTP/1.0", lines, &exchange), "12288"));
}

static void a_target_is_visible_ascii(void **state)
{
    static const char *const targets[] = {"/a b", "/a\tb", "/\x7f", "/\xc3\xa9", "/a#b"};
    static char long_target[8194];
    (void)state;
    for (size_t i = 0; i < COUNT(targets); i++)
        assert_non_null(server_exchange_check_target(targets[i]));
    assert_null(server_exchange_check_target("/v1/meshes/%20?a=[1]&b=\"c\""));
    memset(long_target, 'a', 8192);
    assert_null(server_exchange_check_target(long_target));
    long_target[8192] = 'a';
    assert_non_null(strstr(server_exchange_check_target(long_target), "8192"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_body_ends_where_its_head_says),
        cmocka_unit_test(heads_that_readers_disagree_on_are_refused),
        cmocka_unit_test(a_method_is_a_token),
        cmocka_unit_test(a_head_has_a_size_limit),
        cmocka_unit_test(a_target_is_visible_ascii),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
