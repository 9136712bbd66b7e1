/* Problem: why a request failed, as RFC 9457 tells it. One list, so that code, HTTP status and
 * title can't drift apart.
 *
 * Every fallible function of this folder returns true, or false with a problem filled in; its other
 * outputs are untouched then. proto_problem_set and its kin return false, so that they can stand in
 * a return:
 *
 *     if (count == 0) return proto_problem_refuse(problem, "/points", "name at least one point");
 *
 * A place says where in the request the fault is: a JSON Pointer ("" or "/from/vertex") into the
 * body, or the name of a query-string parameter ("from"). One string serves for both, since a
 * pointer that is not empty begins with a slash and a parameter's name does not. */
#ifndef PROTO_PROBLEM_H
#define PROTO_PROBLEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/status.h"

/* X(HTTP status, NAME, name, title) */
#define PROTO_PROBLEM_MAP(X)                                                                       \
    X(400, INVALID_REQUEST, invalid_request, "Invalid request")                                    \
    X(401, UNAUTHORIZED, unauthorized, "Unauthorized")                                             \
    X(403, FORBIDDEN, forbidden, "Forbidden")                                                      \
    X(404, NOT_FOUND, not_found, "Not found")                                                      \
    X(405, METHOD_NOT_ALLOWED, method_not_allowed, "Method not allowed")                           \
    X(406, NOT_ACCEPTABLE, not_acceptable, "Not acceptable")                                       \
    X(409, CONFLICT, conflict, "Conflict")                                                         \
    X(410, FIELD_EVICTED, field_evicted, "Field evicted")                                          \
    X(411, LENGTH_REQUIRED, length_required, "Length required")                                    \
    X(412, PRECONDITION_FAILED, precondition_failed, "Precondition failed")                        \
    X(413, TOO_LARGE, too_large, "Too large")                                                      \
    X(415, UNSUPPORTED_MEDIA_TYPE, unsupported_media_type, "Unsupported media type")               \
    X(422, INVALID_MESH, invalid_mesh, "Invalid mesh")                                             \
    X(422, POINT_NOT_ON_SURFACE, point_not_on_surface, "Point not on surface")                     \
    X(429, RATE_LIMITED, rate_limited, "Rate limited")                                             \
    X(500, INTERNAL, internal, "Internal error")                                                   \
    X(503, OVERLOADED, overloaded, "Overloaded")                                                   \
    X(503, DRAINING, draining, "Draining")                                                         \
    X(503, STORE_UNAVAILABLE, store_unavailable, "Store unavailable")                              \
    X(504, DEADLINE_EXCEEDED, deadline_exceeded, "Deadline exceeded")                              \
    X(507, INSUFFICIENT_MEMORY, insufficient_memory, "Insufficient memory")                        \
    X(507, INSUFFICIENT_STORAGE, insufficient_storage, "Insufficient storage")

enum proto_problem_code {
    PROTO_PROBLEM_NONE,
#define PROTO_PROBLEM_ENUM(status, NAME, name, title) PROTO_PROBLEM_##NAME,
    PROTO_PROBLEM_MAP(PROTO_PROBLEM_ENUM)
#undef PROTO_PROBLEM_ENUM
};

#define PROTO_PROBLEM_DETAIL    512
#define PROTO_PROBLEM_POINTER   256
#define PROTO_PROBLEM_PARAMETER 64
#define PROTO_PROBLEM_ALLOW     64

struct proto_problem {
    enum proto_problem_code code; /* PROTO_PROBLEM_NONE: no problem */
    unsigned status;              /* HTTP status of the code */
    char detail[PROTO_PROBLEM_DETAIL];
    bool has_pointer; /* "" is a pointer too: the whole body */
    char pointer[PROTO_PROBLEM_POINTER];
    char parameter[PROTO_PROBLEM_PARAMETER]; /* empty: none */
    const char *reason;                      /* static string, e.g. a gd_status_name; NULL: none */
    bool has_limit;
    uint64_t limit;                           /* the configured maximum that was passed */
    enum gd_element element;                  /* what the elements are; GD_ELEMENT_NONE: none */
    uint32_t element_count;                   /* how many are listed */
    uint64_t elements[GD_DETAIL_ELEMENTS][2]; /* [1] is used by edges only */
    /* value of the Allow header; empty: none. Not part of the body */
    char allow[PROTO_PROBLEM_ALLOW];
    /* seconds, for the Retry-After header; 0: none. Not part of the body */
    unsigned retry_after;
    /* static value of the WWW-Authenticate header; NULL: none. Not part of the body */
    const char *challenge;
};

/* Makes `problem` a fresh one of that code with a sentence that tells the person what to change
 * (cut at PROTO_PROBLEM_DETAIL). False. */
bool proto_problem_set(struct proto_problem *problem, enum proto_problem_code code,
                       const char *format, ...) __attribute__((format(printf, 3, 4)));

/* proto_problem_set with INVALID_REQUEST, at a place (copied; see above). False. */
bool proto_problem_refuse(struct proto_problem *problem, const char *place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Says where: a JSON Pointer or a parameter's name (see above), copied and cut at the size of its
 * buffer. False. */
bool proto_problem_at(struct proto_problem *problem, const char *place);

/* Extends the pointer by a member of the value that it points at; `member` is escaped (RFC 6901),
 * cut when the buffer is full. A parameter has no members: nothing happens then. False. */
bool proto_problem_descend(struct proto_problem *problem, const char *member);

/* Adds the configured maximum that was passed. False. */
bool proto_problem_limit(struct proto_problem *problem, uint64_t limit);

/* The problem that an engine's failure is: `detail` (may be NULL) gives sentence and elements. Data
 * statuses become invalid_mesh with the status' name as reason. GD_CANCELLED becomes draining, the
 * only reason for which the daemon cancels a client's work unasked; a caller that cancelled for
 * another reason sets its own problem. What a failed self-check said is not given out. `status` is
 * not GD_OK. False. */
bool proto_problem_from_status(struct proto_problem *problem, enum gd_status status,
                               const struct gd_detail *detail);

/* "invalid_request" and so on; "none" for PROTO_PROBLEM_NONE. Static string. */
const char *proto_problem_name(enum proto_problem_code code);

struct proto_writer;

/* Writes the problem as one JSON value (media type application/problem+json). */
void proto_problem_encode(struct proto_writer *writer, const struct proto_problem *problem);

/* True, or false with the problem. insufficient_memory: out of memory, no room in the account
 * (retry_after is set), or over the maximum, which is the problem's limit then; cancelled: the sink
 * stopped it. */
bool proto_writer_check(const struct proto_writer *writer, struct proto_problem *problem);

#endif
