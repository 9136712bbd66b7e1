#include "guide/guide.h"

#include <math.h>
#include "base/tolerance.h"
#include "gd/landmarks.h"
#include "mesh/topology.h"
#include "query/landmarks.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"
#include "tests/support/test.h"
#include "guide/guide.h"

/* A guide, which holds lower bounds of distances to the end `to`, and the exact fields of both
 * ends. Distances are in the normalised unit. */
struct scene {
    struct gd_mesh *mesh;
    struct gd_point from, to;
    struct gd_field *of_from, *of_to;
    double distance;
    struct gd__guide guide;
};

static double inside(const struct scene *scene, const struct gd_field *field, uint32_t vertex)
{
    return test_distance(field, &(struct gd_point){.kind = GD_POINT_VERTEX, .element = vertex}) /
           scene->mesh->unit;
}

/* `landmarks` may be NULL. */
static void open_scene(struct scene *scene, struct gd_mesh *mesh,
                       const struct gd_landmarks *landmarks, struct gd_point from,
                       struct gd_point to)
{
    double upper;
    *scene = (struct scene){.mesh = mesh, .from = from, .to = to};
    scene->of_from = test_field_from(mesh, from);
    scene->of_to = test_field_from(mesh, to);
    scene->distance = test_distance(scene->of_from, &to) / mesh->unit;
    gd__landmarks_offer(landmarks, mesh, &scene->guide);
    check_ok(gd__guide_aim(&scene->guide, mesh, &from, &to, NULL, &upper), NULL);
}

static void close_scene(struct scene *scene)
{
    gd__guide_clean(&scene->guide);
    gd__guide_destroy(&scene->guide);
    gd_field_release(scene->of_from);
    gd_field_release(scene->of_to);
}

/* Checks the lower bound of each vertex through which a path of at most the length `bound` leads.
 * This lower bound must be at most the exact distance. Returns the number of these vertices. */
static uint32_t check_bounds(struct scene *scene, double bound)
{
    uint32_t passed = 0;
    for (uint32_t v = 0; v < scene->mesh->vertex_count; v++) {
        double rest = inside(scene, scene->of_to, v), lower = gd__guide_lower(&scene->guide, v);
        bool may_pass = inside(scene, scene->of_from, v) + rest <= bound;
        if (may_pass) assert_true(lower <= rest);
        passed += may_pass;
    }
    return passed;
}

static void check_pairs(const char *name, struct gd_polygons *polygons, uint32_t pairs)
{
    struct rng rng = {5};
    struct gd_mesh *mesh = test_mesh(polygons);
    struct gd_landmarks *landmarks;
    uint32_t drawn = 0, passed = 0;
    check_ok(gd_landmarks_build(mesh, 6, NULL, &landmarks), NULL);
    for (uint32_t i = 0; i < pairs; i += TEST_IS_SANITIZED ? 4 : 1) {
        struct scene scene;
        open_scene(&scene, mesh, i % 8 < 4 ? landmarks : NULL,
                   test_point(mesh, test_random_place(polygons, &rng)),
                   test_point(mesh, test_random_place(polygons, &rng)));
        for (double excess = 0; excess < 0.5; excess += 0.12) {
            double bound = scene.distance * (1 + excess) * (1 + GD_TOL_BOUND) + scene.guide.margin;
            check_ok(gd__rings_draw(&scene.guide, &scene.from, bound), NULL);
            drawn += scene.guide.rings.count > 1;
            passed += check_bounds(&scene, bound);
        }
        close_scene(&scene);
    }
    print_message("# %s: rings for %u of %u bounds, %u vertices on ways\n", name, drawn, 5 * pairs,
                  passed);
    assert_true(drawn > 0);
    gd_landmarks_release(landmarks);
    gd_mesh_release(mesh);
    gd_polygons_free(polygons);
}

