/* Tests a kind of surface that exists only in this test, the toy. The test shows that the daemon
 * depends only on the functions and routes of a kind. The tables of kinds and routes in this file
 * replace the daemon's tables. */
#include "tests/unit/server/daemon.h"
#include "tests/unit/server/folder.h"

#include "server/surfaces/surface.h"
#include "server/query/handlers.h"
#include "server/query/request.h"
#include "server/store/store.h"

/* --- toys: a number in a file, in some unit --------------------------------------------------- */

struct toy {
    long number;
};

static int living; /* toys in memory */

static bool read_toy_options(const struct proto_parameters *parameters,
                             const struct server_file *file, char text[SERVER_OPTIONS],
                             struct proto_problem *problem)
{
    static const char *const names[] = {"unit", NULL}, *const units[] = {"m", "cm", NULL};
    unsigned unit = 0;
    (void)file;
    if (!proto_parameters_check(parameters, names, problem)) return false;
    if (!proto_parameters_choice(parameters, "unit", units, &unit, problem)) return false;
    snprintf(text, SERVER_OPTIONS, "unit=%s", units[unit]);
    return true;
}

static enum gd_status build_toy(const struct server_builder *builder, struct server_built *out)
{
    char text[32], *end;
    snprintf(text, sizeof text, "%.*s", (int)builder->record->size, (const char *)builder->bytes);
    long number = strtol(text, &end, 10);
    if (end == text || *end) return server_build_refuse(builder, GD_SYNTAX, NULL);
    enum gd_status status = server_build_take(builder, sizeof(struct toy));
    if (status) return status;
    struct toy *toy = malloc(sizeof *toy);
    toy->number = number;
    *out = (struct server_built){toy, sizeof *toy};
    living++;
    return GD_OK;
}

static void release_toy(void *object)
{
    free(object);
    living--;
}

static void describe_toy(struct proto_writer *writer, const struct server_surface *surface)
{
    const struct toy *toy = surface->object;
    proto_write_object_begin(writer);
    proto_write_key(writer, "name");
    proto_write_string(writer, surface->record->name);
    proto_write_key(writer, "number");
    proto_write_int(writer, toy->number);
    proto_write_key(writer, "options");
    proto_write_string(writer, surface->record->options);
    proto_write_object_end(writer);
}

static const struct server_kind toy_kind = {.word = "toy",
                                            .plural = "toys",
                                            .noun = "toy",
                                            .read_options = read_toy_options,
                                            .build = build_toy,
                                            .release = release_toy,
                                            .describe = describe_toy};

const struct server_kind *const server_kinds[] = {&server_kind_mesh, &toy_kind, NULL};

/* Handles a query that only toys have. */
static void handle_double(struct server_exchange *exchange)
{
    struct server_surface *surface = server_request_surface(exchange);
    struct proto_writer writer;
    if (!surface) return;
    const struct toy *toy = surface->object;
    proto_writer_init(&writer, SERVER_DESCRIPTION_MOST);
    proto_write_int(&writer, 2 * toy->number);
    server_reply_json(exchange, 200, &writer);
}

#define ROUTES(plural)                                                                             \
    {.method = PROTO_METHOD_GET,                                                                   \
     .path = "/v1/" plural,                                                                        \
     .segment_count = 2,                                                                           \
     .segments = {"v1", plural},                                                                   \
     .handle = server_handle_list_surfaces},                                                       \
        {.method = PROTO_METHOD_POST,                                                              \
         .has_body = true,                                                                         \
         .path = "/v1/" plural,                                                                    \
         .segment_count = 2,                                                                       \
         .segments = {"v1", plural},                                                               \
         .handle = server_handle_create_surface},                                                  \
        {.method = PROTO_METHOD_PUT,                                                               \
         .has_body = true,                                                                         \
         .path = "/v1/" plural "/{name}",                                                          \
         .segment_count = 3,                                                                       \
         .segments = {"v1", plural, NULL},                                                         \
         .handle = server_handle_put_surface},                                                     \
        {.method = PROTO_METHOD_GET,                                                               \
         .path = "/v1/" plural "/{name}",                                                          \
         .segment_count = 3,                                                                       \
         .segments = {"v1", plural, NULL},                                                         \
         .handle = server_handle_get_surface},                                                     \
    {                                                                                              \
        .method = PROTO_METHOD_DELETE, .path = "/v1/" plural "/{name}", .segment_count = 3,        \
        .segments = {"v1", plural, NULL}, .handle = server_handle_delete_surface                   \
    }

