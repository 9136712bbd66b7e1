/* Tests derived meshes. A handler of the test makes up to three meshes. Each mesh has the numbers
 * of its vertices as an attachment. */
#include "tests/unit/server/daemon.h"
#include "tests/unit/server/folder.h"

#include "server/query/surface_resource.h"
#include "server/query/handlers.h"
#include "server/query/request.h"
#include "server/store/store.h"

/* The meshes that the next request makes. */
static struct {
    const char *names[3];
    uint32_t count;
    bool is_flat;        /* makes a degenerate triangle */
    bool has_attachment; /* attaches one byte for each vertex */
} order;

static const double irrational[3][3] = {
    {0.1, 1.0 / 3, 1e-17}, {1e6 + 1.0 / 7, 0, 0}, {0, 1e6 + 1.0 / 9, 1e-300}};
static const unsigned char numbers[3] = {7, 0, 9};

/* --- the handler ------------------------------------------------------------------------------ */

static void free_making(void *state)
{
    server_derived_meshes_free(state);
    free(state);
}

static bool add_all(struct server_derived_meshes *making, struct proto_problem *problem)
{
    double flat[3][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, positions[3][3];
    uint32_t corners[3] = {0, 1, 2};
    memcpy(positions, order.is_flat ? flat : (double(*)[3])irrational, sizeof positions);
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 3, .polygon_count = 1, .corners = corners};
    for (uint32_t i = 0; i < order.count; i++) {
        struct server_attachment attachment;
        if (order.has_attachment) {
            if (!server_attachment_create(&attachment, sizeof numbers,
                                          making->exchange->host->budget, problem))
                return false;
            memcpy(attachment.bytes, numbers, sizeof numbers);
        }
        const struct server_derived_source source = {
            .polygons = &polygons, .attachment = order.has_attachment ? &attachment : NULL};
        if (!server_derived_meshes_add(making, order.names[i], &source, problem)) return false;
        positions[0][2] += 1; /* makes the next mesh different */
    }
    return true;
}

static bool store(struct server_exchange *exchange)
{
    struct server_derived_meshes *making = exchange->state;
    struct proto_writer writer;
    enum server_outcome outcome = server_derived_meshes_store(making);
    if (outcome != SERVER_STORE_CREATED && outcome != SERVER_STORE_REPLACED) {
        server_request_fail(exchange, outcome);
        return true;
    }
    proto_writer_init(&writer, SERVER_DESCRIPTION_MOST);
    proto_write_array_begin(&writer);
    for (uint32_t i = 0; i < making->count; i++) {
        struct server_surface *surface = making->list[i].surface;
        server_surface_resource_describe(&writer,
                                         &(struct server_listed){surface->record, surface});
    }
    proto_write_array_end(&writer);
    server_reply_json(exchange, outcome == SERVER_STORE_CREATED ? 201 : 200, &writer);
    return true;
}

static bool compute(struct server_exchange *exchange)
{
    struct proto_problem problem;
    if (add_all(exchange->state, &problem)) return server_request_write(exchange, store);
    server_reply_problem(exchange, &problem);
    return true;
}

static void handle_make(struct server_exchange *exchange)
{
    struct server_derived_meshes *making = calloc(1, sizeof *making);
    making->exchange = exchange;
    server_exchange_keep(exchange, making, free_making);
    server_exchange_defer(exchange, compute, NULL);
}

/* Loads a mesh and replies with its attachment as an array of numbers. If the mesh has no
 * attachment, the array is empty. */
static void handle_attachment(struct server_exchange *exchange)
{
    struct server_surface *surface = server_request_surface(exchange);
    struct proto_writer writer;
    if (!surface) return;
    proto_writer_init(&writer, SERVER_DESCRIPTION_MOST);
    proto_write_array_begin(&writer);
    for (size_t i = 0; surface->attachment && i < surface->record->attachment_size; i++)
        proto_write_uint(&writer, ((unsigned char *)surface->attachment)[i]);
    proto_write_array_end(&writer);
    server_reply_json(exchange, 200, &writer);
}

