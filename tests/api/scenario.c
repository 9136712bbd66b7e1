/* Tests the C client against a daemon: the scenario of all clients, and the client's own
 * functions. Usage: scenario URL SCENARIO.json [busy|silent]. Prints unexpected results; the exit
 * status is then 1. */
#include <jansson.h>
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

/* Returns whether the answer has all expected members with the expected values. */
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

/* Parses the body of an answer, and frees the body. */
static json_t *read_json(struct gdc_answer *answer)
{
    json_t *json = json_loadb(answer->body, answer->size, 0, NULL);
    gdc_free(answer->body);
    return json;
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
    *out = read_json(&answer);
    return GDC_OK;
}

static const char *text_of(const json_t *object, const char *name)
{
    return json_string_value(json_object_get(object, name));
}

/* Returns the numbers of rows with three columns in one array. */
static double *flat(const json_t *rows)
{
    size_t count = 3 * json_array_size(rows);
    double *numbers = malloc((count + 1) * sizeof *numbers);
    for (size_t i = 0; i < count; i++)
        numbers[i] = json_number_value(json_array_get(json_array_get(rows, i / 3), i % 3));
    return numbers;
}

static enum gdc_status upload_arrays(struct gdc_client *client, const char *mesh,
                                     const json_t *arrays, struct gdc_problem *problem)
{
    const json_t *rows = json_object_get(arrays, "faces");
    size_t count = json_array_size(rows);
    double *vertices = flat(json_object_get(arrays, "vertices")), *corners = flat(rows);
    uint32_t *faces = malloc((3 * count + 1) * sizeof *faces);
    for (size_t i = 0; i < 3 * count; i++) faces[i] = (uint32_t)corners[i];
    enum gdc_status status = gdc_upload_arrays(
        client, mesh,
        &(struct gdc_arrays){vertices, json_array_size(json_object_get(arrays, "vertices")), faces,
                             count},
        problem);
    free(vertices);
    free(corners);
    free(faces);
    return status;
}

static enum gdc_status do_upload(struct gdc_client *client, const json_t *step,
                                 struct gdc_problem *problem)
{
    const char *file = text_of(step, "file"), *edit;
    char parameters[128] = "";
    json_t *value;
    if (!file)
        return upload_arrays(client, text_of(step, "upload"), json_object_get(step, "arrays"),
                             problem);
    json_object_foreach(json_object_get(step, "edits"), edit, value)
        snprintf(parameters, sizeof parameters, "%s=%d", edit, (int)json_integer_value(value));
    return gdc_upload_with(client, text_of(step, "upload"), &(struct gdc_file){file, strlen(file)},
                           parameters, problem);
}

/* Runs split. Returns the descriptions of the expected parts. */
static enum gdc_status do_split(struct gdc_client *client, const json_t *step, json_t **answer,
                                struct gdc_problem *problem)
{
    size_t count = json_array_size(json_object_get(step, "expect"));
    char *operations = json_dumps(json_object_get(step, "operations"), 0);
    enum gdc_status status =
        gdc_split(client, "scenario", text_of(step, "split"), operations, problem);
    free(operations);
    *answer = json_array();
    for (size_t i = 1; !status && i <= count; i++) {
        char name[64];
        json_t *part;
        snprintf(name, sizeof name, "%s-%zu", text_of(step, "split"), i);
        status = describe(client, name, &part, problem);
        if (!status) json_array_append_new(*answer, part);
    }
    return status;
}

/* Runs preview. Returns the first four bytes of the preview. */
static enum gdc_status do_preview(struct gdc_client *client, const json_t *step, json_t **answer,
                                  struct gdc_problem *problem)
{
    struct gdc_answer file;
    enum gdc_status status =
        gdc_preview(client, text_of(step, "preview"),
                    (unsigned)json_integer_value(json_object_get(step, "faces")), &file, problem);
    if (status) return status;
    *answer = json_stringn(file.body, 4);
    gdc_free(file.body);
    return GDC_OK;
}

static enum gdc_status query(struct gdc_client *client, const json_t *step, json_t **out,
                             struct gdc_problem *problem)
{
    struct gdc_answer answer;
    char *body = json_dumps(json_object_get(step, "body"), JSON_COMPACT);
    enum gdc_status status =
        gdc_query(client, "scenario", json_string_value(json_object_get(step, "query")), body,
                  &answer, problem);
    free(body);
    if (!status) *out = read_json(&answer);
    return status;
}

