/* The C client against a daemon: the scenario of all clients, and what it adds to the contract.
 * scenario URL SCENARIO.json [busy] Prints what is not as expected; the status is 1 then. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "clients/c/geodesicd.h"

static int failures;

#define EXPECT(condition) expect(condition, #condition, __LINE__)
static void expect(int holds, const char *what, int line)
{
    failures += !holds;
    if (!holds) printf("line %d: not so: %s\n", line, what);
}

/* --- the scenario ----------------------------------------------------------------------------- */

/* The answer has all that is expected. */
static int has(const json_t *answer, const json_t *expected)
{
    const char *name;
    json_t *value;
    size_t i;
    int all = 1;
    if (json_is_real(expected))
        return fabs(json_number_value(answer) - json_real_value(expected)) <=
               1e-12 * fabs(json_real_value(expected));
    if (json_is_number(expected)) return json_number_value(answer) == json_number_value(expected);
    if (json_is_object(expected)) {
        json_object_foreach((json_t *)expected, name, value) all &=
            has(json_object_get(answer, name), value);
        return all;
    }
    if (!json_is_array(expected)) return json_equal(answer, expected);
    json_array_foreach(expected, i, value) all &= has(json_array_get(answer, i), value);
    return all && json_array_size(answer) == json_array_size(expected);
}

static enum gdc_status describe(struct gdc_client *client, const char *mesh, json_t **out,
                                struct gdc_problem *problem)
{
    char path[128];
    struct gdc_answer answer;
    snprintf(path, sizeof path, "/v1/meshes/%s", mesh);
    enum gdc_status status =
        gdc_call(client, &(struct gdc_request){.method = "GET", .path = path}, &answer, problem);
    if (status) return status;
    *out = json_loadb(answer.body, answer.size, 0, NULL);
    free(answer.body);
    return GDC_OK;
}

static enum gdc_status do_step(struct gdc_client *client, const json_t *step, json_t **answer,
                               struct gdc_problem *problem)
{
    const char *upload = json_string_value(json_object_get(step, "upload")),
               *file = json_string_value(json_object_get(step, "file")),
               *remove = json_string_value(json_object_get(step, "delete")),
               *query = json_string_value(json_object_get(step, "query"));
    if (remove) return gdc_delete(client, remove, problem);
    if (!upload)
        return gdc_query(client, "scenario", query, json_object_get(step, "body"), answer, problem);
    enum gdc_status status = gdc_upload(client, upload, file, strlen(file), problem);
    return status ? status : describe(client, upload, answer, problem);
}

static int is_problem(const struct gdc_problem *problem, const json_t *expected)
{
    const char *code = json_string_value(json_object_get(expected, "code")),
               *pointer = json_string_value(json_object_get(expected, "pointer"));
    return strcmp(problem->code, code) == 0 &&
           problem->status == json_integer_value(json_object_get(expected, "status")) &&
           (!pointer || strcmp(problem->pointer, pointer) == 0) && *problem->detail;
}

static void run_scenario(struct gdc_client *client, const char *path)
{
    json_t *scenario = json_load_file(path, 0, NULL), *step;
    size_t i;
    EXPECT(json_array_size(json_object_get(scenario, "steps")) > 10);
    json_array_foreach(json_object_get(scenario, "steps"), i, step)
    {
        struct gdc_problem problem = {0};
        json_t *answer = NULL, *refusal = json_object_get(step, "problem"),
               *expected = json_object_get(step, "expect");
        enum gdc_status status = do_step(client, step, &answer, &problem);
        int is_right = refusal ? status == GDC_PROBLEM && is_problem(&problem, refusal)
                               : status == GDC_OK && (!expected || has(answer, expected));
        if (!is_right) printf("step %zu: %s\n", i, status ? problem.detail : "another answer");
        failures += !is_right;
        json_decref(answer);
    }
    json_decref(scenario);
}

/* --- the functions for meshes ----------------------------------------------------------------- */

static const char square[] =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 1 3 4\nf 5 6 7\n";

static int tell(void *user, double progress)
{
    double *last = user;
    EXPECT(progress >= *last && progress <= 1);
    *last = progress;
    return 0;
}

static int refuse(void *user, double progress)
{
    (void)user, (void)progress;
    return 1;
}

