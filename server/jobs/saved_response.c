/* See kept.h. */
#include "server/jobs/saved_response.h"

#include <stdlib.h>
#include <string.h>

/* What an answer says of other representations of a resource is not true of a kept one. */
static bool is_kept(const char *header)
{
    return strcmp(header, "Vary") != 0;
}

static bool copy_headers(struct server_kept *kept, const struct server_response *response)
{
    size_t size = 0;
    uint32_t count = response->header_count;
    for (uint32_t i = 0; i < count; i++) size += strlen(response->headers[i].value) + 1;
    char *at = kept->values = count ? malloc(size) : NULL;
    if (count && !at) return false;
    for (uint32_t i = 0; i < count; i++) {
        if (!is_kept(response->headers[i].name)) continue;
        strcpy(at, response->headers[i].value);
        kept->headers[kept->answer.header_count++] =
            (struct proto_job_header){response->headers[i].name, at};
        at += strlen(at) + 1;
    }
    return true;
}

bool server_kept_take(struct server_kept *kept, struct server_response *response)
{
    kept->answer = (struct proto_job_answer){.status = response->status,
                                             .media_type = response->media_type,
                                             .body = response->body,
                                             .size = response->body ? response->size : 0,
                                             .headers = kept->headers};
    if (!copy_headers(kept, response)) {
        *kept = (struct server_kept){0};
        return false;
    }
    kept->owned = response->owned;
    response->owned = NULL;
    return true;
}

void server_kept_free(struct server_kept *kept)
{
    free(kept->owned);
    free(kept->values);
    *kept = (struct server_kept){0};
}
