#include "tests/unit/server/support.h"

#include <zlib.h>

#include "server/exchange/exchange.h"
#include "server/base/gzip.h"

#define LIMIT 10000

static struct server_budget budget;
static struct server_body body;
static struct proto_problem problem;

static bool prepare(size_t memory, uint64_t declared)
{
    server_budget_init(&budget, memory);
    body = (struct server_body){0};
    return server_body_prepare(&body, &budget.common, declared, LIMIT, &problem);
}

static void append_all(size_t size)
{
    char bytes[100];
    for (size_t sent = 0; sent < size; sent += sizeof bytes) {
        memset(bytes, (int)(sent / sizeof bytes), sizeof bytes);
        server_body_append(&body, bytes, size - sent < sizeof bytes ? size - sent : sizeof bytes);
    }
}

static void collects_pieces(void **state)
{
    (void)state;
    static const uint64_t declared[] = {9000, SERVER_BODY_CHUNKED};
    for (size_t i = 0; i < COUNT(declared); i++) {
        assert_true(prepare(1 << 20, declared[i]));
        append_all(9000);
        assert_true(server_body_check(&body, &problem));
        assert_int_equal(body.size, 9000);
        assert_int_equal(body.bytes[8999], 89);
        assert_int_equal(budget.total, body.capacity);
        /* the capacity does not exceed the declared size */
        if (declared[i] == 9000) assert_int_equal(body.capacity, 9000);
        server_body_drop(&body);
        assert_int_equal(budget.total, 0);
    }
}