/* Returns the numbers as rows of `columns`. */
static json_t *rows_json(const double *numbers, size_t count, size_t columns)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < count; i += columns) {
        json_t *row = json_array();
        for (size_t k = 0; k < columns; k++) json_array_append_new(row, json_real(numbers[i + k]));
        json_array_append_new(rows, row);
    }
    return rows;
}

static size_t read_points(const json_t *vertices, struct gdc_point *points)
{
    size_t i;
    json_t *vertex;
    json_array_foreach(vertices, i, vertex) points[i] =
        gdc_vertex((unsigned)json_integer_value(vertex));
    return json_array_size(vertices);
}

static enum gdc_status do_call(struct gdc_client *client, const json_t *step, json_t **answer,
                               struct gdc_problem *problem)
{
    const char *mesh = json_string_value(json_object_get(step, "mesh"));
    struct gdc_point sources[8], targets[8];
    size_t rows = read_points(json_object_get(step, "sources"), sources), count;
    size_t columns = read_points(json_object_get(step, "targets"), targets);
    double distances[64], *values;
    if (strcmp(text_of(step, "call"), "matrix") == 0) {
        enum gdc_status status = gdc_matrix(
            client, mesh, &(struct gdc_matrix_points){sources, targets, rows, columns, 0},
            distances, problem);
        if (!status) *answer = rows_json(distances, rows * columns, columns);
        return status;
    }
    enum gdc_status status = gdc_field(client, mesh, sources, rows, &values, &count, problem);
    if (status) return status;
    json_t *row = rows_json(values, count, count);
    *answer = json_incref(json_array_get(row, 0));
    json_decref(row);
    gdc_free(values);
    return status;
}