const struct proto_route proto_routes[] = {
    ROUTES("meshes"),
    ROUTES("toys"),
    {.method = PROTO_METHOD_GET,
     .path = "/v1/toys/{name}/double",
     .segment_count = 4,
     .segments = {"v1", "toys", NULL, "double"},
     .handle = handle_double},
};
const size_t proto_route_count = COUNT(proto_routes);

/* --- a daemon with a folder ------------------------------------------------------------------- */

static char folder[FOLDER_PATH];

static void start(void)
{
    char error[SERVER_ERROR] = "";
    struct server_store *store = server_store_local_open(folder, error);
    if (!store) fail_msg("%s", error);
    daemon_start(store);
}

static void restart(void)
{
    daemon_stop();
    assert_int_equal(living, 0);
    start();
}

static int set_up(void **state)
{
    (void)state;
    folder_make(folder);
    start();
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    daemon_stop();
    assert_int_equal(living, 0);
    folder_remove(folder);
    return 0;
}

#define ASK(...) daemon_answer((struct daemon_request){__VA_ARGS__})
#define PUT(path, bytes)                                                                           \
    daemon_status((struct daemon_request){.method = "PUT", .target = path, .body = bytes})
#define GET(path)    ASK(.method = "GET", .target = path)
#define DELETE(path) daemon_status((struct daemon_request){.method = "DELETE", .target = path})

static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

static const char absent[] =
    "there is no toy of this name; GET /v1/toys lists those that there are";

/* --- tests ------------------------------------------------------------------------------------ */

static void toys_are_put_listed_and_deleted_like_meshes(void **state)
{
    (void)state;
    assert_int_equal(PUT("/v1/toys/b", "42"), 201);
    assert_int_equal(PUT("/v1/toys/b", "42"), 200);
    assert_int_equal(PUT("/v1/toys/a?unit=cm", "7"), 201);
    assert_string_equal(GET("/v1/toys/b"),
                        "200 {\"name\":\"b\",\"number\":42,\"options\":\"unit=m\"}");
    assert_string_equal(
        GET("/v1/toys?limit=1"),
        "200 {\"toys\":[{\"name\":\"a\",\"number\":7,\"options\":\"unit=cm\"}],\"next\":\"a\"}");
    assert_string_equal(
        GET("/v1/toys?after=a"),
        "200 {\"toys\":[{\"name\":\"b\",\"number\":42,\"options\":\"unit=m\"}],\"next\":null}");
    assert_int_equal(PUT("/v1/toys/b", "43"), 200); /* replaced */
    assert_string_equal(GET("/v1/toys/b/double"), "200 86");
    assert_int_equal(DELETE("/v1/toys/b"), 204);
    assert_int_equal(DELETE("/v1/toys/b"), 404);
    assert_non_null(strstr(GET("/v1/toys/b/double"), absent));
    assert_int_equal(
        daemon_status((struct daemon_request){.method = "HEAD", .target = "/v1/toys/a"}), 200);
    assert_int_equal(
        daemon_status((struct daemon_request){.method = "HEAD", .target = "/v1/toys/b"}), 404);
}

static void other_files_are_refused(void **state)
{
    (void)state;
    assert_int_equal(PUT("/v1/toys/a", "forty-two"), 422);
    assert_int_equal(PUT("/v1/toys/a?unit=mile", "42"), 400);
    assert_int_equal(PUT("/v1/toys/a?weld=1", "42"), 400); /* only meshes have this option */
    assert_int_equal(PUT("/v1/toys/.a", "42"), 400);
    assert_non_null(strstr(GET("/v1/toys/a"), absent));
}

static void each_kind_has_its_own_names(void **state)
{
    (void)state;
    assert_int_equal(PUT("/v1/toys/same", "1"), 201);
    assert_int_equal(PUT("/v1/meshes/same", triangle), 201);
    assert_non_null(strstr(GET("/v1/meshes"), "\"faces\":1"));
    assert_null(strstr(GET("/v1/meshes"), "\"number\""));
    assert_string_equal(
        GET("/v1/toys"),
        "200 {\"toys\":[{\"name\":\"same\",\"number\":1,\"options\":\"unit=m\"}],\"next\":null}");
    assert_int_equal(DELETE("/v1/meshes/same"), 204);
    assert_string_equal(GET("/v1/toys/same/double"), "200 2");
    assert_int_equal(PUT("/v1/meshes/same", "1"), 422);
}

