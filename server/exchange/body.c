/* The body of a request: see exchange.h. */
#include "server/exchange/exchange.h"

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

static bool refuse_share(struct proto_problem *problem)
{
    proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                      "the bodies of the requests of this tenant hold as much memory as a tenant "
                      "may take for them; send this request again when others have ended");
    problem->retry_after = 1;
    return false;
}

static bool refuse_memory(const struct server_body *body, uint64_t bytes,
                          struct proto_problem *problem)
{
    return server_budget_refuse(body->share->budget, "the request body", (size_t)bytes, problem);
}

bool server_body_prepare(struct server_body *body, struct server_share *share, uint64_t declared,
                         uint64_t limit, struct proto_problem *problem)
{
    body->share = share;
    body->declared = declared;
    body->limit = limit;
    if (declared == SERVER_BODY_CHUNKED) return true;
    if (declared > limit) return refuse_size(body, problem);
    if (!server_share_admits_body(share, (size_t)declared)) return refuse_share(problem);
    return server_budget_could_take(share->budget, (size_t)declared) ||
           refuse_memory(body, declared, problem);
}

static void body_drop_inflater(struct server_body *body)
{
    if (!body->inflater) return;
    server_inflater_destroy(body->inflater);
    server_share_give_body(body->share, SERVER_INFLATE_BYTES);
    body->inflater = NULL;
}

/* Doubles the capacity (so that copying is linear), but not beyond the declared length. A client
 * that only declares a length takes no memory. */
static bool body_grow(struct server_body *body, size_t needed)
{
    size_t capacity = body->capacity ? 2 * body->capacity : FIRST_CAPACITY;
    if (needed <= body->capacity) return true;
    if (capacity < needed) capacity = needed;
    if (body->declared >= needed && capacity > body->declared) capacity = (size_t)body->declared;
    size_t more = capacity - body->capacity;
    if (!server_share_take_body(body->share, more)) return false;
    char *bytes = realloc(body->bytes, capacity);
    if (!bytes) {
        server_share_give_body(body->share, more);
        return false;
    }
    body->bytes = bytes;
    body->capacity = capacity;
    return true;
}

static void body_fail(struct server_body *body, enum proto_problem_code failure, const char *fault)
{
    server_body_drop(body);
    body->failure = failure;
    body->fault = fault;
}

/* Appends bytes, as sent or decompressed. */
static bool body_append(void *user, const void *bytes, size_t size)
{
    struct server_body *body = user;
    if (size > body->limit - body->size) {
        body_fail(body, PROTO_PROBLEM_TOO_LARGE, NULL);
    } else if (!body_grow(body, body->size + size)) {
        body->refused = body->size + size;
        body->is_share_full = !server_share_admits_body(body->share, size);
        body_fail(body, PROTO_PROBLEM_INSUFFICIENT_MEMORY, NULL);
    } else {
        memcpy(body->bytes + body->size, bytes, size);
        body->size += size;
    }
    return !body->failure;
}

void server_body_append(struct server_body *body, const void *bytes, size_t size)
{
    if (body->failure) return;
    if (!body->inflater) {
        (void)body_append(body, bytes, size);
        return;
    }
    switch (server_inflate(body->inflater, bytes, size, body_append, body)) {
    case SERVER_INFLATE_OK:
    case SERVER_INFLATE_STOPPED:
        break;
    case SERVER_INFLATE_DAMAGED:
        body_fail(body, PROTO_PROBLEM_INVALID_REQUEST,
                  "the request body is not gzip, as Content-Encoding says, or is damaged");
        break;
    case SERVER_INFLATE_RATIO_PASSED:
        body_fail(
            body, PROTO_PROBLEM_TOO_LARGE,
            "the request body decompresses to more than 100 times its size; send it uncompressed");
        break;
    }
}

bool server_body_unpack(struct server_body *body, struct proto_problem *problem)
{
    if (!server_share_take_body(body->share, SERVER_INFLATE_BYTES))
        return refuse_memory(body, SERVER_INFLATE_BYTES, problem);
    body->inflater = server_inflater_create();
    if (body->inflater) return true;
    server_share_give_body(body->share, SERVER_INFLATE_BYTES);
    return refuse_memory(body, SERVER_INFLATE_BYTES, problem);
}

bool server_body_check(struct server_body *body, struct proto_problem *problem)
{
    bool is_cut = !body->failure && body->inflater && !server_inflater_is_whole(body->inflater);
    body_drop_inflater(body);
    if (is_cut)
        return proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST,
                                 "the compressed request body ends too early; send all of it");
    if (body->fault) return proto_problem_set(problem, body->failure, "%s", body->fault);
    if (body->failure == PROTO_PROBLEM_TOO_LARGE) return refuse_size(body, problem);
    if (body->is_share_full) return refuse_share(problem);
    return !body->failure || refuse_memory(body, body->refused, problem);
}

void server_body_drop(struct server_body *body)
{
    body_drop_inflater(body);
    free(body->bytes);
    server_share_give_body(body->share, body->capacity);
    body->bytes = NULL;
    body->size = body->capacity = 0;
}
