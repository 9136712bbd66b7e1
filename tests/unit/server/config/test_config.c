#include "tests/unit/server/support.h"

#include <errno.h>
#include <stdio.h>
#include <sys/un.h>
#include <unistd.h>

#include "server/config/config.h"

static struct server_config config;
static char *said, *complained;

static void forget(void)
{
    free(said);
    free(complained);
    said = complained = NULL;
}

/* Loads from the arguments up to NULL, and captures the output. */
static enum server_config_outcome load(const char *first, ...)
{
    char *argv[16] = {"geodesicd"};
    int argc = 1;
    size_t out_size, error_size;
    va_list arguments;
    va_start(arguments, first);
    for (const char *argument = first; argument; argument = va_arg(arguments, const char *))
        argv[argc++] = (char *)argument;
    va_end(arguments);
    forget();
    FILE *out = open_memstream(&said, &out_size), *error = open_memstream(&complained, &error_size);
    enum server_config_outcome outcome = server_config_load(&config, argv, out, error);
    fclose(out);
    fclose(error);
    return outcome;
}

#define LOAD(...) load(__VA_ARGS__, NULL)

static void assert_wrong(enum server_config_outcome outcome, const char *hint)
{
    assert_int_equal(outcome, SERVER_CONFIG_WRONG);
    assert_non_null(strstr(complained, hint));
    assert_ptr_equal(strchr(complained, '\n'), complained + strlen(complained) - 1);
}

static void has_defaults(void **state)
{
    (void)state;
    char address[SERVER_ADDRESS_TEXT];
    assert_int_equal(load(NULL), SERVER_CONFIG_RUN);
    server_address_format(&config.listen, address);
    assert_string_equal(address, "127.0.0.1:8080");
    assert_int_equal(config.memory_budget, UINT64_C(4) << 30);
    assert_true(config.workers >= 1);
    assert_int_equal(config.log_level, SERVER_LOG_INFO);
    assert_string_equal(server_config_cpus[config.cpu], "auto");
    assert_int_equal(config.landmarks, 32);
    assert_int_equal(config.job_ttl_s, 3600);
    assert_int_equal(config.max_jobs, 10000);
}

static void reads_flags_in_both_forms(void **state)
{
    (void)state;
    assert_int_equal(LOAD("--workers", "3", "--max-body=10k", "--log-level", "warn", "--cpu",
                          "avx2", "--landmarks", "0"),
                     SERVER_CONFIG_RUN);
    assert_int_equal(config.landmarks, 0);
    assert_string_equal(server_config_cpus[config.cpu], "avx2");
    assert_int_equal(config.workers, 3);
    assert_int_equal(config.max_body, 10240);
    assert_int_equal(config.log_level, SERVER_LOG_WARN);
}

static void reads_sizes(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint64_t bytes;
    } sizes[] = {{"4096", 4096},    {"4096B", 4096}, {"64k", 65536},   {"64K", 65536},
                 {"2MiB", 2 << 20}, {"2M", 2 << 20}, {"1GiB", 1 << 30}};
    static const char *const wrong[] = {"",          "4 GiB",  "4Gb", "-1",
                                        "1e9",       "0x1000", "4GB", "99999999999999999999",
                                        "20000000T", "4GiBB"};
    for (size_t i = 0; i < COUNT(sizes); i++) {
        assert_int_equal(LOAD("--max-body", sizes[i].text), SERVER_CONFIG_RUN);
        assert_int_equal(config.max_body, sizes[i].bytes);
    }
    for (size_t i = 0; i < COUNT(wrong); i++) assert_wrong(LOAD("--max-body", wrong[i]), "size");
}

static void names_the_nearest_flag(void **state)
{
    (void)state;
    assert_wrong(LOAD("--wrokers", "3"), "did you mean --workers?");
    assert_wrong(LOAD("--memory_budget", "3"), "did you mean --memory-budget?");
    assert_wrong(LOAD("--timeout", "3"), "did you mean --timeout-ms?");
    char name[4096];
    memset(name, '-', sizeof name);
    name[sizeof name - 1] = '\0';
    assert_int_equal(LOAD(name), SERVER_CONFIG_WRONG);
}

