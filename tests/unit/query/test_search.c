#include "gd/query.h"

#include <math.h>
#include <stdlib.h>

#include "mesh/canonical.h"
#include "wavefront/workspace.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"
#include "tests/support/field.h"
#include "tests/support/test.h"
#include "tests/support/watch.h"

static struct gd_mesh *terrain(uint32_t cells)
{
    struct gd_polygons polygons;
    check_ok(sample_terrain(cells, 0.5, 5, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

/* Builds a disc of triangles around vertex 0 with `rim` vertices on its boundary. */
static struct gd_mesh *disc(uint32_t rim)
{
    struct gd_polygons polygons = {.position_count = rim + 1, .polygon_count = rim};
    polygons.positions = calloc(rim + 1, sizeof *polygons.positions);
    polygons.corners = calloc(rim, 3 * sizeof *polygons.corners);
    assert_true(polygons.positions && polygons.corners);
    for (uint32_t i = 0; i < rim; i++) {
        double angle = 2 * M_PI * i / rim;
        uint32_t *corners = &polygons.corners[3 * (size_t)i];
        polygons.positions[i + 1][0] = cos(angle);
        polygons.positions[i + 1][1] = sin(angle);
        corners[0] = 0, corners[1] = 1 + i, corners[2] = 1 + (i + 1) % rim;
    }
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

static double solve(const struct gd_mesh *mesh, uint32_t a, uint32_t b,
                    const struct gd_control *control)
{
    struct gd_point from = test_vertex(mesh, a), to = test_vertex(mesh, b);
    struct gd_pair_answer answer = {.distance = -1};
    check_ok(gd_pair_solve(mesh, &(struct gd_pair_request){.from = &from, .to = &to}, control,
                           &answer, NULL),
             NULL);
    return answer.distance;
}

/* --- control ---------------------------------------------------------------------------------- */

static bool never(void *user, double fraction)
{
    (void)fraction;
    ++*(int *)user;
    return false;
}

/* Progress increases over both runs of the search. */
static void progress_increases(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(48);
    for (uint32_t to = 100; to < 2300; to += 200) {
        struct test_watch watch = {0};
        struct gd_control control = {.progress = test_watch, .user = &watch};
        solve(mesh, 0, to, &control);
        assert_true(watch.last >= 0.5);
    }
    gd_mesh_release(mesh);
}

/* A target on another component is detected without a search. */
static void other_components_are_not_searched(void **state)
{
    (void)state;
    struct gd_polygons polygons, part;
    check_ok(sample_icosphere(3, 1, &polygons), NULL);
    check_ok(sample_icosphere(1, 1, &part), NULL);
    for (uint32_t i = 0; i < part.position_count; i++) part.positions[i][0] += 5;
    uint32_t last = polygons.position_count;
    check_ok(sample_append(&polygons, &part), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_control control = {.workspace = gd_workspace_create()};
    assert_true(isinf(solve(mesh, last, 7, &control)) && isinf(solve(mesh, 7, last, &control)));
    assert_int_equal(control.workspace->guide.capacity, 0);
    assert_true(solve(mesh, last, last + 3, &control) > 0);
    gd_workspace_destroy(control.workspace);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    gd_polygons_free(&part);
}

static enum gd_status aim(struct gd__guide *guide, const struct gd_mesh *mesh, uint32_t to,
                          const struct gd_control *control)
{
    struct gd_point from = test_vertex(mesh, 0), target = test_vertex(mesh, to);
    double upper = 0;
    enum gd_status status = gd__guide_aim(guide, mesh, &from, &target, control, &upper);
    if (!status) assert_true(upper > 0 && upper < GD__FAR);
    return status;
}

static void check_clean(const struct gd__guide *guide, const struct gd_mesh *mesh)
{
    for (uint32_t v = 0; v < mesh->vertex_count && guide->node; v++) {
        const struct gd__guide_node *node = &guide->node[v];
        assert_true(node->upper >= GD__FAR && node->lower < 0 && node->parent == GD_NONE &&
                    node->across == GD_NONE);
        assert_true(!node->closed && !node->touched);
        assert_true(!guide->rings.hops || guide->rings.hops[v] == 0);
    }
}

/* The guide checks the control before the first window is propagated. */
static void the_guide_checks_its_control(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(64);
    uint32_t far = 65 * 65 - 1;
    int asked = 0;
    struct gd_control cancel = {.progress = never, .user = &asked}, late = {.deadline_ns = 1};
    struct gd__guide guide = {0};
    assert_int_equal(aim(&guide, mesh, far, &cancel), GD_CANCELLED);
    assert_int_equal(asked, 1);
    gd__guide_clean(&guide);
    check_clean(&guide, mesh);
    assert_int_equal(aim(&guide, mesh, far, &late), GD_DEADLINE);
    gd__guide_clean(&guide);
    check_clean(&guide, mesh);
    gd__guide_destroy(&guide);
    gd_mesh_release(mesh);
}

/* The guide's nodes, lists and heap count against the budget. Without memory for more nodes, the
 * guide still returns bounds, and gd__guide_clean resets it completely. */
static void the_guide_respects_the_budget(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(64);
    struct gd__guide guide = {0};
    size_t nodes = mesh->vertex_count * sizeof *guide.node;
    struct gd_control poor = {.budget_bytes = nodes - 1}, tight = {.budget_bytes = nodes + 64};
    assert_int_equal(aim(&guide, mesh, 100, &poor), GD_BUDGET);
    assert_null(guide.node);
    assert_int_equal(aim(&guide, mesh, 100, &tight), GD_BUDGET);
    gd__guide_clean(&guide);
    check_ok(aim(&guide, mesh, 500, NULL), NULL);
    guide.touched_capacity = guide.touched_count; /* the guide has no memory for further nodes */
    struct gd_control spent = {.budget_bytes = gd__guide_held(&guide)};
    guide.control = &spent;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) assert_true(gd__guide_lower(&guide, v) >= 0);
    assert_int_equal(guide.touched_count, guide.touched_capacity);
    gd__guide_clean(&guide);
    check_clean(&guide, mesh);
    gd__guide_destroy(&guide);
    gd_mesh_release(mesh);
}

/* After gd__guide_turn, the bounds of the guide are bounds of the distances to the other end. */
static void a_turned_guide_has_bounds_to_the_other_end(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(32);
    struct gd_point from = test_vertex(mesh, 0), to = test_vertex(mesh, 700);
    struct gd_field *field = test_field_from(mesh, from);
    struct gd__guide guide = {0};
    double upper, exact;
    check_ok(gd__guide_aim(&guide, mesh, &from, &to, NULL, &upper), NULL);
    check_ok(gd__guide_turn(&guide, &from), NULL);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        check_ok(gd_field_distance(field, &(struct gd_point){.kind = GD_POINT_VERTEX, .element = v},
                                   &exact),
                 NULL);
        assert_true(gd__guide_lower(&guide, v) <= exact / mesh->unit);
        assert_true(guide.node[v].upper >= exact / mesh->unit);
    }
    gd__guide_clean(&guide);
    check_clean(&guide, mesh);
    gd__guide_destroy(&guide);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* Most pairs are searched from the same end, whichever end is given first. */
static void both_directions_search_from_one_end(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(32);
    struct rng rng = {3};
    uint32_t one = 0, pairs = 200;
    for (uint32_t i = 0; i < pairs; i++) {
        struct gd_point a = {.kind = GD_POINT_VERTEX,
                             .element = rng_below(&rng, mesh->vertex_count)},
                        b = {.kind = GD_POINT_VERTEX,
                             .element = rng_below(&rng, mesh->vertex_count)};
        struct gd__guide guide = {0};
        double upper;
        check_ok(gd__guide_aim(&guide, mesh, &a, &b, NULL, &upper), NULL);
        bool forth = gd__guide_prefers_turn(&guide, &a);
        gd__guide_clean(&guide);
        check_ok(gd__guide_aim(&guide, mesh, &b, &a, NULL, &upper), NULL);
        one += forth != gd__guide_prefers_turn(&guide, &b);
        gd__guide_clean(&guide);
        gd__guide_destroy(&guide);
    }
    print_message("# of %u pairs %u are searched from the same end in either order\n", pairs, one);
    assert_true(one > 0.8 * pairs);
    gd_mesh_release(mesh);
}

/* After a search that failed for lack of budget, the workspace solves the next pair as a new
 * workspace would. */
static void a_failed_search_leaves_nothing(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(32);
    uint32_t far = 33 * 33 - 1, failed = 0;
    struct gd_point from = test_vertex(mesh, 0), to = test_vertex(mesh, far);
    double expected = solve(mesh, far, 0, NULL);
    struct gd_control usual = {.workspace = gd_workspace_create()}, poor = usual;
    enum gd_status status = GD_BUDGET;
    for (poor.budget_bytes = 10000; status == GD_BUDGET;
         poor.budget_bytes += poor.budget_bytes / 20) {
        struct gd_pair_answer answer = {.distance = -1};
        status = gd_pair_solve(mesh, &(struct gd_pair_request){.from = &from, .to = &to}, &poor,
                               &answer, NULL);
        check_close(solve(mesh, far, 0, &usual), expected, 1e-15);
        failed += status == GD_BUDGET;
    }
    check_ok(status, NULL);
    assert_true(failed > 10);
    gd_workspace_destroy(usual.workspace);
    gd_mesh_release(mesh);
}

/* A search for a path close to a vertex with a large fan visits the fan a few times, not once for
 * each vertex of the fan. */
static void large_fans_are_visited_a_few_times(void **state)
{
    (void)state;
    struct gd_mesh *mesh = disc(4000);
    struct gd__guide guide = {0};
    struct gd_point from = test_vertex(mesh, 1), to = test_vertex(mesh, 400);
    double upper;
    check_ok(gd__guide_aim(&guide, mesh, &from, &to, NULL, &upper), NULL);
    print_message("# a hub of 4000: %u entries of fans were checked\n", guide.steps);
    assert_true(guide.steps < 10 * 4000);
    gd__guide_clean(&guide);
    gd__guide_destroy(&guide);
    check_close(solve(mesh, 1, 400, NULL), 2 * sin(M_PI * 399 / 4000), 1e-6);
    gd_mesh_release(mesh);
}

/* The distance of two points close to a vertex is their Euclidean distance. The path through the
 * vertex is hardly longer but not the shortest. */
static struct gd_point random_point(const struct gd_mesh *mesh, uint32_t kind, struct rng *rng)
{
    double weight[3] = {rng_between(rng, 0.1, 0.4), rng_between(rng, 0.1, 0.4)};
    weight[2] = 1 - weight[0] - weight[1];
    switch (kind) {
    case 0:
        return gd__point_of_vertex(rng_below(rng, mesh->vertex_count));
    case 1:
        return gd__point_of_edge(mesh, rng_below(rng, mesh->edge_count), weight[0]);
    default:
        return gd__point_of_face(mesh, rng_below(rng, mesh->face_count), weight);
    }
}

/* A search of a distance stores wedges only for the target's faces, a search of a path all. */
static void distances_are_those_of_paths(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(24);
    struct rng rng = {4};
    for (uint32_t i = 0; i < 300; i++) {
        struct gd_point from = random_point(mesh, i / 3 % 3, &rng),
                        to = random_point(mesh, i % 3, &rng);
        struct gd_pair_request request = {.from = &from, .to = &to};
        struct gd_pair_answer answer, by_path;
        check_ok(gd_pair_solve(mesh, &request, NULL, &answer, NULL), NULL);
        request.output = GD_PAIR_PATH;
        check_ok(gd_pair_solve(mesh, &request, NULL, &by_path, NULL), NULL);
        assert_true(answer.distance == by_path.distance);
        gd_pair_answer_free(&by_path);
    }
    gd_mesh_release(mesh);
}

static void points_close_to_a_vertex(void **state)
{
    (void)state;
    struct rng rng = {1};
    struct gd_polygons polygons;
    check_ok(sample_grid(8, 8, 1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int i = 0; i < 3000; i++) {
        double size = pow(10, rng_between(&rng, -14, -8));
        struct gd_vec3 xyz[2];
        struct gd_point point[2];
        struct gd_pair_answer answer;
        for (int k = 0; k < 2; k++) {
            xyz[k] = (struct gd_vec3){0.25 + size * (rng_unit(&rng) - 0.5),
                                      0.5 + size * (rng_unit(&rng) - 0.5), 0};
            check_ok(gd_locate_nearest(mesh, xyz[k], -1, &point[k], NULL), NULL);
        }
        check_ok(gd_pair_solve(mesh,
                               &(struct gd_pair_request){
                                   .from = &point[0], .to = &point[1], .output = GD_PAIR_PATH},
                               NULL, &answer, NULL),
                 NULL);
        assert_true(fabs(answer.distance - gd_vec3_distance(xyz[0], xyz[1])) < 4e-15);
        gd_pair_answer_free(&answer);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Like points_close_to_a_vertex, but with a point of an edge and the end of this edge at the
 * origin. At the origin, coordinates are exact but edge lengths are rounded. */
static void points_close_to_a_vertex_at_the_origin(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_box((double[3]){1, 1, 1}, (uint32_t[3]){1, 1, 1}, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point corner = test_vertex(mesh, 0), point;
    for (uint32_t other = 1; other < 8; other++) {
        for (double t = 1e-14; t < 1e-6; t *= 1.7) {
            struct gd_pair_answer answer;
            if (gd_point_on_edge(mesh, (struct gd_vertex[]){{0}, {other}}, t, &point, NULL))
                continue;
            double length = gd_vec3_distance(gd_mesh_position(mesh, (struct gd_vertex){0}),
                                             gd_mesh_position(mesh, (struct gd_vertex){other}));
            check_ok(gd_pair_solve(mesh,
                                   &(struct gd_pair_request){
                                       .from = &point, .to = &corner, .output = GD_PAIR_PATH},
                                   NULL, &answer, NULL),
                     NULL);
            assert_true(fabs(answer.distance - t * length) < 4e-15);
            gd_pair_answer_free(&answer);
        }
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(progress_increases),
        cmocka_unit_test(other_components_are_not_searched),
        cmocka_unit_test(the_guide_checks_its_control),
        cmocka_unit_test(the_guide_respects_the_budget),
        cmocka_unit_test(a_turned_guide_has_bounds_to_the_other_end),
        cmocka_unit_test(both_directions_search_from_one_end),
        cmocka_unit_test(a_failed_search_leaves_nothing),
        cmocka_unit_test(large_fans_are_visited_a_few_times),
        cmocka_unit_test(distances_are_those_of_paths),
        cmocka_unit_test(points_close_to_a_vertex),
        cmocka_unit_test(points_close_to_a_vertex_at_the_origin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
