/* Budget: limits the bytes that meshes, fields, running calls and caches hold together.
 *
 *     if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, bytes)) -> 507
 *     ...
 *     server_budget_give(budget, SERVER_BUDGET_FLIGHT, bytes);
 *
 * DESIGN. The budget has one atomic total, and one atomic count for each class. A call of
 * server_budget_take that would exceed the limit calls the reclaimers in the order of
 * server_reclaim_turn until enough is free. The order begins with the data that is cheapest to
 * compute again. Reclaimers take their own locks, so a caller of server_budget_take must not hold a
 * lock. server_budget_give calls no other part of the daemon. All functions are thread-safe.
 *
 * A client decides how long the body of its request and its unread answer hold memory. So with keys
 * each tenant has a share of this memory (struct server_share), and takes at most as much as it
 * leaves free. Then no tenant can hold all of it. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "proto/json/problem.h"
#include "proto/json/writer.h"

enum server_budget_class {
    SERVER_BUDGET_MESHES,
    SERVER_BUDGET_FIELDS,
    /* memory of running calls, and of their results until a cache counts them */
    SERVER_BUDGET_FLIGHT,
    SERVER_BUDGET_ANSWERS,    /* texts of answers, until their last byte is sent; never reclaimed */
    SERVER_BUDGET_RECORDS,    /* metadata of surfaces and jobs; never reclaimed */
    SERVER_BUDGET_WORKSPACES, /* idle workspaces */
    SERVER_BUDGET_LANDMARKS,
    SERVER_BUDGET_PREVIEWS,
    SERVER_BUDGET_DISCRETIZATIONS, /* cached discretizations */
    SERVER_BUDGET_JOBS,            /* answers stored for jobs; never reclaimed */
    SERVER_BUDGET_SPARE,           /* reserve for the memory of released fields; never reclaimed */
    SERVER_BUDGET_CLASSES
};

/* The order in which reclaimers are called. */
enum server_reclaim_turn {
    SERVER_RECLAIM_WORKSPACES,
    SERVER_RECLAIM_LANDMARKS,
    SERVER_RECLAIM_PREVIEWS,
    SERVER_RECLAIM_DISCRETIZATIONS,
    SERVER_RECLAIM_IDLE,
    SERVER_RECLAIM_FIELDS,
    SERVER_RECLAIM_MESHES,
    SERVER_RECLAIM_TURNS
};

struct server_reclaimer {
    void (*reclaim)(void *user, size_t bytes); /* frees `bytes` or more if possible; may be NULL */
    /* returns the bytes of SERVER_BUDGET_MESHES that the reclaimer could free; may be NULL */
    size_t (*holds)(void *user);
    void *user;
};

/* Answers leave 1/2 of the budget to the other classes. Small answers leave 1/4. */
#define SERVER_BUDGET_ANSWERS_PART       2
#define SERVER_BUDGET_SMALL_ANSWERS_PART 4

/* A tenant's part of the memory that waits for clients. It outlives the tenant's requests. */
struct server_share {
    struct server_budget *budget;
    struct proto_writer_account account; /* takes answers, for writers */
    bool is_bounded;                     /* false without keys */
    atomic_size_t bodies, answers;       /* bytes that the tenant holds */
};

struct server_budget {
    size_t limit;
    size_t largest_answer;      /* bytes */
    struct server_share common; /* the share of all requests without a key */
    atomic_size_t bodies;       /* part of SERVER_BUDGET_FLIGHT: bodies of requests */
    /* number of takes that failed because the part of answers was full */
    atomic_uint_least64_t refused_answers;
    atomic_size_t total;
    atomic_size_t used[SERVER_BUDGET_CLASSES];
    struct server_reclaimer reclaimers[SERVER_RECLAIM_TURNS]; /* set before the first take */
};

void server_budget_init(struct server_budget *budget, size_t limit);

/* Counts `bytes` in the class. Returns false and counts nothing if even reclaiming does not make
 * enough room. */
bool server_budget_take(struct server_budget *budget, enum server_budget_class class, size_t bytes);

/* Like server_budget_take, but reclaims nothing. */
bool server_budget_take_spare(struct server_budget *budget, enum server_budget_class class,
                              size_t bytes);

void server_budget_give(struct server_budget *budget, enum server_budget_class class, size_t bytes);

/* Moves taken bytes from one class to another. */
void server_budget_move(struct server_budget *budget, enum server_budget_class from,
                        enum server_budget_class to, size_t bytes);

/* Counts `actual` bytes instead of the estimated `held`, even beyond the limit. */
void server_budget_adjust(struct server_budget *budget, enum server_budget_class class, size_t held,
                          size_t actual);

/* server_budget_available returns an upper bound of the bytes that a take can get now, that is, of
 * the free and the reclaimable bytes. O(meshes). server_budget_could_take returns true if this
 * bound is at least `bytes`; O(1) if that many bytes are free. */
size_t server_budget_available(struct server_budget *budget);
bool server_budget_could_take(struct server_budget *budget, size_t bytes);

void server_share_init(struct server_share *share, struct server_budget *budget, bool is_bounded);

/* Returns the size of the largest answer, except streams. A tenant gets at most half of the part of
 * answers. */
size_t server_share_largest_answer(const struct server_share *share);

/* Takes bytes of SERVER_BUDGET_FLIGHT for the body of a request. Returns false and counts nothing
 * if the budget or the tenant's share has no room. server_share_admits_body checks only the
 * share. */
bool server_share_take_body(struct server_share *share, size_t bytes);
void server_share_give_body(struct server_share *share, size_t bytes);
bool server_share_admits_body(struct server_share *share, size_t bytes);

/* Takes bytes for an answer, or moves them from SERVER_BUDGET_FLIGHT to SERVER_BUDGET_ANSWERS.
 * Returns false and changes nothing if the answers of all clients or of the tenant would exceed
 * their part. */
bool server_share_take_answer(struct server_share *share, size_t bytes);
bool server_share_move_to_answers(struct server_share *share, size_t bytes);
void server_share_give_answer(struct server_share *share, size_t bytes);

/* Counts the text of a dropped job, which clients may still read, as an answer, even beyond the
 * share. */
void server_share_adopt_job(struct server_share *share, size_t bytes);

/* Counts `bytes` as an answer, even beyond the limit. */
void server_share_count_answer(struct server_share *share, size_t bytes);

/* Sets the problem insufficient_memory. Its text says how many bytes `what` ("the mesh") needs; 0
 * means that the number is unknown. Returns false. */
bool server_budget_refuse(struct server_budget *budget, const char *what, size_t bytes,
                          struct proto_problem *problem);