static void run_queries(struct gdc_client *client)
{
    struct gdc_problem problem = {0};
    struct gdc_path path;
    double distance, *values, last = 0;
    size_t count;
    const struct gdc_point ends[] = {gdc_vertex(2), gdc_edge(1, 2, 1), gdc_face(0, 0, 0, 1),
                                     gdc_near(1, 1, 0)};
    EXPECT(gdc_upload(client, "a-square", square, sizeof square - 1, &problem) == GDC_OK);
    for (int i = 0; i < 4; i++) {
        EXPECT(gdc_distance(client, "a-square", gdc_vertex(0), ends[i], &distance, &problem) ==
               GDC_OK);
        EXPECT(fabs(distance - sqrt(2)) < 1e-12);
    }
    EXPECT(gdc_distance(client, "a-square", gdc_vertex(0), gdc_vertex(4), &distance, &problem) ==
           GDC_NO_PATH);
    EXPECT(gdc_shortest_path(client, "a-square", gdc_vertex(0), gdc_vertex(4), &path, NULL) ==
           GDC_NO_PATH);
    EXPECT(gdc_shortest_path(client, "a-square", gdc_vertex(0), gdc_vertex(1), &path, &problem) ==
           GDC_OK);
    EXPECT(path.length == 1 && path.count == 2 && path.xyz[0] == 0 && path.xyz[3] == 1);
    free(path.xyz);
    gdc_client_set_progress(client, tell, &last);
    EXPECT(gdc_field(client, "a-square", (struct gdc_point[]){gdc_vertex(0), gdc_vertex(1)}, 2,
                     &values, &count, &problem) == GDC_OK);
    EXPECT(last == 1 && count == 7 && values[0] == 0 && values[2] == 1 && values[3] == 1 &&
           isnan(values[4]));
    free(values);
    gdc_client_set_progress(client, refuse, NULL);
    EXPECT(gdc_upload(client, "another", square, sizeof square - 1, &problem) == GDC_CANCELLED);
    gdc_client_set_progress(client, NULL, NULL);
    EXPECT(gdc_upload_file(client, "another", "/there/is/none", &problem) == GDC_FILE &&
           strstr(problem.detail, "none"));
    EXPECT(gdc_distance(client, "a-square", gdc_vertex(0), gdc_near(NAN, 0, 0), &distance,
                        &problem) != GDC_OK);
    static const char three_faces[] =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    json_t *page;
    EXPECT(gdc_upload(client, "a-fan", three_faces, sizeof three_faces - 1, &problem) ==
               GDC_PROBLEM &&
           problem.status == 422);
    EXPECT(gdc_upload_split(client, "a-fan", three_faces, sizeof three_faces - 1, &problem) ==
           GDC_OK);
    EXPECT(gdc_list(client, "a-f", NULL, &page, &problem) == GDC_OK);
    EXPECT(json_array_size(json_object_get(page, "meshes")) == 1);
    json_decref(page);
    EXPECT(gdc_delete(client, "a-fan", &problem) == GDC_OK);
    EXPECT(gdc_delete(client, "a-square", &problem) == GDC_OK);
    EXPECT(gdc_delete(client, "a-square", &problem) == GDC_PROBLEM && problem.status == 404);
}

/* --- batches ---------------------------------------------------------------------------------- */

static const char *text_of(const json_t *object, const char *name)
{
    return json_string_value(json_object_get(object, name));
}

/* Follows the answers of a batch; returns how many there are when it has ended. */
static size_t follow_batch(struct gdc_client *client, const char *id)
{
    size_t count = 0;
    json_t *page, *last = NULL;
    do {
        EXPECT(gdc_batch_next(client, id, last ? text_of(last, "next") : NULL, &page, NULL) ==
               GDC_OK);
        count += json_array_size(json_object_get(page, "results"));
        json_decref(last);
        last = page;
    } while (text_of(page, "next"));
    EXPECT(strcmp(text_of(page, "state"), "done") == 0);
    json_decref(page);
    return count;
}

/* How many items have been answered; each of them has to be a problem. */
static size_t count_refused(struct gdc_client *client, const char *id)
{
    size_t count = 0, i;
    json_t *page, *item, *last = NULL;
    do {
        EXPECT(gdc_batch_results(client, id, last ? text_of(last, "next") : NULL, &page, NULL) ==
               GDC_OK);
        json_array_foreach(json_object_get(page, "results"), i, item)
            EXPECT(json_integer_value(json_object_get(item, "item")) == (json_int_t)count++ &&
                   json_object_get(item, "problem"));
        json_decref(last);
        last = page;
    } while (text_of(page, "next"));
    json_decref(page);
    return count;
}

/* A batch of a request, which is used up, once it has ended. */
static json_t *run_batch(struct gdc_client *client, json_t *request)
{
    json_t *batch = NULL, *ended = NULL;
    EXPECT(gdc_batch_create(client, request, &batch, NULL) == GDC_OK);
    EXPECT(gdc_batch_wait(client, text_of(batch, "id"), &ended, NULL) == GDC_OK);
    EXPECT(strcmp(text_of(ended, "state"), "done") == 0);
    json_decref(batch);
    json_decref(request);
    return ended;
}