static enum gdc_status do_step(struct gdc_client *client, const json_t *step, json_t **answer,
                               struct gdc_problem *problem)
{
    const char *upload = text_of(step, "upload"), *remove = text_of(step, "delete"),
               *derived = text_of(step, "derive");
    enum gdc_status status;
    if (remove) return gdc_delete(client, remove, problem);
    if (text_of(step, "call")) return do_call(client, step, answer, problem);
    if (text_of(step, "split")) return do_split(client, step, answer, problem);
    if (text_of(step, "preview")) return do_preview(client, step, answer, problem);
    if (text_of(step, "query")) return query(client, step, answer, problem);
    if (upload) {
        status = do_upload(client, step, problem);
    } else {
        char *operations = json_dumps(json_object_get(step, "operations"), 0);
        status = gdc_derive(client, "scenario", derived, operations, problem);
        free(operations);
    }
    return status ? status : describe(client, upload ? upload : derived, answer, problem);
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

/* Queries a ray and a matrix on the mesh `a-square`. */
static void ask_ray_and_matrix(struct gdc_client *client)
{
    struct gdc_problem problem = {0};
    double distance;
    const struct gdc_point hit = gdc_ray((const double[]){1, 1, 5}, (const double[]){0, 0, -1});
    EXPECT(gdc_distance(client, "a-square", gdc_vertex(0), hit, &distance, &problem) == GDC_OK);
    EXPECT(fabs(distance - sqrt(2)) < 1e-12);
    char *text = gdc_point_json(&hit);
    EXPECT(text && strstr(text, "\"ray\""));
    gdc_free(text);
    double table[2];
    struct gdc_matrix_points points = {&hit, (struct gdc_point[]){gdc_vertex(1), gdc_vertex(4)}, 1,
                                       2, 0};
    EXPECT(gdc_matrix(client, "a-square", &points, table, &problem) == GDC_OK);
    EXPECT(table[0] == 1 && isnan(table[1]));
    points.max_distance = 0.5;
    EXPECT(gdc_matrix(client, "a-square", &points, table, &problem) == GDC_OK && isnan(table[0]));
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
    gdc_free(path.xyz);
    ask_ray_and_matrix(client);
    gdc_client_set_progress(client, tell, &last);
    EXPECT(gdc_field(client, "a-square", (struct gdc_point[]){gdc_vertex(0), gdc_vertex(1)}, 2,
                     &values, &count, &problem) == GDC_OK);
    EXPECT(last == 1 && count == 7 && values[0] == 0 && values[2] == 1 && values[3] == 1 &&
           isnan(values[4]));
    gdc_free(values);
    gdc_client_set_progress(client, refuse, NULL);
    EXPECT(gdc_upload(client, "another", square, sizeof square - 1, &problem) == GDC_CANCELLED);
    gdc_client_set_progress(client, NULL, NULL);
    EXPECT(gdc_upload_file(client, "another", "/there/is/none", &problem) == GDC_FILE &&
           strstr(problem.detail, "none"));
    EXPECT(gdc_distance(client, "a-square", gdc_vertex(0), gdc_near(NAN, 0, 0), &distance,
                        &problem) != GDC_OK);
    static const char three_faces[] =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    struct gdc_page page = {0};
    EXPECT(gdc_upload(client, "a-fan", three_faces, sizeof three_faces - 1, &problem) ==
               GDC_PROBLEM &&
           problem.status == 422);
    EXPECT(gdc_upload_split(client, "a-fan", three_faces, sizeof three_faces - 1, &problem) ==
           GDC_OK);
    EXPECT(gdc_list(client, "a-f", &page, &problem) == GDC_OK);
    EXPECT(strstr(page.json, "\"a-fan\"") && !strstr(page.json, "\"a-square\"") && !*page.next);
    gdc_free(page.json);
    EXPECT(gdc_delete(client, "a-fan", &problem) == GDC_OK);
    EXPECT(gdc_delete(client, "a-square", &problem) == GDC_OK);
    EXPECT(gdc_delete(client, "a-square", &problem) == GDC_PROBLEM && problem.status == 404);
}

/* --- batches ---------------------------------------------------------------------------------- */

/* Follows the answers of a batch until the batch has ended. Returns the number of answers. */
static size_t follow_batch(struct gdc_client *client, const char *id)
{
    size_t count = 0;
    struct gdc_page page = {0};
    do {
        EXPECT(gdc_batch_next(client, id, &page, NULL) == GDC_OK);
        json_t *json = json_loads(page.json, 0, NULL);
        count += json_array_size(json_object_get(json, "results"));
        json_decref(json);
    } while (*page.next);
    EXPECT(strstr(page.json, "\"done\"") != NULL);
    gdc_free(page.json);
    return count;
}

/* Returns the number of answered items; asserts that each answer is a problem. */
static size_t count_refused(struct gdc_client *client, const char *id)
{
    size_t count = 0, i;
    struct gdc_page page = {0};
    json_t *item;
    do {
        EXPECT(gdc_batch_results(client, id, &page, NULL) == GDC_OK);
        json_t *json = json_loads(page.json, 0, NULL);
        json_array_foreach(json_object_get(json, "results"), i, item)
            EXPECT(json_integer_value(json_object_get(item, "item")) == (json_int_t)count++ &&
                   json_object_get(item, "problem"));
        json_decref(json);
    } while (*page.next);
    gdc_free(page.json);
    return count;
}

/* Starts a batch by a request, waits until the batch has ended, and returns its description. */
static struct gdc_batch run_batch(struct gdc_client *client, const char *request)
{
    struct gdc_batch batch = {.items = 0}, ended = {.items = 0};
    EXPECT(gdc_batch_create(client, request, &batch, NULL) == GDC_OK);
    EXPECT(gdc_batch_wait(client, batch.id, &ended, NULL) == GDC_OK);
    EXPECT(strcmp(ended.state, "done") == 0 && ended.progress == 1 && ended.items == ended.done);
    return ended;
}

static void end_batch(struct gdc_client *client, const struct gdc_batch *batch)
{
    struct gdc_problem problem = {0};
    struct gdc_batch none;
    EXPECT(gdc_batch_delete(client, batch->id, &problem) == GDC_OK);
    EXPECT(gdc_batch_look(client, batch->id, &none, &problem) == GDC_PROBLEM &&
           problem.status == 404);
}

/* Waits for a job that another client may have started. */
static void run_job(struct gdc_client *client)
{
    struct gdc_problem problem = {0};
    struct gdc_answer answer;
    const struct gdc_request list = {.method = "GET", .path = "/v1/jobs?limit=1"};
    EXPECT(gdc_job_wait(client, "000000000000000000000000", &answer, &problem) == GDC_PROBLEM &&
           problem.status == 404);
    EXPECT(gdc_call(client, &list, &answer, NULL) == GDC_OK);
    json_t *jobs = read_json(&answer);
    const json_t *job = json_array_get(json_object_get(jobs, "jobs"), 0);
    const char *id = json_string_value(json_object_get(job, "id"));
    EXPECT(gdc_job_wait(client, id, &answer, NULL) == GDC_OK && answer.size > 0);
    gdc_free(answer.body);
    json_decref(jobs);
}

static void run_batches(struct gdc_client *client)
{
    static char many[2048] = "{\"query\": \"fields\", \"set\": {\"points\": [\"v:0\"]}, "
                             "\"meshes\": [\"nobody\"";
    struct gdc_page page = {0};
    EXPECT(gdc_upload(client, "a-square", square, sizeof square - 1, NULL) == GDC_OK);
    struct gdc_batch pairs = run_batch(
        client, "{\"query\": \"all-pairs\", \"mesh\": \"a-square\", \"vertices\": [0, 1]}");
    EXPECT(pairs.items == 2 && pairs.failed == 0 && follow_batch(client, pairs.id) == 2);
    EXPECT(gdc_batch_results(client, pairs.id, &page, NULL) == GDC_OK);
    EXPECT(strstr(page.json, "[[1,0]]") != NULL);
    gdc_free(page.json);
    end_batch(client, &pairs);
    for (int i = 1; i < 150; i++) strcat(many, ", \"nobody\"");
    struct gdc_batch refused = run_batch(client, strcat(many, "]}"));
    EXPECT(count_refused(client, refused.id) == 150); /* the answers take more than one page */
    EXPECT(refused.failed == 150);
    end_batch(client, &refused);
    EXPECT(gdc_delete(client, "a-square", NULL) == GDC_OK);
}

/* Reads answers that no daemon sends. */
static void run_odd(struct gdc_client *client)
{
    struct gdc_problem problem = {0};
    struct gdc_path path;
    struct gdc_answer answer;
    double distance;
    EXPECT(gdc_distance(client, "a", gdc_vertex(0), gdc_vertex(1), &distance, &problem) ==
           GDC_PROBLEM); /* Retry-After is a day */
    EXPECT(problem.status == 503);
    EXPECT(gdc_upload(client, "a", "v", 1, &problem) == GDC_BAD_ANSWER); /* a redirection */
    EXPECT(strstr(problem.detail, "302") != NULL);
    EXPECT(gdc_shortest_path(client, "a", gdc_vertex(0), gdc_vertex(1), &path, &problem) ==
           GDC_BAD_ANSWER); /* {} */
    gdc_client_set_timeout(client, 10);
    EXPECT(gdc_job_wait(client, "j", &answer, &problem) == GDC_BAD_ANSWER);
}

/* The daemon of this URL refuses three requests, closes the connection, refuses one more. */
static void run_busy(struct gdc_client *client)
{
    struct gdc_problem problem = {0};
    double distance;
    gdc_client_set_retries(client, 2);
    EXPECT(gdc_distance(client, "a", gdc_vertex(0), gdc_vertex(1), &distance, &problem) ==
           GDC_PROBLEM);
    EXPECT(problem.status == 503 && strcmp(problem.code, "overloaded") == 0);
    struct gdc_batch batch;
    /* the daemon closes the connection on this request, and refuses the next one without
     * Retry-After: both may have created a batch */
    EXPECT(gdc_batch_create(client, "{}", &batch, &problem) == GDC_NO_CONNECTION);
    EXPECT(gdc_batch_create(client, "{}", &batch, &problem) == GDC_PROBLEM);
    run_odd(client);
    struct gdc_client *nobody = gdc_client_create("http://127.0.0.1:1", "key");
    gdc_client_set_retries(nobody, 0);
    EXPECT(gdc_distance(nobody, "a", gdc_vertex(0), gdc_vertex(1), &distance, &problem) ==
           GDC_NO_CONNECTION);
    EXPECT(strstr(problem.detail, "127.0.0.1:1") != NULL);
    gdc_client_destroy(nobody);
}

/* A client of a host that accepts no connection. */
static void run_silent(struct gdc_client *client)
{
    double distance;
    gdc_client_set_retries(client, 0);
    gdc_client_set_timeout(client, 1);
    EXPECT(gdc_distance(client, "a", gdc_vertex(0), gdc_vertex(1), &distance, NULL) ==
           GDC_NO_CONNECTION);
}

int main(int count, char **arguments)
{
    if (count < 3) return 2;
    setvbuf(stdout, NULL, _IOLBF, 0);
    struct gdc_client *client = gdc_client_create(arguments[1], NULL);
    if (count > 3) {
        (strcmp(arguments[3], "busy") == 0 ? run_busy : run_silent)(client);
    } else {
        run_scenario(client, arguments[2]);
        run_queries(client);
        run_job(client);
        run_batches(client);
    }
    gdc_client_destroy(client);
    return failures > 0;
}
