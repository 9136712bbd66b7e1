#include "tests/unit/mesh/shapes.h"

#include <stdlib.h>

#include "gd/point.h"

static void expect_corners(const struct gd_mesh *mesh, uint32_t face, uint32_t a, uint32_t b,
                           uint32_t c)
{
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){face}, corners);
    assert_int_equal(corners[0].index, a);
    assert_int_equal(corners[1].index, b);
    assert_int_equal(corners[2].index, c);
}

static void expect_pieces(const struct gd_mesh *mesh, uint32_t components, uint32_t boundaries)
{
    assert_int_equal(gd_mesh_summary(mesh)->components, components);
    assert_int_equal(gd_mesh_summary(mesh)->boundaries, boundaries);
}

/* --- vertices --------------------------------------------------------------------------------- */

static void an_open_bow_tie_is_cut(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, -1, 0}, {-1, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 0, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = mend(&polygons);
    const struct gd_mesh_repair *repair = gd_mesh_repair(mesh);
    expect_mended(&repair->vertices_split, MENDED({0, 1}));
    expect_mended(&repair->edges_split, UNTOUCHED);
    assert_int_equal(repair->copies, 1);
    assert_int_equal(gd_mesh_original(mesh, (struct gd_vertex){5}).index, 0);
    assert_int_equal(gd_mesh_original(mesh, (struct gd_vertex){3}).index, 3);
    struct gd_vec3 copy = gd_mesh_position(mesh, (struct gd_vertex){5});
    assert_true(copy.x == 0 && copy.y == 0 && copy.z == 0);
    expect_corners(mesh, 0, 0, 1, 2);
    expect_corners(mesh, 1, 3, 5, 4);
    expect_pieces(mesh, 2, 2);
    gd_mesh_release(mesh);
}

/* Uses tetrahedra that share only their last vertex. */
static void a_closed_bow_tie_is_cut(void **state)
{
    (void)state;
    double positions[][3] = {{1, 0, 1},   {-1, 1, 1},   {-1, -1, 1}, {1, 0, -1},
                             {-1, 1, -1}, {-1, -1, -1}, {0, 0, 0}};
    uint32_t corners[] = {0, 1, 2, 1, 0, 6, 2, 1, 6, 0, 2, 6, 3, 5, 4, 4, 6, 3, 5, 6, 4, 3, 6, 5};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->vertices_split, MENDED({6, 1}));
    expect_pieces(mesh, 2, 0);
    assert_int_equal(gd_mesh_summary(mesh)->euler_characteristic, 4);
    gd_mesh_release(mesh);
}

static void each_further_fan_gets_a_copy(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0},  {1, 0, 0},  {1, 1, 0}, {-1, 1, 0},
                             {-1, 2, 0}, {0, -1, 0}, {0, -1, 1}};
    uint32_t corners[] = {1, 2, 0, 3, 4, 0, 5, 6, 0};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->vertices_split, MENDED({0, 2}));
    expect_corners(mesh, 1, 3, 4, 7);
    expect_corners(mesh, 2, 5, 6, 8);
    gd_mesh_release(mesh);
}

/* --- edges ------------------------------------------------------------------------------------ */

/* The order of the vertices about the x axis, counter-clockwise: 2 at 0 degrees, 4 at 90, 3 at
 * 180. */
static double around_x[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

static void of_three_faces_the_two_around_the_inside_stay_joined(void **state)
{
    (void)state;
    uint32_t corners[] = {1, 0, 2, 0, 1, 3, 0, 1, 4};
    struct gd_polygons polygons = TRIANGLES(around_x, corners);
    struct gd_mesh *mesh = mend(&polygons);
    const struct gd_mesh_repair *repair = gd_mesh_repair(mesh);
    expect_mended(&repair->edges_split, MENDED({0, 1}));
    expect_mended(&repair->vertices_split, MENDED({0, 1}, {1, 1}));
    expect_corners(mesh, 0, 1, 0, 2);
    expect_corners(mesh, 1, 6, 7, 3);
    expect_corners(mesh, 2, 0, 1, 4);
    assert_int_equal(gd_mesh_summary(mesh)->flipped_faces, 0);
    gd_mesh_release(mesh);

    /* the orientation is opposite, so the inside is between 3 and 2 */
    uint32_t turned[] = {0, 1, 2, 1, 0, 3, 1, 0, 4};
    polygons = TRIANGLES(around_x, turned);
    mesh = mend(&polygons);
    expect_corners(mesh, 0, 0, 1, 2);
    expect_corners(mesh, 1, 1, 0, 3);
    expect_corners(mesh, 2, 6, 7, 4);
    gd_mesh_release(mesh);
}

static void faces_of_one_direction_are_not_joined(void **state)
{
    (void)state;
    uint32_t corners[] = {0, 1, 2, 0, 1, 3, 0, 1, 4};
    struct gd_polygons polygons = TRIANGLES(around_x, corners);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->edges_split, MENDED({0, 1}));
    expect_mended(&gd_mesh_repair(mesh)->vertices_split, MENDED({0, 2}, {1, 2}));
    expect_pieces(mesh, 3, 3);
    gd_mesh_release(mesh);
}