static void allocates_for_received_bytes_only(void **state)
{
    (void)state;
    assert_true(prepare(1 << 20, LIMIT));
    assert_int_equal(budget.total, 0);
    append_all(100);
    assert_true(budget.total < LIMIT);
    server_body_drop(&body);
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

static void accepting_a_small_length_walks_no_meshes(void **state)
{
    (void)state;
    server_budget_init(&budget, LIMIT);
    budget.reclaimers[SERVER_RECLAIM_IDLE] = (struct server_reclaimer){NULL, walk, NULL};
    body = (struct server_body){0};
    assert_true(server_body_prepare(&body, &budget.common, LIMIT, LIMIT, &problem));
}

static void remembers_that_chunks_passed_the_limit(void **state)
{
    (void)state;
    assert_true(prepare(1 << 20, SERVER_BODY_CHUNKED));
    append_all(LIMIT);
    assert_true(server_body_check(&body, &problem));
    append_all(1);
    append_all(500);
    assert_int_equal(budget.total, 0);
    assert_false(server_body_check(&body, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    server_body_drop(&body);
}

static void remembers_that_chunks_passed_the_budget(void **state)
{
    (void)state;
    assert_true(prepare(6000, SERVER_BODY_CHUNKED));
    append_all(9000);
    assert_int_equal(budget.total, 0);
    assert_false(server_body_check(&body, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_INSUFFICIENT_MEMORY);
    server_body_drop(&body);
}

/* --- packed bodies ---------------------------------------------------------------------------- */

/* Returns `size` equal bytes in compressed form. The caller frees them. */
static unsigned char *pack(size_t size, size_t *packed_size)
{
    z_stream stream = {0};
    unsigned char *bytes = calloc(1, size), *packed = malloc(size + 1024);
    memset(bytes, 'x', size);
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = bytes;
    stream.avail_in = (uInt)size;
    stream.next_out = packed;
    stream.avail_out = (uInt)size + 1024;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    *packed_size = stream.total_out;
    deflateEnd(&stream);
    free(bytes);
    return packed;
}

/* Sends a compressed body of that size in pieces, without the last `cut` bytes. Returns whether it
 * was accepted. */
static bool send_packed(uint64_t limit, size_t size, size_t piece, size_t cut)
{
    size_t packed_size;
    unsigned char *packed = pack(size, &packed_size);
    server_budget_init(&budget, 64 << 20);
    body = (struct server_body){0};
    assert_true(server_body_prepare(&body, &budget.common, SERVER_BODY_CHUNKED, limit, &problem));
    assert_true(server_body_unpack(&body, &problem));
    assert_int_equal(budget.total, SERVER_INFLATE_BYTES);
    packed_size -= cut;
    for (size_t at = 0; at < packed_size; at += piece)
        server_body_append(&body, packed + at, piece < packed_size - at ? piece : packed_size - at);
    free(packed);
    return server_body_check(&body, &problem);
}

static void decompresses_gzip(void **state)
{
    (void)state;
    static const size_t sizes[] = {0, 1, 16383, 16384, 16385, 32768, 1 << 20},
                        pieces[] = {1, 100, 1 << 20};
    for (size_t i = 0; i < COUNT(sizes); i++) {
        for (size_t j = 0; j < COUNT(pieces); j++) {
            assert_true(send_packed(1 << 20, sizes[i], pieces[j], 0));
            assert_int_equal(body.size, sizes[i]);
            assert_true(!sizes[i] || (body.bytes[0] == 'x' && body.bytes[sizes[i] - 1] == 'x'));
            assert_int_equal(budget.total, body.capacity);
            server_body_drop(&body);
            assert_int_equal(budget.total, 0);
        }
    }
}

static void refuses_damaged_gzip_and_bombs(void **state)
{
    (void)state;
    assert_false(send_packed(1000, 1001, 100, 0));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_int_equal(problem.limit, 1000);
    /* the body expands to a thousand times its size */
    assert_false(send_packed(1 << 30, 10 << 20, 100, 0));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_non_null(strstr(problem.detail, "100 times"));
    for (size_t cut = 1; cut < 20; cut++) {
        assert_false(send_packed(1000, 100, 100, cut));
        assert_int_equal(problem.code, PROTO_PROBLEM_INVALID_REQUEST);
        server_body_drop(&body);
    }
    assert_int_equal(budget.total, 0);
}

static void refuses_bodies_that_are_not_gzip(void **state)
{
    (void)state;
    static const char plain[] = "v 0 0 0";
    assert_true(prepare(1 << 20, SERVER_BODY_CHUNKED) && server_body_unpack(&body, &problem));
    server_body_append(&body, plain, sizeof plain);
    server_body_append(&body, plain, sizeof plain);
    assert_int_equal(budget.total, 0);
    assert_false(server_body_check(&body, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_INVALID_REQUEST);
}

/* Several compressed members form one body. Other bytes after the members are refused. */
static void decompresses_several_members(void **state)
{
    (void)state;
    size_t size;
    unsigned char *packed = pack(100, &size);
    assert_true(prepare(1 << 20, SERVER_BODY_CHUNKED) && server_body_unpack(&body, &problem));
    for (int i = 0; i < 3; i++) server_body_append(&body, packed, size);
    assert_true(server_body_check(&body, &problem));
    assert_int_equal(body.size, 300);
    server_body_drop(&body);
    assert_true(prepare(1 << 20, SERVER_BODY_CHUNKED) && server_body_unpack(&body, &problem));
    server_body_append(&body, packed, size);
    server_body_append(&body, "rubbish", 7);
    assert_false(server_body_check(&body, &problem));
    free(packed);
}

static void decompression_needs_memory(void **state)
{
    (void)state;
    assert_true(prepare(SERVER_INFLATE_BYTES - 1, SERVER_BODY_CHUNKED));
    assert_false(server_body_unpack(&body, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_INSUFFICIENT_MEMORY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(collects_pieces),
        cmocka_unit_test(allocates_for_received_bytes_only),
        cmocka_unit_test(refuses_a_length_before_it_is_sent),
        cmocka_unit_test(accepting_a_small_length_walks_no_meshes),
        cmocka_unit_test(remembers_that_chunks_passed_the_limit),
        cmocka_unit_test(remembers_that_chunks_passed_the_budget),
        cmocka_unit_test(decompresses_gzip),
        cmocka_unit_test(refuses_damaged_gzip_and_bombs),
        cmocka_unit_test(refuses_bodies_that_are_not_gzip),
        cmocka_unit_test(decompresses_several_members),
        cmocka_unit_test(decompression_needs_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
