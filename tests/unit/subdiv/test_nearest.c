#include "tests/unit/subdiv/surfaces.h"

static struct gd_limit_closest foot_of(const struct gd_subdivision *surface, struct gd_vec3 xyz)
{
    struct gd_limit_closest foot = {0};
    struct gd_detail detail = {0};
    check_ok(gd_limit_nearest(surface, xyz, NULL, &foot, &detail), &detail);
    return foot;
}

/* Moves points along the normal by less than the radius of curvature. Their nearest point is the
 * original point. */
static void check_normals(const struct gd_subdivision *surface, uint32_t faces, double height)
{
    struct rng rng = {5};
    for (int n = 0; n < 60; n++) {
        struct gd_limit_point place = {rng_below(&rng, faces), 0, rng_between(&rng, 0, 0.5),
                                       rng_between(&rng, 0, 0.5)};
        if (n % 10 == 0) place.v = 0;
        struct gd_limit_jet jet = jet_at(surface, place.face, 0, place.u, place.v);
        struct gd_limit_closest foot =
            foot_of(surface, gd_vec3_along(jet.position, height, jet.normal));
        check_close(foot.distance, height, 1e-13);
        check_near(foot.position, jet.position.x, jet.position.y, jet.position.z, 1e-7);
        struct gd_limit_jet there =
            jet_at(surface, foot.place.face, foot.place.corner, foot.place.u, foot.place.v);
        check_near(there.position, foot.position.x, foot.position.y, foot.position.z, 1e-14);
        foot = foot_of(surface, jet.position);
        assert_true(foot.distance < 1e-13);
        struct gd_limit_jet near =
            /* near a vertex, so the search starts there */
            jet_at(surface, place.face, 0, place.u / 20, place.v / 20);
        assert_true(foot_of(surface, near.position).distance < 1e-13);
    }
}

static void along_normals(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    check_normals(surface, 6, 0.3);
    /* uses the vertex of valence 3 */
    struct gd_limit_closest foot = foot_of(surface, (struct gd_vec3){3, 3, 3});
    check_near(foot.position, 0.5, 0.5, 0.5, 1e-12);
    check_close(foot.distance, 2.5 * sqrt(3), 1e-14);
    gd_subdivision_release(surface);
    surface = surface_from(OCTAHEDRON, GD_SCHEME_LOOP);
    check_normals(surface, 8, 0.3);
    gd_subdivision_release(surface);
}

/* The nearest point to a position beyond a boundary is on the boundary. The line that connects them
 * meets the boundary at a right angle. */
static void boundary(void **state)
{
    (void)state;
    struct gd_control_mesh mesh;
    make_sheet(4, false, &mesh);
    struct gd_subdivision *sheet = surface_of(&mesh, GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_closest foot = foot_of(sheet, (struct gd_vec3){2.1, -3, 0.4});
    struct gd_limit_jet jet = jet_at(sheet, foot.place.face, 0, foot.place.u, foot.place.v);
    assert_true(foot.place.v < 1e-12);
    struct gd_vec3 way = gd_vec3_sub((struct gd_vec3){2.1, -3, 0.4}, foot.position);
    assert_true(fabs(gd_vec3_dot(way, jet.du)) < 1e-9);
    foot = foot_of(sheet, (struct gd_vec3){-5, -5, 0});
    check_near(foot.position, mesh.polygons.positions[0][0], mesh.polygons.positions[0][1],
               mesh.polygons.positions[0][2], 1e-12);
    assert_int_equal(gd_limit_nearest(sheet, (struct gd_vec3){NAN, 0, 0}, NULL, &foot, NULL),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_limit_nearest(sheet, (struct gd_vec3){1e155, 0, 0}, NULL, &foot, NULL),
                     GD_INVALID_ARGUMENT);
    gd_subdivision_release(sheet);
    gd_control_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(along_normals), cmocka_unit_test(boundary)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
