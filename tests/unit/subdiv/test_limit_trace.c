#include "tests/unit/subdiv/surfaces.h"

#include "gd/limit_path.h"

static struct gd_limit_path trace(const struct gd_subdivision *surface, struct gd_limit_point start,
                                  struct gd_vec3 direction, double length)
{
    struct gd_limit_path path = {0};
    struct gd_detail detail = {0};
    check_ok(gd_limit_trace(surface, &start, direction, length, NULL, &path, &detail), &detail);
    return path;
}

static const struct gd_limit_step *last(const struct gd_limit_path *path)
{
    return &path->steps[path->step_count - 1];
}

static double gap(const struct gd_limit_path *path)
{
    return gd_vec3_distance(path->steps[0].position, last(path)->position);
}

/* The two closed geodesics in mirror planes of the smoothed cube. The lengths: quadrature of |S'| along them; the second one's, with Gauss nodes graded towards
 * the four vertices of valence 3, is 5.384418260817. */
static void closed_geodesics(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_path path =
        trace(cube, (struct gd_limit_point){0, 0, 0.3, 0.5}, (struct gd_vec3){1, 0, 0}, 5.344803240448);
    assert_true(gap(&path) < 1e-11);
    for (uint32_t i = 0; i < path.step_count; i++) assert_true(fabs(path.steps[i].position.y) < 1e-13);
    gd_limit_path_free(&path);

    const struct gd_limit_point starts[] = {{0, 0, 0.5, 0.5}, {0, 0, 0.25, 0.25}, {0, 0, 0, 0}};
    for (int k = 0; k < 3; k++) {
        path = trace(cube, starts[k], (struct gd_vec3){1, 1, 0}, 5.384418260817);
        assert_int_equal(path.end, GD_LIMIT_END_LENGTH);
        double off = 0;
        for (uint32_t i = 0; i < path.step_count; i++)
            off = fmax(off, fabs(path.steps[i].position.x - path.steps[i].position.y));
        print_message("# through four vertices: gap %.1e, off the plane %.1e\n", gap(&path), off);
        assert_true(gap(&path) < 1e-8 && off < 1e-8);
        gd_limit_path_free(&path);
    }
    gd_subdivision_release(cube);
}

/* A geodesic traced back is itself, with creases and boundaries or not, in both schemes. */
static void check_back(const struct gd_subdivision *surface, double length, uint32_t faces, int count)
{
    struct rng rng = {11};
    double worst = 0;
    for (int n = 0; n < count; n++) {
        struct gd_limit_point start = {rng_below(&rng, faces), 0, rng_between(&rng, 0, 0.5), rng_between(&rng, 0, 0.5)};
        struct gd_limit_jet jet = jet_at(surface, start.face, 0, start.u, start.v);
        double angle = rng_between(&rng, 0, 2 * M_PI);
        struct gd_vec3 direction = gd_vec3_along(gd_vec3_scale(jet.du, cos(angle)), sin(angle), jet.dv);
        struct gd_limit_path there = trace(surface, start, direction, length);
        if (there.end == GD_LIMIT_END_LENGTH) {
            struct gd_limit_path back = trace(surface, last(&there)->place, gd_vec3_scale(there.direction, -1), length);
            assert_int_equal(back.end, GD_LIMIT_END_LENGTH);
            worst = fmax(worst, gd_vec3_distance(last(&back)->position, jet.position));
            double chords = 0;
            for (uint32_t i = 1; i < there.step_count; i++)
                chords += gd_vec3_distance(there.steps[i].position, there.steps[i - 1].position);
            assert_true(chords <= length * (1 + 1e-12) && chords > 0.9 * length);
            gd_limit_path_free(&back);
        }
        gd_limit_path_free(&there);
    }
    print_message("# there and back: worst %.1e\n", worst);
    assert_true(worst < 1e-8);
}

static void there_and_back(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    check_back(surface, 5, 6, 40);
    gd_subdivision_release(surface);
    surface = surface_from(CUBE "t crease 5/1/0 4 5 7 6 4 10\n", GD_SCHEME_CATMULL_CLARK);
    check_back(surface, 5, 6, 40);
    gd_subdivision_release(surface);
    surface = surface_from(OCTAHEDRON, GD_SCHEME_LOOP);
    check_back(surface, 3, 8, 40);
    gd_subdivision_release(surface);
}

/* In a flat sheet geodesics are straight, to the boundary; the parameters there are not even. */
static void flat(void **state)
{
    (void)state;
    struct gd_control_mesh mesh;
    make_sheet(4, false, &mesh);
    for (uint32_t i = 0; i < mesh.polygons.position_count; i++) mesh.polygons.positions[i][2] = 0;
    struct gd_subdivision *sheet = surface_of(&mesh, GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_point start = {5, 0, 0.3, 0.4};
    struct gd_vec3 from = jet_at(sheet, 5, 0, 0.3, 0.4).position;
    for (int k = 0; k < 36; k++) {
        struct gd_vec3 direction = {cos(k * M_PI / 18), sin(k * M_PI / 18), 0};
        struct gd_limit_path path = trace(sheet, start, direction, 10);
        assert_int_equal(path.end, GD_LIMIT_END_BOUNDARY);
        struct gd_vec3 to = gd_vec3_along(from, path.length, direction);
        check_near(last(&path)->position, to.x, to.y, 0, 1e-11);
        gd_limit_path_free(&path);
    }
    gd_subdivision_release(sheet);
    gd_control_mesh_free(&mesh);
}

static void refusals(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_path path;
    struct gd_limit_point at = {0, 0, 0.5, 0.5};
    struct gd_vec3 up = {0, 0, 1}, none = {0, 0, 0}, along = {1, 0, 0};
    assert_int_equal(gd_limit_trace(cube, &at, up, 1, NULL, &path, NULL), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_limit_trace(cube, &at, none, 1, NULL, &path, NULL), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_limit_trace(cube, &at, along, -1, NULL, &path, NULL), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_limit_trace(cube, &at, along, NAN, NULL, &path, NULL), GD_INVALID_ARGUMENT);
    struct gd_control late = {.deadline_ns = 1}, small = {.budget_bytes = 100};
    assert_int_equal(gd_limit_trace(cube, &at, along, 1, &late, &path, NULL), GD_DEADLINE);
    assert_int_equal(gd_limit_trace(cube, &at, along, 1, &small, &path, NULL), GD_BUDGET);
    path = trace(cube, at, along, 0);
    assert_int_equal(path.step_count, 1);
    gd_limit_path_free(&path);
    gd_subdivision_release(cube);
}

/* A thousand directions on a real control mesh never fail. */
static void real_mesh(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from_file("../shared/meshes/suzanne.obj", GD_SCHEME_CATMULL_CLARK);
    if (!surface) {
        print_message("# ../shared/meshes/suzanne.obj is not here: skipped\n");
        return;
    }
    struct gd_limit_point start = {100, 0, 0.4, 0.3};
    struct gd_limit_jet jet = jet_at(surface, start.face, 0, start.u, start.v);
    for (int k = 0; k < 200; k++) {
        struct gd_vec3 direction =
            gd_vec3_along(gd_vec3_scale(jet.du, cos(k * M_PI / 100)), sin(k * M_PI / 100), jet.dv);
        struct gd_limit_path path = trace(surface, start, direction, 2);
        assert_true(path.end != GD_LIMIT_END_STEPS);
        gd_limit_path_free(&path);
    }
    gd_subdivision_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(closed_geodesics), cmocka_unit_test(there_and_back),
                                       cmocka_unit_test(flat), cmocka_unit_test(refusals), cmocka_unit_test(real_mesh)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
