/* Tests resumed fields: refused calls, the partial field, images, control and memory.
 * tests/property/test_resume.c tests their distances. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "gd/workspace.h"
#include "tests/samples/samples.h"
#include "tests/support/watch.h"

enum { SEEDS = 5 }; /* the seeds are two points, and a segment with its two ends */

static struct gd_polygons polygons;
static struct gd_mesh *mesh;
static struct gd_seed seeds[SEEDS];
static struct gd_field *partial; /* radius 0.3 */

static struct gd_field *build(double radius, const struct gd_control *control)
{
    struct gd_field *field;
    check_ok(gd_field_build(
                 mesh,
                 &(struct gd_field_request){.seeds = seeds, .seed_count = SEEDS, .radius = radius},
                 control, &field, NULL),
             NULL);
    return field;
}

static struct gd_field *resume(const struct gd_field *field, double radius,
                               const struct gd_control *control)
{
    struct gd_field *farther;
    struct gd_detail detail = {0};
    check_ok(gd_field_resume(field, radius, control, &farther, &detail), &detail);
    return farther;
}

static char *image_of(const struct gd_field *field)
{
    char *image = malloc(gd_field_image_size(field));
    gd_field_write_image(field, image);
    return image;
}

static void assert_same_distances(const struct gd_field *a, const struct gd_field *b,
                                  double relative)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (relative > 0)
            check_close(a->distance[v], b->distance[v], relative);
        else
            assert_true(a->distance[v] == b->distance[v]);
    }
}

static int open_mesh(void **state)
{
    (void)state;
    check_ok(sample_terrain(32, 0.4, 7, &polygons), NULL);
    mesh = test_mesh(&polygons);
    struct rng rng = {4};
    for (int i = 0; i < 2; i++)
        seeds[i] = (struct gd_seed){.point = test_point(mesh, test_random_place(&polygons, &rng)),
                                    .offset = 0.1 * i};
    struct gd_point a = test_point(mesh, (struct test_place){.face = 5, .weight = {0.2, 0.3, 0.5}}),
                    b = test_point(mesh, (struct test_place){.face = 5, .weight = {0.7, 0.2, 0.1}});
    seeds[2] = (struct gd_seed){.point = a, .offset = 0.05};
    seeds[3] = (struct gd_seed){.point = b, .offset = 0.05};
    seeds[4] = (struct gd_seed){.point = a, .end = b, .is_segment = true, .offset = 0.05};
    partial = build(0.3, NULL);
    return 0;
}

static int close_mesh(void **state)
{
    (void)state;
    gd_field_release(partial);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    return 0;
}

/* --- arguments -------------------------------------------------------------------------------- */

static void assert_refused(const struct gd_field *field, double radius, const char *why)
{
    struct gd_field *none = NULL;
    struct gd_detail detail = {0};
    assert_int_equal(gd_field_resume(field, radius, NULL, &none, &detail), GD_INVALID_ARGUMENT);
    assert_null(none);
    assert_non_null(strstr(detail.text, why));
}

static void a_radius_within_reach_is_refused(void **state)
{
    (void)state;
    struct gd_field *whole = build(0, NULL);
    assert_refused(partial, 0.3, "greater than the field's reach, 0.3");
    assert_refused(partial, 0.1, "greater");
    assert_refused(partial, -1, "zero (no limit) or more");
    assert_refused(partial, NAN, "zero (no limit) or more");
    assert_refused(whole, 0, "complete");
    assert_refused(whole, 1, "complete");
    gd_field_release(whole);
}

static void reports_reach_and_work(void **state)
{
    (void)state;
    struct gd_field *twice = resume(partial, 0.6, NULL), *whole = resume(twice, 0, NULL);
    const struct gd_field_statistics *first = gd_field_statistics(partial),
                                     *second = gd_field_statistics(twice),
                                     *third = gd_field_statistics(whole);
    check_close(gd_field_reach(twice), 0.6, 1e-15);
    assert_true(isinf(gd_field_reach(whole)));
    assert_int_equal(gd_field_seed_count(whole), SEEDS);
    assert_true(first->windows_propagated < second->windows_propagated);
    assert_true(second->windows_propagated < third->windows_propagated);
    assert_true(first->build_ns < second->build_ns && second->build_ns < third->build_ns);
    assert_true(third->wedges * GD__WEDGE_LEAST <= whole->wedge_bytes);
    gd_field_release(twice);
    gd_field_release(whole);
}

