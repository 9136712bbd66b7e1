#include "tests/unit/server/support.h"

#include <stdio.h>
#include <unistd.h>

#include "server/access/access.h"

#define A_KEY    "gdk_AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"
#define B_KEY    "gdk_BBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBB"
#define OLD_KEY  "gdk_OOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOOO"
#define NO_SUM   "sha256:0000000000000000000000000000000000000000000000000000000000000000"
#define NO_SUM_2 "sha256:1111111111111111111111111111111111111111111111111111111111111111"

static char path[] = "credentials-XXXXXX", error[SERVER_ERROR];

static int set_up(void **state)
{
    (void)state;
    strcpy(path, "credentials-XXXXXX");
    int file = mkstemp(path);
    close(file);
    return file >= 0 ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    return unlink(path);
}

static void write_file(const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* Returns the line of the keys' file that describes a key. */
static const char *line(const char *name, const char *key, const char *settings)
{
    static char lines[4][256];
    static unsigned next;
    char sha256[SERVER_SHA256_HEX], *text = lines[next++ % 4];
    server_sha256(key, strlen(key), sha256);
    snprintf(text, sizeof lines[0], "%s sha256:%s %s\n", name, sha256, settings);
    return text;
}

static struct server_credentials *load(const char *text)
{
    write_file(text);
    error[0] = '\0';
    return server_credentials_load(path, NULL, error);
}

/* --- the file --------------------------------------------------------------------------------- */

static void reads_lines(void **state)
{
    (void)state;
    char text[1024];
    snprintf(text, sizeof text, "# keys\n\n  %s%s%s", line("a", A_KEY, "# reads"),
             line("b.2_x", B_KEY, "role=write rate=50 concurrent=8 expires=2100-01-31"),
             line("old", OLD_KEY, "expires=2001-02-03T04:05:06Z"));
    struct server_credentials *keys = load(text);
    assert_non_null(keys);
    assert_int_equal(keys->count, 3);
    const struct server_credential *a = server_credentials_find(keys, A_KEY, strlen(A_KEY)),
                                   *b = server_credentials_find(keys, B_KEY, strlen(B_KEY)),
                                   *old = server_credentials_find(keys, OLD_KEY, strlen(OLD_KEY));
    assert_string_equal(a->name, "a");
    assert_int_equal(a->role, SERVER_ROLE_READ);
    assert_int_equal(a->expires, 0);
    assert_int_equal(a->limits.rate + a->limits.concurrent, 0);
    assert_string_equal(b->name, "b.2_x");
    assert_int_equal(b->role, SERVER_ROLE_WRITE);
    assert_int_equal(b->limits.rate, 50);
    assert_int_equal(b->limits.concurrent, 8);
    assert_int_equal(b->expires, 4105036800);
    assert_int_equal(old->expires, 981173106);
    assert_null(server_credentials_find(keys, A_KEY, strlen(A_KEY) - 1));
    assert_null(server_credentials_find(keys, "", 0));
    server_credentials_release(keys);
}

static void errors_name_the_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *hint;
    } cases[] = {{"", ":0: the file holds no key"},
                 {"# nothing\n\n", "holds no key"},
                 {"\n\nci\n", ":3: after the name"},
                 {"ci gdk_secret\n", "sha256:"},
                 {"ci sha256:00\n", "64 hexadecimal"},
                 {"a/b " NO_SUM "\n", "a name has"},
                 {".a " NO_SUM "\n", "a name has"},
                 {"a@b " NO_SUM "\n", "a name has"},
                 {"a " NO_SUM " role=admin\n", "read, write or operator"},
                 {"a " NO_SUM " role=read rate=1 role=write\n", "role stands twice"},
                 {"a " NO_SUM " expires=2020-01-31 expires=2100-01-31\n", "expires stands twice"},
                 {"a " NO_SUM " expires=tomorrow\n", "is not a time"},
                 {"a " NO_SUM " expires=2027-02-31\n", "is not a time"},
                 {"a " NO_SUM " expires=1960-01-01\n", "is not a time"},
                 {"a " NO_SUM " rate=0\n", "requests a second"},
                 {"a " NO_SUM " rate=-1\n", "requests a second"},
                 {"a " NO_SUM " rate=1000001\n", "requests a second"},
                 {"a " NO_SUM " concurrent=9999999999\n", "at once"},
                 {"a " NO_SUM " colour=red\n", "no setting 'colour'"},
                 {"a " NO_SUM " write\n", "'write' is not a setting"},
                 {"a " NO_SUM "\na " NO_SUM_2 "\n", ":2: the name 'a' stands twice"},
                 {"a " NO_SUM "\nb " NO_SUM "\n", "are the same key"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_null(load(cases[i].text));
        assert_non_null(strstr(error, cases[i].hint));
        /* messages must not repeat the word, because it might be a misplaced key */
        assert_null(strstr(error, "gdk_secret"));
    }
    assert_null(server_credentials_load("no such file", NULL, error));
    assert_non_null(strstr(error, "No such file"));
}

