/* Budget: the bytes that meshes, fields, work in flight and what is kept between works may hold
 * together.
 *
 *     if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, bytes)) -> 507
 *     ...
 *     server_budget_give(budget, SERVER_BUDGET_FLIGHT, bytes);
 *
 * DESIGN. One atomic total, one atomic count a class. A take that would pass the limit asks one
 * reclaimer after the other to let go of enough: for idle workspaces, for landmarks, for
 * discretizations, for meshes that are stored and not in use and have no fields, for fields, for
 * any mesh that is stored and not in use. Reclaimers take locks of their own: so no lock is held
 * around a take; a give never calls out and is allowed anywhere. All functions are thread-safe. */
#ifndef SERVER_WORK_BUDGET_H
#define SERVER_WORK_BUDGET_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "proto/problem.h"
#include "proto/writer.h"

enum server_budget_class {
    SERVER_BUDGET_MESHES,
    SERVER_BUDGET_FIELDS,
    SERVER_BUDGET_FLIGHT,
    /* texts of answers, from their first byte on until the last one is sent: never reclaimed */
    SERVER_BUDGET_ANSWERS,
    SERVER_BUDGET_RECORDS,    /* what is remembered of surfaces and jobs: never reclaimed */
    SERVER_BUDGET_WORKSPACES, /* idle ones */
    SERVER_BUDGET_LANDMARKS,
    SERVER_BUDGET_DISCRETIZATIONS, /* kept ones */
    SERVER_BUDGET_JOBS,            /* answers that are kept for jobs: never reclaimed */
    /* set aside for the memory of released fields: never reclaimed */
    SERVER_BUDGET_SPARE,
    SERVER_BUDGET_CLASSES
};

enum server_reclaim_turn {
    SERVER_RECLAIM_WORKSPACES,
    SERVER_RECLAIM_LANDMARKS,
    SERVER_RECLAIM_DISCRETIZATIONS,
    SERVER_RECLAIM_IDLE,
    SERVER_RECLAIM_FIELDS,
    SERVER_RECLAIM_MESHES,
    SERVER_RECLAIM_TURNS
};

struct server_reclaimer {
    /* lets go of at least `bytes` if it can; NULL: there is none */
    void (*reclaim)(void *user, size_t bytes);
    /* bytes of SERVER_BUDGET_MESHES that it could let go of; may be NULL */
    size_t (*holds)(void *user);
    void *user;
};

/* Parts of the budget that answers leave to others, all of them together; and when only small ones
 * are added. */
#define SERVER_BUDGET_ANSWERS_PART       2
#define SERVER_BUDGET_SMALL_ANSWERS_PART 4

struct server_budget {
    size_t limit;
    size_t largest_answer;               /* bytes */
    struct proto_writer_account answers; /* takes from SERVER_BUDGET_ANSWERS */
    atomic_size_t total;
    atomic_size_t used[SERVER_BUDGET_CLASSES];
    struct server_reclaimer reclaimers[SERVER_RECLAIM_TURNS]; /* set while nothing takes */
};

void server_budget_init(struct server_budget *budget, size_t limit);

/* Counts `bytes` to the class; false, with nothing counted, when the limit would be passed even
 * after reclaiming. */
bool server_budget_take(struct server_budget *budget, enum server_budget_class class, size_t bytes);

/* The same without letting go of anything. */
bool server_budget_take_spare(struct server_budget *budget, enum server_budget_class class,
                              size_t bytes);

/* Takes for an answer: false also when all answers together would pass their part of the budget, so
 * that clients that do not read what they asked for leave the rest of it to others. */
bool server_budget_take_answer(struct server_budget *budget, size_t bytes);

/* Gives back what was taken. */
void server_budget_give(struct server_budget *budget, enum server_budget_class class, size_t bytes);

/* Moves bytes that are taken already from one class to another. */
void server_budget_move(struct server_budget *budget, enum server_budget_class from,
                        enum server_budget_class to, size_t bytes);

/* Corrects a class that counts `held` bytes for what turned out to hold `actual` ones. More are
 * counted even past the limit, since they are there: later takes make up for it. */
void server_budget_adjust(struct server_budget *budget, enum server_budget_class class, size_t held,
                          size_t actual);

/* What is left if every workspace, every field and all landmarks that are idle were let go of and
 * every unused mesh unloaded: an upper bound of what a take can get at this moment. Walks all
 * meshes. */
size_t server_budget_available(struct server_budget *budget);

/* Is that as much as `bytes`? Walks only when there are fewer without letting go of anything. */
bool server_budget_could_take(struct server_budget *budget, size_t bytes);

/* The problem of `what` ("the mesh") that needs `bytes` (0: more than can be had, not known how
 * many) and can't have them. False. */
bool server_budget_refuse(struct server_budget *budget, const char *what, size_t bytes,
                          struct proto_problem *problem);

#endif
