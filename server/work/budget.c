#include "server/work/budget.h"

#include <assert.h>

#define SMALL_ANSWER ((size_t)64 << 10) /* largest size of a small answer */
#define REMEDY       "delete meshes, or raise --memory-budget"

void server_budget_init(struct server_budget *budget, size_t limit)
{
    *budget = (struct server_budget){.limit = limit,
                                     .largest_answer = limit - limit / SERVER_BUDGET_ANSWERS_PART};
    server_share_init(&budget->common, budget, false);
}

bool server_budget_take_spare(struct server_budget *budget, enum server_budget_class class,
                              size_t bytes)
{
    size_t total = atomic_load_explicit(&budget->total, memory_order_relaxed);
    do {
        if (bytes > budget->limit || total > budget->limit - bytes) return false;
    } while (!atomic_compare_exchange_weak(&budget->total, &total, total + bytes));
    atomic_fetch_add(&budget->used[class], bytes);
    return true;
}

/* Returns the number of bytes that must be reclaimed before `bytes` can be taken. */
static size_t budget_shortage(struct server_budget *budget, size_t bytes)
{
    size_t total = atomic_load(&budget->total);
    size_t left = total < budget->limit ? budget->limit - total : 0;
    return bytes > left ? bytes - left : 0;
}

bool server_budget_could_take(struct server_budget *budget, size_t bytes)
{
    return budget_shortage(budget, bytes) == 0 || bytes <= server_budget_available(budget);
}

bool server_budget_take(struct server_budget *budget, enum server_budget_class class, size_t bytes)
{
    if (server_budget_take_spare(budget, class, bytes)) return true;
    if (bytes > server_budget_available(budget)) return false;
    for (int turn = 0; turn < SERVER_RECLAIM_TURNS; turn++) {
        const struct server_reclaimer *reclaimer = &budget->reclaimers[turn];
        if (!reclaimer->reclaim) continue;
        reclaimer->reclaim(reclaimer->user, budget_shortage(budget, bytes));
        if (server_budget_take_spare(budget, class, bytes)) return true;
    }
    return false;
}

void server_budget_give(struct server_budget *budget, enum server_budget_class class, size_t bytes)
{
    if (!bytes) return; /* saves a write to a shared cache line */
    size_t before = atomic_fetch_sub(&budget->used[class], bytes);
    assert(before >= bytes);
    (void)before;
    atomic_fetch_sub(&budget->total, bytes);
}

void server_budget_move(struct server_budget *budget, enum server_budget_class from,
                        enum server_budget_class to, size_t bytes)
{
    atomic_fetch_add(&budget->used[to], bytes);
    atomic_fetch_sub(&budget->used[from], bytes);
}

size_t server_budget_available(struct server_budget *budget)
{
    static const enum server_budget_class fixed[] = {SERVER_BUDGET_FLIGHT, SERVER_BUDGET_ANSWERS,
                                                     SERVER_BUDGET_RECORDS, SERVER_BUDGET_JOBS,
                                                     SERVER_BUDGET_SPARE};
    size_t unused = 0, held = 0, meshes = atomic_load(&budget->used[SERVER_BUDGET_MESHES]);
    for (int turn = 0; turn < SERVER_RECLAIM_TURNS; turn++) {
        const struct server_reclaimer *reclaimer = &budget->reclaimers[turn];
        if (reclaimer->holds) unused += reclaimer->holds(reclaimer->user);
    }
    if (meshes > unused) held = meshes - unused;
    for (size_t i = 0; i < sizeof fixed / sizeof fixed[0]; i++)
        held += atomic_load(&budget->used[fixed[i]]);
    return held < budget->limit ? budget->limit - held : 0;
}

void server_budget_adjust(struct server_budget *budget, enum server_budget_class class, size_t held,
                          size_t actual)
{
    if (actual <= held) {
        server_budget_give(budget, class, held - actual);
    } else {
        atomic_fetch_add(&budget->total, actual - held);
        atomic_fetch_add(&budget->used[class], actual - held);
    }
}

bool server_budget_refuse(struct server_budget *budget, const char *what, size_t bytes,
                          struct proto_problem *problem)
{
    size_t available = server_budget_available(budget);
    if (bytes)
        proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                          "%s needs about %zu bytes, and %zu of the %zu bytes of the memory budget "
                          "are available; " REMEDY,
                          what, bytes, available, budget->limit);
    else
        proto_problem_set(
            problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
            "%s needs more than the available %zu of the %zu bytes of the memory budget; " REMEDY,
            what, available, budget->limit);
    return proto_problem_limit(problem, budget->limit);
}

