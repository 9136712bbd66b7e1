#include "cutting.h"

/* Returns a square curve on the grid with x and y in [0.15, 0.65]. A cut along this curve leaves
 * two pieces. */
static struct gd_curve square_in_a_grid(const struct gd_mesh *mesh)
{
    const struct gd_point points[] = {point_at(mesh, 0.15, 0.15, 0), point_at(mesh, 0.65, 0.15, 0),
                                      point_at(mesh, 0.65, 0.65, 0), point_at(mesh, 0.15, 0.65, 0)};
    return curve_through(mesh, points, 4, true);
}

static struct gd_mesh *grid(uint32_t cells)
{
    return sample_mesh("grid", (double[SAMPLE_PARAMETERS]){cells, cells, 1, 1});
}

static enum gd_status cut_inside(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                 struct gd_point inside, bool select_only, struct gd_cut *out)
{
    const struct gd_cut_request request = {
        .curve = curve, .inside = &inside, .select_only = select_only};
    return gd_cut_along(mesh, &request, NULL, out, NULL);
}

static void the_piece_that_holds_a_point(void **state)
{
    (void)state;
    struct gd_mesh *mesh = grid(5);
    struct gd_curve curve = square_in_a_grid(mesh);
    struct rng rng = {7};
    for (int i = 0; i < 200; i++) {
        /* the point is a vertex, or lies on an edge or in a face */
        double x = i % 2 ? rng_unit(&rng) : rng_below(&rng, 6) / 5.0,
               y = i % 3 ? rng_unit(&rng) : rng_below(&rng, 6) / 5.0;
        bool is_inside = x > 0.15 && x < 0.65 && y > 0.15 && y < 0.65;
        struct gd_cut cut;
        check_ok(cut_inside(mesh, &curve, point_at(mesh, x, y, 0), i % 4 == 0, &cut), NULL);
        assert_int_equal(cut.piece_count, 1);
        assert_true(cut.separates);
        check_close(cut.pieces[0].area, is_inside ? 0.25 : 0.75, 1e-12);
        assert_true((cut.pieces[0].polygons.position_count == 0) == (i % 4 == 0));
        gd_cut_free(&cut);
    }
    gd_curve_free(&curve);
    gd_mesh_release(mesh);
}

static void a_point_on_the_curve_is_on_no_side(void **state)
{
    (void)state;
    struct gd_mesh *mesh = grid(5);
    struct gd_curve curve = square_in_a_grid(mesh);
    for (uint32_t i = 0; i < curve.count; i++) {
        struct gd_cut cut;
        assert_int_equal(cut_inside(mesh, &curve, curve.points[i], true, &cut),
                         GD_INVALID_ARGUMENT);
    }
    gd_curve_free(&curve);
    gd_mesh_release(mesh);
}

/* A selection assigns each face to the piece that has the largest part of the face. On this grid,
 * this piece contains the face's centroid, except near the curve. */
static void faces_of_a_selection(void **state)
{
    (void)state;
    struct gd_mesh *mesh = grid(10);
    struct gd_curve curve = square_in_a_grid(mesh);
    const struct gd_cut_request request = {.curve = &curve, .select_only = true};
    struct gd_cut cut;
    check_ok(gd_cut_along(mesh, &request, NULL, &cut, NULL), NULL);
    assert_int_equal(cut.piece_count, 2);
    assert_int_equal(cut.pieces[0].face_count + cut.pieces[1].face_count,
                     gd_mesh_summary(mesh)->faces);
    check_close(cut.pieces[0].area, 0.75, 1e-12);
    check_close(cut.pieces[1].area, 0.25, 1e-12);
    for (uint32_t p = 0; p < 2; p++) {
        assert_null(cut.pieces[p].vertex_map);
        for (uint32_t i = 0; i < cut.pieces[p].face_count; i++) {
            struct gd_vertex corners[3];
            struct gd_vec3 sum = {0};
            if (i) assert_true(cut.pieces[p].face_map[i] > cut.pieces[p].face_map[i - 1]);
            gd_mesh_corners(mesh, (struct gd_face){cut.pieces[p].face_map[i]}, corners);
            for (int k = 0; k < 3; k++) sum = gd_vec3_add(sum, gd_mesh_position(mesh, corners[k]));
            double out = fmax(fabs(sum.x / 3 - 0.4), fabs(sum.y / 3 - 0.4));
            if (fabs(out - 0.25) > 0.06) assert_int_equal(p, out < 0.25);
        }
    }
    gd_cut_free(&cut);
    gd_curve_free(&curve);
    gd_mesh_release(mesh);
}

