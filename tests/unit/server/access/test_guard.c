#include "tests/unit/server/support.h"

#include "server/access/access.h"

static bool admit(const struct server_guard_request *request)
{
    struct server_config config = {.allowed_hosts = {.name = {"meshes.example"}, .count = 1}};
    struct proto_problem problem;
    return server_guard_admit(&config, request, &problem);
}

/* Like ADMIT, for a daemon with keys and a listed origin. */
static bool admit_with(const char *keys, const char *host,
                       const struct server_guard_request *request)
{
    struct server_config config = {.cors_origins = {.name = {"https://maps.example"}, .count = 1}};
    struct proto_problem problem;
    strcpy(config.keys, keys);
    if (host) strcpy(config.allowed_hosts.name[config.allowed_hosts.count++], host);
    return server_guard_admit(&config, request, &problem);
}

#define ADMIT_WITH(keys, host, ...)                                                                \
    admit_with(keys, host, &(struct server_guard_request){__VA_ARGS__})

#define ADMIT(...) admit(&(struct server_guard_request){__VA_ARGS__})

static void accepts_hosts_of_this_machine(void **state)
{
    (void)state;
    static const char *const own[] = {"localhost",          "LocalHost:80",  "127.0.0.1:8080",
                                      "127.1.2.3",          "[::1]",         "[::1]:9",
                                      "meshes.example:443", "MESHES.example"};
    static const char *const foreign[] = {"",
                                          ":80",
                                          "example",
                                          "evil.example",
                                          "localhost.",
                                          "localhost:80:80",
                                          "localhost:8o",
                                          "[::1",
                                          "[::1]x",
                                          "::1",
                                          "[::2]",
                                          "128.0.0.1",
                                          "127.1",
                                          "0x7f.0.0.1",
                                          "localhost ",
                                          "meshes.example.evil"};
    for (size_t i = 0; i < COUNT(own); i++) assert_true(ADMIT(.host = own[i]));
    for (size_t i = 0; i < COUNT(foreign); i++) assert_false(ADMIT(.host = foreign[i]));
}

static void a_too_long_host_is_refused(void **state)
{
    (void)state;
    char host[4096];
    memset(host, 'a', sizeof host - 1);
    host[sizeof host - 1] = '\0';
    assert_false(ADMIT(.host = host));
}

static void only_http_1_0_may_omit_the_host(void **state)
{
    (void)state;
    assert_false(ADMIT(.host = NULL));
    assert_true(ADMIT(.host = NULL, .is_http10 = true));
    assert_false(ADMIT(.host = "evil.example", .is_http10 = true));
}

static void pages_of_other_origins_are_refused(void **state)
{
    (void)state;
    assert_true(ADMIT(.host = "localhost:8080", .origin = "http://localhost:8080"));
    assert_false(ADMIT(.host = "localhost:8080", .origin = "http://localhost"));
    assert_false(ADMIT(.host = "localhost:8080", .origin = "http://localhost:8081"));
    assert_false(ADMIT(.host = "localhost:8080", .origin = "http://127.0.0.1:8080"));
    assert_false(ADMIT(.host = "localhost:8080", .origin = "null"));
    assert_false(ADMIT(.host = "localhost:8080", .origin = ""));
    assert_false(ADMIT(.host = NULL, .is_http10 = true, .origin = "http://localhost"));
}

static void a_cross_site_request_is_refused(void **state)
{
    (void)state;
    assert_false(ADMIT(.host = "localhost", .fetch_site = "cross-site"));
    assert_false(ADMIT(.host = "localhost", .fetch_site = "Cross-Site"));
    assert_true(ADMIT(.host = "localhost", .fetch_site = "same-origin"));
    assert_true(ADMIT(.host = "localhost", .fetch_site = "none"));
}

static void with_keys_any_host_is_accepted_unless_some_are_listed(void **state)
{
    (void)state;
    assert_true(ADMIT_WITH("keys", NULL, .host = "meshes.example"));
    assert_true(ADMIT_WITH("keys", NULL, .host = "10.0.0.1:8080"));
    assert_false(ADMIT_WITH("keys", NULL, .host = "meshes.example/x:y"));
    assert_false(ADMIT_WITH("keys", NULL, .host = ""));
    assert_false(ADMIT_WITH("keys", NULL, .host = NULL));
    assert_true(ADMIT_WITH("keys", "a.example", .host = "a.example"));
    assert_true(ADMIT_WITH("keys", "a.example", .host = "localhost"));
    assert_false(ADMIT_WITH("keys", "a.example", .host = "b.example"));
    /* the request follows a link to the page */
    assert_true(ADMIT_WITH("keys", NULL, .host = "m.example", .fetch_site = "cross-site"));
    assert_false(ADMIT_WITH("keys", NULL, .host = "m.example", .origin = "https://evil.example"));
    assert_false(ADMIT_WITH("", NULL, .host = "meshes.example"));
}

static void listed_origins_are_accepted(void **state)
{
    (void)state;
    assert_true(ADMIT_WITH("", NULL, .host = "localhost", .origin = "https://maps.example"));
    assert_true(ADMIT_WITH("", NULL, .host = "localhost", .origin = "https://maps.example",
                           .fetch_site = "cross-site"));
    assert_false(ADMIT_WITH("", NULL, .host = "evil.example", .origin = "https://maps.example"));
    static const char *const others[] = {"http://maps.example",
                                         "https://maps.example:444",
                                         "https://maps.example.evil",
                                         "https://a.maps.example",
                                         "maps.example",
                                         "null"};
    for (size_t i = 0; i < COUNT(others); i++)
        assert_false(ADMIT_WITH("", NULL, .host = "localhost", .origin = others[i]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accepts_hosts_of_this_machine),
        cmocka_unit_test(a_too_long_host_is_refused),
        cmocka_unit_test(only_http_1_0_may_omit_the_host),
        cmocka_unit_test(pages_of_other_origins_are_refused),
        cmocka_unit_test(a_cross_site_request_is_refused),
        cmocka_unit_test(with_keys_any_host_is_accepted_unless_some_are_listed),
        cmocka_unit_test(listed_origins_are_accepted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
