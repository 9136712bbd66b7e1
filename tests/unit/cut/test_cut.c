#include "cutting.h"

#include <stdio.h>

#include "gd/query.h"
#include "tests/samples/zoo.h"
#include "tests/support/laws.h"
#include "tests/support/shared.h"
#include "tests/support/watch.h"

/* --- closed forms ----------------------------------------------------------------------------- */

static void a_straight_cut_of_a_square(void **state)
{
    (void)state;
    for (uint32_t cells = 1; cells <= 9; cells += 4) {
        struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){cells, cells, 1, 1});
        const struct gd_point ends[] = {point_at(mesh, 0.3, 0, 0), point_at(mesh, 0.3, 1, 0)};
        struct cutting cutting = cutting_through(mesh, ends, 2, false);
        check_cutting(mesh, &cutting, 1e-12);
        assert_true(cutting.cut.separates);
        assert_int_equal(cutting.cut.piece_count, 2);
        double least = fmin(cutting.cut.pieces[0].area, cutting.cut.pieces[1].area);
        check_close(least, 0.3, 1e-12);
        assert_true(cutting.cut.largest_shift < 1e-15);
        cutting_free(&cutting);
        gd_mesh_release(mesh);
    }
}

/* A curve around the middle of a box leaves two open boxes. */
static void the_waist_of_a_box(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("box", (double[SAMPLE_PARAMETERS]){1, 1, 2, 2});
    const struct gd_point points[] = {point_at(mesh, 0, 0, 0.7), point_at(mesh, 1, 0, 0.7),
                                      point_at(mesh, 1, 1, 0.7), point_at(mesh, 0, 1, 0.7)};
    struct cutting cutting = cutting_through(mesh, points, 4, true);
    check_cutting(mesh, &cutting, 1e-12);
    assert_int_equal(cutting.cut.piece_count, 2);
    check_close(fmin(cutting.cut.pieces[0].area, cutting.cut.pieces[1].area), 1 + 4 * 0.7, 1e-12);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(gd_mesh_summary(cutting.pieces[i])->boundaries, 1);
        check_close(gd_mesh_boundary(cutting.pieces[i], 0).length, 4, 1e-12);
    }
    cutting_free(&cutting);
    gd_mesh_release(mesh);
}

/* Tests a curve that consists only of points inside faces. */
static void a_hole_in_one_face(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){1, 1, 1, 1});
    double weights[][3] = {{0.6, 0.2, 0.2}, {0.2, 0.6, 0.2}, {0.2, 0.2, 0.6}};
    struct gd_point points[3];
    for (int i = 0; i < 3; i++)
        check_ok(gd_point_in_face(mesh, (struct gd_face){1}, weights[i], &points[i], NULL), NULL);
    struct cutting cutting = cutting_through(mesh, points, 3, true);
    check_cutting(mesh, &cutting, 1e-12);
    assert_int_equal(cutting.cut.piece_count, 2);
    check_close(cutting.cut.pieces[1].area, 0.5 * 0.16, 1e-12);
    assert_int_equal(cutting.cut.pieces[1].face_count, 1);
    assert_int_equal(gd_mesh_summary(cutting.pieces[0])->boundaries, 2);
    cutting_free(&cutting);
    gd_mesh_release(mesh);
}

/* --- curves that do not separate the mesh ----------------------------------------------------- */

