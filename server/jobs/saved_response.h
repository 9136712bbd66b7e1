/* Kept: an answer that outlives its exchange. */
#ifndef SERVER_JOBS_SAVED_RESPONSE_H
#define SERVER_JOBS_SAVED_RESPONSE_H

#include "proto/job.h"
#include "server/http/exchange.h"

struct server_kept {
    struct proto_job_answer answer; /* its pointers live as long as this struct stays where it is */
    struct proto_job_header headers[SERVER_RESPONSE_HEADERS];
    char *values; /* of the headers */
    /* the body, if it is to be freed; NULL: it outlives the server. Its memory is its keeper's to
     * count */
    void *owned;
};

/* Takes the answer over before it is sealed (reply.h): its body, and those of its headers that are
 * true of it alone. False without memory, with nothing changed; never for an answer without
 * headers. */
bool server_kept_take(struct server_kept *kept, struct server_response *response);
void server_kept_free(struct server_kept *kept); /* what it holds; all zero is harmless */

#endif