/* Resuming a field propagates few windows in addition to the windows beyond the radius. */
static void continues_where_it_ended(void **state)
{
    (void)state;
    struct gd_field *whole = build(0, NULL), *most = build(0.45, NULL),
                    *rest = resume(most, 0, NULL);
    uint64_t all = gd_field_statistics(whole)->windows_propagated,
             some = gd_field_statistics(most)->windows_propagated;
    uint64_t later = gd_field_statistics(rest)->windows_propagated - some;
    assert_true(some > all / 4);
    print_message("# %llu of %llu windows, then %llu\n", (unsigned long long)some,
                  (unsigned long long)all, (unsigned long long)later);
    assert_true((double)later < 1.3 * (double)(all - some));
    assert_true((double)gd_field_statistics(rest)->wedges <
                1.1 * (double)gd_field_statistics(whole)->wedges);
    gd_field_release(whole);
    gd_field_release(most);
    gd_field_release(rest);
}

/* --- a field within a smaller reach ----------------------------------------------------------- */

/* Checks that the view answers like a field that was built for this radius. */
static void assert_like(const struct gd_field *view, const struct gd_field *field)
{
    struct rng rng = {3};
    int known = 0;
    assert_true(gd_field_reach(view) == gd_field_reach(field));
    assert_int_equal(gd_field_seed_count(view), SEEDS);
    for (int i = 0; i < 300; i++) {
        struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
        double a, b;
        uint32_t seed;
        enum gd_status status = gd_field_distance(view, &point, &a);
        assert_int_equal(status, gd_field_distance(field, &point, &b));
        assert_int_equal(status, gd_field_nearest(view, &point, &a, &seed));
        if (status) continue;
        check_close(a, b, 1e-12);
        known++;
    }
    assert_true(known > 10 && known < 290);
}

static void a_view_has_a_smaller_reach(void **state)
{
    (void)state;
    struct gd_field *whole = build(0, NULL), *view, *again, *same, *none = NULL;
    check_ok(gd_field_within(whole, 0.3, &view), NULL);
    assert_int_equal(gd_field_memsize(view), gd_field_memsize(whole));
    gd_field_release(whole); /* the view holds a reference */
    assert_like(view, partial);
    check_ok(gd_field_within(view, 0.2, &again), NULL);
    gd_field_release(view);
    check_ok(gd_field_within(again, 0.25, &same), NULL);
    assert_ptr_equal(same, again);
    gd_field_release(same);
    assert_int_equal(gd_field_within(again, 0, &none), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_field_within(again, NAN, &none), GD_INVALID_ARGUMENT);
    struct gd_field *near = build(0.2, NULL), *farther = resume(again, 0.3, NULL);
    assert_like(again, near);
    assert_like(farther, partial);
    gd_field_release(near);
    gd_field_release(farther);
    gd_field_release(again);
}

/* --- what resuming does not change ------------------------------------------------------------ */

static void the_partial_field_stays(void **state)
{
    (void)state;
    char *before = image_of(partial);
    struct gd_field *whole = resume(partial, 0, NULL);
    char *after = image_of(partial);
    assert_memory_equal(before, after, gd_field_image_size(partial));
    gd_field_release(whole);
    free(before);
    free(after);
}

static void a_field_from_an_image_is_resumed(void **state)
{
    (void)state;
    char *image = image_of(partial);
    struct gd_field *opened, *fresh = build(0, NULL);
    check_ok(gd_field_open_image(
                 mesh, &(struct gd_field_image){image, gd_field_image_size(partial), NULL, NULL},
                 &opened, NULL),
             NULL);
    struct gd_field *a = resume(partial, 0, NULL), *b = resume(opened, 0, NULL);
    gd_field_release(opened);
    free(image);
    assert_same_distances(a, b, 0);
    assert_same_distances(a, fresh, 1e-12);
    gd_field_release(a);
    gd_field_release(b);
    gd_field_release(fresh);
}

