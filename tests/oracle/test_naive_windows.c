/* Compares the solver by naive windows with closed forms, with the solver by unfolding, and with
 * itself in the other precision. */
#include "tests/oracle/naive_windows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/oracle/closed_forms.h"
#include "tests/oracle/unfold.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"
#include "tests/support/test.h"

static struct naive_mesh *open_mesh(const struct gd_polygons *mesh)
{
    struct naive_mesh *naive =
        naive_mesh_create((const double(*)[3])mesh->positions, mesh->position_count, mesh->corners,
                          mesh->polygon_count);
    assert_non_null(naive);
    return naive;
}

static struct naive_field *solve(const struct naive_mesh *mesh, enum naive_precision precision,
                                 struct naive_point source)
{
    struct naive_field *field =
        naive_field_solve(mesh, precision, &(struct naive_source){source, 0}, 1, INFINITY);
    assert_non_null(field);
    return field;
}

static struct naive_point random_point(const struct gd_polygons *mesh, struct rng *rng)
{
    struct test_place place = test_random_place(mesh, rng);
    struct naive_point point = {.face = place.face};
    memcpy(point.weight, place.weight, sizeof point.weight);
    return point;
}

/* Returns a point of a face or its border, 1e-15 to 1e-9 edge lengths away from a corner. */
static struct naive_point point_beside_corner(const struct gd_polygons *mesh, struct rng *rng)
{
    struct naive_point point = {.face = rng_below(rng, mesh->polygon_count)};
    uint32_t k = rng_below(rng, 3), on_edge = rng_below(rng, 3);
    double apart = pow(10, rng_between(rng, -15, -9)),
           part = on_edge ? rng_unit(rng) : rng_below(rng, 2);
    point.weight[(k + 1) % 3] = apart * part;
    point.weight[(k + 2) % 3] = apart * (1 - part);
    point.weight[k] = 1 - apart;
    return point;
}

static void position(const struct gd_polygons *mesh, struct naive_point point, double out[3])
{
    struct test_place place = {.face = point.face};
    memcpy(place.weight, point.weight, sizeof place.weight);
    test_place_position(mesh, place, out);
}

/* --- closed forms ----------------------------------------------------------------------------- */

typedef double closed_form(const void *context, const double p[3], const double q[3]);

static double check_form(const struct gd_polygons *mesh, closed_form *form, const void *context,
                         struct rng *rng)
{
    struct naive_mesh *naive = open_mesh(mesh);
    double worst = 0;
    for (int i = 0; i < 4; i++) {
        struct naive_point source = random_point(mesh, rng);
        struct naive_field *field = solve(naive, i % 4 ? NAIVE_EXTENDED : NAIVE_QUADRUPLE, source);
        for (int j = 0; j < 30; j++) {
            struct naive_point target = random_point(mesh, rng);
            double p[3], q[3];
            position(mesh, source, p);
            position(mesh, target, q);
            double expected = form(context, p, q),
                   actual = (double)naive_field_distance(field, &target);
            worst = fmax(worst, check_close(actual + 1, expected + 1, 1e-13));
        }
        naive_field_free(field);
    }
    naive_mesh_free(naive);
    return worst;
}

static double plane(const void *context, const double p[3], const double q[3])
{
    (void)context;
    return hypot(p[0] - q[0], p[1] - q[1]);
}

static double box(const void *context, const double p[3], const double q[3])
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

static double fan(const void *context, const double p[3], const double q[3])
{
    return closed_form_fan(context, p, q);
}

static void check_fan(int turn, struct rng *rng, double *worst)
{
    uint32_t sectors = 4 + 2 * rng_below(rng, 3);
    double height = rng_between(rng, 0.1, 1.5);
    struct closed_form_fan cone = {1, height, {0, 0}, sectors},
                           saddle = {1, 0, {height, -height}, sectors};
    struct gd_polygons mesh;
    if (turn % 2)
        check_ok(sample_cone(1, height, sectors, 2, &mesh), NULL);
    else
        check_ok(sample_saddle(1, height, sectors, 2, &mesh), NULL);
    *worst = fmax(*worst, check_form(&mesh, fan, turn % 2 ? &cone : &saddle, rng));
    gd_polygons_free(&mesh);
}

static void closed_forms(void **state)
{
    (void)state;
    struct rng rng = {1};
    double worst = 0;
    for (int turn = 0; turn < 20; turn++) {
        const double size[3] = {1, rng_between(&rng, 0.1, 1), rng_between(&rng, 0.1, 1)};
        struct gd_polygons mesh;
        check_ok(sample_grid(5, 4, 2, 1, &mesh), NULL);
        worst = fmax(worst, check_form(&mesh, plane, NULL, &rng));
        gd_polygons_free(&mesh);
        check_ok(sample_box(size, (const uint32_t[3]){2, 1, 1}, &mesh), NULL);
        worst = fmax(worst, check_form(&mesh, box, size, &rng));
        gd_polygons_free(&mesh);
        check_fan(turn, &rng, &worst);
    }
    print_message("# plane, box, cone and saddle: worst error %.2g\n", worst);
}

/* --- the other solver, and the other precision ------------------------------------------------ */

