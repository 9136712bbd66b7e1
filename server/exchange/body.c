/* See body.h. */
#include "server/exchange/body.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/gzip.h"

#define FIRST_CAPACITY 4096

static bool refuse_size(const struct server_body *body, struct proto_problem *problem)
{
    proto_problem_set(
        problem, PROTO_PROBLEM_TOO_LARGE,
        "the request body is larger than the %llu bytes allowed here; send a smaller one",
        (unsigned long long)body->limit);
    return proto_problem_limit(problem, body->limit);
}

static bool refuse_memory(struct server_budget *budget, uint64_t bytes,
                          struct proto_problem *problem)
{
    return server_budget_refuse(budget, "the request body", (size_t)bytes, problem);
}

bool server_body_prepare(struct server_body *body, struct server_budget *budget, uint64_t declared,
                         uint64_t limit, struct proto_problem *problem)
{
    body->declared = declared;
    body->limit = limit;
    if (declared == SERVER_BODY_CHUNKED) return true;
    if (declared > limit) return refuse_size(body, problem);
    if (!server_budget_could_take(budget, (size_t)declared))
        return refuse_memory(budget, declared, problem);
    return true;
}

static void drop_inflater(struct server_body *body, struct server_budget *budget)
{
    if (!body->inflater) return;
    server_inflater_destroy(body->inflater);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, SERVER_INFLATE_BYTES);
    body->inflater = NULL;
}

/* Doubles, so that copying stays linear, but never past what was declared. Memory is held for what
 * arrived, not for what was promised. */
static size_t next_capacity(const struct server_body *body, size_t needed)
{
    size_t capacity = body->capacity ? 2 * body->capacity : FIRST_CAPACITY;
    if (capacity < needed) capacity = needed;
    if (body->declared >= needed && capacity > body->declared) capacity = (size_t)body->declared;
    return capacity;
}

static bool body_grow(struct server_body *body, struct server_budget *budget, size_t needed)
{
    if (needed <= body->capacity) return true;
    size_t capacity = next_capacity(body, needed), more = capacity - body->capacity;
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, more)) return false;
    char *bytes = realloc(body->bytes, capacity);
    if (!bytes) {
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, more);
        return false;
    }
    body->bytes = bytes;
    body->capacity = capacity;
    return true;
}

static void body_fail(struct server_body *body, struct server_budget *budget,
                      enum proto_problem_code failure)
{
    server_body_drop(body, budget);
    body->failure = failure;
}

/* Appends what was sent, or unpacked. */
static void body_append(struct server_body *body, struct server_budget *budget, const void *bytes,
                        size_t size)
{
    if (size > body->limit - body->size) {
        body_fail(body, budget, PROTO_PROBLEM_TOO_LARGE);
    } else if (!body_grow(body, budget, body->size + size)) {
        body->refused = body->size + size;
        body_fail(body, budget, PROTO_PROBLEM_INSUFFICIENT_MEMORY);
    } else {
        memcpy(body->bytes + body->size, bytes, size);
        body->size += size;
    }
}

struct unpacking {
    struct server_body *body;
    struct server_budget *budget;
};

static bool append_unpacked(void *user, const void *bytes, size_t size)
{
    const struct unpacking *unpacking = user;
    body_append(unpacking->body, unpacking->budget, bytes, size);
    return !unpacking->body->failure;
}

static void body_unpack(struct server_body *body, struct server_budget *budget, const void *bytes,
                        size_t size)
{
    struct unpacking unpacking = {body, budget};
    switch (server_inflate(body->inflater, bytes, size, append_unpacked, &unpacking)) {
    case SERVER_INFLATE_OK:
    case SERVER_INFLATE_STOPPED:
        break;
    case SERVER_INFLATE_DAMAGED:
        body_fail(body, budget, PROTO_PROBLEM_INVALID_REQUEST);
        body->fault = "the request body is not what Content-Encoding: gzip says, or is damaged";
        break;
    case SERVER_INFLATE_RATIO_PASSED:
        body_fail(body, budget, PROTO_PROBLEM_TOO_LARGE);
        body->fault = "the request body unpacks to so many times its size that it is taken for an "
                      "attack; send it unpacked";
        break;
    }
}

void server_body_append(struct server_body *body, struct server_budget *budget, const void *bytes,
                        size_t size)
{
    if (body->failure) return;
    if (body->inflater)
        body_unpack(body, budget, bytes, size);
    else
        body_append(body, budget, bytes, size);
}

bool server_body_unpack(struct server_body *body, struct server_budget *budget,
                        struct proto_problem *problem)
{
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, SERVER_INFLATE_BYTES))
        return refuse_memory(budget, SERVER_INFLATE_BYTES, problem);
    body->inflater = server_inflater_create();
    if (body->inflater) return true;
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, SERVER_INFLATE_BYTES);
    return refuse_memory(budget, SERVER_INFLATE_BYTES, problem);
}

bool server_body_check(struct server_body *body, struct server_budget *budget,
                       struct proto_problem *problem)
{
    bool is_cut = !body->failure && body->inflater && !server_inflater_is_whole(body->inflater);
    drop_inflater(body, budget);
    if (is_cut)
        return proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST,
                                 "the packed request body is cut short");
    if (body->fault) return proto_problem_set(problem, body->failure, "%s", body->fault);
    switch (body->failure) {
    case PROTO_PROBLEM_NONE:
        return true;
    case PROTO_PROBLEM_TOO_LARGE:
        return refuse_size(body, problem);
    default:
        return refuse_memory(budget, body->refused, problem);
    }
}

void server_body_drop(struct server_body *body, struct server_budget *budget)
{
    drop_inflater(body, budget);
    free(body->bytes);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, body->capacity);
    body->bytes = NULL;
    body->size = body->capacity = 0;
}
