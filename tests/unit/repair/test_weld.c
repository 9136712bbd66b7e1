#include "tests/unit/mesh/shapes.h"

#include <stdlib.h>

#include "gd/point.h"

static struct gd_mesh *weld(const struct gd_polygons *polygons, double tolerance)
{
    return build_with(polygons,
                      (struct gd_mesh_options){.weld = true, .weld_tolerance = tolerance});
}

static struct gd_detail refuse_weld(const struct gd_polygons *polygons, double tolerance,
                                    enum gd_status status)
{
    struct gd_mesh_options options = {.weld = true, .weld_tolerance = tolerance};
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    assert_string_equal(gd_status_name(gd_mesh_build(polygons, &options, NULL, &mesh, &detail)),
                        gd_status_name(status));
    assert_null(mesh);
    return detail;
}

static void expect_same_vertex(const struct gd_mesh *mesh, uint32_t i, uint32_t j, bool same)
{
    struct gd_point p, q;
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){i}, &p, NULL), GD_OK);
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){j}, &q, NULL), GD_OK);
    assert_int_equal(gd_point_equal(&p, &q), same);
}

/* Makes the cube's twelve triangles, each with its own corners, moved by up to `jitter` in each
 * coordinate. */
static void make_soup(double jitter, double (*positions)[3], uint32_t *corners)
{
    uint64_t random = 1;
    for (uint32_t i = 0, n = 0; i < 6; i++) {
        const uint32_t *q = cube_corners + 4 * (size_t)i,
                       six[6] = {q[0], q[1], q[2], q[0], q[2], q[3]};
        for (uint32_t k = 0; k < 6; k++, n++) {
            corners[n] = n;
            for (int c = 0; c < 3; c++) {
                random = random * 6364136223846793005u + 1442695040888963407u;
                positions[n][c] =
                    cube_positions[six[k]][c] + jitter * ((double)(random >> 33) / (1u << 30) - 1);
            }
        }
    }
}

static void a_soup_of_triangles_becomes_a_cube(void **state)
{
    (void)state;
    const double jitters[] = {0, 1e-6};
    for (int i = 0; i < 2; i++) {
        double positions[36][3];
        uint32_t corners[36];
        make_soup(jitters[i], positions, corners);
        struct gd_polygons polygons = TRIANGLES(positions, corners);
        struct gd_mesh *mesh = weld(&polygons, 4 * jitters[i]);
        const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
        assert_int_equal(summary->index_count, 36);
        assert_int_equal(summary->vertices, 8);
        assert_int_equal(summary->faces, 12);
        assert_int_equal(summary->unreferenced_vertices, 0);
        assert_int_equal(summary->genus, 0);
        assert_int_equal(summary->boundaries, 0);
        assert_int_equal(gd_mesh_repair(mesh)->vertices_welded.count, 28);
        assert_int_equal(gd_mesh_repair(mesh)->vertices_welded.elements[0][0], 3);
        assert_int_equal(gd_mesh_repair(mesh)->vertices_welded.elements[0][1], 0);
        assert_true(gd_mesh_repair(mesh)->largest_shift <= 4 * jitters[i]);
        expect_same_vertex(mesh, 0, 3, true);
        expect_same_vertex(mesh, 0, 1, false);
        struct gd_vec3 p = gd_mesh_position(mesh, (struct gd_vertex){3}); /* as uploaded */
        assert_true(p.x == positions[3][0] && p.y == positions[3][1] && p.z == positions[3][2]);
        gd_mesh_release(mesh);
    }
}

/* Vertices 1, 3 and 4 are in a row, each within the tolerance of the next vertex. Vertex 3 is
 * welded to vertex 1, but vertex 4 is not. */
static void a_chain_of_close_points_is_not_welded_to_one(void **state)
{
    (void)state;
    double positions[][3] = {{5, 5, 0}, {0, 0, 0}, {5, 0, 0}, {0, 0.9, 0}, {0, 1.8, 0}, {9, 9, 0}};
    uint32_t corners[] = {1, 2, 0, 3, 0, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = weld(&polygons, 1);
    expect_mended(&gd_mesh_repair(mesh)->vertices_welded, MENDED({3, 1}));
    expect_near(gd_mesh_repair(mesh)->largest_shift, 0.9, 0);
    expect_same_vertex(mesh, 3, 1, true);
    expect_same_vertex(mesh, 4, 1, false);
    assert_int_equal(gd_mesh_summary(mesh)->unreferenced_vertices, 1);
    gd_mesh_release(mesh);
}

static void the_tolerance_itself_is_within_reach(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {-1, 0, 0}, {-9, 0, 0}, {-9, -9, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 4, 5};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse_weld(&polygons, 1, GD_NON_MANIFOLD_VERTEX);
    expect_elements(&detail, GD_ELEMENT_VERTEX, 1, ONE_ELEMENT(0, 0),
                    "the weld brought vertex 3 to vertex 0");
    struct gd_mesh *mesh = weld(&polygons, 0.999);
    expect_mended(&gd_mesh_repair(mesh)->vertices_welded, UNTOUCHED);
    gd_mesh_release(mesh);
    mesh = build_with(&polygons, (struct gd_mesh_options){
                                     .weld = true, .weld_tolerance = 1, .repair_split = true});
    expect_mended(&gd_mesh_repair(mesh)->vertices_welded, MENDED({3, 0}));
    expect_mended(&gd_mesh_repair(mesh)->vertices_split, MENDED({0, 1}));
    assert_int_equal(gd_mesh_summary(mesh)->components, 2);
    gd_mesh_release(mesh);
}

static void an_error_of_an_edge_with_three_faces_names_the_weld(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0},    {1, 0, 0},    {0, 1, 0}, {0, -1, 0},
                             {1e-3, 0, 0}, {1, 1e-3, 0}, {0, 0, 1}};
    uint32_t corners[] = {1, 0, 2, 0, 1, 3, 4, 5, 6};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse_weld(&polygons, 1e-2, GD_NON_MANIFOLD_EDGE);
    expect_elements(&detail, GD_ELEMENT_EDGE, 1, ONE_ELEMENT(0, 1),
                    "the weld brought vertex 4 to vertex 0");
}