/* Two tetrahedra that share the edge 0-1, one of them with the orientation of `solid_corners`, and
 * a single face at the same edge (a fin). */
static double two_solids[][3] = {{0, 0, -1}, {0, 0, 1},   {2, 1, 0}, {2, -1, 0},
                                 {-2, 1, 0}, {-2, -1, 0}, {0, 3, 0}};
static uint32_t solid_corners[] = {0, 1, 2, 1, 0, 3, 2, 1, 3, 3, 0, 2, 5, 0,
                                   1, 0, 4, 1, 4, 5, 1, 5, 4, 0, 0, 1, 6};

static void solids_that_share_an_edge_are_taken_apart(void **state)
{
    (void)state;
    uint32_t corners[24];
    memcpy(corners, solid_corners, sizeof corners);
    for (int turned = 0; turned < 2; turned++) {
        struct gd_polygons polygons = TRIANGLES(two_solids, corners);
        struct gd_mesh *mesh = mend(&polygons);
        expect_mended(&gd_mesh_repair(mesh)->edges_split, MENDED({0, 1}));
        expect_mended(&gd_mesh_repair(mesh)->vertices_split, MENDED({0, 1}, {1, 1}));
        expect_pieces(mesh, 2, 0);
        assert_int_equal(gd_mesh_summary(mesh)->euler_characteristic, 4);
        gd_mesh_release(mesh);
        /* repeats the test with one face reversed */
        corners[12] = 0;
        corners[13] = 5;
    }
}

static void a_fin_between_solids_is_cut_off(void **state)
{
    (void)state;
    struct gd_polygons polygons = TRIANGLES(two_solids, solid_corners);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->edges_split, MENDED({0, 1}));
    expect_mended(&gd_mesh_repair(mesh)->vertices_split, MENDED({0, 2}, {1, 2}));
    expect_pieces(mesh, 3, 1);
    expect_corners(mesh, 8, 9, 10, 6);
    gd_mesh_release(mesh);
}

static void many_faces_at_an_edge_are_paired_fast(void **state)
{
    (void)state;
    enum { SHEETS = 100000 };
    double(*positions)[3] = calloc(SHEETS + 2, sizeof *positions);
    uint32_t *corners = calloc(3 * SHEETS, sizeof *corners);
    positions[1][2] = 1;
    for (uint32_t i = 0; i < SHEETS; i++) {
        double angle = 2 * M_PI * i / SHEETS;
        memcpy(positions[i + 2], (double[3]){cos(angle), sin(angle), 0.5}, sizeof *positions);
        memcpy(corners + 3 * (size_t)i, (uint32_t[3]){i % 2, 1 - i % 2, i + 2},
               3 * sizeof *corners);
    }
    struct gd_polygons polygons = {.positions = positions,
                                   .position_count = SHEETS + 2,
                                   .corners = corners,
                                   .polygon_count = SHEETS};
    struct gd_mesh *mesh = mend(&polygons);
    expect_pieces(mesh, SHEETS / 2, SHEETS / 2);
    gd_mesh_release(mesh);
    free(positions);
    free(corners);
}

