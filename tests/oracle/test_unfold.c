/* Compares the brute-force solver with closed forms, which share no code with the solver. */
#include "tests/oracle/closed_forms.h"
#include "tests/oracle/unfold.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/samples/samples.h"
#include "tests/support/test.h"

enum { PLACES = 6 };

/* Compares all pairs of some random places. Returns the largest relative error. */
static double compare(const struct gd_polygons *mesh, struct rng *rng,
                      double (*expected)(const void *context, const double *p, const double *q),
                      const void *context)
{
    struct unfold_mesh *unfold =
        unfold_create((const double(*)[3])mesh->positions, mesh->position_count, mesh->corners,
                      mesh->polygon_count, PLACES);
    assert_non_null(unfold);
    uint32_t vertex[PLACES];
    double at[PLACES][3], worst = 0;
    for (int i = 0; i < PLACES; i++) {
        struct test_place place = test_random_place(mesh, rng);
        if (i == 1) place.face = 0; /* places 1 and 2 share face 0 */
        if (i == 2) place.face = 0;
        vertex[i] = unfold_insert(unfold, place.face, place.weight);
        test_place_position(mesh, place, at[i]);
    }
    long double *distance = calloc(mesh->position_count + PLACES, sizeof *distance);
    assert_non_null(distance);
    for (int i = 0; i < PLACES; i++) {
        unfold_distances(unfold, vertex[i], distance);
        for (int j = 0; j < PLACES; j++) {
            double form = expected(context, at[i], at[j]), size = fmax(form, 1e-3);
            worst = fmax(worst, fabs((double)distance[vertex[j]] - form) / size);
            check_close((double)distance[vertex[j]] + size, form + size, 1e-12);
        }
    }
    free(distance);
    unfold_free(unfold);
    return worst;
}

static double plane(const void *context, const double *p, const double *q)
{
    (void)context;
    return hypot(p[0] - q[0], p[1] - q[1]);
}

static void test_grid(void **state)
{
    (void)state;
    struct rng rng = {1};
    struct gd_polygons mesh;
    assert_int_equal(sample_grid(4, 3, 2, 1, &mesh), GD_OK);
    double worst = 0;
    for (int i = 0; i < 20; i++) worst = fmax(worst, compare(&mesh, &rng, plane, NULL));
    print_message("# grid: worst error %.2g\n", worst);
    gd_polygons_free(&mesh);
}

static double box(const void *context, const double *p, const double *q)
{
    const double *size = context;
    double a[2][3];
    for (int k = 0; k < 3; k++) {
        a[0][k] = p[k], a[1][k] = q[k];
        for (int i = 0; i < 2; i++) {
            if (fabs(a[i][k]) < 1e-12) a[i][k] = 0;
            if (fabs(a[i][k] - size[k]) < 1e-12) a[i][k] = size[k];
        }
    }
    return closed_form_box(size, a[0], a[1]);
}

static void test_box(void **state)
{
    (void)state;
    struct rng rng = {2};
    double worst = 0;
    for (int i = 0; i < 60; i++) {
        double size[3];
        for (int k = 0; k < 3; k++) size[k] = i < 20 ? 1 : pow(10, rng_between(&rng, -1, 0));
        struct gd_polygons mesh;
        assert_int_equal(sample_box(size, (const uint32_t[3]){1, 1 + rng_below(&rng, 2), 1}, &mesh),
                         GD_OK);
        worst = fmax(worst, compare(&mesh, &rng, box, size));
        gd_polygons_free(&mesh);
    }
    print_message("# box: worst error %.2g\n", worst);
}

/* The classic puzzle of the spider and the fly: in a 30 x 12 x 12 room the shortest path crosses
 * five walls. */
static void test_spider_and_fly(void **state)
{
    (void)state;
    const double room[3] = {30, 12, 12}, spider[3] = {0, 6, 11}, fly[3] = {30, 6, 1};
    check_close(closed_form_box(room, spider, fly), 40, 1e-15);
}

static double fan(const void *context, const double *p, const double *q)
{
    return closed_form_fan(context, p, q);
}

static void test_fans(void **state)
{
    (void)state;
    struct rng rng = {3};
    double worst = 0;
    for (int i = 0; i < 30; i++) {
        uint32_t sectors = 4 + 2 * rng_below(&rng, 3);
        double height = rng_between(&rng, 0.1, 1.5);
        struct closed_form_fan cone = {1, height, {0, 0}, sectors},
                               saddle = {1, 0, {height, -height}, sectors};
        struct gd_polygons mesh;
        assert_int_equal(sample_cone(1, height, sectors, 2, &mesh), GD_OK);
        worst = fmax(worst, compare(&mesh, &rng, fan, &cone));
        gd_polygons_free(&mesh);
        assert_int_equal(sample_saddle(1, height, sectors, 2, &mesh), GD_OK);
        worst = fmax(worst, compare(&mesh, &rng, fan, &saddle));
        gd_polygons_free(&mesh);
    }
    print_message("# cone and saddle: worst error %.2g\n", worst);
}

static double prism(const void *context, const double *p, const double *q)
{
    return closed_form_prism(1, *(const uint32_t *)context, p, q);
}

static void test_cylinder(void **state)
{
    (void)state;
    struct rng rng = {4};
    double worst = 0;
    for (uint32_t sides = 3; sides < 9; sides++) {
        struct gd_polygons mesh;
        assert_int_equal(sample_cylinder(1, 2, sides, 2, &mesh), GD_OK);
        for (int i = 0; i < 5; i++) worst = fmax(worst, compare(&mesh, &rng, prism, &sides));
        gd_polygons_free(&mesh);
    }
    print_message("# cylinder: worst error %.2g\n", worst);
}

/* Computes barycentric weights in a regular tetrahedron about the origin. They are linear in the
 * position. */
static void weights(const struct gd_polygons *mesh, const double *p, double out[4])
{
    for (int k = 0; k < 4; k++) {
        const double *c = mesh->positions[k];
        out[k] = 0.25 + 0.75 * (p[0] * c[0] + p[1] * c[1] + p[2] * c[2]) /
                            (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    }
}

static double tetrahedron(const void *context, const double *p, const double *q)
{
    double a[4], b[4];
    weights(context, p, a);
    weights(context, q, b);
    return closed_form_tetrahedron(1.25, a, b);
}

static void test_tetrahedron(void **state)
{
    (void)state;
    struct rng rng = {5};
    double worst = 0;
    for (uint32_t level = 0; level < 2; level++) {
        struct gd_polygons mesh;
        assert_int_equal(sample_tetrahedron(1.25, level, &mesh), GD_OK);
        for (int i = 0; i < 20; i++) worst = fmax(worst, compare(&mesh, &rng, tetrahedron, &mesh));
        gd_polygons_free(&mesh);
    }
    print_message("# tetrahedron: worst error %.2g\n", worst);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),           cmocka_unit_test(test_box),
        cmocka_unit_test(test_spider_and_fly), cmocka_unit_test(test_fans),
        cmocka_unit_test(test_cylinder),       cmocka_unit_test(test_tetrahedron),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
