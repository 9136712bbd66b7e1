#include "tests/unit/mesh/shapes.h"

#include <stdlib.h>

#include "base/tolerance.h"
#include "gd/field.h"
#include "gd/point.h"

static double distance(const struct gd_mesh *mesh, uint32_t from, uint32_t to)
{
    struct gd_seed seed = {0};
    struct gd_point target;
    struct gd_field *field = NULL;
    double result = NAN;
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){from}, &seed.point, NULL), GD_OK);
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){to}, &target, NULL), GD_OK);
    const struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    assert_int_equal(gd_field_build(mesh, &request, NULL, &field, NULL), GD_OK);
    assert_int_equal(gd_field_distance(field, &target, &result), GD_OK);
    gd_field_release(field);
    return result;
}

/* Checks that the distances between the first `count` vertices are equal in both meshes. */
static void expect_same_distances(const struct gd_mesh *a, const struct gd_mesh *b, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = 0; j < count; j++) {
            double expected = distance(a, i, j);
            expect_near(distance(b, i, j), expected, 1e-12 * expected);
        }
    }
}

enum { CUBE_FACES = 12, MOST = 40 };

/* A triangulated cube with `points` on its edge 0-1 (z = 0, y = 0). Each of these points is a
 * corner of faces below. The face in front has the whole edge as one side. Caps, which are faces
 * without area, fill the gap. */
struct gapped_cube {
    double positions[MOST][3];
    uint32_t corners[3 * MOST];
    struct gd_polygons polygons;
};

static void add_face(struct gd_polygons *polygons, uint32_t a, uint32_t b, uint32_t c)
{
    memcpy(polygons->corners + 3 * (size_t)polygons->polygon_count++, (uint32_t[3]){a, b, c},
           3 * sizeof a);
}

static void start_cube(struct gapped_cube *cube_, bool with_front_bottom)
{
    static const uint32_t faces[CUBE_FACES][3] = {{0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5},
                                                  {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7},
                                                  {2, 7, 6}, {3, 0, 4}, {3, 4, 7}, {0, 2, 1}};
    memcpy(cube_->positions, cube_positions, sizeof cube_positions);
    cube_->polygons = (struct gd_polygons){.positions = cube_->positions,
                                           .position_count = 8,
                                           .corners = cube_->corners,
                                           .polygon_count = 0};
    for (int f = 0; f < CUBE_FACES - !with_front_bottom; f++)
        add_face(&cube_->polygons, faces[f][0], faces[f][1], faces[f][2]);
}

static uint32_t add_point(struct gapped_cube *cube_, double x)
{
    memcpy(cube_->positions[cube_->polygons.position_count], (double[3]){x, 0, 0},
           sizeof *cube_->positions);
    return cube_->polygons.position_count++;
}

/* Makes the cube. Points are at x = 1/(n+1) ... n/(n+1). The bottom is a fan about vertex 2. Caps
 * form a fan about vertex 0, or alternate between both ends if `zigzag`. */
static void make_gapped_cube(struct gapped_cube *cube_, uint32_t points, bool zigzag)
{
    start_cube(cube_, false);
    uint32_t chain[MOST] = {0};
    for (uint32_t i = 1; i <= points; i++) chain[i] = add_point(cube_, (double)i / (points + 1));
    chain[points + 1] = 1;
    for (uint32_t i = 0; i <= points; i++) add_face(&cube_->polygons, chain[i + 1], chain[i], 2);
    for (uint32_t low = 0, high = points + 1, step = 0; high - low > 1; step++) {
        if (zigzag && step % 2) {
            add_face(&cube_->polygons, chain[low], chain[low + 1], chain[high]);
            low++;
        } else {
            add_face(&cube_->polygons, chain[low], chain[high - 1], chain[high]);
            high--;
        }
    }
}

static void caps_on_an_edge_of_a_box_are_flipped_away(void **state)
{
    (void)state;
    struct gapped_cube whole, gapped;
    start_cube(&whole, true);
    struct gd_mesh *plain = build(&whole.polygons);
    for (uint32_t points = 1; points <= 12; points++) {
        for (int zigzag = 0; zigzag < 2; zigzag++) {
            make_gapped_cube(&gapped, points, zigzag);
            refuse(&gapped.polygons, GD_DEGENERATE_FACE);
            struct gd_mesh *mesh = mend(&gapped.polygons);
            const struct gd_mesh_repair *repair = gd_mesh_repair(mesh);
            assert_true(repair->edges_flipped.count >= points);
            expect_mended(&repair->degenerate_faces, UNTOUCHED);
            expect_mended(&repair->edges_split, UNTOUCHED);
            assert_true(repair->largest_shift <= 1e-16);
            assert_int_equal(gd_mesh_summary(mesh)->boundaries, 0);
            assert_int_equal(gd_mesh_summary(mesh)->genus, 0);
            expect_near(gd_mesh_summary(mesh)->area, 6, 1e-14);
            if (points % 5 == 1) expect_same_distances(plain, mesh, 8);
            gd_mesh_release(mesh);
        }
    }
    gd_mesh_release(plain);
}