static void round_a_handle(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("torus", (double[SAMPLE_PARAMETERS]){24, 12, 1, 0.4});
    struct gd_point round_tube[4], round_axis[6];
    for (int i = 0; i < 4; i++)
        check_ok(gd_locate_nearest(
                     mesh, (struct gd_vec3){1 + 0.4 * cos(1.5 * i), 0.05, 0.4 * sin(1.5 * i)}, -1,
                     &round_tube[i], NULL),
                 NULL);
    for (int i = 0; i < 6; i++)
        check_ok(gd_locate_nearest(mesh,
                                   (struct gd_vec3){1.4 * cos(1.05 * i), 1.4 * sin(1.05 * i), 0.03},
                                   -1, &round_axis[i], NULL),
                 NULL);
    struct cutting tube = cutting_through(mesh, round_tube, 4, true),
                   axis = cutting_through(mesh, round_axis, 6, true);
    struct cutting *both[] = {&tube, &axis};
    for (int i = 0; i < 2; i++) {
        check_cutting(mesh, both[i], 1e-12);
        assert_false(both[i]->cut.separates);
        assert_int_equal(both[i]->cut.piece_count, 1);
        assert_int_equal(gd_mesh_summary(both[i]->pieces[0])->boundaries, 2);
        assert_int_equal(gd_mesh_summary(both[i]->pieces[0])->genus, 0);
        cutting_free(both[i]);
    }
    gd_mesh_release(mesh);
}

/* A cut from one rim of a tube to the other leaves a rectangle. */
static void along_a_tube(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 12, 3});
    struct gd_point ends[2];
    for (int i = 0; i < 2; i++)
        check_ok(gd_locate_nearest(mesh, (struct gd_vec3){0.9, 0.2, i * 2.0}, -1, &ends[i], NULL),
                 NULL);
    struct cutting cutting = cutting_through(mesh, ends, 2, false);
    check_cutting(mesh, &cutting, 1e-12);
    assert_false(cutting.cut.separates);
    assert_int_equal(gd_mesh_summary(cutting.pieces[0])->boundaries, 1);
    assert_int_equal(gd_mesh_summary(cutting.pieces[0])->euler_characteristic, 1);
    cutting_free(&cutting);
    gd_mesh_release(mesh);
}

/* --- through vertices, along edges, at boundaries --------------------------------------------- */

static void along_edges(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){4, 4, 1, 1});
    static const struct gd_vertex ring[] = {{6}, {7}, {8}, {13}, {18}, {17}, {16}, {11}};
    const struct gd_curve_request request = {
        .kind = GD_CURVE_VERTICES, .closed = true, .count = COUNT(ring), .vertices = ring};
    struct gd_curve curve;
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
    struct cutting cutting = cutting_along(mesh, &curve);
    check_cutting(mesh, &cutting, 1e-12);
    assert_int_equal(cutting.cut.piece_count, 2);
    check_close(cutting.cut.pieces[1].area, 0.25, 1e-12);
    for (uint32_t p = 0; p < 2; p++)
        for (uint32_t i = 0; i < cutting.cut.pieces[p].polygons.position_count; i++)
            assert_int_not_equal(cutting.cut.pieces[p].vertex_map[i], GD_NONE);
    gd_curve_free(&curve);
    cutting_free(&cutting);
    gd_mesh_release(mesh);
}

/* Tests polygons on a flat grid. Their corners and sides meet vertices, edges and the boundary in
 * every way. Expected areas are from the shoelace formula. */
