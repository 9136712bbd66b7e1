#include "tests/support/test.h"

#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "tests/samples/samples.h"

static struct gd_polygons polygons;
static struct gd_mesh *mesh;
static struct gd_field *field;
static char *image;
static size_t size;
static int released;

static void count_release(void *user)
{
    ++*(int *)user;
}

static int make_image(void **state)
{
    (void)state;
    check_ok(sample_terrain(12, 0.3, 7, &polygons), NULL);
    mesh = test_mesh(&polygons);
    struct rng rng = {4};
    struct gd_seed seeds[2] = {{test_point(mesh, test_random_place(&polygons, &rng)), 0},
                               {test_point(mesh, test_random_place(&polygons, &rng)), 0.25}};
    check_ok(
        gd_field_build(mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = 2}, NULL, NULL, &field, NULL),
        NULL);
    size = gd_field_image_size(field);
    image = malloc(size);
    gd_field_write_image(field, image);
    released = 0;
    return 0;
}

static int drop_image(void **state)
{
    (void)state;
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    free(image);
    return 0;
}

static void answers_like_the_field(void **state)
{
    (void)state;
    struct gd_field *opened;
    struct gd_detail detail;
    check_ok(gd_field_open_image(mesh, image, size, count_release, &released, &opened, &detail), &detail);
    assert_int_equal(gd_field_memsize(opened), gd_field_memsize(field));
    struct rng rng = {8};
    for (int i = 0; i < 500; i++) {
        struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
        double a, b;
        struct gd_path p, q;
        check_ok(gd_field_distance(field, &point, &a), NULL);
        check_ok(gd_field_distance(opened, &point, &b), NULL);
        assert_true(a == b);
        check_ok(gd_field_path(field, &point, &p), NULL);
        check_ok(gd_field_path(opened, &point, &q), NULL);
        assert_int_equal(p.count, q.count);
        assert_true(p.length == q.length);
        gd_path_free(&p);
        gd_path_free(&q);
    }
    char *again = malloc(size);
    gd_field_write_image(opened, again);
    assert_memory_equal(again, image, size);
    free(again);
    assert_int_equal(released, 0);
    gd_field_release(opened);
    assert_int_equal(released, 1);
}

static void refuses_what_is_no_image_of_this_mesh(void **state)
{
    (void)state;
    struct gd_field *opened = NULL;
    struct gd_detail detail;
    struct gd_polygons other;
    check_ok(sample_terrain(12, 0.3, 8, &other), NULL);
    struct gd_mesh *stranger = test_mesh(&other);
    assert_int_equal(gd_field_open_image(stranger, image, size, count_release, &released, &opened, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_field_open_image(mesh, image, 50, count_release, &released, &opened, &detail), GD_TRUNCATED);
    assert_int_equal(gd_field_open_image(mesh, image, size - 8, count_release, &released, &opened, &detail),
                     GD_TRUNCATED);
    image[0] ^= 1;
    assert_int_equal(gd_field_open_image(mesh, image, size, count_release, &released, &opened, &detail),
                     GD_UNRECOGNIZED);
    image[0] ^= 1;
    assert_int_equal(released, 0);
    assert_null(opened);
    gd_mesh_release(stranger);
    gd_polygons_free(&other);
}

/* Whatever byte is damaged: refused, or every answer is given without leaving the arrays (under AddressSanitizer). */
static void damage_never_leads_outside(void **state)
{
    (void)state;
    struct rng rng = {15};
    int refused = 0;
    for (int i = 0; i < 3000; i++) {
        size_t at = rng_below(&rng, (uint32_t)size);
        char keep = image[at];
        image[at] ^= (char)(1 << rng_below(&rng, 8));
        struct gd_field *opened = NULL;
        if (gd_field_open_image(mesh, image, size, NULL, NULL, &opened, NULL) == GD_OK) {
            for (int k = 0; k < 5; k++) {
                struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
                double distance;
                struct gd_path path;
                enum gd_status status = gd_field_distance(opened, &point, &distance);
                if (!status && gd_field_path(opened, &point, &path) == GD_OK) gd_path_free(&path);
            }
            gd_field_release(opened);
        } else {
            refused++;
        }
        image[at] = keep;
    }
    print_message("# 3000 damaged field images: %d refused by their indices\n", refused);
    assert_true(refused > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(answers_like_the_field, make_image, drop_image),
        cmocka_unit_test_setup_teardown(refuses_what_is_no_image_of_this_mesh, make_image, drop_image),
        cmocka_unit_test_setup_teardown(damage_never_leads_outside, make_image, drop_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
