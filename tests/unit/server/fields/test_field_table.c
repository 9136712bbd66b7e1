#include "tests/unit/server/support.h"

#include "server/fields/field_table.h"

enum { SLOTS = 500 };

static void finds_what_was_put_in(void **state)
{
    (void)state;
    struct gd_seed seeds[SLOTS];
    struct server_field_slot slots[SLOTS];
    struct server_field_table table = {0};
    for (uint32_t i = 0; i < SLOTS; i++) {
        const struct gd_point point = {.kind = GD_POINT_VERTEX, .element = i};
        slots[i].key = server_field_key_of_point(&point, &seeds[i]);
        assert_true(server_field_key_is_point(&slots[i].key));
        assert_null(server_field_table_find(&table, &slots[i].key));
        assert_true(server_field_table_reserve(&table));
        server_field_table_insert(&table, &slots[i]);
    }
    for (uint32_t i = 0; i < SLOTS; i += 2) server_field_table_remove(&table, &slots[i]);
    for (uint32_t i = 0; i < SLOTS; i++)
        assert_ptr_equal(server_field_table_find(&table, &slots[i].key), i % 2 ? &slots[i] : NULL);
    assert_int_equal(table.count, SLOTS / 2);
    server_field_table_free(&table);
}

static void every_part_of_the_seeds_counts(void **state)
{
    (void)state;
    struct gd_seed seed = {.point = {.kind = GD_POINT_FACE,
                                     .element = 4,
                                     .weight = {0.5, 0.25, 0.25}}},
                   seeds[7];
    struct gd_field_request requests[8];
    for (int i = 0; i < 7; i++) seeds[i] = seed;
    seeds[0].point.kind = GD_POINT_EDGE;
    seeds[1].point.element = 5;
    for (int k = 0; k < 3; k++) seeds[2 + k].point.weight[k] = 0.125;
    seeds[5].offset = 1;
    for (int i = 0; i < 7; i++)
        requests[i] = (struct gd_field_request){.seeds = &seeds[i], .seed_count = 1};
    requests[7] = (struct gd_field_request){.seeds = &seeds[5], .seed_count = 2};
    for (int i = 0; i < 8; i++) {
        for (int j = 0; j < 8; j++) {
            struct server_field_key a = server_field_key_of(&requests[i]),
                                    b = server_field_key_of(&requests[j]);
            assert_int_equal(server_field_key_equal(&a, &b), i == j);
        }
    }
}

/* Radii in order, 0 for no limit; the field is the same. */
static void who_reaches_farther_covers(void **state)
{
    (void)state;
    static const double radii[] = {1e-9, 1, 2, 0};
    struct gd_seed seed = {.point = {.element = 4}};
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            const struct gd_field_request requests[2] = {
                {.seeds = &seed, .seed_count = 1, .radius = radii[i]},
                {.seeds = &seed, .seed_count = 1, .radius = radii[j]}};
            struct server_field_key a = server_field_key_of(&requests[0]),
                                    b = server_field_key_of(&requests[1]);
            assert_true(server_field_key_equal(&a, &b) && a.hash == b.hash);
            assert_int_equal(server_field_key_covers(&a, &b), i >= j);
        }
    }
}

static void copies_have_seeds_of_their_own(void **state)
{
    (void)state;
    struct gd_seed seeds[2] = {{.point = {.element = 1}}, {.point = {.element = 2}, .offset = 3}};
    const struct gd_field_request request = {.seeds = seeds, .seed_count = 2, .radius = 1};
    struct server_field_key key = server_field_key_of(&request), copy;
    assert_true(server_field_key_copy(&key, &copy));
    assert_true(server_field_key_equal(&key, &copy));
    assert_false(server_field_key_is_point(&copy));
    seeds[1].offset = 4;
    assert_false(server_field_key_equal(&key, &copy));
    server_field_key_free(&copy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_what_was_put_in),
        cmocka_unit_test(every_part_of_the_seeds_counts),
        cmocka_unit_test(who_reaches_farther_covers),
        cmocka_unit_test(copies_have_seeds_of_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
