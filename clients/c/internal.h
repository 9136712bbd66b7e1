/* What the client's sources share. */
#ifndef GEODESICD_INTERNAL_H
#define GEODESICD_INTERNAL_H

#include "geodesicd.h"

#include <curl/curl.h>

struct gdc_client {
    CURL *curl;
    char *url, *socket_path; /* socket_path: NULL but for unix:PATH */
    char *authorization;     /* a header line; NULL: none */
    unsigned retries;
    long timeout_s;
    gdc_progress progress;
    void *user;
};

/* Fills in a problem of the client's own. Returns the status. */
enum gdc_status gdc__fail(struct gdc_problem *problem, enum gdc_status status, const char *format,
                          ...) __attribute__((format(printf, 3, 4)));

/* One request with its retries; `is_job`: as a job, of which the answer is 202. */
enum gdc_status gdc__exchange(struct gdc_client *client, const struct gdc_request *request,
                              int is_job, struct gdc_answer *answer, struct gdc_problem *problem);

/* Waits for the job that an answer of 202 tells of (freed), and gets what came of it. */
enum gdc_status gdc__await_job(struct gdc_client *client, struct gdc_answer *accepted,
                               struct gdc_answer *answer, struct gdc_problem *problem);

/* The JSON of an answer, whose body is freed; the caller's to json_decref. */
enum gdc_status gdc__read_json(struct gdc_answer *answer, json_t **json,
                               struct gdc_problem *problem);

/* "/v1/meshes/{mesh}" and what follows it, the name encoded; the caller's to free(). NULL without
 * memory. */
char *gdc__mesh_path(struct gdc_client *client, const char *mesh, const char *rest);

#endif
