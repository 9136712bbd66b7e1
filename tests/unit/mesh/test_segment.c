/* Tests which face or edge contains a segment, and the chord of the segment in the frame of a
 * face. */
#include "tests/support/test.h"

#include <math.h>

#include "mesh/segment.h"
#include "tests/samples/samples.h"

static struct gd_mesh *mesh;

static int make_mesh(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(2, 1, 2, 1, &polygons), NULL); /* two squares of two triangles each */
    mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return 0;
}

static int drop_mesh(void **state)
{
    (void)state;
    gd_mesh_release(mesh);
    return 0;
}

static struct gd_point at(double x, double y)
{
    struct gd_point point;
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){x, y, 0}, 0, &point, NULL), NULL);
    return point;
}

static struct gd__segment_location home_of(struct gd_point a, struct gd_point b)
{
    struct gd__segment_location location = {7, 7}, back = {7, 7};
    bool found = gd__segment_locate(mesh, &a, &b, &location);
    assert_true(gd__segment_locate(mesh, &b, &a, &back) == found);
    if (!found) return (struct gd__segment_location){GD_NONE, GD_NONE};
    assert_true(location.edge == back.edge &&
                (location.edge != GD_NONE || location.face == back.face));
    return location;
}

static void along_edges(void **state)
{
    (void)state;
    struct gd_point corner = at(0, 0), next = at(1, 0), between = at(0.25, 0);
    uint32_t edge = home_of(corner, next).edge;
    assert_true(edge != GD_NONE && between.kind == GD_POINT_EDGE && between.element == edge);
    assert_int_equal(home_of(corner, between).edge, edge);
    assert_int_equal(home_of(between, at(0.75, 0)).edge, edge);
    double t = gd__edge_parameter(mesh, edge, &between),
           first = gd__edge_parameter(mesh, edge, &corner);
    check_close(fabs(t - first), 0.25 / mesh->unit, 1e-15);
}

static void across_faces(void **state)
{
    (void)state;
    struct gd_point inside = at(0.7, 0.2), border = at(0.3, 0);
    struct gd__segment_location location = home_of(inside, border);
    assert_int_equal(location.edge, GD_NONE);
    assert_int_equal(location.face, inside.element);
    assert_true(gd__face_contains(mesh, location.face, &border) &&
                gd__face_contains(mesh, location.face, &inside));
    location = home_of(at(0.3, 0), at(1, 0.6)); /* from edge to edge of a face */
    assert_int_equal(location.edge, GD_NONE);
    assert_int_equal(location.face, inside.element);
    for (int k = 0; k < 3; k++) { /* the frame of each side gives the same length and end */
        struct gd__chord chord = gd__chord(mesh, inside.element, k, &inside, &border);
        check_close(chord.length * mesh->unit, hypot(0.4, 0.2), 1e-15);
        struct gd__local end = {chord.from.x + chord.length * chord.along.x,
                                chord.from.y + chord.length * chord.along.y};
        check_close(gd__chord_foot(&chord, end), chord.length, 1e-15);
        assert_true(fabs(gd__chord_height(&chord, end)) < 1e-15);
        struct gd__local left = {end.x - 0.1 * chord.along.y, end.y + 0.1 * chord.along.x};
        check_close(gd__chord_height(&chord, left), 0.1, 1e-14);
    }
}

static void segments_without_a_face(void **state)
{
    (void)state;
    struct gd_point corner = at(0, 0);
    assert_int_equal(home_of(corner, corner).face, GD_NONE);
    assert_int_equal(home_of(corner, at(2, 1)).face, GD_NONE);
    assert_int_equal(home_of(at(0.7, 0.2), at(1.7, 0.2)).face, GD_NONE);
    assert_int_equal(home_of(at(0.25, 0), at(2, 0.5)).face, GD_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(along_edges),
                                       cmocka_unit_test(across_faces),
                                       cmocka_unit_test(segments_without_a_face)};
    return cmocka_run_group_tests(tests, make_mesh, drop_mesh);
}
