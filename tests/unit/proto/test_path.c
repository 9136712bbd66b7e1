#include "support.h"

#include "proto/values/path.h"

static void encodes_by_geometry(void **state)
{
    (void)state;
    static const struct {
        enum proto_geometry geometry;
        const char *text;
    } cases[] = {
        {PROTO_GEOMETRY_FULL,
         "{\"length\":1.5,\"points\":[{\"xyz\":[0,0,0],\"vertex\":0},{\"xyz\":[0.5,0.5,0],\"edge\":"
         "[1,2],\"t\":0.5},"
         "{\"face\":0,\"barycentric\":[0.5,0.25,0.25],\"xyz\":[0.25,0.25,0]}]}"},
        {PROTO_GEOMETRY_XYZ, "{\"length\":1.5,\"points\":[[0,0,0],[0.5,0.5,0],[0.25,0.25,0]]}"},
        {PROTO_GEOMETRY_NONE, "{\"length\":1.5}"},
    };
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_point points[3];
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){0}, &points[0], NULL), GD_OK);
    assert_int_equal(gd_point_on_edge(mesh, (struct gd_vertex[]){{1}, {2}}, 0.5, &points[1], NULL),
                     GD_OK);
    assert_int_equal(gd_point_in_face(mesh, (struct gd_face){0}, (const double[]){0.5, 0.25, 0.25},
                                      &points[2], NULL),
                     GD_OK);
    const struct gd_path path = {.length = 1.5, .count = 3, .points = points};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_writer writer = new_writer();
        proto_path_encode(&writer, mesh, &path, cases[i].geometry);
        assert_written(&writer, cases[i].text);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(encodes_by_geometry)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
