#include "support.h"

#include "proto/http/job.h"
#include "proto/http/page.h"

static const struct proto_job_header headers[] = {{"ETag", "\"a\""}, {"Location", "/v1/meshes/a"}};

static const struct proto_job_answer json = {.status = 201,
                                             .media_type = "application/json",
                                             .body = "{\"a\":1}",
                                             .size = 7,
                                             .headers = headers,
                                             .header_count = 2};
static const struct proto_job_answer bytes = {
    .status = 200, .media_type = "application/octet-stream", .body = "\0\1", .size = 2};
static const struct proto_job_answer problem = {
    .status = 404, .media_type = "application/problem+json", .body = "{\"p\":2}", .size = 7};
static const struct proto_job_answer empty = {.status = 204};

#define HEAD(state, progress)                                                                      \
    "{\"id\":\"x\",\"state\":\"" state "\",\"progress\":" progress                                 \
    ",\"created\":\"1970-01-01T00:00:00Z\",\"request\":\"PUT /v1/meshes/a\""
#define JSON_RESPONSE                                                                              \
    ",\"response\":{\"status\":201,\"media_type\":\"application/"                                  \
    "json\",\"bytes\":7,\"headers\":{\"ETag\":\"\\\"a\\\""                                         \
    "\",\"Location\":\"/v1/meshes/a\"}}"

static struct proto_job job_of(enum proto_job_state state, double progress,
                               const struct proto_job_answer *answer)
{
    return (struct proto_job){.id = "x",
                              .request = "PUT /v1/meshes/a",
                              .state = state,
                              .progress = progress,
                              .answer = answer};
}

static void assert_encoded(const struct proto_job *job, enum proto_job_detail detail,
                           const char *expected)
{
    struct proto_writer writer;
    proto_writer_init(&writer, 4096);
    proto_job_encode(&writer, job, detail);
    assert_written(&writer, expected);
}

static void without_an_answer(void **state)
{
    (void)state;
    struct proto_job job = job_of(PROTO_JOB_RUNNING, 0.42, NULL);
    assert_encoded(&job, PROTO_JOB_FULL, HEAD("running", "0.42") "}");
    job = job_of(PROTO_JOB_CANCELLED, 0.5, NULL);
    assert_encoded(&job, PROTO_JOB_EVENT, HEAD("cancelled", "0.5") "}");
}

static void a_result_is_embedded(void **state)
{
    (void)state;
    const struct proto_job job = job_of(PROTO_JOB_DONE, 1, &json);
    assert_encoded(&job, PROTO_JOB_FULL, HEAD("done", "1") JSON_RESPONSE ",\"result\":{\"a\":1}}");
    assert_encoded(&job, PROTO_JOB_EVENT, HEAD("done", "1") JSON_RESPONSE "}");
    assert_encoded(&job, PROTO_JOB_BRIEF, HEAD("done", "1") JSON_RESPONSE "}");
}

static void other_results_are_linked(void **state)
{
    (void)state;
    struct proto_job job = job_of(PROTO_JOB_DONE, 1, &bytes);
    assert_encoded(
        &job, PROTO_JOB_FULL,
        HEAD("done", "1") ",\"response\":{\"status\":200,\"media_type\":\"application/"
                          "octet-stream\",\"bytes\":2,"
                          "\"headers\":{}},\"result\":{\"href\":\"/v1/jobs/x/result\"}}");
    job = job_of(PROTO_JOB_DONE, 1, &empty);
    assert_encoded(
        &job, PROTO_JOB_FULL,
        HEAD("done",
             "1") ",\"response\":{\"status\":204,\"media_type\":null,\"bytes\":0,\"headers\":{}},"
                  "\"result\":null}");
}

static void events_have_the_problem(void **state)
{
    (void)state;
    const struct proto_job job = job_of(PROTO_JOB_FAILED, 0, &problem);
#define FAILED                                                                                     \
    HEAD("failed", "0")                                                                            \
    ",\"response\":{\"status\":404,\"media_type\":\"application/"                                  \
    "problem+json\",\"bytes\":7,\"headers\":{}}"
    assert_encoded(&job, PROTO_JOB_FULL, FAILED ",\"problem\":{\"p\":2}}");
    assert_encoded(&job, PROTO_JOB_EVENT, FAILED ",\"problem\":{\"p\":2}}");
    assert_encoded(&job, PROTO_JOB_BRIEF, FAILED "}");
#undef FAILED
}

static void encodes_lists(void **state)
{
    (void)state;
    const struct proto_job job = job_of(PROTO_JOB_QUEUED, 0, NULL);
    struct proto_writer writer;
    proto_writer_init(&writer, 4096);
    proto_page_begin(&writer, "jobs");
    proto_job_encode(&writer, &job, PROTO_JOB_BRIEF);
    proto_job_encode(&writer, &job, PROTO_JOB_BRIEF);
    proto_page_end(&writer, "x");
    assert_written(&writer,
                   "{\"jobs\":[" HEAD("queued", "0") "}," HEAD("queued", "0") "}],\"next\":\"x\"}");
}

static void encodes_events(void **state)
{
    (void)state;
    struct proto_job job = job_of(PROTO_JOB_RUNNING, 0.5, NULL);
    struct proto_writer writer;
    proto_writer_init(&writer, 4096);
    proto_job_encode_event(&writer, &job);
    job = job_of(PROTO_JOB_CANCELLED, 0.5, NULL);
    proto_job_encode_event(&writer, &job);
    assert_written(
        &writer,
        "event: progress\ndata: " HEAD("running", "0.5") "}\n\nid: done\nevent: done\ndata: " HEAD(
            "cancelled", "0.5") "}\n\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_an_answer),
        cmocka_unit_test(a_result_is_embedded),
        cmocka_unit_test(other_results_are_linked),
        cmocka_unit_test(events_have_the_problem),
        cmocka_unit_test(encodes_lists),
        cmocka_unit_test(encodes_events),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
