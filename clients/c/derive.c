/* Derives meshes from other meshes: edits, components and previews. */
#include "internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define PREVIEW_WAIT_NS 500000000 /* pause between two requests for a preview */

static enum gdc_status derive(struct gdc_client *client, const char *mesh, json_t *body,
                              struct gdc_problem *problem)
{
    struct gdc_answer answer;
    char *text = body ? json_dumps(body, JSON_COMPACT) : NULL;
    json_decref(body);
    if (!text) return gdc__fail(problem, GDC_NO_MEMORY, "the operations are not JSON");
    enum gdc_status status = gdc_query(client, mesh, "derive", text, &answer, problem);
    free(text);
    if (!status) free(answer.body);
    return status;
}

enum gdc_status gdc_derive(struct gdc_client *client, const char *mesh, const char *name,
                           const char *operations, struct gdc_problem *problem)
{
    json_t *body =
        json_pack("{s:s,s:o}", "mesh", name, "operations", json_loads(operations, 0, NULL));
    return derive(client, mesh, body, problem);
}

enum gdc_status gdc_split(struct gdc_client *client, const char *mesh, const char *name,
                          const char *operations, struct gdc_problem *problem)
{
    json_t *body = json_pack("{s:s,s:b,s:o}", "mesh", name, "split", 1, "operations",
                             json_loads(operations, 0, NULL));
    return derive(client, mesh, body, problem);
}

/* Calls the progress function, if there is one, and returns its result. A nonzero result cancels
 * the request. */
static int report(const struct gdc_client *client, const struct gdc_answer *answer)
{
    json_t *json = json_loadb(answer->body, answer->size, 0, NULL);
    double progress = json_number_value(json_object_get(json, "progress"));
    json_decref(json);
    return client->progress && client->progress(client->user, progress);
}

enum gdc_status gdc_preview(struct gdc_client *client, const char *mesh, unsigned faces,
                            struct gdc_answer *answer, struct gdc_problem *problem)
{
    char rest[64];
    snprintf(rest, sizeof rest, "/preview?format=glb&faces=%u", faces);
    char *path = gdc__mesh_path(client, mesh, rest);
    if (!path) return gdc__fail(problem, GDC_NO_MEMORY, "the system is out of memory");
    const struct gdc_request request = {.method = "GET", .path = path, .accept = "*/*"};
    enum gdc_status status;
    while (!(status = gdc_call(client, &request, answer, problem)) && answer->status == 202) {
        if (report(client, answer)) status = GDC_CANCELLED;
        free(answer->body);
        if (status) break;
        nanosleep(&(struct timespec){.tv_nsec = PREVIEW_WAIT_NS}, NULL);
    }
    free(path);
    return status == GDC_CANCELLED ? gdc__fail(problem, status, "the caller cancelled the wait")
                                   : status;
}