static void end_batch(struct gdc_client *client, json_t *batch)
{
    struct gdc_problem problem = {0};
    json_t *none;
    EXPECT(gdc_batch_delete(client, text_of(batch, "id"), &problem) == GDC_OK);
    EXPECT(gdc_batch_look(client, text_of(batch, "id"), &none, &problem) == GDC_PROBLEM &&
           problem.status == 404);
    json_decref(batch);
}

/* Waits for a job that another client may have begun. */
static void run_job(struct gdc_client *client)
{
    struct gdc_problem problem = {0};
    struct gdc_answer answer;
    const struct gdc_request list = {.method = "GET", .path = "/v1/jobs?limit=1"};
    EXPECT(gdc_job_wait(client, "000000000000000000000000", &answer, &problem) == GDC_PROBLEM &&
           problem.status == 404);
    EXPECT(gdc_call(client, &list, &answer, NULL) == GDC_OK);
    json_t *jobs = json_loads(answer.body, 0, NULL);
    free(answer.body);
    const json_t *job = json_array_get(json_object_get(jobs, "jobs"), 0);
    EXPECT(gdc_job_wait(client, text_of(job, "id"), &answer, NULL) == GDC_OK && answer.size > 0);
    free(answer.body);
    json_decref(jobs);
}

static void run_batches(struct gdc_client *client)
{
    json_t *page, *nobodies = json_array();
    EXPECT(gdc_upload(client, "a-square", square, sizeof square - 1, NULL) == GDC_OK);
    json_t *pairs = run_batch(client, json_pack("{s:s,s:s,s:[i,i]}", "query", "all-pairs", "mesh",
                                                "a-square", "vertices", 0, 1));
    EXPECT(follow_batch(client, text_of(pairs, "id")) == 2);
    EXPECT(gdc_batch_results(client, text_of(pairs, "id"), NULL, &page, NULL) == GDC_OK);
    const json_t *answer =
                     json_object_get(json_array_get(json_object_get(page, "results"), 1), "answer"),
                 *row = json_array_get(json_object_get(answer, "distances"), 0);
    EXPECT(json_number_value(json_array_get(row, 0)) == 1 &&
           json_number_value(json_array_get(row, 1)) == 0);
    json_decref(page);
    end_batch(client, pairs);
    for (int i = 0; i < 150; i++) json_array_append_new(nobodies, json_string("nobody"));
    json_t *many = run_batch(client, json_pack("{s:s,s:o,s:{s:[{s:i}]}}", "query", "fields",
                                               "meshes", nobodies, "set", "points", "vertex", 0));
    EXPECT(count_refused(client, text_of(many, "id")) == 150); /* of more than one page */
    end_batch(client, many);
    EXPECT(gdc_delete(client, "a-square", NULL) == GDC_OK);
}

/* The daemon of this URL turns what comes away, three times, then hangs up. */
static void run_busy(struct gdc_client *client)
{
    struct gdc_problem problem = {0};
    double distance;
    gdc_client_set_retries(client, 2);
    EXPECT(gdc_distance(client, "a", gdc_vertex(0), gdc_vertex(1), &distance, &problem) ==
           GDC_PROBLEM);
    EXPECT(problem.status == 503 && strcmp(problem.code, "overloaded") == 0);
    json_t *batch, *request = json_object();
    /* it hangs up on this one */
    EXPECT(gdc_batch_create(client, request, &batch, &problem) == GDC_NO_CONNECTION);
    json_decref(request);
    struct gdc_client *nobody = gdc_client_create("http://127.0.0.1:1", "key");
    gdc_client_set_retries(nobody, 0);
    EXPECT(gdc_distance(nobody, "a", gdc_vertex(0), gdc_vertex(1), &distance, &problem) ==
           GDC_NO_CONNECTION);
    EXPECT(strstr(problem.detail, "127.0.0.1:1") != NULL);
    gdc_client_destroy(nobody);
}

int main(int count, char **arguments)
{
    if (count < 3) return 2;
    setvbuf(stdout, NULL, _IOLBF, 0);
    struct gdc_client *client = gdc_client_create(arguments[1], NULL);
    if (count > 3) {
        run_busy(client);
    } else {
        run_scenario(client, arguments[2]);
        run_queries(client);
        run_job(client);
        run_batches(client);
    }
    gdc_client_destroy(client);
    return failures > 0;
}