const struct proto_route proto_routes[] = {
    {.method = PROTO_METHOD_GET,
     .path = "/v1/meshes/{name}",
     .segment_count = 3,
     .segments = {"v1", "meshes", NULL},
     .handle = server_handle_get_surface},
    {.method = PROTO_METHOD_DELETE,
     .path = "/v1/meshes/{name}",
     .segment_count = 3,
     .segments = {"v1", "meshes", NULL},
     .handle = server_handle_delete_surface},
    {.method = PROTO_METHOD_GET,
     .path = "/v1/meshes/{name}/attachment",
     .segment_count = 4,
     .segments = {"v1", "meshes", NULL, "attachment"},
     .handle = handle_attachment},
    {.method = PROTO_METHOD_GET,
     .path = "/v1/make",
     .segment_count = 2,
     .segments = {"v1", "make"},
     .handle = handle_make},
};
const size_t proto_route_count = COUNT(proto_routes);

/* --- a daemon with a folder ------------------------------------------------------------------- */

static char folder[FOLDER_PATH];
static enum server_outcome (*put)(struct server_store *store, const struct server_record *record,
                                  const struct server_content *content, uint64_t *version);
static int puts_left; /* number of writes before a write fails */

static enum server_outcome put_or_fail(struct server_store *store,
                                       const struct server_record *record,
                                       const struct server_content *content, uint64_t *version)
{
    return puts_left-- > 0 ? put(store, record, content, version) : SERVER_STORE_FULL;
}

static void start(void)
{
    char error[SERVER_ERROR] = "";
    struct server_store *local = server_store_local_open(folder, error);
    if (!local) fail_msg("%s", error);
    put = local->put;
    local->put = put_or_fail;
    puts_left = 1000;
    daemon_start(local);
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
    folder_remove(folder);
    return 0;
}

#define GET(path) daemon_answer((struct daemon_request){.method = "GET", .target = path})
#define MAKE(...)                                                                                  \
    (memcpy(&order, &(__typeof__(order)){__VA_ARGS__}, sizeof order),                              \
     daemon_answer((struct daemon_request){.method = "GET", .target = "/v1/make"}))

static bool begins(const char *text, const char *beginning)
{
    return strncmp(text, beginning, strlen(beginning)) == 0;
}

static unsigned stored(const char *pattern)
{
    char command[2 * FOLDER_PATH];
    unsigned count = 0;
    snprintf(command, sizeof command, "find '%s/%s' -type f | wc -l", folder, pattern);
    FILE *pipe = popen(command, "re");
    assert_int_equal(fscanf(pipe, "%u", &count), 1);
    pclose(pipe);
    return count;
}

static void made_meshes_are_unchanged_after_a_restart(void **state)
{
    (void)state;
    assert_true(begins(MAKE(.names = {"a", "b"}, .count = 2, .has_attachment = true),
                       "201 [{\"name\":\"a\""));
    assert_string_equal(GET("/v1/meshes/a/attachment"), "200 [7,0,9]");
    char *before = strdup(GET("/v1/meshes/b"));
    daemon_stop();
    start();
    assert_string_equal(GET("/v1/meshes/b"), before); /* reads the stored description */
    assert_string_equal(GET("/v1/meshes/b/attachment"), "200 [7,0,9]");
    assert_string_equal(GET("/v1/meshes/b"), before); /* reads the description of the loaded mesh */
    free(before);
    const struct server_key key = mesh_key("a");
    struct server_listed listed;
    assert_string_equal(GET("/v1/meshes/a/attachment"), "200 [7,0,9]");
    assert_true(server_registry_find(daemon_server.api.registry, &key, &listed));
    for (uint32_t i = 0; i < 3; i++) {
        struct gd_vec3 position = gd_mesh_position(listed.surface->mesh, (struct gd_vertex){i});
        assert_memory_equal(&position, irrational[i], sizeof position);
    }
    server_listed_release(&listed);
}

