#include "tests/unit/mesh/shapes.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

/* A band of BAND quads. If `twisted`, the band makes half a turn before its ends are joined. If
 * `closed`, the cross-section of the band is a closed triangle. */
enum { BAND = 12 };

static struct gd_polygons band(bool twisted, bool closed, double positions[3 * BAND][3],
                               uint32_t corners[18 * BAND])
{
    uint32_t rows = closed ? 3 : 2, n = 0;
    for (uint32_t i = 0; i < BAND; i++) {
        for (uint32_t j = 0; j < rows; j++) {
            double a = 2 * M_PI * i / BAND, r = 3 + cos(a / 2 + 2 * j) * 0.7;
            memcpy(positions[rows * i + j], (double[3]){r * cos(a), r * sin(a), sin(a / 2 + 2 * j)},
                   sizeof *positions);
        }
    }
    for (uint32_t i = 0; i < BAND; i++) {
        for (uint32_t j = 0; j < (closed ? 3u : 1u); j++) {
            uint32_t k = (j + 1) % rows, last = i + 1 == BAND && twisted,
                     next = rows * ((i + 1) % BAND);
            uint32_t a = rows * i + j, b = rows * i + k;
            uint32_t c = next + (last ? rows - 1 - k : k), d = next + (last ? rows - 1 - j : j);
            memcpy(corners + n, (uint32_t[6]){a, b, c, a, c, d}, 6 * sizeof *corners);
            n += 6;
        }
    }
    return (struct gd_polygons){.positions = positions,
                                .position_count = rows * BAND,
                                .corners = corners,
                                .polygon_count = n / 3};
}

static void moebius_strip_and_klein_bottle_are_refused(void **state)
{
    (void)state;
    double positions[3 * BAND][3];
    uint32_t corners[18 * BAND];
    struct gd_polygons moebius = band(true, false, positions, corners);
    struct gd_detail detail = refuse(&moebius, GD_NON_ORIENTABLE);
    assert_int_equal(detail.kind, GD_ELEMENT_EDGE);
    assert_int_equal(detail.total, 1);
    struct gd_polygons klein = band(true, true, positions, corners);
    detail = refuse(&klein, GD_NON_ORIENTABLE);
    assert_int_equal(detail.total, 1);
}

static void ring_and_torus_are_accepted(void **state)
{
    (void)state;
    double positions[3 * BAND][3];
    uint32_t corners[18 * BAND];
    for (int closed = 0; closed < 2; closed++) {
        struct gd_polygons polygons = band(false, closed, positions, corners);
        struct gd_mesh *mesh = build(&polygons);
        assert_int_equal(gd_mesh_summary(mesh)->euler_characteristic, 0);
        assert_int_equal(gd_mesh_summary(mesh)->genus, closed);
        assert_int_equal(gd_mesh_summary(mesh)->boundaries, closed ? 0 : 2);
        gd_mesh_release(mesh);
    }
}

static void the_minority_is_turned_over_and_counted(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_icosphere(2, 1.0, &polygons), GD_OK);
    uint32_t flip[] = {3, 77, 100};
    for (uint32_t i = 0; i < COUNT(flip); i++) {
        uint32_t *c = polygons.corners + 3 * flip[i], kept = c[0];
        c[0] = c[1];
        c[1] = kept;
    }
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(gd_mesh_summary(mesh)->flipped_faces, 3);
    for (uint32_t f = 0; f < polygons.polygon_count; f++) {
        struct gd_vertex corners[3];
        gd_mesh_corners(mesh, (struct gd_face){f}, corners);
        struct gd_vec3 p[3];
        for (int k = 0; k < 3; k++) p[k] = gd_mesh_position(mesh, corners[k]);
        double volume = gd_vec3_dot(p[0], gd_vec3_cross(p[1], p[2]));
        assert_true(volume > 0);
        assert_int_equal(corners[0].index, polygons.corners[3 * f]);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void each_component_has_its_own_majority(void **state)
{
    (void)state;
    struct gd_polygons polygons, other;
    assert_int_equal(sample_icosphere(1, 1.0, &polygons), GD_OK);
    assert_int_equal(sample_icosphere(1, 3.0, &other), GD_OK);
    /* if all faces of a component are reversed, they stay reversed */
    sample_flip_faces(&other, 1, 1);
    assert_int_equal(sample_append(&polygons, &other), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(gd_mesh_summary(mesh)->flipped_faces, 0);
    assert_int_equal(gd_mesh_summary(mesh)->components, 2);
    gd_mesh_release(mesh);
    gd_polygons_free(&other);
    gd_polygons_free(&polygons);
}

static void at_a_tie_the_lowest_face_keeps_its_orientation(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    uint32_t corners[] = {2, 0, 3, 1, 2, 0}; /* one face clockwise, one counter-clockwise */
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = build(&polygons);
    struct gd_vertex c[3];
    assert_int_equal(gd_mesh_summary(mesh)->flipped_faces, 1);
    gd_mesh_corners(mesh, (struct gd_face){0}, c);
    assert_true(c[0].index == 2 && c[1].index == 0 && c[2].index == 3);
    gd_mesh_corners(mesh, (struct gd_face){1}, c);
    assert_true(c[0].index == 1 && c[1].index == 0 && c[2].index == 2);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moebius_strip_and_klein_bottle_are_refused),
        cmocka_unit_test(ring_and_torus_are_accepted),
        cmocka_unit_test(the_minority_is_turned_over_and_counted),
        cmocka_unit_test(each_component_has_its_own_majority),
        cmocka_unit_test(at_a_tie_the_lowest_face_keeps_its_orientation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