static void polygons_on_a_grid(void **state)
{
    (void)state;
    static const struct {
        double corners[6][2];
        uint32_t count, pieces;
        double areas[2]; /* the areas of all pieces except the outermost piece */
    } polygons[] = {
        /* leads through vertices and along edges */
        {{{0.25, 0.25}, {0.75, 0.25}, {0.75, 0.75}, {0.25, 0.75}}, 4, 2, {0.25}},
        /* leads through vertices and faces */
        {{{0.25, 0.25}, {0.75, 0.5}, {0.5, 0.75}}, 3, 2, {0.09375}},
        /* through faces */
        {{{0.1, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.1, 0.9}}, 4, 2, {0.64}},
        /* touches a boundary vertex */
        {{{0.5, 0}, {0.75, 0.5}, {0.25, 0.5}}, 3, 2, {0.125}},
        /* touches a boundary edge */
        {{{0.6, 0}, {0.75, 0.5}, {0.25, 0.5}}, 3, 2, {0.125}},
        /* runs along the boundary */
        {{{0.2, 0}, {0.6, 0}, {0.4, 0.3}}, 3, 2, {0.06}},
        /* a figure of eight */
        {{{0.2, 0.2}, {0.8, 0.8}, {0.8, 0.2}, {0.2, 0.8}}, 4, 3, {0.09, 0.09}},
        /* through faces */
        {{{0.2, 0.21}, {0.83, 0.8}, {0.83, 0.21}, {0.2, 0.8}}, 4, 3, {0.092925, 0.092925}},
    };
    struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){4, 4, 1, 1});
    for (size_t i = 0; i < COUNT(polygons); i++) {
        struct gd_point points[6];
        for (uint32_t k = 0; k < polygons[i].count; k++)
            points[k] = point_at(mesh, polygons[i].corners[k][0], polygons[i].corners[k][1], 0);
        struct cutting cutting = cutting_through(mesh, points, polygons[i].count, true);
        check_cutting(mesh, &cutting, 1e-12);
        assert_int_equal(cutting.cut.piece_count, polygons[i].pieces);
        for (uint32_t p = 1; p < polygons[i].pieces; p++) {
            double least = INFINITY;
            for (uint32_t k = 0; k < cutting.cut.piece_count; k++)
                least = fmin(least, fabs(cutting.cut.pieces[k].area - polygons[i].areas[p - 1]));
            assert_true(least < 1e-12);
        }
        cutting_free(&cutting);
    }
    gd_mesh_release(mesh);
}

/* A corner of the curve is moved to a very close vertex. largest_shift reports the distance. */
static void a_corner_is_moved_to_a_vertex(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){4, 4, 1000, 1000});
    const struct gd_point points[] = {point_at(mesh, 250 + 2e-4, 250, 0),
                                      point_at(mesh, 600, 300, 0), point_at(mesh, 400, 700, 0)};
    struct cutting cutting = cutting_through(mesh, points, 3, true);
    check_cutting(mesh, &cutting, 1e-12);
    check_close(cutting.cut.largest_shift, 2e-4, 1e-6);
    check_close(fmin(cutting.cut.pieces[0].area, cutting.cut.pieces[1].area), 75000, 1e-6);
    cutting_free(&cutting);
    gd_mesh_release(mesh);
}

/* --- random curves ---------------------------------------------------------------------------- */

/* Returns a random point of the component, or of any component if `component` is GD_NONE. */
static struct gd_point random_point(const struct gd_mesh *mesh, uint32_t component, struct rng *rng)
{
    for (;;) {
        struct gd_face face = {rng_below(rng, gd_mesh_summary(mesh)->face_index_count)};
        double u = rng_unit(rng), v = rng_unit(rng) * (1 - u);
        uint32_t kind = rng_below(rng, 4);
        const double weight[3] = {kind == 0 ? 1 : 1 - u - v, kind == 0 ? 0 : u, kind == 0 ? 0 : v};
        struct gd_point point;
        if (!gd_mesh_has_face(mesh, face)) continue;
        check_ok(gd_point_in_face(mesh, face, weight, &point, NULL), NULL);
        if (component == GD_NONE || gd_point_component(mesh, &point) == component) return point;
    }
}

/* A distance within a piece is at least the distance on the whole mesh. */
static void check_distances(const struct gd_mesh *mesh, const struct cutting *cutting,
                            struct rng *rng)
{
    uint32_t p = rng_below(rng, cutting->cut.piece_count);
    const struct gd_cut_piece *piece = &cutting->cut.pieces[p];
    uint32_t a = rng_below(rng, piece->polygons.position_count),
             b = rng_below(rng, piece->polygons.position_count);
    if (piece->vertex_map[a] == GD_NONE || piece->vertex_map[b] == GD_NONE) return;
    double inside = law_distance(cutting->pieces[p], vertex_of(cutting->pieces[p], a),
                                 vertex_of(cutting->pieces[p], b));
    double whole = law_distance(mesh, vertex_of(mesh, piece->vertex_map[a]),
                                vertex_of(mesh, piece->vertex_map[b]));
    assert_true(isfinite(inside));
    assert_true(inside >= whole * (1 - 1e-9));
}