static void the_faces_of_a_flipped_edge_keep_their_indices(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, 0, 0}, {1, -1, 0}};
    uint32_t corners[] = {0, 1, 2, 0, 4, 3, 0, 3, 1};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->edges_flipped, MENDED({2, 0}));
    struct gd_vertex now[3];
    gd_mesh_corners(mesh, (struct gd_face){2}, now);
    assert_true(now[0].index == 0 && now[1].index == 3 && now[2].index == 2);
    gd_mesh_corners(mesh, (struct gd_face){0}, now);
    assert_true(now[0].index == 3 && now[1].index == 1 && now[2].index == 2);
    expect_near(distance(mesh, 0, 1), 2, 1e-15);
    expect_near(distance(mesh, 4, 1), 2, 1e-15);
    gd_mesh_release(mesh);
}

/* Caps at the lower border of a square are dropped. The border keeps all points of the caps. */
static void caps_at_the_border_are_dropped(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                             {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    uint32_t corners[] = {0, 4, 3, 4, 5, 3, 5, 6, 3, 6, 1, 3, 1, 2, 3, 4, 0, 5, 5, 0, 6, 6, 0, 1};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->degenerate_faces, MENDED({7, 0}, {6, 0}, {5, 0}));
    expect_mended(&gd_mesh_repair(mesh)->edges_flipped, UNTOUCHED);
    assert_int_equal(gd_mesh_summary(mesh)->faces, 5);
    assert_int_equal(gd_mesh_summary(mesh)->boundaries, 1);
    assert_int_equal(gd_mesh_boundary(mesh, 0).vertices, 7);
    expect_near(gd_mesh_summary(mesh)->area, 16, 0);
    expect_near(distance(mesh, 4, 2), 5, 1e-14);
    gd_mesh_release(mesh);
}

/* Uses two opposite caps on the diagonal of a square. The caps have the same inner point or two
 * different inner points. */
static void a_pocket_closes(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 1, 0}, {3, 3, 0}};
    uint32_t one[] = {0, 1, 4, 1, 2, 4, 0, 4, 3, 4, 2, 3, 0, 4, 2, 2, 4, 0};
    struct gd_polygons polygons = TRIANGLES(positions, one);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->duplicate_faces, MENDED({5, 4}));
    assert_int_equal(gd_mesh_summary(mesh)->boundaries, 1);
    expect_near(distance(mesh, 1, 3), 4 * sqrt(2), 1e-14);
    gd_mesh_release(mesh);

    uint32_t two[] = {0, 1, 4, 1, 2, 4, 0, 5, 3, 5, 2, 3, 0, 4, 2, 2, 5, 0};
    polygons = TRIANGLES(positions, two);
    mesh = mend(&polygons);
    assert_true(gd_mesh_repair(mesh)->edges_flipped.count > 0);
    assert_int_equal(gd_mesh_summary(mesh)->components, 1);
    assert_int_equal(gd_mesh_summary(mesh)->boundaries, 1);
    expect_near(gd_mesh_summary(mesh)->area, 16, 1e-14);
    expect_near(distance(mesh, 1, 3), 4 * sqrt(2), 1e-14);
    gd_mesh_release(mesh);
}

/* A side that is a billion times shorter than the others collapses, and its ends become one
 * vertex. */
static void needles_collapse(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1e-10, 1, 0}};
    uint32_t corners[] = {0, 1, 4, 0, 4, 3, 1, 2, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    refuse(&polygons, GD_DEGENERATE_FACE);
    struct gd_mesh *mesh = mend(&polygons);
    expect_mended(&gd_mesh_repair(mesh)->vertices_merged, MENDED({4, 3}));
    expect_mended(&gd_mesh_repair(mesh)->degenerate_faces, MENDED({1, 0}));
    expect_near(gd_mesh_repair(mesh)->largest_shift, 1e-10, 1e-24);
    expect_near(distance(mesh, 4, 1), sqrt(2), 1e-15);
    assert_int_equal(gd_mesh_summary(mesh)->unreferenced_vertices, 0);
    gd_mesh_release(mesh);
}