static void errors_of_the_file_do_not_name_the_weld(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    uint32_t corners[] = {1, 0, 2, 0, 1, 3, 0, 1, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse_weld(&polygons, 1e-2, GD_NON_MANIFOLD_EDGE);
    assert_null(strstr(detail.text, "weld"));
}

static void an_error_of_coinciding_faces_names_the_weld(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0},    {1, 0, 0},    {0, 1, 0},
                             {0, 0, 1e-3}, {1, 0, 1e-3}, {0, 1, 1e-3}};
    uint32_t corners[] = {0, 1, 2, 3, 5, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse_weld(&polygons, 1e-2, GD_DUPLICATE_FACE);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(1, 0),
                    "the weld brought vertex 3 to vertex 0");
}

/* A quad with a short side becomes a triangle, and the adjacent sliver is removed. Indices of other
 * faces stay the same. */
static void faces_that_fall_together_are_removed(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1.001, 0}, {0, 2, 0}, {2, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 3, 2, 5, 0, 3, 4, 1, 5, 2}, first[] = {0, 4, 7, 10, 13};
    struct gd_polygons polygons = POLYGONS(positions, corners, first);
    struct gd_mesh *mesh = weld(&polygons, 0.01);
    expect_mended(&gd_mesh_repair(mesh)->vertices_welded, MENDED({3, 2}));
    expect_mended(&gd_mesh_repair(mesh)->degenerate_faces, MENDED({1, 0}, {2, 0}));
    assert_int_equal(gd_mesh_summary(mesh)->face_index_count, 5);
    assert_int_equal(gd_mesh_summary(mesh)->faces, 3);
    const uint32_t sources[] = {0, 0, 1, 2, 3};
    for (uint32_t f = 0; f < 5; f++)
        assert_int_equal(gd_mesh_source_face(mesh, (struct gd_face){f}), sources[f]);
    struct gd_point point;
    struct gd_detail detail = {0};
    assert_int_equal(
        gd_point_in_face(mesh, (struct gd_face){2}, (double[3]){0.5, 0.25, 0.25}, &point, &detail),
        GD_OUT_OF_RANGE);
    assert_non_null(strstr(detail.text, "face 2 was removed"));
    assert_int_equal(
        gd_point_in_face(mesh, (struct gd_face){4}, (double[3]){0.5, 0.25, 0.25}, &point, &detail),
        GD_OK);
    struct gd_point_description description;
    gd_point_describe(mesh, &point, &description);
    assert_int_equal(description.face.index, 4);
    gd_mesh_release(mesh);
}

