/* Problem: the reason why a request failed, in the form of RFC 9457. One list defines code, HTTP
 * status and title.
 *
 * Every fallible function of this folder returns true, or false with a problem filled in; its other
 * outputs are then untouched. proto_problem_set and its variants return false, so that a caller can
 * return their result:
 *
 *     if (count == 0) return proto_problem_refuse(problem, "/points", "name at least one point");
 *
 * A place locates the fault in the request: a JSON Pointer ("" or "/from/vertex") into the body, or
 * the name of a query-string parameter ("from"). A pointer is empty or begins with a slash; a
 * parameter's name does neither. */
#pragma once

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
    enum proto_problem_code code; /* PROTO_PROBLEM_NONE means none */
    unsigned status;              /* HTTP status of the code */
    char detail[PROTO_PROBLEM_DETAIL];
    bool has_pointer; /* the place is a pointer; the pointer "" is the whole body */
    char pointer[PROTO_PROBLEM_POINTER];
    char parameter[PROTO_PROBLEM_PARAMETER]; /* empty means none */
    /* static string, such as a gd_status_name; may be NULL */
    const char *reason;
    bool has_limit;
    uint64_t limit; /* the configured maximum that was exceeded */
    /* kind of the elements; GD_ELEMENT_NONE means none */
    enum gd_element element;
    uint32_t element_count;                   /* number of listed elements */
    uint64_t elements[GD_DETAIL_ELEMENTS][2]; /* only edges use [1] */
    /* value of the Allow header; empty means none. Not in the body */
    char allow[PROTO_PROBLEM_ALLOW];
    /* seconds, for the Retry-After header; 0 means none. Not in the body */
    unsigned retry_after;
    /* static value of the WWW-Authenticate header; may be NULL. Not in the body */
    const char *challenge;
};

/* Overwrites `problem` with a problem of that code. The sentence should say what the client must
 * change; it is truncated at PROTO_PROBLEM_DETAIL. Returns false. */
bool proto_problem_set(struct proto_problem *problem, enum proto_problem_code code,
                       const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Like proto_problem_set with INVALID_REQUEST, but also sets the place (see above), which is
 * copied. Returns false. */
bool proto_problem_refuse(struct proto_problem *problem, const char *place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Like proto_problem_refuse, but the fault is at a member of the object at `place`. */
bool proto_problem_refuse_member(struct proto_problem *problem, const char *place,
                                 const char *member, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Like proto_problem_set with TOO_LARGE, but also sets the exceeded maximum and the place (may be
 * NULL). Returns false. */
bool proto_problem_exceed(struct proto_problem *problem, const char *place, uint64_t limit,
                          const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Sets the place: a JSON Pointer or a parameter's name (see above), copied and truncated at the
 * size of its buffer. Returns false. */
bool proto_problem_at(struct proto_problem *problem, const char *place);

/* Extends the pointer by a member of the value that it points at. `member` is escaped (RFC 6901)
 * and truncated when the buffer is full. A parameter's place stays unchanged. Returns false. */
bool proto_problem_descend(struct proto_problem *problem, const char *member);

/* Adds the configured maximum that was exceeded. Returns false. */
bool proto_problem_limit(struct proto_problem *problem, uint64_t limit);

/* Converts an engine failure into a problem; `detail` (may be NULL) gives sentence and elements.
 * Data statuses become invalid_mesh with the status' name as reason. GD_CANCELLED becomes draining,
 * because the daemon cancels a client's work only when it drains. A caller that cancels for another
 * reason sets its own problem. The problem of a failed self-check does not contain the engine's
 * text. `status` is not GD_OK. Returns false. */
bool proto_problem_from_status(struct proto_problem *problem, enum gd_status status,
                               const struct gd_detail *detail);

/* Returns the name of the code ("invalid_request"), a static string; for PROTO_PROBLEM_NONE
 * "none". */
const char *proto_problem_name(enum proto_problem_code code);

struct proto_writer;

/* Writes the problem as one JSON value (media type application/problem+json). */
void proto_problem_encode(struct proto_writer *writer, const struct proto_problem *problem);

/* Returns true if the writer has not failed, otherwise false with the problem. The problem is
 * insufficient_memory if there is no memory, no room in the account (retry_after is then set), or
 * more text than the maximum, which becomes the problem's limit. It is `cancelled` if the sink
 * stopped the writer. */
bool proto_writer_check(const struct proto_writer *writer, struct proto_problem *problem);