static void an_equal_mesh_changes_nothing(void **state)
{
    (void)state;
    assert_true(begins(MAKE(.names = {"a"}, .count = 1, .has_attachment = true), "201"));
    char *before = strdup(GET("/v1/meshes/a"));
    assert_true(begins(MAKE(.names = {"a"}, .count = 1, .has_attachment = true), "200"));
    assert_string_equal(GET("/v1/meshes/a"), before);
    assert_int_equal(stored("objects"), 2);
    /* without its attachment the mesh is another surface */
    assert_true(begins(MAKE(.names = {"a"}, .count = 1), "200"));
    assert_string_not_equal(GET("/v1/meshes/a"), before);
    assert_string_equal(GET("/v1/meshes/a/attachment"), "200 []");
    assert_int_equal(stored("objects"), 1);
    free(before);
}

static void an_attachment_is_deleted_with_its_last_mesh(void **state)
{
    (void)state;
    MAKE(.names = {"a", "b", "c"}, .count = 3, .has_attachment = true);
    assert_int_equal(stored("objects"), 4); /* the store has three files and one attachment */
    for (char name = 'a'; name <= 'c'; name++) {
        char target[] = "/v1/meshes/ ";
        target[11] = name;
        assert_int_equal(
            daemon_status((struct daemon_request){.method = "DELETE", .target = target}), 204);
    }
    assert_int_equal(stored("objects"), 0);
}

static void if_one_mesh_fails_none_is_stored(void **state)
{
    (void)state;
    assert_non_null(strstr(MAKE(.names = {"a", "a"}, .count = 2), "name each one differently"));
    assert_true(begins(MAKE(.names = {"a", ".b"}, .count = 2), "400"));
    assert_true(begins(MAKE(.names = {"a"}, .count = 1, .is_flat = true), "422"));
    puts_left = 2;
    assert_true(begins(MAKE(.names = {"a", "b", "c"}, .count = 3, .has_attachment = true), "507"));
    assert_true(begins(GET("/v1/meshes/a"), "404"));
    assert_true(begins(GET("/v1/meshes/b"), "404"));
    assert_int_equal(stored("objects"), 0);
    assert_int_equal(stored("manifests"), 0);
}

static void lack_of_memory_is_reported(void **state)
{
    (void)state;
    daemon_server.budget.limit = daemon_server.budget.total + 100;
    assert_true(begins(MAKE(.names = {"a"}, .count = 1, .has_attachment = true), "507"));
    daemon_server.budget.limit = 64 << 20;
    assert_true(begins(MAKE(.names = {"a"}, .count = 1, .has_attachment = true), "201"));
}

static void a_damaged_attachment_is_never_returned(void **state)
{
    (void)state;
    char command[2 * FOLDER_PATH];
    MAKE(.names = {"a"}, .count = 1, .has_attachment = true);
    daemon_stop();
    snprintf(command, sizeof command,
             "find '%s/objects' -type f -size -4c -exec sh -c 'printf x > \"$1\"' - {} ';'",
             folder);
    assert_int_equal(system(command), 0);
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    assert_false(server_store_check(folder, out));
    fclose(out);
    assert_non_null(
        strstr(text, "fault: the surface's attachment is damaged or can't be read: a\n"));
    free(text);
    start();
    assert_true(begins(GET("/v1/meshes/a/attachment"), "500"));
    assert_true(begins(MAKE(.names = {"a"}, .count = 1, .has_attachment = true), "200"));
    assert_string_equal(GET("/v1/meshes/a/attachment"), "200 [7,0,9]");
}

static void a_backup_contains_attachments(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    char original[FOLDER_PATH], copy[FOLDER_PATH];
    MAKE(.names = {"a", "b"}, .count = 2, .has_attachment = true);
    strcpy(original, folder);
    folder_make(copy);
    assert_true(server_store_backup(folder, copy, out));
    daemon_stop();
    strcpy(folder, copy);
    start();
    assert_string_equal(GET("/v1/meshes/b/attachment"), "200 [7,0,9]");
    assert_int_equal(stored("objects"), 3);
    fclose(out);
    free(text);
    folder_remove(original);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(made_meshes_are_unchanged_after_a_restart),
        TEST(an_equal_mesh_changes_nothing),
        TEST(an_attachment_is_deleted_with_its_last_mesh),
        TEST(if_one_mesh_fails_none_is_stored),
        TEST(lack_of_memory_is_reported),
        TEST(a_damaged_attachment_is_never_returned),
        TEST(a_backup_contains_attachments),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