static void refuses_wrong_values(void **state)
{
    (void)state;
    assert_wrong(LOAD("--workers"), "a value is missing");
    assert_wrong(LOAD("--workers", "0"), "outside");
    assert_wrong(LOAD("--workers", "two"), "whole number");
    assert_wrong(LOAD("--help=yes"), "takes no value");
    assert_wrong(LOAD("serve"), "--help");
    assert_wrong(LOAD("--log-level", "loud"), "debug, info, warn or error");
    assert_wrong(LOAD("--cpu", "sse"), "auto, baseline, avx2 or avx512");
    assert_wrong(LOAD("--landmarks", "33"), "0 to 32");
    assert_wrong(LOAD("--cpu", ""), "auto, baseline, avx2 or avx512");
    assert_wrong(LOAD("--listen", "8080"), "ADDR:PORT");
    assert_wrong(LOAD("--listen", "127.0.0.1:65536"), "port");
    assert_wrong(LOAD("--listen", "example.com:80"), "numeric");
    assert_wrong(LOAD("--listen", "unix:"), "unix socket");
    assert_wrong(LOAD("--max-body", "2GiB", "--memory-budget", "1GiB"), "--memory-budget");
    assert_wrong(LOAD("--allowed-host", "http://meshes.example"), "host name");
    assert_wrong(LOAD("--tls-cert", "cert.pem"), "belong together");
    assert_wrong(LOAD("--tls-key", "key.pem"), "belong together");
    assert_wrong(LOAD("--keys", ""), "a path has");
    assert_wrong(LOAD("--max-connections", "0"), "outside");
}

static void listens_on_loopback_only(void **state)
{
    (void)state;
    static const char *const local[] = {"127.0.0.1:0", "127.3.2.1:80", "localhost:80", "[::1]:80",
                                        "unix:geodesicd.socket"};
    static const char *const open[] = {"0.0.0.0:80", "[::]:80", "192.0.2.1:80", "[2001:db8::1]:80"};
    for (size_t i = 0; i < COUNT(local); i++)
        assert_int_equal(LOAD("--listen", local[i]), SERVER_CONFIG_RUN);
    for (size_t i = 0; i < COUNT(open); i++)
        assert_wrong(LOAD("--listen", open[i]), "refusing to listen");
}

/* Connects until the queue of the listening socket is full. Returns the number of connections. */
static int queue_fill(const struct server_address *address, int clients[8])
{
    for (int i = 0; i < 8; i++) {
        clients[i] = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0);
        if (connect(clients[i], (const struct sockaddr *)&address->socket, address->size) == 0)
            continue;
        assert_int_equal(errno, EAGAIN);
        close(clients[i]);
        return i;
    }
    return 8;
}

static void refuses_the_socket_of_a_process_that_accepts_no_connection(void **state)
{
    (void)state;
    struct server_address address;
    char name[] = "/tmp/geodesicd-test-XXXXXX", text[64], error[SERVER_ERROR] = "";
    int clients[8], busy = socket(AF_UNIX, SOCK_STREAM, 0);
    assert_non_null(mkdtemp(name));
    snprintf(text, sizeof text, "unix:%s/socket", name);
    assert_true(server_address_parse(text, &address, error));
    const struct sockaddr_un *place = (const struct sockaddr_un *)&address.socket;
    assert_int_equal(bind(busy, (const struct sockaddr *)place, address.size), 0);
    assert_int_equal(listen(busy, 0), 0);
    int count = queue_fill(&address, clients), second = server_address_bind(&address, error);
    assert_in_range(count, 1, 7);
    assert_false(server_address_listen(second, &address, error));
    assert_non_null(strstr(error, "Address already in use"));
    assert_int_equal(access(place->sun_path, F_OK), 0);
    for (int i = 0; i < count; i++) close(clients[i]);
    close(second);
    close(busy);
    unlink(place->sun_path);
    rmdir(name);
}

static void listens_anywhere_with_keys(void **state)
{
    (void)state;
    assert_int_equal(LOAD("--keys", "keys.txt", "--listen", "0.0.0.0:80"), SERVER_CONFIG_RUN);
    assert_string_equal(config.keys, "keys.txt");
    assert_wrong(LOAD("--tls-cert", "c.pem", "--tls-key", "k.pem", "--listen", "0.0.0.0:80"),
                 "refusing to listen");
}

static void origins_have_only_a_scheme_and_a_host(void **state)
{
    (void)state;
    static const char *const wrong[] = {"*",
                                        "null",
                                        "maps.example",
                                        "ftp://maps.example",
                                        "https://",
                                        "https://*.example",
                                        "https://maps.example/",
                                        "https://user@maps.example"};
    for (size_t i = 0; i < COUNT(wrong); i++)
        assert_wrong(LOAD("--cors-origin", wrong[i]), "is not an origin");
    assert_int_equal(LOAD("--cors-origin", "https://a.example,http://localhost:3000",
                          "--cors-origin", "http://[::1]:80"),
                     SERVER_CONFIG_RUN);
    assert_int_equal(config.cors_origins.count, 3);
    assert_string_equal(config.cors_origins.name[1], "http://localhost:3000");
}