static void make_surface(int turn, struct gd_polygons *mesh)
{
    uint64_t seed = (uint64_t)turn;
    if (turn % 4 == 0) check_ok(sample_terrain(6, 0.5, seed, mesh), NULL);
    if (turn % 4 == 1) check_ok(sample_tangle(60, seed, mesh), NULL);
    if (turn % 4 == 2) check_ok(sample_icosphere(1, 1, mesh), NULL);
    if (turn % 4 == 3) check_ok(sample_torus(8, 6, 1, 0.5, mesh), NULL);
    if (turn % 4 >= 2) sample_jitter(mesh, 0.1, seed);
}

/* Compares the distances from one source to all vertices and one point. Returns the largest
 * error. */
static double compare_unfolded(const struct gd_polygons *mesh, const struct naive_mesh *naive,
                               struct rng *rng)
{
    struct unfold_mesh *unfold =
        unfold_create((const double(*)[3])mesh->positions, mesh->position_count, mesh->corners,
                      mesh->polygon_count, 2);
    long double *expected = calloc(mesh->position_count + 2, sizeof *expected), worst = 0;
    assert_non_null(unfold);
    assert_non_null(expected);
    struct naive_point source = random_point(mesh, rng), target = random_point(mesh, rng);
    uint32_t from = unfold_insert(unfold, source.face, source.weight);
    uint32_t to = unfold_insert(unfold, target.face, target.weight);
    unfold_distances(unfold, from, expected);
    struct naive_field *field = solve(naive, NAIVE_EXTENDED, source);
    for (uint32_t v = 0; v <= mesh->position_count; v++) {
        long double known = v < mesh->position_count ? expected[v] : expected[to];
        long double found = v < mesh->position_count ? naive_field_vertex_distance(field, v)
                                                     : naive_field_distance(field, &target);
        if (known == found) continue; /* both are infinite */
        worst = fmaxl(worst, fabsl(found - known) / (1 + known));
    }
    naive_field_free(field);
    unfold_free(unfold);
    free(expected);
    assert_true(worst < 1e-14L);
    return (double)worst;
}

static void agrees_with_unfolding(void **state)
{
    (void)state;
    struct rng rng = {2};
    double worst = 0;
    for (int turn = 0; turn < 40; turn++) {
        struct gd_polygons mesh;
        make_surface(turn, &mesh);
        struct naive_mesh *naive = open_mesh(&mesh);
        for (int i = 0; i < 3; i++) worst = fmax(worst, compare_unfolded(&mesh, naive, &rng));
        naive_mesh_free(naive);
        gd_polygons_free(&mesh);
    }
    print_message("# against unfolding: worst error %.2g\n", worst);
}

static double compare_precisions(const struct gd_polygons *mesh, const struct naive_mesh *naive,
                                 struct rng *rng)
{
    struct naive_point source = point_beside_corner(mesh, rng);
    struct naive_field *extended = solve(naive, NAIVE_EXTENDED, source),
                       *quadruple = solve(naive, NAIVE_QUADRUPLE, source);
    long double worst = 0;
    for (int i = 0; i < 50; i++) {
        struct naive_point target =
            i % 2 ? random_point(mesh, rng) : point_beside_corner(mesh, rng);
        if (i == 0) target = source;
        if (i == 2) {
            memmove(target.weight,
                    (double[3]){source.weight[1], source.weight[2], source.weight[0]},
                    sizeof target.weight);
            target.face = source.face;
        }
        long double known = naive_field_distance(quadruple, &target),
                    found = naive_field_distance(extended, &target);
        if (known == found) continue;
        worst = fmaxl(worst, fabsl(found - known) / known);
    }
    naive_field_free(extended);
    naive_field_free(quadruple);
    assert_true(worst < 1e-12L);
    return (double)worst;
}

static void precisions_agree_beside_corners(void **state)
{
    (void)state;
    struct rng rng = {3};
    double worst = 0;
    for (int turn = 0; turn < 24; turn++) {
        struct gd_polygons mesh;
        make_surface(turn, &mesh);
        struct naive_mesh *naive = open_mesh(&mesh);
        for (int i = 0; i < 2; i++) worst = fmax(worst, compare_precisions(&mesh, naive, &rng));
        naive_mesh_free(naive);
        gd_polygons_free(&mesh);
    }
    print_message("# extended against quadruple, beside corners: worst error %.2g\n", worst);
}

static double prism(const void *context, const double p[3], const double q[3])
{
    return closed_form_prism(*(const double *)context, 5, p, q);
}

/* Uses thin tubes. Without pruning, windows would wind around the tube as often as the ratio of its
 * length and its radius allows. The solver must drop such windows. */
static void tubes(void **state)
{
    (void)state;
    struct rng rng = {4};
    double worst = 0;
    for (double radius = 1e-1; radius > 1e-7; radius /= 10) {
        struct gd_polygons mesh;
        check_ok(sample_cylinder(radius, 1, 5, 10, &mesh), NULL);
        worst = fmax(worst, check_form(&mesh, prism, &radius, &rng));
        gd_polygons_free(&mesh);
    }
    print_message("# tubes: worst error %.2g\n", worst);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(closed_forms), cmocka_unit_test(tubes),
                                       cmocka_unit_test(agrees_with_unfolding),
                                       cmocka_unit_test(precisions_agree_beside_corners)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