static void bounds_are_below_distances(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(4, 1, &polygons), NULL);
    check_pairs("icosphere", &polygons, 20);
    check_ok(sample_torus(90, 50, 1, 0.4, &polygons), NULL);
    check_pairs("torus", &polygons, 20);
    check_ok(sample_terrain(60, 0.6, 3, &polygons), NULL);
    check_pairs("terrain", &polygons, 20);
    check_ok(sample_terrain(40, 20, 3, &polygons), NULL);
    check_pairs("steep terrain", &polygons, 20);
    check_ok(sample_box((const double[3]){1, 2, 3}, (const uint32_t[3]){16, 24, 32}, &polygons),
             NULL);
    check_pairs("box", &polygons, 20);
    check_ok(sample_cylinder(1, 3, 90, 40, &polygons), NULL);
    check_pairs("cylinder", &polygons, 20);
    check_ok(sample_saddle(1, 0.5, 60, 24, &polygons), NULL);
    check_pairs("saddle", &polygons, 10);
}

/* Opens a scene with two points on opposite sides of a sphere. */
static struct gd_mesh *open_half_round(struct scene *scene, struct gd_polygons *polygons)
{
    check_ok(sample_icosphere(5, 1, polygons), NULL);
    struct gd_mesh *mesh = test_mesh(polygons);
    open_scene(scene, mesh, NULL, test_point_near(mesh, 0.2, 0.3, 2),
               test_point_near(mesh, 0.3, 0.2, -2));
    return mesh;
}

/* The straight line between opposite points of a sphere is two thirds as long as the path. */
static void rings_go_round(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct scene scene;
    struct gd_mesh *mesh = open_half_round(&scene, &polygons);
    uint32_t corner = gd__anchor(mesh, &scene.from).corner[0];
    double exact = inside(&scene, scene.of_to, corner),
           straight = gd__guide_lower(&scene.guide, corner);
    check_ok(gd__rings_draw(&scene.guide, &scene.from, scene.distance * (1 + GD_TOL_TETHER)), NULL);
    double rings = gd__guide_lower(&scene.guide, corner);
    print_message("# half round a sphere: %.4f of the way by a straight line, %.4f by %u rings\n",
                  straight / exact, rings / exact, scene.guide.rings.count);
    assert_true(straight < 0.72 * exact && rings > 0.97 * exact && rings <= exact);
    close_scene(&scene);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static bool never(void *user, double fraction)
{
    (void)user, (void)fraction;
    return false;
}

/* A failed call of gd__rings_draw leaves no rings and does not change the bounds. Every budget up
 * to a sufficient one is tested. */
static void a_failure_leaves_no_rings(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct scene scene;
    struct gd_mesh *mesh = open_half_round(&scene, &polygons);
    struct gd__guide *guide = &scene.guide;
    size_t held = gd__guide_held(guide);
    double before = gd__guide_lower(guide, 7), bound = scene.distance * 1.01;
    guide->control = &(struct gd_control){.progress = never};
    assert_int_equal(gd__rings_draw(guide, &scene.from, bound), GD_CANCELLED);
    assert_int_equal(guide->rings.count, 0);
    assert_true(gd__guide_lower(guide, 7) == before);
    gd__rings_destroy(&guide->rings);
    enum gd_status status = GD_BUDGET;
    uint32_t failed = 0;
    for (struct gd_control poor = {.budget_bytes = held}; status == GD_BUDGET;
         poor.budget_bytes += 20000, failed++) {
        guide->control = &poor;
        status = gd__rings_draw(guide, &scene.from, bound);
        assert_true((guide->rings.count > 0) == (status == GD_OK));
        if (status) assert_true(gd__guide_lower(guide, 7) == before);
    }
    check_ok(status, NULL);
    assert_true(failed > 5);
    assert_true(gd__guide_held(guide) > held + gd__rings_held(&guide->rings) - 1);
    close_scene(&scene);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_are_below_distances),
        cmocka_unit_test(rings_go_round),
        cmocka_unit_test(a_failure_leaves_no_rings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
