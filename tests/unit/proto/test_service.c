#include "support.h"

#include "proto/http/service.h"

static void describes_the_daemon(void **state)
{
    (void)state;
    static const struct proto_route routes[] = {
        {.operation = "get_path"}, {.query = "path"}, {.query = "nearest"}};
    const struct proto_service service = {
        .version = "1.2.3",
        .limits = {.max_body_bytes = 1,
                   .max_faces = 2,
                   .timeout_ms = 3,
                   .memory_budget_bytes = 4294967296,
                   .max_answer_bytes = 6,
                   .workers = 5},
        .routes = routes,
        .route_count = COUNT(routes),
    };
    struct proto_writer writer = new_writer();
    proto_service_encode(&writer, &service);
    assert_written(
        &writer,
        "{\"version\":\"1.2.3\",\"limits\":{\"max_body_bytes\":1,\"max_faces\":2,\"timeout_ms\":3,"
        "\"memory_budget_bytes\":4294967296,\"max_answer_bytes\":6,\"workers\":5},\"capabilities\":"
        "{\"formats\":[\"obj\",\"ply\",\"stl\","
        "\"off\",\"json\",\"glb\",\"gltf\",\"3mf\"],\"queries\":[\"path\",\"nearest\"]}}");
}

static void assert_health(enum proto_health health, const char *reason, const char *text)
{
    struct proto_writer writer = new_writer();
    proto_health_encode(&writer, health, reason);
    assert_written(&writer, text);
}

static void encodes_health(void **state)
{
    (void)state;
    assert_health(PROTO_HEALTH_OK, NULL, "{\"status\":\"ok\"}");
    assert_health(PROTO_HEALTH_STARTING, NULL, "{\"status\":\"starting\"}");
    assert_health(PROTO_HEALTH_DRAINING, NULL, "{\"status\":\"draining\"}");
    assert_health(PROTO_HEALTH_READ_ONLY, "a \"disk\"",
                  "{\"status\":\"read_only\",\"reason\":\"a \\\"disk\\\"\"}");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(describes_the_daemon),
                                       cmocka_unit_test(encodes_health)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