static void only_vertices_of_faces_are_welded(void **state)
{
    (void)state;
    double positions[][3] = {{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t corners[] = {1, 2, 3};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = weld(&polygons, 0);
    expect_mended(&gd_mesh_repair(mesh)->vertices_welded, UNTOUCHED);
    assert_int_equal(gd_mesh_summary(mesh)->unreferenced_vertices, 1);
    gd_mesh_release(mesh);
}

static void a_tolerance_is_a_length(void **state)
{
    (void)state;
    struct gd_polygons polygons = tetrahedron();
    const double bad[] = {NAN, INFINITY, -INFINITY, -1, -1e-300};
    for (size_t i = 0; i < COUNT(bad); i++) {
        struct gd_detail detail = refuse_weld(&polygons, bad[i], GD_INVALID_ARGUMENT);
        assert_non_null(strstr(detail.text, "weld tolerance"));
    }
    refuse_weld(&polygons, 1e-200, GD_INVALID_ARGUMENT);
    refuse_weld(&polygons, 5e-324, GD_INVALID_ARGUMENT);
    const double good[] = {0, -0.0, 1e-149, 1e-17, 1e-3};
    for (size_t i = 0; i < COUNT(good); i++) gd_mesh_release(weld(&polygons, good[i]));
}

static void a_tolerance_beyond_the_mesh_leaves_nothing(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    const double tolerances[] = {2, 1e10, 1.7e308};
    for (size_t i = 0; i < COUNT(tolerances); i++) {
        struct gd_detail detail = refuse_weld(&polygons, tolerances[i], GD_EMPTY);
        assert_non_null(strstr(detail.text, "smaller weld tolerance"));
    }
}

/* Compares with the welding rule applied to all pairs. Each face shares at most one corner with
 * welded points. */
static void agrees_with_a_search_of_all_pairs(void **state)
{
    (void)state;
    enum { POINTS = 300 };
    const double scales[] = {1, 1e-140, 1e140, 1e-7};
    uint64_t random = 7;
    for (int round = 0; round < 40; round++) {
        double positions[POINTS][3], scale = scales[round % 4],
                                     tolerance = scale * 0.02 * (1 + round % 7);
        double offset = round % 3 == 0 ? 1e6 * scale : 0;
        uint32_t corners[POINTS], expected[POINTS], welded = 0;
        for (uint32_t i = 0; i < POINTS; i++) {
            corners[i] = i;
            for (int k = 0; k < 3; k++) {
                random = random * 6364136223846793005u + 1442695040888963407u;
                positions[i][k] = offset + scale * ((double)(random >> 33) / (1u << 30) - 1);
            }
            expected[i] = i;
            for (uint32_t j = 0; j < i && expected[i] == i; j++) {
                double d[3];
                for (int k = 0; k < 3; k++) d[k] = (positions[i][k] - positions[j][k]) / tolerance;
                if (expected[j] == j && d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= 1)
                    expected[i] = j;
            }
            welded += expected[i] != i;
        }
        struct gd_polygons polygons = TRIANGLES(positions, corners);
        struct gd_mesh *mesh = build_with(
            &polygons, (struct gd_mesh_options){
                           .weld = true, .weld_tolerance = tolerance, .repair_split = true});
        assert_int_equal(gd_mesh_repair(mesh)->vertices_welded.count, welded);
        const struct gd_mended *listed = &gd_mesh_repair(mesh)->vertices_welded;
        for (uint32_t i = 0; i < listed->listed; i++)
            assert_int_equal(expected[listed->elements[i][0]], listed->elements[i][1]);
        gd_mesh_release(mesh);
    }
}

/* All points are in one cell, within the tolerance or slightly beyond it. Welding must remain
 * fast. */
static void crowded_points_are_welded_fast(void **state)
{
    (void)state;
    enum { POINTS = 300000 };
    double(*positions)[3] = calloc(POINTS, sizeof *positions);
    uint32_t *corners = calloc(POINTS, sizeof *corners);
    const double tolerances[] = {0, 1e-149, 1e-9, 1e-3, 0.9};
    for (size_t t = 0; t < COUNT(tolerances); t++) {
        uint64_t random = 3;
        for (uint32_t i = 0; i < POINTS; i++) {
            corners[i] = i;
            for (int k = 0; k < 3; k++) {
                random = random * 6364136223846793005u + 1442695040888963407u;
                positions[i][k] = (double)(random >> 33) / (1u << 31) * (i % 2 ? 1 : 1e-12);
            }
        }
        struct gd_polygons polygons = {.positions = positions,
                                       .position_count = POINTS,
                                       .corners = corners,
                                       .polygon_count = POINTS / 3};
        struct gd_mesh_options options = {.weld = true, .weld_tolerance = tolerances[t]};
        struct gd_mesh *mesh = NULL;
        uint64_t begun = gd_now_ns();
        enum gd_status status = gd_mesh_build(&polygons, &options, NULL, &mesh, NULL);
        double seconds = (double)(gd_now_ns() - begun) * 1e-9;
        print_message("# 300k points, tolerance %g: %.2f s, %s\n", tolerances[t], seconds,
                      gd_status_name(status));
        assert_true(seconds < 20);
        gd_mesh_release(mesh);
    }
    free(positions);
    free(corners);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_soup_of_triangles_becomes_a_cube),
        cmocka_unit_test(a_chain_of_close_points_is_not_welded_to_one),
        cmocka_unit_test(the_tolerance_itself_is_within_reach),
        cmocka_unit_test(an_error_of_an_edge_with_three_faces_names_the_weld),
        cmocka_unit_test(errors_of_the_file_do_not_name_the_weld),
        cmocka_unit_test(an_error_of_coinciding_faces_names_the_weld),
        cmocka_unit_test(faces_that_fall_together_are_removed),
        cmocka_unit_test(only_vertices_of_faces_are_welded),
        cmocka_unit_test(a_tolerance_is_a_length),
        cmocka_unit_test(a_tolerance_beyond_the_mesh_leaves_nothing),
        cmocka_unit_test(agrees_with_a_search_of_all_pairs),
        cmocka_unit_test(crowded_points_are_welded_fast),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