/* The square has two triangles of area 0.5. The part of the upper triangle to the left of x = 0.3
 * has the area 0.255; the part to the left of x = 0.29 has the area 0.248. */
static void a_crossed_face_belongs_to_the_piece_with_most_of_it(void **state)
{
    (void)state;
    static const struct {
        double x;
        uint32_t left, right;
    } cuts[] = {{0.3, 1, 1}, {0.29, 0, 2}, {0.71, 2, 0}};
    struct gd_mesh *mesh = grid(1);
    for (size_t i = 0; i < COUNT(cuts); i++) {
        const struct gd_point ends[] = {point_at(mesh, cuts[i].x, 0, 0),
                                        point_at(mesh, cuts[i].x, 1, 0)};
        struct gd_curve curve = curve_through(mesh, ends, 2, false);
        for (int right = 0; right < 2; right++) {
            struct gd_cut cut;
            check_ok(cut_inside(mesh, &curve, point_at(mesh, right, 0.5, 0), true, &cut), NULL);
            check_close(cut.pieces[0].area, right ? 1 - cuts[i].x : cuts[i].x, 1e-12);
            assert_int_equal(cut.pieces[0].face_count, right ? cuts[i].right : cuts[i].left);
            gd_cut_free(&cut);
        }
        gd_curve_free(&curve);
    }
    gd_mesh_release(mesh);
}

/* The curve cuts one of two spheres. The other sphere stays the same, bit for bit. */
static void other_components_stay(void **state)
{
    (void)state;
    struct gd_polygons two, one;
    check_ok(sample_find("icosphere")->generate((double[SAMPLE_PARAMETERS]){1, 1}, &one), NULL);
    two = (struct gd_polygons){.position_count = 2 * one.position_count,
                               .polygon_count = 2 * one.polygon_count};
    two.positions = calloc(two.position_count, sizeof *two.positions);
    two.corners = calloc(3 * (size_t)two.polygon_count, sizeof *two.corners);
    for (uint32_t i = 0; i < two.position_count; i++) {
        memcpy(two.positions[i], one.positions[i % one.position_count], sizeof *two.positions);
        two.positions[i][0] += i < one.position_count ? 0 : 5;
    }
    for (uint32_t i = 0; i < 3 * two.polygon_count; i++)
        two.corners[i] = one.corners[i % (3 * one.polygon_count)] +
                         (i < 3 * one.polygon_count ? 0 : one.position_count);
    struct gd_mesh *mesh = test_mesh(&two);
    const struct gd_point points[] = {vertex_of(mesh, 0), vertex_of(mesh, 5), vertex_of(mesh, 9)};
    struct cutting cutting = cutting_through(mesh, points, 3, true);
    check_cutting(mesh, &cutting, 1e-12);
    assert_int_equal(cutting.cut.piece_count, 3);
    const struct gd_cut_piece *other = &cutting.cut.pieces[2];
    assert_int_equal(other->face_count, one.polygon_count);
    for (uint32_t i = 0; i < one.position_count; i++)
        assert_int_equal(other->vertex_map[i], one.position_count + i);
    assert_memory_equal(other->polygons.corners, one.corners,
                        3 * one.polygon_count * sizeof *one.corners);
    cutting_free(&cutting);
    gd_mesh_release(mesh);
    gd_polygons_free(&one);
    gd_polygons_free(&two);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_piece_that_holds_a_point),
        cmocka_unit_test(a_point_on_the_curve_is_on_no_side),
        cmocka_unit_test(faces_of_a_selection),
        cmocka_unit_test(a_crossed_face_belongs_to_the_piece_with_most_of_it),
        cmocka_unit_test(other_components_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