static void a_name_can_be_made_from_the_content(void **state)
{
    (void)state;
    struct server_exchange *exchange =
        daemon_ask((struct daemon_request){.method = "POST", .target = "/v1/toys", .body = "5"});
    assert_int_equal(exchange->response.status, 201);
    const char *location = daemon_header(exchange, "Location");
    assert_non_null(location);
    assert_int_equal(strncmp(location, "/v1/toys/", 9), 0);
    assert_non_null(strstr(GET(location), "\"number\":5"));
    server_exchange_destroy(exchange);
}

static void conditions_hold_for_toys(void **state)
{
    (void)state;
    const struct daemon_request put = {
        .method = "PUT", .target = "/v1/toys/a", .headers = "If-None-Match: *", .body = "1"};
    assert_int_equal(daemon_status(put), 201);
    const char *refusal = daemon_answer(put);
    assert_int_equal(strncmp(refusal, "412", 3), 0);
    assert_non_null(strstr(refusal, "the toy is not in the state"));
    struct server_key key = {.tenant = "", .kind = &toy_kind, .name = "a"};
    struct server_listed listed;
    char same[SERVER_ETAG + 32], only[SERVER_ETAG + 32];
    assert_true(server_registry_find(daemon_server.api.registry, &key, &listed));
    snprintf(same, sizeof same, "If-None-Match: \"%s\"", listed.record->etag);
    snprintf(only, sizeof only, "If-Match: \"%s\"", listed.record->etag);
    server_listed_release(&listed);
    assert_int_equal(daemon_status((struct daemon_request){
                         .method = "GET", .target = "/v1/toys/a", .headers = same}),
                     304);
    assert_int_equal(daemon_status((struct daemon_request){.method = "DELETE",
                                                           .target = "/v1/toys/a",
                                                           .headers = "If-Match: \"other\""}),
                     412);
    assert_int_equal(daemon_status((struct daemon_request){
                         .method = "DELETE", .target = "/v1/toys/a", .headers = only}),
                     204);
}

static bool check_is_fine(void)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    bool is_fine = server_store_check(folder, out);
    fclose(out);
    if (!is_fine) print_message("%s", text);
    free(text);
    return is_fine;
}

static void toys_survive_a_restart(void **state)
{
    (void)state;
    PUT("/v1/toys/a?unit=cm", "21");
    PUT("/v1/meshes/z", triangle);
    restart(); /* the keys' texts, z and toy+a, sort differently than the keys */
    assert_string_equal(GET("/v1/toys/a"),
                        "200 {\"name\":\"a\",\"number\":21,\"options\":\"unit=cm\"}");
    assert_int_equal(living, 0); /* a description does not load a toy */
    assert_string_equal(GET("/v1/toys/a/double"), "200 42");
    assert_int_equal(living, 1);
    assert_int_equal(PUT("/v1/toys/a?unit=cm", "21"), 200);
    assert_int_equal(DELETE("/v1/toys/a"), 204);
    daemon_stop();
    assert_true(check_is_fine());
    start();
    assert_non_null(strstr(GET("/v1/toys/a"), absent));
    assert_non_null(strstr(GET("/v1/meshes/z"), "\"faces\":1"));
}

static void lose(const char *pattern)
{
    char path[2 * FOLDER_PATH];
    snprintf(path, sizeof path, "%s/%s", folder, pattern);
    assert_int_equal(remove(path), 0);
}

static void a_lost_database_or_manifest_is_made_again(void **state)
{
    (void)state;
    PUT("/v1/toys/a", "21");
    PUT("/v1/meshes/a", triangle);
    daemon_stop();
    lose("geodesicd.db");
    start();
    assert_string_equal(GET("/v1/toys/a/double"), "200 42");
    daemon_stop();
    lose("manifests/toy+a.manifest");
    start();
    assert_string_equal(GET("/v1/toys/a/double"), "200 42");
    daemon_stop();
    assert_true(check_is_fine());
    start();
}

