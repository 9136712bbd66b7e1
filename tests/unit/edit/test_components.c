#include "edits.h"

static const double radii[] = {1, 3, 2, 2.5};

static struct gd_edited kept(const struct gd_mesh *mesh, uint32_t keep, uint32_t skip)
{
    const struct gd_components_options options = {keep, skip};
    struct gd_detail detail = {0};
    struct gd_edited edited;
    check_ok(gd_components(mesh, &options, NULL, &edited, &detail), &detail);
    return edited;
}

/* Checks that the result has exactly the spheres with these numbers, in the order of the input. */
static void check_kept(const struct gd_edited *edited, const uint32_t *spheres, uint32_t count)
{
    uint32_t vertices = edited->polygons.position_count / count;
    assert_int_equal(edited->polygons.polygon_count, count * 80);
    for (uint32_t v = 0; v < edited->polygons.position_count; v++) {
        struct gd_vec3 p = position_at(&edited->polygons, v);
        p.x -= 10.0 * spheres[v / vertices];
        check_close(gd_vec3_length(p), radii[spheres[v / vertices]], 1e-12);
    }
}

static void the_largest_stay(void **state)
{
    (void)state;
    struct gd_mesh *mesh = separate_spheres(radii, 4);
    const struct {
        uint32_t keep, skip, count, spheres[4];
    } cases[] = {
        {1, 0, 1, {1}}, {2, 0, 2, {1, 3}}, {3, 0, 3, {1, 2, 3}}, {9, 0, 4, {0, 1, 2, 3}},
        {1, 1, 1, {3}}, {1, 2, 1, {2}},    {2, 2, 2, {0, 2}},    {UINT32_MAX, 1, 3, {0, 2, 3}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct gd_edited edited = kept(mesh, cases[i].keep, cases[i].skip);
        check_kept(&edited, cases[i].spheres, cases[i].count);
        assert_true(farthest_origin(mesh, &edited) == 0);
        gd_mesh_release(test_mesh(&edited.polygons));
        gd_edited_free(&edited);
    }
    gd_mesh_release(mesh);
}

static void keeping_none_is_refused(void **state)
{
    (void)state;
    struct gd_mesh *mesh = separate_spheres(radii, 2);
    const struct gd_components_options bad[] = {{0, 0}, {1, 2}, {7, UINT32_MAX}};
    struct gd_edited edited = {.bytes = 7};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct gd_detail detail = {0};
        assert_int_equal(gd_components(mesh, &bad[i], NULL, &edited, &detail), GD_INVALID_ARGUMENT);
        assert_non_null(strstr(detail.text, "of 2 components"));
        assert_int_equal(edited.bytes, 7);
    }
    gd_mesh_release(mesh);
}

static void budget_and_cancel(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){5, 1}, NULL);
    const struct gd_components_options options = {.keep = 1};
    const struct gd_control small = {.budget_bytes = 1000}, late = {.deadline_ns = 1},
                            cancelled = {.progress = test_cancel};
    struct gd_edited edited;
    assert_int_equal(gd_components(mesh, &options, &small, &edited, NULL), GD_BUDGET);
    assert_int_equal(gd_components(mesh, &options, &late, &edited, NULL), GD_DEADLINE);
    assert_int_equal(gd_components(mesh, &options, &cancelled, &edited, NULL), GD_CANCELLED);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_stay),
        cmocka_unit_test(keeping_none_is_refused),
        cmocka_unit_test(budget_and_cancel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