/* A workspace is reusable after a resumed field, also after a failure. */
static void a_workspace_is_used_again(void **state)
{
    (void)state;
    struct gd_workspace *workspace = gd_workspace_create();
    struct gd_control control = {.workspace = workspace},
                      late = {.workspace = workspace, .deadline_ns = 1};
    struct gd_field *alone = resume(partial, 0, NULL), *fresh = build(0.1, NULL), *none = NULL;
    for (int i = 0; i < 3; i++) {
        struct gd_field *again = resume(partial, 0, &control);
        assert_int_equal(gd_field_resume(partial, 0, &late, &none, NULL), GD_DEADLINE);
        assert_null(none);
        struct gd_field *anew = build(0.1, &control);
        assert_same_distances(again, alone, 0);
        assert_same_distances(anew, fresh, 0);
        gd_field_release(again);
        gd_field_release(anew);
    }
    gd_field_release(alone);
    gd_field_release(fresh);
    gd_workspace_destroy(workspace);
}

/* --- control ---------------------------------------------------------------------------------- */

static void progress_grows_and_cancels(void **state)
{
    (void)state;
    struct test_watch watch = {0};
    struct gd_control control = {.progress = test_watch, .user = &watch};
    gd_field_release(resume(partial, 0, &control));
    int all = watch.calls;
    assert_true(all > 3 && watch.last > 0.3);
    for (int most = 1; most <= all; most++) {
        struct gd_field *none = NULL;
        watch = (struct test_watch){.most = most};
        assert_int_equal(gd_field_resume(partial, 0, &control, &none, NULL), GD_CANCELLED);
        assert_null(none);
    }
}

static void memory_is_budgeted(void **state)
{
    (void)state;
    size_t need = gd__workspace_need(mesh) + 64;
    int refused = 0;
    enum gd_status status;
    do {
        struct gd_control control = {.budget_bytes = need};
        struct gd_field *field = NULL;
        status = gd_field_resume(partial, 0, &control, &field, NULL);
        assert_true(status == GD_OK || (status == GD_BUDGET && !field));
        gd_field_release(field);
        refused += status != GD_OK;
        need += need / 8;
    } while (status);
    assert_true(refused > 2);
}

/* --- damaged images --------------------------------------------------------------------------- */

/* Resuming a damaged image that can be opened ends with a status and stays within the arrays. */
static void damaged_images_do_no_harm(void **state)
{
    (void)state;
    struct rng rng = {12};
    size_t size = gd_field_image_size(partial);
    char *image = image_of(partial), *damaged = malloc(size);
    int opened = 0;
    for (int i = 0; i < 400; i++) {
        memcpy(damaged, image, size);
        for (uint32_t k = 1 + rng_below(&rng, 5); k > 0; k--)
            damaged[rng_below(&rng, (uint32_t)size)] ^= (char)(1 << rng_below(&rng, 8));
        struct gd_field *field, *farther;
        if (gd_field_open_image(mesh, &(struct gd_field_image){damaged, size, NULL, NULL}, &field,
                                NULL))
            continue;
        opened++;
        const struct gd_control control = {.deadline_ns = gd_now_ns() + 200000000};
        if (gd_field_resume(field, 0, &control, &farther, NULL) == GD_OK) gd_field_release(farther);
        gd_field_release(field);
    }
    print_message("# %d of 400 could be opened\n", opened);
    assert_true(opened > 50);
    free(image);
    free(damaged);
}

static void distances_below_zero_are_damage(void **state)
{
    (void)state;
    char *image = image_of(partial);
    struct gd_field *field;
    check_ok(gd_field_open_image(
                 mesh, &(struct gd_field_image){image, gd_field_image_size(partial), NULL, NULL},
                 &field, NULL),
             NULL);
    field->distance[3] = -1;
    assert_refused(field, 0, "damaged");
    field->distance[3] = NAN;
    assert_refused(field, 0, "damaged");
    gd_field_release(field);
    free(image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_radius_within_reach_is_refused),
        cmocka_unit_test(reports_reach_and_work),
        cmocka_unit_test(continues_where_it_ended),
        cmocka_unit_test(a_view_has_a_smaller_reach),
        cmocka_unit_test(the_partial_field_stays),
        cmocka_unit_test(a_field_from_an_image_is_resumed),
        cmocka_unit_test(a_workspace_is_used_again),
        cmocka_unit_test(progress_grows_and_cancels),
        cmocka_unit_test(memory_is_budgeted),
        cmocka_unit_test(damaged_images_do_no_harm),
        cmocka_unit_test(distances_below_zero_are_damage),
    };
    return cmocka_run_group_tests(tests, open_mesh, close_mesh);
}
