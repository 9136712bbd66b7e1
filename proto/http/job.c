#include "proto/http/job.h"

#include <string.h>

#include "generated/answers.h"

const char *proto_job_state_name(enum proto_job_state state)
{
    static const char *const names[] = {
#define STATE_NAME(NAME, name) [PROTO_JOB_##NAME] = #name,
        PROTO_JOB_STATES(STATE_NAME)
#undef STATE_NAME
    };
    return names[state];
}

bool proto_job_has_ended(enum proto_job_state state)
{
    return state != PROTO_JOB_QUEUED && state != PROTO_JOB_RUNNING;
}

void proto_job_response_encode_headers(struct proto_writer *writer,
                                       const struct proto_job_answer *answer)
{
    proto_write_object_begin(writer);
    for (uint32_t i = 0; i < answer->header_count; i++)
        proto_member_string(writer, answer->headers[i].name, answer->headers[i].value);
    proto_write_object_end(writer);
}

/* Returns whether a body of this media type can be embedded in JSON. */
static bool is_json(const char *media_type)
{
    return media_type && (strcmp(media_type, "application/json") == 0 ||
                          strcmp(media_type, "application/problem+json") == 0);
}

static void encode_link(struct proto_writer *writer, const struct proto_job *job)
{
    proto_write_object_begin(writer);
    proto_write_key(writer, "href");
    proto_append_format(writer, "\"/v1/jobs/%s/result\"", job->id);
    proto_write_object_end(writer);
}

static void encode_body(struct proto_writer *writer, const struct proto_job *job)
{
    const struct proto_job_answer *answer = job->answer;
    proto_write_key(writer, job->state == PROTO_JOB_DONE ? "result" : "problem");
    if (!answer->size)
        proto_write_null(writer);
    else if (is_json(answer->media_type))
        proto_write_raw(writer, answer->body, answer->size);
    else
        encode_link(writer, job);
}

static void encode_state(struct proto_writer *writer, const struct proto_job *job)
{
    proto_write_object_begin(writer);
    proto_member_string(writer, "id", job->id);
    proto_member_string(writer, "state", proto_job_state_name(job->state));
    proto_member_number(writer, "progress", job->progress);
    proto_member_time(writer, "created", job->created);
    proto_member_string(writer, "request", job->request);
    if (!job->answer) return;
    proto_write_key(writer, "response");
    proto_job_response_encode(writer, job->answer);
}

bool proto_job_encode_head(struct proto_writer *writer, const struct proto_job *job)
{
    if (!job->answer || !job->answer->size || !is_json(job->answer->media_type)) return false;
    encode_state(writer, job);
    proto_write_key(writer, job->state == PROTO_JOB_DONE ? "result" : "problem");
    return true;
}

void proto_job_encode(struct proto_writer *writer, const struct proto_job *job,
                      enum proto_job_detail detail)
{
    bool shows_body =
        detail == PROTO_JOB_FULL || (detail == PROTO_JOB_EVENT && job->state == PROTO_JOB_FAILED);
    encode_state(writer, job);
    if (job->answer && shows_body) encode_body(writer, job);
    proto_write_object_end(writer);
}

/* The JSON of this writer has no line breaks, so it is one `data` line. */
void proto_job_encode_event(struct proto_writer *writer, const struct proto_job *job)
{
    bool has_ended = proto_job_has_ended(job->state);
    if (has_ended) proto_append_format(writer, "id: " PROTO_JOB_LAST_EVENT "\n");
    proto_append_format(writer, "event: %s\ndata: ", has_ended ? "done" : "progress");
    writer->comma = false;
    proto_job_encode(writer, job, PROTO_JOB_EVENT);
    proto_append_format(writer, "\n\n");
}