struct tally {
    uint32_t cuts, separating, empty, flat;
};

/* Cuts along closed curves through 2 to 6 random points of one component. Some curves enclose
 * nothing or meet an almost flat face. */
static struct tally cut_at_random(const struct gd_mesh *mesh, uint32_t curves, uint64_t seed,
                                  double relative)
{
    struct rng rng = {seed};
    struct tally tally = {0};
    for (uint32_t i = 0; i < curves; i++) {
        struct gd_point points[6];
        uint32_t count = 2 + rng_below(&rng, 5);
        points[0] = random_point(mesh, GD_NONE, &rng);
        for (uint32_t k = 1; k < count; k++)
            points[k] = random_point(mesh, gd_point_component(mesh, &points[0]), &rng);
        struct gd_curve curve = curve_through(mesh, points, count, true);
        const struct gd_cut_request request = {.curve = &curve, .select_only = true};
        struct gd_cut selection;
        struct gd_detail detail = {0};
        enum gd_status status = gd_cut_along(mesh, &request, NULL, &selection, &detail);
        if (status == GD_INVALID_ARGUMENT) {
            bool is_empty = strstr(detail.text, "cuts nothing");
            tally.empty += is_empty;
            tally.flat += !is_empty;
        } else {
            check_ok(status, &detail);
            gd_cut_free(&selection);
            struct cutting cutting = cutting_along(mesh, &curve);
            check_cutting(mesh, &cutting, relative);
            check_distances(mesh, &cutting, &rng);
            tally.cuts++;
            tally.separating += cutting.cut.separates;
            cutting_free(&cutting);
        }
        gd_curve_free(&curve);
    }
    return tally;
}

static void random_curves_on_samples(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"icosphere", {3, 1}},      {"torus", {20, 10, 1, 0.4}},
                    {"terrain", {14, 0.8, 3}},  {"genus2", {5, 0.2}},
                    {"saddle", {1, 0.7, 8, 4}}, {"cylinder", {1, 2, 9, 3}},
                    {"tetrahedron", {1, 1}},    {"box", {1, 2, 3, 2}}};
    for (size_t i = 0; i < COUNT(surfaces); i++) {
        struct gd_mesh *mesh = sample_mesh(surfaces[i].name, surfaces[i].values);
        struct tally tally = cut_at_random(mesh, 12, i, 1e-12);
        assert_int_equal(tally.flat, 0);
        assert_true(tally.separating > 0);
        gd_mesh_release(mesh);
    }
}

/* Tests slivers, saddles and boundaries at every scale, and far from the origin, where the
 * positions of new vertices have larger rounding errors. */
static void random_curves_on_tangles(void **state)
{
    (void)state;
    static const double placings[][2] = {{1, 0}, {1e-6, 0}, {1e6, 0}, {1, 1e6}};
    uint32_t flat = 0, cuts = 0;
    for (uint32_t i = 0; i < 24; i++) {
        struct zoo_shape shape;
        const double *placing = placings[i % 4];
        check_ok(zoo_tangle((double[]){i, 120, placing[0], placing[1]}, &shape), NULL);
        struct gd_mesh *mesh = test_mesh(&shape.mesh);
        struct tally tally = cut_at_random(mesh, 6, i, placing[1] > 0 ? 1e-8 : 1e-12);
        flat += tally.flat;
        cuts += tally.cuts;
        gd_mesh_release(mesh);
        zoo_shape_free(&shape);
    }
    print_message("# %u cuts of tangles, %u met a face too flat\n", cuts, flat);
    assert_true(cuts > 100 && flat == 0);
}

/* In a face flatter than 1e-5, most points are so close to the border that a curve can't pass
 * through them. The engine refuses some of the random curves. */