/* --- shares ----------------------------------------------------------------------------------- */

static bool account_take(void *share, size_t bytes)
{
    return server_share_take_answer(share, bytes);
}

static void account_give(void *share, size_t bytes)
{
    server_share_give_answer(share, bytes);
}

void server_share_init(struct server_share *share, struct server_budget *budget, bool is_bounded)
{
    size_t answers = budget->limit - budget->limit / SERVER_BUDGET_ANSWERS_PART,
           most = is_bounded ? answers / 2 : answers; /* share_leaves */
    *share = (struct server_share){.budget = budget,
                                   .account = {account_take, account_give, share, most},
                                   .is_bounded = is_bounded};
}

size_t server_share_largest_answer(const struct server_share *share)
{
    size_t largest = share->budget->largest_answer;
    return share->account.most < largest ? share->account.most : largest;
}

/* Returns true if the tenant would then hold at most as much as is free. `own` and `all` are the
 * bytes that the tenant and all tenants hold, of `most`. Concurrent calls may exceed this once. */
static bool share_leaves(const struct server_share *share, size_t own, size_t all, size_t most,
                         size_t bytes)
{
    if (!share->is_bounded) return true;
    return bytes <= most && all <= most - bytes && own + bytes <= most - bytes - all;
}

bool server_share_admits_body(struct server_share *share, size_t bytes)
{
    struct server_budget *budget = share->budget;
    return share_leaves(share, atomic_load(&share->bodies), atomic_load(&budget->bodies),
                        budget->limit, bytes);
}

bool server_share_take_body(struct server_share *share, size_t bytes)
{
    if (!server_share_admits_body(share, bytes) ||
        !server_budget_take(share->budget, SERVER_BUDGET_FLIGHT, bytes))
        return false;
    atomic_fetch_add(&share->bodies, bytes);
    atomic_fetch_add(&share->budget->bodies, bytes);
    return true;
}

void server_share_give_body(struct server_share *share, size_t bytes)
{
    if (!bytes) return;
    atomic_fetch_sub(&share->bodies, bytes);
    atomic_fetch_sub(&share->budget->bodies, bytes);
    server_budget_give(share->budget, SERVER_BUDGET_FLIGHT, bytes);
}

/* Checks that the answers stay within their part of the budget, and within the tenant's share of
 * this part. Each concurrent call may exceed the part once, but never the limit of the budget. */
static bool admits_answer(struct server_share *share, size_t bytes)
{
    struct server_budget *budget = share->budget;
    size_t part =
        bytes > SMALL_ANSWER ? SERVER_BUDGET_ANSWERS_PART : SERVER_BUDGET_SMALL_ANSWERS_PART;
    size_t most = budget->limit - budget->limit / part,
           used = atomic_load(&budget->used[SERVER_BUDGET_ANSWERS]);
    if (bytes <= most && used <= most - bytes)
        return share_leaves(share, atomic_load(&share->answers), used, most, bytes);
    atomic_fetch_add(&budget->refused_answers, 1);
    return false;
}

bool server_share_take_answer(struct server_share *share, size_t bytes)
{
    if (!admits_answer(share, bytes) ||
        !server_budget_take(share->budget, SERVER_BUDGET_ANSWERS, bytes))
        return false;
    atomic_fetch_add(&share->answers, bytes);
    return true;
}

bool server_share_move_to_answers(struct server_share *share, size_t bytes)
{
    if (!admits_answer(share, bytes)) return false;
    server_budget_move(share->budget, SERVER_BUDGET_FLIGHT, SERVER_BUDGET_ANSWERS, bytes);
    atomic_fetch_add(&share->answers, bytes);
    return true;
}

void server_share_give_answer(struct server_share *share, size_t bytes)
{
    if (!bytes) return;
    atomic_fetch_sub(&share->answers, bytes);
    server_budget_give(share->budget, SERVER_BUDGET_ANSWERS, bytes);
}

void server_share_adopt_job(struct server_share *share, size_t bytes)
{
    server_budget_move(share->budget, SERVER_BUDGET_JOBS, SERVER_BUDGET_ANSWERS, bytes);
    atomic_fetch_add(&share->answers, bytes);
}

void server_share_count_answer(struct server_share *share, size_t bytes)
{
    server_budget_adjust(share->budget, SERVER_BUDGET_ANSWERS, 0, bytes);
    atomic_fetch_add(&share->answers, bytes);
}