static void thin_faces_that_are_not_flat_stay(void **state)
{
    (void)state;
    double positions[][3] = {
        {0, 0, 0}, {1, 0, 0}, {0.5, 2 * GD_TOL_FLAT, 0}, {1, 3 * GD_TOL_FLAT, 0}};
    uint32_t corners[] = {0, 1, 2, 1, 3, 2};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = mend(&polygons);
    const struct gd_mesh_repair nothing = {0};
    assert_memory_equal(gd_mesh_repair(mesh), &nothing, sizeof nothing);
    gd_mesh_release(mesh);
}

static void a_mesh_without_area_is_empty(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    uint32_t corners[] = {0, 1, 2, 1, 2, 3, 0, 3, 1};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh_options options = {.repair_split = true};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&polygons, &options, NULL, &mesh, NULL), GD_EMPTY);
}

static void scale_does_not_matter(void **state)
{
    (void)state;
    const double scales[] = {1e-140, 1e-40, 1e40, 1e140};
    for (size_t i = 0; i < COUNT(scales); i++) {
        struct gapped_cube gapped;
        make_gapped_cube(&gapped, 5, true);
        for (uint32_t v = 0; v < gapped.polygons.position_count; v++) {
            for (int k = 0; k < 3; k++) gapped.positions[v][k] *= scales[i];
        }
        struct gd_mesh *mesh = mend(&gapped.polygons);
        assert_int_equal(gd_mesh_repair(mesh)->degenerate_faces.count, 0);
        expect_near(distance(mesh, 0, 6) / scales[i], sqrt(5), 1e-14);
        gd_mesh_release(mesh);
    }
}

/* A random triangulation of collinear points between two triangles is the worst case for the order
 * of flips. The repair must finish in bounded time. */
static void random_caps_are_repaired_in_bounded_time(void **state)
{
    (void)state;
    enum { POINTS = 3000 };
    static double positions[POINTS + 2][3];
    static uint32_t corners[6 * POINTS];
    uint64_t random = 5;
    for (uint32_t i = 0; i < POINTS; i++) positions[i][0] = i;
    memcpy(positions[POINTS], (double[3]){POINTS / 2, POINTS, 0}, sizeof *positions);
    uint32_t ring[POINTS], left = POINTS, faces = 0;
    for (uint32_t i = 0; i < POINTS; i++) ring[i] = i;
    for (uint32_t i = 0; i + 1 < POINTS; i++)
        memcpy(corners + 3 * (size_t)faces++, (uint32_t[3]){i, i + 1, POINTS}, 3 * sizeof *corners);
    while (left > 2) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        uint32_t at = 1 + (uint32_t)(random >> 33) % (left - 2);
        memcpy(corners + 3 * (size_t)faces++, (uint32_t[3]){ring[at], ring[at - 1], ring[at + 1]},
               3 * sizeof *corners);
        memmove(ring + at, ring + at + 1, (left - at - 1) * sizeof *ring);
        left--;
    }
    memcpy(positions[POINTS + 1], (double[3]){POINTS / 2, -POINTS, 0}, sizeof *positions);
    memcpy(corners + 3 * (size_t)faces++, (uint32_t[3]){POINTS - 1, 0, POINTS + 1},
           3 * sizeof *corners);
    struct gd_polygons polygons = {.positions = positions,
                                   .position_count = POINTS + 2,
                                   .corners = corners,
                                   .polygon_count = faces};
    uint64_t begun = gd_now_ns();
    struct gd_mesh *mesh = mend(&polygons);
    print_message("# %u caps: %u flips, %.1f ms\n", POINTS - 2,
                  gd_mesh_repair(mesh)->edges_flipped.count, (double)(gd_now_ns() - begun) * 1e-6);
    assert_int_equal(gd_mesh_summary(mesh)->boundaries, 1);
    assert_int_equal(gd_mesh_repair(mesh)->edges_split.count, 0);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(caps_on_an_edge_of_a_box_are_flipped_away),
        cmocka_unit_test(the_faces_of_a_flipped_edge_keep_their_indices),
        cmocka_unit_test(caps_at_the_border_are_dropped),
        cmocka_unit_test(a_pocket_closes),
        cmocka_unit_test(needles_collapse),
        cmocka_unit_test(thin_faces_that_are_not_flat_stay),
        cmocka_unit_test(a_mesh_without_area_is_empty),
        cmocka_unit_test(scale_does_not_matter),
        cmocka_unit_test(random_caps_are_repaired_in_bounded_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
