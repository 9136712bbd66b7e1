#include "tests/unit/subdiv/surfaces.h"

static void check_refused(const char *text, enum gd_scheme scheme, enum gd_status expected,
                          const char *words)
{
    struct gd_control_mesh mesh;
    struct gd_detail detail = {0};
    enum gd_status status = gd_read_control_mesh(
        text, strlen(text), &(struct gd_read_options){.format = GD_FORMAT_OBJ}, &mesh, &detail);
    struct gd_subdivision *surface = NULL;
    if (!status) {
        status = gd_subdivision_create(&mesh, scheme, NULL, &surface, &detail);
        gd_control_mesh_free(&mesh);
    }
    if (status != expected)
        fail_msg("%s instead of %s: %s", gd_status_name(status), gd_status_name(expected),
                 detail.text);
    if (!strstr(detail.text, words)) fail_msg("'%s' doesn't say '%s'", detail.text, words);
    assert_null(surface);
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 1\nv 2 1 1\nv 9 9 9\nf 1 2 3 4\n"

static void refused_by_name(void **state)
{
    (void)state;
    const enum gd_scheme quads = GD_SCHEME_CATMULL_CLARK;
    check_refused(SQUARE "f 2 5 6 6\n", quads, GD_DEGENERATE_FACE, "face 1 has one vertex twice");
    check_refused(SQUARE "f 2 5 6 3\nf 3 2 7\n", quads, GD_NON_MANIFOLD_EDGE,
                  "vertices 1 and 2 belongs to 3 faces");
    check_refused(SQUARE "f 2 3 6 5\n", quads, GD_NON_ORIENTABLE, "faces 0 and 1 run along");
    check_refused(SQUARE "f 3 5 6\n", quads, GD_NON_MANIFOLD_VERTEX, "around vertex 2");
    check_refused(SQUARE, GD_SCHEME_LOOP, GD_NOT_TRIANGLES, "face 0 has 4 corners");
    check_refused(SQUARE "t crease 2/1/0 0 2 1\n", quads, GD_NO_SUCH_EDGE,
                  "vertices 0 and 2, which share no edge");
    check_refused(SQUARE "t crease 2/1/0 0 1 -1\n", quads, GD_INVALID_ARGUMENT, "sharpness -1");
    check_refused(SQUARE "t crease 2/1/0 0 1 nan\n", quads, GD_INVALID_ARGUMENT, "sharpness");
    check_refused(SQUARE "t corner 1/1/0 6 2\n", quads, GD_UNREFERENCED_VERTEX, "vertex 6");
    check_refused(SQUARE "t corner 1/1/0 7 2\n", quads, GD_INDEX, "numbered from 0 to 6");
    check_refused(SQUARE "t interpolateboundary 1/0/0 0\n", quads, GD_UNSUPPORTED, "boundary rule");
    check_refused(SQUARE "t hole 1/0/0 0\n", quads, GD_UNSUPPORTED, "'hole'");
    check_refused(SQUARE "t crease 2/3/0 0 1 1 1 1\n", quads, GD_SYNTAX, "one sharpness");
    check_refused(SQUARE "t crease 2 0 1 1\n", quads, GD_SYNTAX, "2/1/0");
    check_refused(SQUARE "t crease 999999999/1/0 0 1 1\n", quads, GD_TRUNCATED,
                  "its line ends before them");
    check_refused("v 0 0 0\n", quads, GD_EMPTY, "");
    struct gd_control_mesh none = {0};
    struct gd_subdivision *surface;
    assert_int_equal(gd_subdivision_create(&none, quads, NULL, &surface, NULL), GD_EMPTY);
}

static void summaries(void **state)
{
    (void)state;
    struct gd_subdivision *cube =
        surface_from(CUBE "t crease 3/1/0 4 5 7 2\nt corner 1/1/0 0 3\n", GD_SCHEME_CATMULL_CLARK);
    struct gd_subdivision_summary summary = gd_subdivision_summary(cube);
    assert_int_equal(summary.vertex_count, 8);
    assert_int_equal(summary.edge_count, 12);
    assert_int_equal(summary.face_count, 6);
    assert_int_equal(summary.crease_edges, 2);
    assert_int_equal(summary.corner_vertices, 1);
    assert_int_equal(summary.boundary_edges, 0);
    assert_int_equal(summary.extraordinary_count, 1);
    assert_int_equal(summary.extraordinary[0].valence, 3);
    assert_int_equal(summary.extraordinary[0].count, 8);
    assert_true(gd_subdivision_memsize(cube) > 1000);
    struct gd_subdivision *shared = gd_subdivision_retain(cube);
    gd_subdivision_release(cube);
    assert_int_equal(gd_subdivision_scheme(shared), GD_SCHEME_CATMULL_CLARK);
    gd_subdivision_release(shared);
    gd_subdivision_release(NULL);

    struct gd_control_mesh mesh;
    make_sheet(3, true, &mesh);
    struct gd_subdivision *sheet = surface_of(&mesh, GD_SCHEME_LOOP);
    summary = gd_subdivision_summary(sheet);
    assert_int_equal(summary.boundary_edges, 12);
    assert_int_equal(summary.boundary_loops, 1);
    assert_int_equal(summary.extraordinary_count, 0);
    gd_subdivision_release(sheet);
    gd_control_mesh_free(&mesh);
}

/* Tests tags of a file: chains of edges, one sharpness for all edges or one for each edge, and
 * ignored tags. */
static void tags(void **state)
{
    (void)state;
    static const char text[] =
        CUBE "t crease 3/2/0 4 5 7 2.5 10\nt crease 2/1/0 0 1 1\nt corner 2/1/0 3 4 7\n"
             "t facevaryinginterpolateboundary 1/0/0 3\nt interpolateboundary 1/0/0 2 # edges\n";
    struct gd_control_mesh mesh;
    struct gd_detail detail = {0};
    check_ok(gd_read_control_mesh(text, sizeof text - 1, NULL, &mesh, &detail), &detail);
    assert_int_equal(mesh.crease_count, 3);
    assert_int_equal(mesh.creases[1].vertices[0], 5);
    assert_int_equal(mesh.creases[1].vertices[1], 7);
    assert_true(mesh.creases[0].sharpness == 2.5 && mesh.creases[1].sharpness == 10 &&
                mesh.creases[2].sharpness == 1);
    assert_int_equal(mesh.corner_count, 2);
    assert_true(mesh.corners[1].vertex == 4 && mesh.corners[1].sharpness == 7 &&
                mesh.corners[0].sharpness == 7);
    assert_int_equal(mesh.boundary, GD_INTERPOLATE_EDGE_ONLY);
    gd_control_mesh_free(&mesh);
}

/* Uses more unreferenced vertices than the mesh has sides. These vertices do not change the
 * surface. */
static void unreferenced_vertices(void **state)
{
    (void)state;
    static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nt corner 1/1/0 1 2\n";
    char text[2048];
    size_t size = (size_t)snprintf(text, sizeof text, "%s", triangle);
    for (int i = 0; i < 60; i++)
        size += (size_t)snprintf(text + size, sizeof text - size, "v %d 2 3\n", i);
    struct gd_subdivision *alone = surface_from(triangle, GD_SCHEME_CATMULL_CLARK);
    struct gd_subdivision *among = surface_from(text, GD_SCHEME_CATMULL_CLARK);
    assert_int_equal(gd_subdivision_summary(among).vertex_count, 63);
    for (uint32_t corner = 0; corner < 3; corner++) {
        const struct gd_limit_point place = {.corner = corner, .u = 0.25, .v = 0.5};
        struct gd_limit_jet expected, jet;
        assert_int_equal(gd_limit_evaluate(alone, &place, &expected, NULL), GD_OK);
        assert_int_equal(gd_limit_evaluate(among, &place, &jet, NULL), GD_OK);
        assert_memory_equal(&jet.position, &expected.position, sizeof jet.position);
    }
    gd_subdivision_release(alone);
    gd_subdivision_release(among);
}

/* Each edge of the control mesh is returned once, even if polygons of the control mesh are refined
 * to get the base faces. */
static void control_edges(void **state)
{
    (void)state;
    static const char pyramid[] = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1 1 2\n"
                                  "f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    static const char *const texts[] = {CUBE, pyramid};
    static const uint32_t counts[][2] = {{8, 12}, {5, 8}};
    for (int i = 0; i < 2; i++) {
        struct gd_subdivision *surface = surface_from(texts[i], GD_SCHEME_CATMULL_CLARK);
        struct gd_subdivision_summary summary = gd_subdivision_summary(surface);
        uint32_t edges[12][2];
        assert_int_equal(summary.vertex_count, counts[i][0]);
        assert_int_equal(summary.edge_count, counts[i][1]);
        gd_subdivision_control_edges(surface, edges);
        for (uint32_t k = 0; k < summary.edge_count; k++)
            for (uint32_t other = 0; other < k; other++)
                assert_false((edges[k][0] == edges[other][0] && edges[k][1] == edges[other][1]) ||
                             (edges[k][0] == edges[other][1] && edges[k][1] == edges[other][0]));
        const struct gd_vec3 *points = gd_subdivision_control_points(surface);
        for (uint32_t k = 0; k < summary.edge_count; k++) {
            double length = gd_vec3_distance(points[edges[k][0]], points[edges[k][1]]);
            assert_true(length == 2 || (i && fabs(length - sqrt(6)) < 1e-12));
        }
        gd_subdivision_release(surface);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(refused_by_name),
                                       cmocka_unit_test(control_edges), cmocka_unit_test(summaries),
                                       cmocka_unit_test(tags),
                                       cmocka_unit_test(unreferenced_vertices)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
