#include "tests/unit/mesh/shapes.h"

#include "gd/point.h"

static struct gd_detail refuse_mending(const struct gd_polygons *polygons, enum gd_status status)
{
    struct gd_mesh_options options = {.repair_split = true};
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    assert_string_equal(gd_status_name(gd_mesh_build(polygons, &options, NULL, &mesh, &detail)),
                        gd_status_name(status));
    assert_null(mesh);
    return detail;
}

static void a_surface_stays_as_it_is(void **state)
{
    (void)state;
    struct gd_polygons shapes[] = {tetrahedron(), cube()};
    for (int i = 0; i < 2; i++) {
        struct gd_mesh *plain = build(&shapes[i]), *mended = mend(&shapes[i]);
        const struct gd_mesh_repair nothing = {0};
        assert_memory_equal(gd_mesh_repair(plain), &nothing, sizeof nothing);
        assert_memory_equal(gd_mesh_repair(mended), &nothing, sizeof nothing);
        assert_memory_equal(gd_mesh_summary(plain), gd_mesh_summary(mended),
                            sizeof(struct gd_mesh_summary));
        gd_mesh_release(plain);
        gd_mesh_release(mended);
    }
}

/* Vertices 1 and 4 have the same position and are joined by an edge, so they are merged. Vertices 2
 * and 5 have the same position, too, but no edge joins them. */
static void vertices_that_an_edge_of_length_zero_joins_become_one(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0},    {1, 0, 0}, {0, 1, 0}, {2, 2, 0},
                             {1, 0, -0.0}, {0, 1, 0}, {3, 0, 0}};
    uint32_t corners[] = {0, 1, 2, 1, 4, 3, 4, 6, 3, 1, 3, 5};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = mend(&polygons);
    const struct gd_mesh_repair *repair = gd_mesh_repair(mesh);
    expect_mended(&repair->vertices_merged, MENDED({4, 1}));
    expect_mended(&repair->degenerate_faces, MENDED({1, 0}));
    expect_mended(&repair->vertices_split, MENDED({1, 1}));
    assert_true(repair->largest_shift == 0);
    struct gd_point p, q;
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){1}, &p, NULL), GD_OK);
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){4}, &q, NULL), GD_OK);
    assert_true(gd_point_equal(&p, &q));
    struct gd_detail detail = {0};
    assert_int_equal(gd_point_in_face(mesh, (struct gd_face){1}, (double[3]){1, 0, 0}, &p, &detail),
                     GD_OUT_OF_RANGE);
    assert_non_null(strstr(detail.text, "face 1 was removed"));
    assert_int_equal(gd_point_in_face(mesh, (struct gd_face){4}, (double[3]){1, 0, 0}, &p, &detail),
                     GD_OUT_OF_RANGE);
    assert_non_null(strstr(detail.text, "there is no face 4"));
    gd_mesh_release(mesh);
}

static void spurs_of_polygons_are_removed(void **state)
{
    (void)state;
    static double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},
                                    {0, 1, 0}, {2, 2, 0}, {3, 3, 0}};
    static const struct {
        uint32_t count, ring[8], faces;
    } cases[] = {
        {3, {1, 3, 1}, 0},
        {3, {1, 1, 3}, 0},
        {4, {0, 1, 2, 2}, 1},
        {4, {0, 0, 1, 2}, 1},
        {4, {0, 1, 2, 0}, 1},
        {5, {0, 1, 2, 4, 2}, 1},
        {7, {0, 1, 2, 4, 5, 4, 2}, 1},
        {5, {4, 2, 0, 1, 2}, 1},
        {5, {2, 0, 1, 2, 4}, 1},
        {4, {0, 1, 0, 1}, 0},
        {6, {0, 1, 2, 3, 2, 1}, 0},
        {6, {0, 1, 2, 3, 3, 3}, 2},
        {7, {5, 4, 2, 0, 1, 2, 4}, 1},
    };
    for (uint32_t i = 0; i < COUNT(cases); i++) {
        /* one valid face */
        uint32_t corners[16] = {0, 3, 5}, first[] = {0, 3, 3 + cases[i].count};
        memcpy(corners + 3, cases[i].ring, cases[i].count * sizeof *corners);
        struct gd_polygons polygons = POLYGONS(positions, corners, first);
        struct gd_mesh *mesh = mend(&polygons);
        assert_int_equal(gd_mesh_summary(mesh)->faces, 1 + cases[i].faces);
        assert_int_equal(gd_mesh_summary(mesh)->face_index_count, cases[i].count - 1);
        assert_int_equal(gd_mesh_repair(mesh)->degenerate_faces.count,
                         cases[i].count - 2 - cases[i].faces);
        gd_mesh_release(mesh);
    }
}

