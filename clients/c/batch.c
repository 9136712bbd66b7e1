#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_MOST    256
#define WAIT_SECONDS 30 /* of one request */

static enum gdc_status ask(struct gdc_client *client, const char *path, json_t **json,
                           struct gdc_problem *problem)
{
    struct gdc_answer answer;
    enum gdc_status status =
        gdc_call(client, &(struct gdc_request){.method = "GET", .path = path}, &answer, problem);
    return status ? status : gdc__read_json(&answer, json, problem);
}

enum gdc_status gdc_batch_create(struct gdc_client *client, const json_t *request, json_t **batch,
                                 struct gdc_problem *problem)
{
    char *text = json_dumps(request, JSON_COMPACT);
    struct gdc_answer answer;
    if (!text)
        return gdc__fail(problem, GDC_NO_MEMORY,
                         "the request is no JSON, or the system is out of memory");
    enum gdc_status status = gdc_call(client,
                                      &(struct gdc_request){.method = "POST",
                                                            .path = "/v1/batches",
                                                            .body = text,
                                                            .body_size = strlen(text),
                                                            .once = 1},
                                      &answer, problem);
    free(text);
    return status ? status : gdc__read_json(&answer, batch, problem);
}

enum gdc_status gdc_batch_look(struct gdc_client *client, const char *id, json_t **batch,
                               struct gdc_problem *problem)
{
    char path[PATH_MOST];
    snprintf(path, sizeof path, "/v1/batches/%s", id);
    return ask(client, path, batch, problem);
}

enum gdc_status gdc_batch_results(struct gdc_client *client, const char *id, const char *after,
                                  json_t **page, struct gdc_problem *problem)
{
    char path[PATH_MOST];
    snprintf(path, sizeof path, "/v1/batches/%s/results%s%s", id, after ? "?after=" : "",
             after ? after : "");
    return ask(client, path, page, problem);
}

enum gdc_status gdc_batch_next(struct gdc_client *client, const char *id, const char *cursor,
                               json_t **page, struct gdc_problem *problem)
{
    char path[PATH_MOST];
    snprintf(path, sizeof path, "/v1/batches/%s/results?cursor=%s&wait=%d", id,
             cursor ? cursor : "0", WAIT_SECONDS);
    return ask(client, path, page, problem);
}

enum gdc_status gdc_batch_wait(struct gdc_client *client, const char *id, json_t **batch,
                               struct gdc_problem *problem)
{
    char path[PATH_MOST];
    json_t *now;
    snprintf(path, sizeof path, "/v1/batches/%s?wait=%d", id, client->progress ? 1 : WAIT_SECONDS);
    for (;;) {
        enum gdc_status status = ask(client, path, &now, problem);
        if (status) return status;
        double progress = json_number_value(json_object_get(now, "progress"));
        const char *state = json_string_value(json_object_get(now, "state"));
        int is_stopped = client->progress && client->progress(client->user, progress);
        if (!state || strcmp(state, "running") != 0) {
            *batch = now;
            return GDC_OK;
        }
        json_decref(now);
        if (is_stopped) return gdc__fail(problem, GDC_CANCELLED, "the batch goes on");
    }
}

enum gdc_status gdc_batch_delete(struct gdc_client *client, const char *id,
                                 struct gdc_problem *problem)
{
    char path[PATH_MOST];
    struct gdc_answer answer;
    snprintf(path, sizeof path, "/v1/batches/%s", id);
    enum gdc_status status =
        gdc_call(client, &(struct gdc_request){.method = "DELETE", .path = path}, &answer, problem);
    if (!status) free(answer.body);
    return status;
}
