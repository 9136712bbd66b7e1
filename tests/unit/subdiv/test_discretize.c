#include "tests/unit/subdiv/surfaces.h"

#include "gd/discretization.h"
#include "gd/mesh.h"

static struct gd_discretization fine_of(const struct gd_subdivision *surface, uint32_t level,
                                        double tolerance)
{
    struct gd_discretization fine = {0};
    struct gd_detail detail = {0};
    struct gd_discretize_options options = {.level = level, .tolerance = tolerance};
    check_ok(gd_discretize(surface, &options, NULL, &fine, &detail), &detail);
    return fine;
}

/* Checks that each vertex has the position and normal that evaluation gives at its parameters. */
static void check_places(const struct gd_subdivision *surface, const struct gd_discretization *fine,
                         double normal_tolerance)
{
    uint32_t count = fine->polygons.position_count;
    struct gd_limit_jet *jets = malloc(count * sizeof *jets);
    check_ok(gd_limit_evaluate_many(surface, &(struct gd_limit_places){fine->places, count}, NULL,
                                    jets, NULL),
             NULL);
    for (uint32_t i = 0; i < count; i++) {
        const double *p = fine->polygons.positions[i];
        check_near(jets[i].position, p[0], p[1], p[2], 1e-13);
        check_near(fine->normals[i], jets[i].normal.x, jets[i].normal.y, jets[i].normal.z,
                   normal_tolerance);
    }
    free(jets);
}

/* Checks that the mesh has no cracks. Its Euler characteristic and boundaries must equal those of
 * the control mesh. */
static void check_mesh(const struct gd_discretization *fine, int64_t euler, uint32_t loops)
{
    struct gd_mesh *mesh = test_mesh(&fine->polygons);
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    assert_int_equal(summary->flipped_faces, 0);
    assert_int_equal(summary->euler_characteristic, euler);
    assert_int_equal(summary->boundaries, loops);
    gd_mesh_release(mesh);
}

static void levels(void **state)
{
    (void)state;
    static const char *const tags[] = {"", "t crease 4/1/0 4 5 7 6 2.5\n",
                                       "t crease 2/1/0 4 5 10\n"};
    char text[1024];
    for (int k = 0; k < 3; k++) {
        snprintf(text, sizeof text, "%s%s", CUBE, tags[k]);
        struct gd_subdivision *cube = surface_from(text, GD_SCHEME_CATMULL_CLARK);
        for (uint32_t level = 0; level < 5; level++) {
            struct gd_discretization fine = fine_of(cube, level, 0);
            assert_int_equal(fine.polygons.polygon_count, 12u << 2 * level);
            check_places(cube, &fine, 1e-9);
            check_mesh(&fine, 2, 0);
            gd_discretization_free(&fine);
        }
        gd_subdivision_release(cube);
    }
    struct gd_subdivision *octahedron = surface_from(OCTAHEDRON, GD_SCHEME_LOOP);
    for (uint32_t level = 0; level < 5; level++) {
        struct gd_discretization fine = fine_of(octahedron, level, 0);
        assert_int_equal(fine.polygons.polygon_count, 8u << 2 * level);
        check_places(octahedron, &fine, 1e-9);
        check_mesh(&fine, 2, 0);
        gd_discretization_free(&fine);
    }
    gd_subdivision_release(octahedron);
}

/* Checks that the centroids of triangles are within the tolerance of the surface. */
static void check_tolerance(const struct gd_subdivision *surface, double tolerance)
{
    struct gd_discretization fine = fine_of(surface, 0, tolerance);
    const struct gd_polygons *p = &fine.polygons;
    double worst = 0;
    for (uint32_t i = 0; i < p->polygon_count; i += p->polygon_count / (1500 / TEST_STRIDE) + 1) {
        struct gd_vec3 middle = {0};
        for (int k = 0; k < 3; k++) {
            const double *q = p->positions[p->corners[3 * i + k]];
            middle = gd_vec3_along(middle, 1.0 / 3, (struct gd_vec3){q[0], q[1], q[2]});
        }
        struct gd_limit_closest foot;
        check_ok(gd_limit_nearest(surface, middle, NULL, &foot, NULL), NULL);
        worst = fmax(worst, foot.distance);
    }
    print_message("# tolerance %g: %u triangles, off by %.2g\n", tolerance, p->polygon_count,
                  worst);
    assert_true(worst <= tolerance && worst > tolerance / 20);
    check_places(surface, &fine, 1e-9);
    check_mesh(&fine, 2, 0);
    gd_discretization_free(&fine);
}

static void tolerances(void **state)
{
    (void)state;
    struct gd_subdivision *surface =
        surface_from(CUBE "t crease 4/1/0 4 5 7 6 2.5\n", GD_SCHEME_CATMULL_CLARK);
    check_tolerance(surface, 0.01);
    if (!TEST_IS_SANITIZED) check_tolerance(surface, 0.0005);
    gd_subdivision_release(surface);
    surface = surface_from(OCTAHEDRON "t crease 3/1/0 0 1 2 10\n", GD_SCHEME_LOOP);
    check_tolerance(surface, 0.01);
    if (!TEST_IS_SANITIZED) check_tolerance(surface, 0.0005);
    gd_subdivision_release(surface);
}