static void random_curves_on_slivers(void **state)
{
    (void)state;
    for (int exponent = 2; exponent <= 6; exponent++) {
        struct zoo_shape shapes[3];
        struct tally all = {0};
        check_ok(zoo_cap((double[]){pow(10, -exponent)}, &shapes[0]), NULL);
        check_ok(zoo_needles((double[]){6, 2, pow(10, -exponent), 0.3}, &shapes[1]), NULL);
        check_ok(zoo_spike((double[]){6, pow(10, exponent - 1)}, &shapes[2]), NULL);
        for (int i = 0; i < 3; i++) {
            struct gd_mesh *mesh = test_mesh(&shapes[i].mesh);
            struct tally tally = cut_at_random(mesh, 20, (uint64_t)exponent, 1e-9);
            all.flat += tally.flat;
            all.cuts += tally.cuts;
            gd_mesh_release(mesh);
            zoo_shape_free(&shapes[i]);
        }
        print_message("# flatness 1e-%d: %u cuts, %u refused\n", exponent, all.cuts, all.flat);
        assert_true(exponent > 4 ? all.cuts > all.flat : all.flat == 0);
    }
}

/* --- refusals --------------------------------------------------------------------------------- */

static void expect_refusal(const struct gd_mesh *mesh, struct gd_curve curve, const char *part)
{
    struct gd_detail detail = {0};
    struct gd_cut cut, untouched;
    memset(&cut, 7, sizeof cut);
    memset(&untouched, 7, sizeof untouched);
    const struct gd_cut_request request = {.curve = &curve};
    assert_int_equal(gd_cut_along(mesh, &request, NULL, &cut, &detail), GD_INVALID_ARGUMENT);
    assert_memory_equal(&cut, &untouched, sizeof cut);
    if (!strstr(detail.text, part)) fail_msg("%s", detail.text);
}

static void curves_that_cut_nothing(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){4, 4, 1, 1});
    struct gd_point inner[] = {point_at(mesh, 0.3, 0.4, 0), point_at(mesh, 0.32, 0.44, 0)};
    struct gd_point apart[] = {point_at(mesh, 0.1, 0.05, 0), point_at(mesh, 0.9, 0.95, 0)};
    struct gd_point rim[] = {point_at(mesh, 0.25, 0, 0), point_at(mesh, 0.3, 0.1, 0)};
    struct gd_curve boundary;
    const struct gd_curve_request request = {.kind = GD_CURVE_BOUNDARY};
    check_ok(gd_curve_resolve(mesh, &request, NULL, &boundary, NULL), NULL);
    expect_refusal(mesh, boundary, "cuts nothing");
    expect_refusal(mesh, (struct gd_curve){inner, 2, true}, "cuts nothing");
    expect_refusal(mesh, (struct gd_curve){inner, 1, true}, "cuts nothing");
    expect_refusal(mesh, (struct gd_curve){inner, 2, false},
                   "the first point of the open curve is not on a boundary");
    expect_refusal(mesh, (struct gd_curve){rim, 2, false},
                   "the last point of the open curve is not on a boundary");
    expect_refusal(mesh, (struct gd_curve){apart, 2, true}, "do not lie within one face");
    gd_curve_free(&boundary);
    gd_mesh_release(mesh);
}

/* A loop with a spur that is traversed twice gives the same cut as the plain loop. */
static void spurs_are_removed(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){4, 4, 1, 1});
    const double corners[][2] = {{0.2, 0.2}, {0.7, 0.2}, {0.9, 0.1}, {0.7, 0.2},
                                 {0.6, 0.7}, {0.2, 0.2}, {0.7, 0.2}, {0.6, 0.7}};
    struct gd_point points[COUNT(corners)];
    for (size_t i = 0; i < COUNT(corners); i++)
        points[i] = point_at(mesh, corners[i][0], corners[i][1], 0);
    struct cutting cutting = cutting_through(mesh, points, COUNT(corners), true);
    check_cutting(mesh, &cutting, 1e-12);
    assert_int_equal(cutting.cut.piece_count, 2);
    check_close(fmin(cutting.cut.pieces[0].area, cutting.cut.pieces[1].area), 0.125, 1e-12);
    cutting_free(&cutting);
    gd_mesh_release(mesh);
}