static void a_ring_that_passes_a_vertex_twice_is_refused(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
    uint32_t corners[] = {0, 1, 2, 0, 3, 4}, first[] = {0, 6};
    struct gd_polygons polygons = POLYGONS(positions, corners, first);
    struct gd_detail detail = refuse_mending(&polygons, GD_DEGENERATE_FACE);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(0, 0),
                    "face 0 has vertex 0 as two of its corners");
}

/* Uses a square with a square hole. The edge 0-4 joins the outer and the inner ring. */
static void a_ring_with_a_bridge_to_its_hole_is_cut(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                             {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 0, 4, 7, 6, 5, 4}, first[] = {0, 10};
    struct gd_polygons polygons = POLYGONS(positions, corners, first);
    struct gd_mesh *mesh = mend(&polygons);
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    assert_int_equal(summary->faces, 8);
    assert_int_equal(summary->boundaries, 2);
    assert_int_equal(summary->euler_characteristic, 0);
    assert_float_equal(summary->area, 15, 1e-14);
    expect_mended(&gd_mesh_repair(mesh)->faces_cut, MENDED({0, 0}));
    gd_mesh_release(mesh);
}

static void a_ring_that_repeats_itself_is_reduced(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3}, first[] = {0, 12};
    struct gd_polygons polygons = POLYGONS(positions, corners, first);
    struct gd_mesh *mesh = mend(&polygons);
    assert_int_equal(gd_mesh_summary(mesh)->faces, 2);
    assert_float_equal(gd_mesh_summary(mesh)->area, 1, 1e-14);
    assert_int_equal(gd_mesh_repair(mesh)->degenerate_faces.count, 8);
    gd_mesh_release(mesh);
}

static void the_first_of_several_duplicates_is_kept(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    uint32_t corners[] = {0, 1, 2, 2, 1, 0, 1, 0, 3, 1, 2, 0};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->duplicate_faces, MENDED({1, 0}, {3, 0}));
    assert_int_equal(gd_mesh_summary(mesh)->faces, 2);
    assert_true(gd_mesh_has_face(mesh, (struct gd_face){0}) &&
                gd_mesh_has_face(mesh, (struct gd_face){2}));
    assert_false(gd_mesh_has_face(mesh, (struct gd_face){1}) ||
                 gd_mesh_has_face(mesh, (struct gd_face){3}));
    struct gd_polygons left = {0};
    assert_int_equal(gd_mesh_polygons(mesh, &left), GD_OK);
    assert_int_equal(left.polygon_count, 2);
    assert_memory_equal(left.corners, ((uint32_t[]){0, 1, 2, 1, 0, 3}), 6 * sizeof(uint32_t));
    gd_polygons_free(&left);
    gd_mesh_release(mesh);
}

static void a_removed_duplicate_keeps_its_face_indices(void **state)
{
    (void)state;
    uint32_t corners[28], first[] = {0, 4, 8, 12, 16, 20, 24, 28};
    memcpy(corners, cube_corners, sizeof cube_corners);
    memcpy(corners + 24, (uint32_t[]){7, 6, 5, 4}, 4 * sizeof *corners);
    struct gd_polygons polygons = POLYGONS(cube_positions, corners, first);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->duplicate_faces, MENDED({12, 2}, {13, 2}));
    assert_int_equal(gd_mesh_summary(mesh)->faces, 12);
    assert_int_equal(gd_mesh_source_face(mesh, (struct gd_face){13}), 6);
    assert_int_equal(gd_mesh_summary(mesh)->boundaries, 0);
    gd_mesh_release(mesh);
}

static void a_mesh_that_loses_all_faces_is_empty(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}};
    uint32_t corners[] = {0, 1, 2};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse_mending(&polygons, GD_EMPTY);
    assert_non_null(strstr(detail.text, "no face is left"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_surface_stays_as_it_is),
        cmocka_unit_test(vertices_that_an_edge_of_length_zero_joins_become_one),
        cmocka_unit_test(spurs_of_polygons_are_removed),
        cmocka_unit_test(a_ring_that_passes_a_vertex_twice_is_refused),
        cmocka_unit_test(a_ring_with_a_bridge_to_its_hole_is_cut),
        cmocka_unit_test(a_ring_that_repeats_itself_is_reduced),
        cmocka_unit_test(the_first_of_several_duplicates_is_kept),
        cmocka_unit_test(a_removed_duplicate_keeps_its_face_indices),
        cmocka_unit_test(a_mesh_that_loses_all_faces_is_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