static void long_lines_are_refused(void **state)
{
    (void)state;
    char text[2048] = "a " NO_SUM;
    memset(text + strlen(text), ' ', 1000);
    assert_null(load(text));
    assert_non_null(strstr(error, "too long"));
}

/* --- keygen ----------------------------------------------------------------------------------- */

static bool generate(int argc, char *argv[], char key[64], char entry[512])
{
    char *out_text, *error_text;
    size_t out_size, error_size;
    FILE *out = open_memstream(&out_text, &out_size),
         *said = open_memstream(&error_text, &error_size);
    bool ok = server_keygen(argc, argv, out, said);
    fclose(out);
    fclose(said);
    if (ok) assert_int_equal(sscanf(out_text, "%63s\n%511[^\n]\n", key, entry), 2);
    if (!ok) assert_non_null(strstr(error_text, "usage"));
    free(out_text);
    free(error_text);
    return ok;
}

static void output_of_keygen_is_a_valid_file(void **state)
{
    (void)state;
    char *plain[] = {"ci"}, *full[] = {"ci",     "--role", "write",        "--expires", "90d",
                                       "--rate", "5",      "--concurrent", "2"};
    char key[64], other[64], entry[512];
    assert_true(generate(1, plain, other, entry));
    assert_true(generate(9, full, key, entry));
    assert_string_not_equal(key, other);
    assert_int_equal(strlen(key), strlen(A_KEY));
    assert_null(strstr(entry, key + 4));
    struct server_credentials *keys = load(entry);
    assert_non_null(keys);
    const struct server_credential *found = server_credentials_find(keys, key, strlen(key));
    assert_string_equal(found->name, "ci");
    assert_int_equal(found->role, SERVER_ROLE_WRITE);
    assert_in_range(found->expires - time(NULL), 90 * 86400 - 60, 90 * 86400);
    assert_int_equal(found->limits.rate, 5);
    assert_int_equal(found->limits.concurrent, 2);
    server_credentials_release(keys);
}

static void keygen_refuses_wrong_arguments(void **state)
{
    (void)state;
    char *cases[][3] = {{"a b"},
                        {""},
                        {"a", "--role"},
                        {"a", "--role", "root"},
                        {"a", "--rate", "0"},
                        {"a", "--rate", "x"},
                        {"a", "--x", "y"},
                        {"a", "--expires", "d"},
                        {"a", "--expires", "0d"}};
    static const int counts[] = {1, 1, 2, 3, 3, 3, 3, 3, 3};
    char key[64], entry[512];
    for (size_t i = 0; i < COUNT(cases); i++)
        assert_false(generate(counts[i], cases[i], key, entry));
    assert_false(generate(0, cases[0], key, entry));
}

/* --- access ----------------------------------------------------------------------------------- */

static struct server_budget budget; /* shared out to tenants, but not used */

static struct server_access *open_access(const char *text)
{
    write_file(text);
    struct server_access *access = server_access_create(path, &budget, error);
    assert_non_null(access);
    return access;
}

/* Returns the code of the problem, or PROTO_PROBLEM_NONE if the request is admitted. Ends the grant
 * unless `kept` is set. */
static enum proto_problem_code admit(struct server_access *access, const char *authorization,
                                     enum proto_access needed, struct server_grant *kept)
{
    const struct server_access_request request = {authorization, authorization != NULL, needed,
                                                  false};
    struct server_grant grant = {0};
    struct proto_problem problem = {0};
    bool ok = server_access_admit(access, &request, &grant, &problem);
    assert_int_equal(ok, problem.code == PROTO_PROBLEM_NONE);
    assert_int_equal(problem.challenge != NULL, problem.code == PROTO_PROBLEM_UNAUTHORIZED ||
                                                    problem.code == PROTO_PROBLEM_FORBIDDEN);
    assert_int_equal(problem.retry_after > 0, problem.code == PROTO_PROBLEM_RATE_LIMITED);
    if (kept)
        *kept = grant;
    else
        server_grant_end(&grant);
    return problem.code;
}

#define READ(authorization)  admit(access, authorization, PROTO_ACCESS_READ, NULL)
#define WRITE(authorization) admit(access, authorization, PROTO_ACCESS_WRITE, NULL)

