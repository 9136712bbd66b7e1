#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* pause before the first poll; each further pause is longer by half, up to POLL_MOST */
#define POLL_MS   20
#define POLL_MOST 250

enum state { STATE_ACTIVE, STATE_OVER, STATE_CANCELLED };

struct job {
    char path[96];
    enum state state;
    double progress;
};

static enum gdc_status hear(struct job *job, const struct gdc_answer *answer,
                            struct gdc_problem *problem)
{
    json_t *json = json_loadb(answer->body, answer->size, 0, NULL);
    const char *id = json_string_value(json_object_get(json, "id")),
               *state = json_string_value(json_object_get(json, "state"));
    int is_job = id && state && strlen(id) < 64;
    if (is_job) {
        snprintf(job->path, sizeof job->path, "/v1/jobs/%s", id);
        job->progress = json_number_value(json_object_get(json, "progress"));
        job->state = strcmp(state, "cancelled") == 0                              ? STATE_CANCELLED
                     : strcmp(state, "done") == 0 || strcmp(state, "failed") == 0 ? STATE_OVER
                                                                                  : STATE_ACTIVE;
    }
    json_decref(json);
    return is_job ? GDC_OK : gdc__fail(problem, GDC_BAD_ANSWER, "the answer does not name the job");
}

static enum gdc_status cancel(struct gdc_client *client, const struct job *job,
                              struct gdc_problem *problem)
{
    struct gdc_answer answer;
    if (gdc__exchange(client, &(struct gdc_request){.method = "DELETE", .path = job->path}, 0,
                      &answer, NULL) == GDC_OK)
        free(answer.body);
    return gdc__fail(problem, GDC_CANCELLED, "the job has been cancelled");
}

/* Reads the job's state. Without a progress function it blocks until the job ends or
 * gdc__wait_seconds pass. */
static enum gdc_status look(struct gdc_client *client, struct job *job, struct gdc_problem *problem)
{
    struct gdc_answer answer;
    char path[sizeof job->path + 16];
    snprintf(path, sizeof path, "%s?wait=%d", job->path,
             client->progress ? 0 : gdc__wait_seconds(client));
    const struct gdc_request request = {.method = "GET", .path = path};
    enum gdc_status status = gdc__exchange(client, &request, 0, &answer, problem);
    if (status) return status;
    status = hear(job, &answer, problem);
    free(answer.body);
    return status;
}

static enum gdc_status await(struct gdc_client *client, struct job *job, struct gdc_answer *answer,
                             struct gdc_problem *problem)
{
    enum gdc_status status = GDC_OK;
    for (long ms = POLL_MS; !status; ms = ms * 3 / 2 < POLL_MOST ? ms * 3 / 2 : POLL_MOST) {
        if (client->progress && client->progress(client->user, job->progress))
            return cancel(client, job, problem);
        if (job->state != STATE_ACTIVE) break;
        if (client->progress) nanosleep(&(struct timespec){0, ms * 1000000}, NULL);
        status = look(client, job, problem);
    }
    if (status) return status;
    if (job->state == STATE_CANCELLED)
        return gdc__fail(problem, GDC_CANCELLED, "the job has been cancelled");
    char path[sizeof job->path + 8];
    snprintf(path, sizeof path, "%s/result", job->path);
    return gdc__exchange(client, &(struct gdc_request){.method = "GET", .path = path}, 0, answer,
                         problem);
}

enum gdc_status gdc__await_job(struct gdc_client *client, struct gdc_answer *accepted,
                               struct gdc_answer *answer, struct gdc_problem *problem)
{
    struct job job;
    enum gdc_status status = hear(&job, accepted, problem);
    free(accepted->body);
    return status ? status : await(client, &job, answer, problem);
}

enum gdc_status gdc_job_wait(struct gdc_client *client, const char *id, struct gdc_answer *answer,
                             struct gdc_problem *problem)
{
    struct job job;
    snprintf(job.path, sizeof job.path, "/v1/jobs/%s", id);
    enum gdc_status status = look(client, &job, problem);
    return status ? status : await(client, &job, answer, problem);
}