static void a_moebius_strip_is_still_refused(void **state)
{
    (void)state;
    enum { TURNS = 12 };
    double positions[2 * TURNS][3];
    uint32_t corners[6 * TURNS];
    for (uint32_t i = 0; i < TURNS; i++) {
        double angle = 2 * M_PI * i / TURNS, lean = angle / 2;
        for (int end = 0; end < 2; end++) {
            double r = 2 + (2 * end - 1) * 0.5 * cos(lean);
            memcpy(positions[2 * i + (uint32_t)end],
                   (double[3]){r * cos(angle), r * sin(angle), (2 * end - 1) * 0.5 * sin(lean)},
                   sizeof *positions);
        }
        uint32_t a = 2 * i, b = 2 * i + 1, c = i + 1 < TURNS ? a + 2 : 1,
                 d = i + 1 < TURNS ? a + 3 : 0;
        memcpy(corners + 6 * (size_t)i, (uint32_t[6]){a, c, b, b, c, d}, 6 * sizeof *corners);
    }
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh_options options = {.repair_split = true};
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    assert_int_equal(gd_mesh_build(&polygons, &options, NULL, &mesh, &detail), GD_NON_ORIENTABLE);
    assert_non_null(strstr(detail.text, "one-sided"));
}

/* --- any triangles ---------------------------------------------------------------------------- */

static uint32_t next_random(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 33);
}

/* Uses random triangles over a few vertices, so that edges have many faces and vertices have many
 * fans. Each mesh is built or rejected as non-orientable. The faces of a built mesh have the
 * input's corners or copies of these corners. */
static void random_triangles_become_surfaces(void **state)
{
    (void)state;
    enum { MESHES = 3000, MOST_VERTICES = 14, MOST_FACES = 60 };
    uint32_t taken = 0, refused = 0;
    for (uint64_t seed = 1; seed <= MESHES; seed++) {
        uint64_t random = seed;
        double positions[MOST_VERTICES][3];
        uint32_t corners[MOST_FACES][3], vertices = 4 + next_random(&random) % (MOST_VERTICES - 4);
        uint32_t faces = 1 + next_random(&random) % MOST_FACES;
        for (uint32_t v = 0; v < vertices; v++) {
            for (int k = 0; k < 3; k++) positions[v][k] = next_random(&random) % 1000 * 1e-3;
        }
        for (uint32_t f = 0; f < faces; f++) {
            uint32_t a = next_random(&random) % vertices, b = next_random(&random) % (vertices - 1);
            uint32_t c = next_random(&random) % (vertices - 2);
            b += b >= a;
            c += c >= (a < b ? a : b);
            c += c >= (a < b ? b : a);
            memcpy(corners[f], (uint32_t[3]){a, b, c}, sizeof corners[f]);
        }
        struct gd_polygons polygons = {.positions = positions,
                                       .position_count = vertices,
                                       .corners = *corners,
                                       .polygon_count = faces};
        struct gd_mesh_options options = {.repair_split = true};
        struct gd_mesh *mesh = NULL;
        enum gd_status status = gd_mesh_build(&polygons, &options, NULL, &mesh, NULL);
        refused += status == GD_NON_ORIENTABLE;
        if (status == GD_NON_ORIENTABLE) continue;
        assert_string_equal(gd_status_name(status), "ok");
        taken++;
        for (uint32_t f = 0; f < faces; f++) {
            if (!gd_mesh_has_face(mesh, (struct gd_face){f})) continue;
            struct gd_vertex now[3];
            gd_mesh_corners(mesh, (struct gd_face){f}, now);
            bool turned = gd_mesh_original(mesh, now[1]).index != corners[f][1];
            assert_int_equal(gd_mesh_original(mesh, now[0]).index, corners[f][0]);
            assert_int_equal(gd_mesh_original(mesh, now[1]).index, corners[f][turned ? 2 : 1]);
            assert_int_equal(gd_mesh_original(mesh, now[2]).index, corners[f][turned ? 1 : 2]);
        }
        gd_mesh_release(mesh);
    }
    print_message("# %u random soups became surfaces, %u one-sided ones were refused\n", taken,
                  refused);
    assert_true(taken > MESHES / 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_open_bow_tie_is_cut),
        cmocka_unit_test(a_closed_bow_tie_is_cut),
        cmocka_unit_test(each_further_fan_gets_a_copy),
        cmocka_unit_test(of_three_faces_the_two_around_the_inside_stay_joined),
        cmocka_unit_test(faces_of_one_direction_are_not_joined),
        cmocka_unit_test(solids_that_share_an_edge_are_taken_apart),
        cmocka_unit_test(a_fin_between_solids_is_cut_off),
        cmocka_unit_test(many_faces_at_an_edge_are_paired_fast),
        cmocka_unit_test(a_moebius_strip_is_still_refused),
        cmocka_unit_test(random_triangles_become_surfaces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