/* For any budget, and at any moment of cancellation, the cut returns either an error or the result,
 * and leaks nothing. */
static void budgets_and_cancels(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("icosphere", (double[SAMPLE_PARAMETERS]){3, 1});
    const struct gd_point points[] = {vertex_of(mesh, 0), vertex_of(mesh, 200),
                                      vertex_of(mesh, 400)};
    struct gd_curve curve = curve_through(mesh, points, 3, true);
    const struct gd_cut_request request = {.curve = &curve};
    bool is_done = false;
    for (size_t budget = 1000; !is_done; budget = budget * 5 / 4) {
        const struct gd_control control = {.budget_bytes = budget};
        struct gd_cut cut;
        enum gd_status status = gd_cut_along(mesh, &request, &control, &cut, NULL);
        is_done = status == GD_OK;
        assert_true(is_done ? cut.bytes < budget && budget < 1000 * gd_mesh_summary(mesh)->faces
                            : status == GD_BUDGET);
        if (is_done) gd_cut_free(&cut);
    }
    is_done = false;
    for (uint32_t calls = 1; !is_done; calls += 1 + calls / 4) {
        struct test_watch watch = {.most = calls};
        const struct gd_control control = {.progress = test_watch, .user = &watch};
        struct gd_cut cut;
        enum gd_status status = gd_cut_along(mesh, &request, &control, &cut, NULL);
        is_done = status == GD_OK;
        assert_true(is_done || status == GD_CANCELLED);
        if (is_done) gd_cut_free(&cut);
    }
    gd_curve_free(&curve);
    gd_mesh_release(mesh);
}

/* --- shared meshes ---------------------------------------------------------------------------- */

/* GD_CUT_CURVES: number of curves; the default is 100. */
static void random_curves_on_shared_meshes(void **state)
{
    (void)state;
    static const char *const names[] = {"teapot",  "cow",       "beetle", "suzanne",
                                        "spot",    "homer",     "beast",  "stanford-bunny",
                                        "fandisk", "rocker-arm"};
    const char *curves = getenv("GD_CUT_CURVES");
    uint32_t each =
        (curves ? (uint32_t)strtoul(curves, NULL, 10) : 100 / TEST_STRIDE) / COUNT(names);
    struct tally all = {0};
    for (size_t i = 0; i < COUNT(names); i++) {
        struct gd_mesh *mesh = test_shared_mesh(names[i]);
        struct tally tally = cut_at_random(mesh, each, i, 1e-12);
        all.cuts += tally.cuts;
        all.separating += tally.separating;
        all.empty += tally.empty;
        assert_int_equal(tally.flat, 0);
        gd_mesh_release(mesh);
    }
    print_message("# %u cuts, %u of which separate; %u curves that enclose nothing\n", all.cuts,
                  all.separating, all.empty);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_straight_cut_of_a_square),
        cmocka_unit_test(the_waist_of_a_box),
        cmocka_unit_test(a_hole_in_one_face),
        cmocka_unit_test(round_a_handle),
        cmocka_unit_test(along_a_tube),
        cmocka_unit_test(along_edges),
        cmocka_unit_test(polygons_on_a_grid),
        cmocka_unit_test(a_corner_is_moved_to_a_vertex),
        cmocka_unit_test(curves_that_cut_nothing),
        cmocka_unit_test(spurs_are_removed),
        cmocka_unit_test(budgets_and_cancels),
        cmocka_unit_test(random_curves_on_samples),
        cmocka_unit_test(random_curves_on_tangles),
        cmocka_unit_test(random_curves_on_slivers),
        cmocka_unit_test(random_curves_on_shared_meshes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
