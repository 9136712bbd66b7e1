#include "support.h"

#include "server/body.h"

#define LIMIT 10000

static struct server_budget budget;
static struct server_body body;
static struct proto_problem problem;

static bool prepare(size_t memory, uint64_t declared)
{
    server_budget_init(&budget, memory);
    body = (struct server_body){0};
    return server_body_prepare(&body, &budget, declared, LIMIT, &problem);
}

static void append_all(size_t size)
{
    char bytes[100];
    for (size_t sent = 0; sent < size; sent += sizeof bytes) {
        memset(bytes, (int)(sent / sizeof bytes), sizeof bytes);
        assert_true(server_body_append(&body, &budget, bytes, size - sent < sizeof bytes ? size - sent : sizeof bytes));
    }
}

static void collects_what_arrives(void **state)
{
    (void)state;
    static const uint64_t declared[] = {9000, SERVER_BODY_CHUNKED};
    for (size_t i = 0; i < COUNT(declared); i++) {
        assert_true(prepare(1 << 20, declared[i]));
        append_all(9000);
        assert_true(server_body_check(&body, &budget, &problem));
        assert_int_equal(body.size, 9000);
        assert_int_equal(body.bytes[8999], 89);
        assert_int_equal(budget.total, body.capacity);
        if (declared[i] == 9000) assert_int_equal(body.capacity, 9000); /* no more than was declared */
        server_body_drop(&body, &budget);
        assert_int_equal(budget.total, 0);
    }
}

static void holds_memory_for_what_arrived_only(void **state)
{
    (void)state;
    assert_true(prepare(1 << 20, LIMIT));
    assert_int_equal(budget.total, 0);
    append_all(100);
    assert_true(budget.total < LIMIT);
    server_body_drop(&body, &budget);
}

static void refuses_a_length_before_it_is_sent(void **state)
{
    (void)state;
    assert_false(prepare(1 << 20, LIMIT + 1));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_int_equal(problem.limit, LIMIT);
    assert_false(prepare(5000, LIMIT));
    assert_int_equal(problem.code, PROTO_PROBLEM_INSUFFICIENT_MEMORY);
    assert_int_equal(problem.limit, 5000);
}

static size_t walk(void *user)
{
    (void)user;
    fail_msg("all meshes were walked, with room for the body");
    return 0;
}

static void a_length_that_finds_room_is_cheap_to_accept(void **state)
{
    (void)state;
    server_budget_init(&budget, LIMIT);
    budget.reclaimers[SERVER_RECLAIM_IDLE] = (struct server_reclaimer){NULL, walk, NULL};
    body = (struct server_body){0};
    assert_true(server_body_prepare(&body, &budget, LIMIT, LIMIT, &problem));
}

static void remembers_that_chunks_passed_the_limit(void **state)
{
    (void)state;
    assert_true(prepare(1 << 20, SERVER_BODY_CHUNKED));
    append_all(LIMIT);
    assert_true(server_body_check(&body, &budget, &problem));
    append_all(1);
    append_all(500);
    assert_int_equal(budget.total, 0);
    assert_false(server_body_check(&body, &budget, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    server_body_drop(&body, &budget);
}

static void remembers_that_chunks_passed_the_budget(void **state)
{
    (void)state;
    assert_true(prepare(6000, SERVER_BODY_CHUNKED));
    append_all(9000);
    assert_int_equal(budget.total, 0);
    assert_false(server_body_check(&body, &budget, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_INSUFFICIENT_MEMORY);
    server_body_drop(&body, &budget);
}

static void drops_a_client_that_trickles(void **state)
{
    (void)state;
    assert_true(prepare(1 << 20, LIMIT));
    body.started_ns -= UINT64_C(29000000000);
    append_all(1); /* anybody may take so long */
    body.started_ns -= UINT64_C(31000000000);
    assert_false(server_body_append(&body, &budget, "x", 1));
    server_body_drop(&body, &budget);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(collects_what_arrives),
        cmocka_unit_test(holds_memory_for_what_arrived_only),
        cmocka_unit_test(refuses_a_length_before_it_is_sent),
        cmocka_unit_test(a_length_that_finds_room_is_cheap_to_accept),
        cmocka_unit_test(remembers_that_chunks_passed_the_limit),
        cmocka_unit_test(remembers_that_chunks_passed_the_budget),
        cmocka_unit_test(drops_a_client_that_trickles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