static void lists_two_frame_ancestors(void **state)
{
    (void)state;
    assert_int_equal(LOAD("--frame-ancestors", "https://a.example,https://b.example"),
                     SERVER_CONFIG_RUN);
    assert_string_equal(config.frame_ancestors.name[1], "https://b.example");
    assert_wrong(LOAD("--frame-ancestors", "https://a.example; script-src *"), "not an origin");
    assert_wrong(LOAD("--frame-ancestors", "https://a.example,https://b.example,https://c.example"),
                 "at most two");
}

static void prints_help_and_version(void **state)
{
    (void)state;
    assert_int_equal(LOAD("--help"), SERVER_CONFIG_DONE);
    assert_non_null(strstr(said, "--memory-budget BYTES"));
    assert_non_null(strstr(said, "4GiB"));
    assert_int_equal(LOAD("--workers", "3", "--version"), SERVER_CONFIG_DONE);
    assert_non_null(strstr(said, "geodesicd "));
}

static void flags_win_over_environment_over_file(void **state)
{
    (void)state;
    char path[] = "geodesicd-test-XXXXXX";
    int file = mkstemp(path);
    static const char text[] = "# limits\n\n  workers = 3  # three\nmax-faces=500\ntimeout-ms = "
                               "700\nallowed-host = a.example, b.example\n";
    assert_int_equal(write(file, text, strlen(text)), strlen(text));
    close(file);
    setenv("GEODESICD_MAX_FACES", "600", 1);
    setenv("GEODESICD_TIMEOUT_MS", "800", 1);
    enum server_config_outcome outcome =
        LOAD("--config", path, "--timeout-ms", "900", "--allowed-host", "c.example");
    unsetenv("GEODESICD_MAX_FACES");
    unsetenv("GEODESICD_TIMEOUT_MS");
    unlink(path);
    assert_int_equal(outcome, SERVER_CONFIG_RUN);
    assert_int_equal(config.workers, 3);
    assert_int_equal(config.max_faces, 600);
    assert_int_equal(config.timeout_ms, 900);
    assert_int_equal(config.allowed_hosts.count, 3);
    assert_string_equal(config.allowed_hosts.name[1], "b.example");
}

static enum server_config_outcome load_file(const char *text)
{
    char path[] = "geodesicd-test-XXXXXX";
    int file = mkstemp(path);
    assert_int_equal(write(file, text, strlen(text)), strlen(text));
    close(file);
    enum server_config_outcome outcome = LOAD("--config", path);
    unlink(path);
    return outcome;
}

static void long_texts_are_not_cut(void **state)
{
    (void)state;
    char text[10000];
    snprintf(text, sizeof text, "%0600d.a,b.example", 0);
    assert_wrong(LOAD("--allowed-host", text), "too long");
    char *at = text;
    for (int i = 0; i < SERVER_CONFIG_NAMES; i++) at += sprintf(at, "%040d.example, ", i);
    assert_int_equal(LOAD("--allowed-host", text), SERVER_CONFIG_RUN);
    assert_int_equal(config.allowed_hosts.count, SERVER_CONFIG_NAMES);
    assert_int_equal(strlen(config.allowed_hosts.name[SERVER_CONFIG_NAMES - 1]), 48);
    snprintf(text, sizeof text, "%09000d", 0);
    assert_wrong(LOAD("--allowed-host", text), "bytes");
    text[0] = '#'; /* a comment; its end must not become a line */
    assert_wrong(load_file(text), ":1: a line has");
}

static void errors_of_a_file_name_the_line(void **state)
{
    (void)state;
    assert_wrong(load_file("workers = 3\nmax-fases = 500\n"), ":2: ");
    assert_non_null(strstr(complained, "max-faces"));
    assert_wrong(load_file("version = true\n"), "can't be set");
    assert_wrong(LOAD("--check-store", "--backup", "copy"), "only one");
    assert_wrong(LOAD("--config", "no-such-file"), "no-such-file");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(has_defaults),
        cmocka_unit_test(reads_flags_in_both_forms),
        cmocka_unit_test(reads_sizes),
        cmocka_unit_test(names_the_nearest_flag),
        cmocka_unit_test(refuses_wrong_values),
        cmocka_unit_test(listens_on_loopback_only),
        cmocka_unit_test(refuses_the_socket_of_a_process_that_accepts_no_connection),
        cmocka_unit_test(listens_anywhere_with_keys),
        cmocka_unit_test(origins_have_only_a_scheme_and_a_host),
        cmocka_unit_test(lists_two_frame_ancestors),
        cmocka_unit_test(prints_help_and_version),
        cmocka_unit_test(flags_win_over_environment_over_file),
        cmocka_unit_test(long_texts_are_not_cut),
        cmocka_unit_test(errors_of_a_file_name_the_line),
    };
    int failures = cmocka_run_group_tests(tests, NULL, NULL);
    forget();
    return failures;
}