static void keys_admit_by_role(void **state)
{
    (void)state;
    char text[1024];
    snprintf(text, sizeof text, "%s%s%s", line("a", A_KEY, ""), line("b", B_KEY, "role=write"),
             line("old", OLD_KEY, "expires=2001-01-01"));
    struct server_access *access = open_access(text);
    static const char *const wrong[] = {NULL,
                                        "",
                                        "Bearer",
                                        "Bearer ",
                                        A_KEY,
                                        "Basic " A_KEY,
                                        "Bearer" A_KEY,
                                        "Bearer " A_KEY "A",
                                        "Bearer " A_KEY " ",
                                        "Bearer " A_KEY "," A_KEY,
                                        "Bearer gdk_",
                                        "Bearer " OLD_KEY};
    for (size_t i = 0; i < COUNT(wrong); i++) {
        assert_int_equal(READ(wrong[i]), PROTO_PROBLEM_UNAUTHORIZED);
        assert_int_equal(admit(access, wrong[i], PROTO_ACCESS_PUBLIC, NULL), PROTO_PROBLEM_NONE);
        assert_int_equal(admit(NULL, wrong[i], PROTO_ACCESS_WRITE, NULL), PROTO_PROBLEM_NONE);
    }
    assert_int_equal(READ("Bearer " A_KEY), PROTO_PROBLEM_NONE);
    assert_int_equal(READ("bearer  " A_KEY), PROTO_PROBLEM_NONE);
    assert_int_equal(READ("Bearer " B_KEY), PROTO_PROBLEM_NONE);
    assert_int_equal(WRITE("Bearer " A_KEY), PROTO_PROBLEM_FORBIDDEN);
    assert_int_equal(WRITE("Bearer " B_KEY), PROTO_PROBLEM_NONE);
    server_access_destroy(access);
}

static void two_authorization_headers_are_refused(void **state)
{
    (void)state;
    struct server_access *access = open_access(line("a", A_KEY, ""));
    const struct server_access_request request = {.authorization = "Bearer " A_KEY,
                                                  .authorization_count = 2};
    struct server_grant grant = {0};
    struct proto_problem problem;
    assert_false(server_access_admit(access, &request, &grant, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_UNAUTHORIZED);
    server_grant_end(&grant);
    server_access_destroy(access);
}

static void limits_hold_until_a_grant_ends(void **state)
{
    (void)state;
    struct server_access *access = open_access(line("a", A_KEY, "concurrent=2"));
    struct server_grant one, two, refused, job = {0};
    assert_int_equal(admit(access, "Bearer " A_KEY, PROTO_ACCESS_READ, &one), PROTO_PROBLEM_NONE);
    assert_int_equal(admit(access, "Bearer " A_KEY, PROTO_ACCESS_READ, &two), PROTO_PROBLEM_NONE);
    assert_int_equal(admit(access, "Bearer " A_KEY, PROTO_ACCESS_READ, &refused),
                     PROTO_PROBLEM_RATE_LIMITED);
    assert_string_equal(server_grant_name(&refused), "a");
    server_grant_end(&refused);
    /* the end of the refused request admits no other request */
    assert_int_equal(READ("Bearer " A_KEY), PROTO_PROBLEM_RATE_LIMITED);
    server_grant_pass(&one, &job);
    server_grant_end(&one);
    /* the job still counts as a request */
    assert_int_equal(READ("Bearer " A_KEY), PROTO_PROBLEM_RATE_LIMITED);
    assert_string_equal(server_grant_name(&job), "a");
    server_grant_end(&job);
    assert_int_equal(READ("Bearer " A_KEY), PROTO_PROBLEM_NONE);
    server_grant_end(&two);
    server_access_destroy(access);
}

static void a_reload_keeps_quotas(void **state)
{
    (void)state;
    struct server_access *access = open_access(line("a", A_KEY, "concurrent=1"));
    struct server_grant held;
    assert_int_equal(admit(access, "Bearer " A_KEY, PROTO_ACCESS_READ, &held), PROTO_PROBLEM_NONE);
    write_file(line("a", B_KEY, "concurrent=1")); /* another key with the same name */
    assert_true(server_access_reload(access, error));
    assert_int_equal(READ("Bearer " A_KEY), PROTO_PROBLEM_UNAUTHORIZED);
    assert_int_equal(READ("Bearer " B_KEY), PROTO_PROBLEM_RATE_LIMITED);
    server_grant_end(&held);
    assert_int_equal(READ("Bearer " B_KEY), PROTO_PROBLEM_NONE);
    server_access_destroy(access);
}

static void a_malformed_file_changes_nothing(void **state)
{
    (void)state;
    struct server_access *access = open_access(line("a", A_KEY, ""));
    write_file("rubbish\n");
    assert_false(server_access_reload(access, error));
    assert_non_null(strstr(error, ":1: "));
    assert_int_equal(READ("Bearer " A_KEY), PROTO_PROBLEM_NONE);
    server_access_destroy(access);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(reads_lines, set_up, tear_down),
        cmocka_unit_test_setup_teardown(errors_name_the_line, set_up, tear_down),
        cmocka_unit_test_setup_teardown(long_lines_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(output_of_keygen_is_a_valid_file, set_up, tear_down),
        cmocka_unit_test(keygen_refuses_wrong_arguments),
        cmocka_unit_test_setup_teardown(keys_admit_by_role, set_up, tear_down),
        cmocka_unit_test_setup_teardown(two_authorization_headers_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(limits_hold_until_a_grant_ends, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_reload_keeps_quotas, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_malformed_file_changes_nothing, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