/* Tests a real control mesh with boundaries, quads and triangles. */
static void real_mesh(void **state)
{
    (void)state;
    struct gd_subdivision *surface =
        surface_from_file("../shared/meshes/suzanne.obj", GD_SCHEME_CATMULL_CLARK);
    if (!surface) {
        print_message("# ../shared/meshes/suzanne.obj is not here: skipped\n");
        return;
    }
    struct gd_subdivision_summary summary = gd_subdivision_summary(surface);
    int64_t euler = (int64_t)summary.vertex_count - summary.edge_count + summary.face_count;
    struct gd_discretization fine = fine_of(surface, 2, 0);
    check_places(surface, &fine, 1e-9);
    check_mesh(&fine, euler, summary.boundary_loops);
    gd_discretization_free(&fine);
    fine = fine_of(surface, 0, 0.003);
    check_places(surface, &fine, 1e-9);
    check_mesh(&fine, euler, summary.boundary_loops);
    gd_discretization_free(&fine);
    assert_int_equal(gd_discretize(surface, NULL, NULL, &fine, NULL), GD_INVALID_ARGUMENT);
    gd_subdivision_release(surface);
}

static void refusals(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    struct gd_discretization fine;
    struct gd_discretize_options deep = {.level = 13}, wrong = {.tolerance = -1},
                                 many = {.level = 5, .max_faces = 1000},
                                 tiny = {.tolerance = 1e-9, .max_faces = 10000},
                                 usual = {.level = 7};
    struct gd_control small = {.budget_bytes = 1000}, late = {.deadline_ns = 1};
    assert_int_equal(gd_discretize(cube, &deep, NULL, &fine, NULL), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_discretize(cube, &wrong, NULL, &fine, NULL), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_discretize(cube, &many, NULL, &fine, NULL), GD_TOO_LARGE);
    assert_int_equal(gd_discretize(cube, &tiny, NULL, &fine, NULL), GD_TOO_LARGE);
    assert_int_equal(gd_discretize(cube, &usual, &small, &fine, NULL), GD_BUDGET);
    assert_int_equal(gd_discretize(cube, &usual, &late, &fine, NULL), GD_DEADLINE);
    gd_subdivision_release(cube);
}

static bool count_looks(void *user, double fraction)
{
    (void)fraction;
    ++*(uint32_t *)user;
    return true;
}

/* A tolerance out of reach is refused before any fine grid is computed. */
static void a_hopeless_tolerance_is_refused_early(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    const double tolerances[] = {1e-14, 1e-8};
    for (int i = 0; i < 2; i++) {
        struct gd_discretization fine;
        struct gd_detail detail = {0};
        uint32_t looks = 0;
        const struct gd_control control = {.progress = count_looks, .user = &looks};
        const struct gd_discretize_options options = {.tolerance = tolerances[i],
                                                      .max_faces = 10000000};
        assert_int_equal(gd_discretize(cube, &options, &control, &fine, &detail), GD_TOO_LARGE);
        assert_non_null(strstr(detail.text, "choose a larger one"));
        assert_true(looks < 20);
    }
    gd_subdivision_release(cube);
}

/* The grids that measure a tolerance are larger than the mesh of a single face. They count towards
 * the budget. */
static void grids_count_towards_the_budget(void **state)
{
    (void)state;
    struct gd_subdivision *quad = surface_from(
        "v 0 0 0\nv 1 0 0.3\nv 1 1 0\nv 0 1 0.3\nf 1 2 3 4\n", GD_SCHEME_CATMULL_CLARK);
    struct gd_discretization fine;
    const struct gd_discretize_options options = {.tolerance = 1e-5};
    const struct gd_control small = {.budget_bytes = 4 << 20}, large = {.budget_bytes = 32 << 20};
    assert_int_equal(gd_discretize(quad, &options, &small, &fine, NULL), GD_BUDGET);
    assert_int_equal(gd_discretize(quad, &options, &large, &fine, NULL), GD_OK);
    assert_true(fine.polygons.position_count * 120 < small.budget_bytes);
    gd_discretization_free(&fine);
    gd_subdivision_release(quad);
}

static bool stop_later(void *user, double fraction)
{
    (void)fraction;
    return --*(uint32_t *)user > 0;
}

/* The control is checked within a single face, which has a million vertices at level 10. */
static void a_large_face_checks_the_control(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    struct gd_subdivision *loop = surface_from(OCTAHEDRON, GD_SCHEME_LOOP);
    const struct gd_subdivision *surfaces[] = {cube, loop};
    const struct gd_discretize_options wanted[] = {{.level = 7}, {.tolerance = 2e-3}};
    for (int i = 0; i < 4; i++) {
        struct gd_discretization fine;
        uint32_t looks = 0;
        const struct gd_control control = {.progress = count_looks, .user = &looks};
        assert_int_equal(gd_discretize(surfaces[i / 2], &wanted[i % 2], &control, &fine, NULL),
                         GD_OK);
        assert_true(looks >= 2 * fine.polygons.position_count / 10000);
        gd_discretization_free(&fine);
        looks /= 2;
        const struct gd_control ending = {.progress = stop_later, .user = &looks};
        assert_int_equal(gd_discretize(surfaces[i / 2], &wanted[i % 2], &ending, &fine, NULL),
                         GD_CANCELLED);
    }
    gd_subdivision_release(cube);
    gd_subdivision_release(loop);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(levels),
                                       cmocka_unit_test(tolerances),
                                       cmocka_unit_test(real_mesh),
                                       cmocka_unit_test(refusals),
                                       cmocka_unit_test(a_hopeless_tolerance_is_refused_early),
                                       cmocka_unit_test(grids_count_towards_the_budget),
                                       cmocka_unit_test(a_large_face_checks_the_control)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
