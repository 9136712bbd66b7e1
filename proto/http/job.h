/* Job: the description of an operation whose answer is stored until the client fetches it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/json/writer.h"

/* X(NAME, name) */
#define PROTO_JOB_STATES(X)                                                                        \
    X(QUEUED, queued)                                                                              \
    X(RUNNING, running)                                                                            \
    X(DONE, done)                                                                                  \
    X(FAILED, failed)                                                                              \
    X(CANCELLED, cancelled)

enum proto_job_state {
#define PROTO_JOB_ENUM(NAME, name) PROTO_JOB_##NAME,
    PROTO_JOB_STATES(PROTO_JOB_ENUM)
#undef PROTO_JOB_ENUM
        PROTO_JOB_STATE_COUNT
};

/* Returns the name of the state ("queued"), a static string. */
const char *proto_job_state_name(enum proto_job_state state);

/* Returns whether the state is final. */
bool proto_job_has_ended(enum proto_job_state state);

struct proto_job_header {
    const char *name, *value;
};

/* The operation's answer. */
struct proto_job_answer {
    unsigned status;
    const char *media_type; /* NULL means no body */
    const char *body;
    size_t size;
    const struct proto_job_header *headers;
    uint32_t header_count;
};

struct proto_job {
    const char *id;
    const char *request; /* "POST /v1/meshes/bunny/matrix" */
    enum proto_job_state state;
    double progress;                       /* [0,1] */
    int64_t created;                       /* seconds since 1970-01-01T00:00:00Z */
    const struct proto_job_answer *answer; /* NULL means that there is no answer, or not yet */
};

/* Detail of a job's description: BRIEF omits the body of its answer; EVENT includes the body of a
 * result but not of a problem. */
enum proto_job_detail { PROTO_JOB_BRIEF, PROTO_JOB_EVENT, PROTO_JOB_FULL };

void proto_job_encode(struct proto_writer *writer, const struct proto_job *job,
                      enum proto_job_detail detail);

/* Writes the description with detail FULL up to the body of its answer; the caller appends the body
 * and then PROTO_JOB_TAIL. Returns false, with nothing written, if the body can't be embedded
 * unchanged. */
bool proto_job_encode_head(struct proto_writer *writer, const struct proto_job *job);
#define PROTO_JOB_TAIL "}"

/* Writes the job as a server-sent event: "done" if the job has ended in any way, otherwise
 * "progress". */
void proto_job_encode_event(struct proto_writer *writer, const struct proto_job *job);

/* The id of the event "done". A client that reconnects sends it back as Last-Event-ID. */
#define PROTO_JOB_LAST_EVENT "done"