/* A tenant can't distinguish a surface of another tenant from one that does not exist. */
static void tenants_can_not_see_each_other(void **state)
{
    (void)state;
    const struct daemon_request put = {
        .tenant = "a", .method = "PUT", .target = "/v1/toys/it", .body = "1"};
    struct daemon_request of_b = put,
                          get = {.tenant = "a", .method = "GET", .target = "/v1/toys/it"};
    of_b.tenant = "b";
    assert_int_equal(daemon_status(put), 201);
    get.tenant = "b";
    char *foreign = strdup(daemon_answer(get));
    get.target = "/v1/toys/none";
    assert_string_equal(foreign, daemon_answer(get));
    free(foreign);
    assert_string_equal(ASK(.tenant = "b", .method = "GET", .target = "/v1/toys"),
                        "200 {\"toys\":[],\"next\":null}");
    assert_string_equal(GET("/v1/toys"), "200 {\"toys\":[],\"next\":null}");
    assert_int_equal(daemon_status((struct daemon_request){
                         .tenant = "b", .method = "DELETE", .target = "/v1/toys/it"}),
                     404);
    assert_int_equal(daemon_status(of_b), 201); /* the surface was created, not replaced */
    restart();
    get = (struct daemon_request){.tenant = "a", .method = "GET", .target = "/v1/toys/it/double"};
    assert_string_equal(daemon_answer(get), "200 2");
    assert_int_equal(daemon_status((struct daemon_request){
                         .tenant = "a", .method = "DELETE", .target = "/v1/toys/it"}),
                     204);
    get.tenant = "b";
    assert_string_equal(daemon_answer(get), "200 2");
    daemon_stop();
    assert_true(check_is_fine());
    start();
}

static void texts_of_keys(void **state)
{
    (void)state;
    static const char *const good[] = {"a", "toy+a", "acme@a", "acme@toy+a", "a.c-_9"};
    static const char *const wrong[] = {
        "",     "@a",    "+a",    "a+",    "a@",   ".a",  "a b",    "toy+.a",
        ".t@a", "a+b+c", "a@b@c", "a+b@c", "../a", "a/b", "a@../b", "word-that-is-too-long+a"};
    for (size_t i = 0; i < COUNT(good); i++)
        assert_true(server_key_check(good[i], strlen(good[i])));
    for (size_t i = 0; i < COUNT(wrong); i++)
        if (server_key_check(wrong[i], strlen(wrong[i])))
            fail_msg("'%s' is taken for a key", wrong[i]);
    char text[SERVER_KEY_TEXT], most[PROTO_MESH_NAME + 1];
    memset(most, 'n', PROTO_MESH_NAME);
    most[PROTO_MESH_NAME] = '\0';
    server_key_write(&(struct server_key){.tenant = "acme", .kind = &toy_kind, .name = most}, text);
    assert_int_equal(strlen(text), strlen("acme@toy+") + PROTO_MESH_NAME);
    assert_true(server_key_check(text, strlen(text)));
    assert_false(server_tenant_check(""));
    assert_false(server_tenant_check("a@b"));
    assert_false(server_tenant_check(most));
    assert_true(server_tenant_check("acme"));
}

static void keys_are_sorted_by_tenant_kind_and_name(void **state)
{
    (void)state;
    const struct server_key keys[] = {{"", &server_kind_mesh, "a"}, {"", &server_kind_mesh, "b"},
                                      {"", &toy_kind, "a"},         {"a", &server_kind_mesh, "z"},
                                      {"a", &toy_kind, "a"},        {"b", &server_kind_mesh, "a"}};
    for (size_t i = 0; i < COUNT(keys); i++)
        for (size_t j = 0; j < COUNT(keys); j++) {
            int order = server_key_compare(&keys[i], &keys[j]);
            assert_true(i < j ? order < 0 : i > j ? order > 0 : order == 0);
        }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(toys_are_put_listed_and_deleted_like_meshes),
        TEST(other_files_are_refused),
        TEST(each_kind_has_its_own_names),
        TEST(a_name_can_be_made_from_the_content),
        TEST(conditions_hold_for_toys),
        TEST(toys_survive_a_restart),
        TEST(a_lost_database_or_manifest_is_made_again),
        TEST(tenants_can_not_see_each_other),
        cmocka_unit_test(texts_of_keys),
        cmocka_unit_test(keys_are_sorted_by_tenant_kind_and_name),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
