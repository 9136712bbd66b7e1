#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_MOST 256

static enum gdc_status batch_ask(struct gdc_client *client, const struct gdc_request *request,
                                 struct gdc_batch *batch, struct gdc_problem *problem)
{
    struct gdc_answer answer;
    json_t *json;
    const char *id, *state;
    json_int_t items, done, failed;
    double progress;
    enum gdc_status status = gdc_call(client, request, &answer, problem);
    if (!status) status = gdc__read_json(&answer, &json, problem);
    if (status) return status;
    if (json_unpack(json, "{s:s,s:s,s:F,s:I,s:I,s:I}", "id", &id, "state", &state, "progress",
                    &progress, "items", &items, "done", &done, "failed", &failed))
        status = gdc__fail(problem, GDC_BAD_ANSWER, "the answer does not describe the batch");
    if (!status) {
        *batch = (struct gdc_batch){.progress = progress,
                                    .items = (size_t)items,
                                    .done = (size_t)done,
                                    .failed = (size_t)failed};
        snprintf(batch->id, sizeof batch->id, "%s", id);
        snprintf(batch->state, sizeof batch->state, "%s", state);
    }
    json_decref(json);
    return status;
}

enum gdc_status gdc_batch_create(struct gdc_client *client, const char *request,
                                 struct gdc_batch *batch, struct gdc_problem *problem)
{
    const struct gdc_request post = {.method = "POST",
                                     .path = "/v1/batches",
                                     .body = request,
                                     .body_size = strlen(request),
                                     .once = 1};
    return batch_ask(client, &post, batch, problem);
}

enum gdc_status gdc_batch_look(struct gdc_client *client, const char *id, struct gdc_batch *batch,
                               struct gdc_problem *problem)
{
    char path[PATH_MOST];
    snprintf(path, sizeof path, "/v1/batches/%s", id);
    return batch_ask(client, &(struct gdc_request){.method = "GET", .path = path}, batch, problem);
}

enum gdc_status gdc_batch_results(struct gdc_client *client, const char *id, struct gdc_page *page,
                                  struct gdc_problem *problem)
{
    char path[PATH_MOST];
    snprintf(path, sizeof path, "/v1/batches/%s/results?", id);
    return gdc__turn(client, path, "after", page, problem);
}

enum gdc_status gdc_batch_next(struct gdc_client *client, const char *id, struct gdc_page *page,
                               struct gdc_problem *problem)
{
    char path[PATH_MOST];
    snprintf(path, sizeof path, "/v1/batches/%s/results?wait=%d&%s", id, gdc__wait_seconds(client),
             *page->next ? "" : "cursor=0");
    return gdc__turn(client, path, "cursor", page, problem);
}

enum gdc_status gdc_batch_wait(struct gdc_client *client, const char *id, struct gdc_batch *batch,
                               struct gdc_problem *problem)
{
    char path[PATH_MOST];
    struct gdc_batch now;
    snprintf(path, sizeof path, "/v1/batches/%s?wait=%d", id,
             client->progress ? 1 : gdc__wait_seconds(client));
    for (;;) {
        enum gdc_status status =
            batch_ask(client, &(struct gdc_request){.method = "GET", .path = path}, &now, problem);
        if (status) return status;
        int is_stopped = client->progress && client->progress(client->user, now.progress);
        if (strcmp(now.state, "running") != 0) {
            *batch = now;
            return GDC_OK;
        }
        if (is_stopped) return gdc__fail(problem, GDC_CANCELLED, "the batch continues");
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
