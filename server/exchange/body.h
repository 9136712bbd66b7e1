/* Body: the bytes of a request, collected under a limit and the byte budget. */
#ifndef SERVER_EXCHANGE_BODY_H
#define SERVER_EXCHANGE_BODY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/json/problem.h"
#include "server/work/budget.h"

#define SERVER_BODY_CHUNKED UINT64_MAX

struct server_inflater;

struct server_body {
    struct server_budget *budget; /* set by server_body_prepare */
    char *bytes;                  /* NULL while empty */
    /* `capacity` bytes are taken from the budget (SERVER_BUDGET_FLIGHT) */
    size_t size, capacity;
    uint64_t declared;                /* Content-Length; 0: none; or SERVER_BODY_CHUNKED */
    uint64_t limit;                   /* most bytes that the operation takes */
    size_t refused;                   /* bytes that the budget did not give */
    struct server_inflater *inflater; /* the body comes packed; NULL: it does not */
    const char *fault;                /* why it can't be unpacked, a sentence; NULL: it can */
    /* a limit was passed on the way: the rest is dropped, and the answer is given at its end */
    enum proto_problem_code failure;
};

/* Refuses a declared length that is over the limit or has no chance in the budget. */
bool server_body_prepare(struct server_body *body, struct server_budget *budget, uint64_t declared,
                         uint64_t limit, struct proto_problem *problem);

/* The body comes packed by gzip: its size and limit are those of what it unpacks to. Before the
 * first byte. */
bool server_body_unpack(struct server_body *body, struct proto_problem *problem);

/* Appends bytes. Passing the limit or the budget sets `failure`, and the rest is dropped. */
void server_body_append(struct server_body *body, const void *bytes, size_t size);

/* At the end of the body. False with the problem that `failure` stands for. */
bool server_body_check(struct server_body *body, struct proto_problem *problem);

/* Frees the bytes and gives them back to the budget. */
void server_body_drop(struct server_body *body);

#endif
