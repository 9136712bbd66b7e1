/* Declarations that the client's sources share. */
#ifndef GEODESICD_INTERNAL_H
#define GEODESICD_INTERNAL_H

#include "geodesicd.h"

#include <curl/curl.h>
#include <jansson.h>

struct gdc_client {
    CURL *curl;
    char *url, *socket_path; /* `socket_path` is NULL unless the address is unix:PATH */
    char *authorization;     /* a header line, or NULL if there is no key */
    /* nonzero if the daemon is on this machine, where compression takes longer than it saves */
    int is_near;
    unsigned retries;
    long timeout_s;
    gdc_progress progress;
    void *user;
};

/* Fills `problem` with an error that the client detected. Returns `status`. */
enum gdc_status gdc__fail(struct gdc_problem *problem, enum gdc_status status, const char *format,
                          ...) __attribute__((format(printf, 3, 4)));

/* Returns the seconds that one request may wait for a job or batch, so that it does not reach the
 * client's timeout. */
int gdc__wait_seconds(const struct gdc_client *client);

/* Sends a request, with retries. If `is_job`, the request asks the daemon to run it as a job and to
 * answer 202. */
enum gdc_status gdc__exchange(struct gdc_client *client, const struct gdc_request *request,
                              int is_job, struct gdc_answer *answer, struct gdc_problem *problem);

/* Waits for the job of a 202 answer and reads the job's result. Frees the body of `accepted`. */
enum gdc_status gdc__await_job(struct gdc_client *client, struct gdc_answer *accepted,
                               struct gdc_answer *answer, struct gdc_problem *problem);

/* Parses the body of an answer and frees it. The caller releases `*json` with json_decref. */
enum gdc_status gdc__read_json(struct gdc_answer *answer, json_t **json,
                               struct gdc_problem *problem);

/* Reads a page of the list at `path`, which ends with ? or &. Adds `parameter`=page->next to the
 * path unless `next` is empty. */
enum gdc_status gdc__turn(struct gdc_client *client, const char *path, const char *parameter,
                          struct gdc_page *page, struct gdc_problem *problem);

/* Returns "/v1/meshes/{mesh}" followed by `rest`, with the name URL-encoded. The caller frees it
 * with free(). Returns NULL if memory is short. */
char *gdc__mesh_path(struct gdc_client *client, const char *mesh, const char *rest);

#endif
