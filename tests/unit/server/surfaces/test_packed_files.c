/* Tests compressed ("packed") files: how their memory is counted and released, and which files are
 * evicted. */
#include "tests/unit/server/support.h"

#include "server/surfaces/packed_files.h"

#define LIMIT ((size_t)1 << 20)
#define MOST  (LIMIT / SERVER_PACKED_PART)

static struct server_budget budget;
static struct server_packed_files *files;

static int set_up(void **state)
{
    (void)state;
    server_budget_init(&budget, LIMIT);
    files = server_packed_files_create(&budget);
    return files ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    server_packed_files_destroy(files);
    return atomic_load(&budget.total) ? -1 : 0;
}

static size_t counted(void)
{
    return atomic_load(&budget.used[SERVER_BUDGET_PACKED]);
}

static struct server_packed_file *add(const char *tag, size_t size)
{
    char *bytes = malloc(size);
    memset(bytes, *tag, size);
    struct server_packed_file *file = server_packed_files_add(files, tag, bytes, size);
    if (!file) free(bytes);
    return file;
}

static bool is_cached(const char *tag)
{
    struct server_packed_file *file = server_packed_files_find(files, tag);
    server_packed_file_release(file);
    return file;
}

static void a_file_is_found_by_its_tag(void **state)
{
    (void)state;
    assert_false(is_cached("a"));
    server_packed_file_release(add("a", 100));
    struct server_packed_file *file = server_packed_files_find(files, "a");
    assert_non_null(file);
    assert_true(file->size == 100 && file->bytes[99] == 'a');
    assert_false(is_cached("b"));
    assert_int_equal(counted(), 100);
    server_packed_file_release(file);
}

static void a_file_is_counted_until_its_last_answer_ends(void **state)
{
    (void)state;
    struct server_packed_file *file = add("a", 100);
    budget.reclaimers[SERVER_RECLAIM_PACKED].reclaim(files, 1);
    assert_false(is_cached("a"));
    assert_int_equal(counted(), 100);
    assert_true(file->bytes[0] == 'a');
    server_packed_file_release(file);
    assert_int_equal(counted(), 0);
}

static void the_least_recently_used_file_goes_first(void **state)
{
    (void)state;
    server_packed_file_release(add("a", 100));
    server_packed_file_release(add("b", 100));
    assert_true(is_cached("a"));
    budget.reclaimers[SERVER_RECLAIM_PACKED].reclaim(files, 1);
    assert_true(is_cached("a"));
    assert_false(is_cached("b"));
    assert_int_equal(counted(), 100);
}

static void a_take_empties_the_cache_first(void **state)
{
    (void)state;
    server_packed_file_release(add("a", MOST));
    assert_true(server_budget_take(&budget, SERVER_BUDGET_FLIGHT, LIMIT));
    assert_int_equal(counted(), 0);
    assert_null(add("b", 1)); /* only free memory */
    server_budget_give(&budget, SERVER_BUDGET_FLIGHT, LIMIT);
}

static void the_cache_has_its_part_of_the_budget(void **state)
{
    (void)state;
    assert_null(add("a", MOST + 1));
    server_packed_file_release(add("a", MOST));
    server_packed_file_release(add("b", MOST));
    assert_false(is_cached("a"));
    assert_true(is_cached("b"));
    assert_int_equal(counted(), MOST);
}

static void equal_files_are_listed_once(void **state)
{
    (void)state;
    struct server_packed_file *first = add("a", 100), *second = add("a", 100);
    assert_true(first != second);
    assert_int_equal(counted(), 200);
    server_packed_file_release(first);
    server_packed_file_release(second);
    assert_int_equal(counted(), 100);
}

int main(void)
{
#define IN(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        IN(a_file_is_found_by_its_tag),
        IN(a_file_is_counted_until_its_last_answer_ends),
        IN(the_least_recently_used_file_goes_first),
        IN(a_take_empties_the_cache_first),
        IN(the_cache_has_its_part_of_the_budget),
        IN(equal_files_are_listed_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
