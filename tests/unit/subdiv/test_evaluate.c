#include "tests/unit/subdiv/surfaces.h"

/* Compares with values that were computed independently and agree with OpenSubdiv to 12 digits. */
static void cube_values(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    const double third = sqrt(3) / 3;
    struct gd_limit_jet jet = jet_at(cube, 0, 0, 0, 0);
    check_near(jet.position, -0.5, -0.5, 0.5, 1e-14);
    check_near(jet.normal, -third, -third, third, 1e-14);
    assert_true(jet.singular && isnan(jet.curvatures[0]));
    check_near(jet_at(cube, 0, 0, 1, 1).position, 0.5, 0.5, 0.5, 1e-14);
    check_near(jet_at(cube, 0, 0, 0.5, 0.5).position, 0, 0, 68.0 / 81, 1e-14);
    check_near(jet_at(cube, 0, 0, 0.5, 0).position, 0, -395.0 / 648, 395.0 / 648, 1e-14);
    jet = jet_at(cube, 0, 0, 0.25, 0.25);
    check_near(jet.position, -0.316157085905, -0.316157085905, 0.728989840535, 1e-12);
    check_near(jet.normal, -0.340539656, -0.340539656, 0.876393453, 1e-9);
    check_near(jet_at(cube, 0, 0, 0.1, 0.2).position, -0.470313871571, -0.354383536694,
               0.629845143176, 1e-12);
    check_near(jet_at(cube, 0, 0, 0.01, 0.02).position, -0.499136625593, -0.492987573699,
               0.507727753563, 1e-12);
    gd_subdivision_release(cube);
}

static void valence_five(void **state)
{
    (void)state;
    struct gd_control_mesh mesh = {.boundary = GD_INTERPOLATE_EDGE_ONLY};
    double positions[11][3] = {{0, 0, 1}};
    uint32_t corners[20], first[6];
    for (uint32_t k = 0; k < 5; k++) {
        double a = k * 0.4 * M_PI, b = a + 0.2 * M_PI;
        double edge[3] = {cos(a), sin(a), 0.5}, far[3] = {1.6 * cos(b), 1.6 * sin(b), 0};
        memcpy(positions[1 + k], edge, sizeof edge);
        memcpy(positions[6 + k], far, sizeof far);
        const uint32_t quad[4] = {0, 1 + k, 6 + k, 1 + (k + 1) % 5};
        memcpy(corners + 4 * k, quad, sizeof quad);
    }
    for (uint32_t k = 0; k <= 5; k++) first[k] = 4 * k;
    mesh.polygons = (struct gd_polygons){positions, 11, 5, corners, first};
    struct gd_subdivision *surface = surface_of(&mesh, GD_SCHEME_CATMULL_CLARK);
    check_near(jet_at(surface, 0, 0, 0, 0).position, 0, 0, 0.7, 1e-14);
    check_near(jet_at(surface, 0, 0, 0.1, 0.2).position, 0.186734180011, 0.228375399151,
               0.662740423111, 1e-12);
    check_near(jet_at(surface, 0, 0, 0, 0).normal, 0, 0, 1, 1e-14);
    gd_subdivision_release(surface);
}

static double basis(int i, double t)
{
    const double b[4] = {pow(1 - t, 3) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                         (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
    return b[i];
}

/* The surface of a regular grid is the uniform bicubic B-spline. */
static void regular_grid(void **state)
{
    (void)state;
    struct gd_control_mesh mesh;
    make_sheet(3, false, &mesh);
    struct gd_subdivision *surface = surface_of(&mesh, GD_SCHEME_CATMULL_CLARK);
    struct rng rng = {7};
    for (int n = 0; n < 50; n++) {
        double u = rng_unit(&rng), v = rng_unit(&rng), sum[3] = {0};
        for (int k = 0; k < 16; k++) {
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += basis(k / 4, u) * basis(k % 4, v) * mesh.polygons.positions[k][axis];
        }
        check_near(jet_at(surface, 4, 0, u, v).position, sum[0], sum[1], sum[2], 1e-13);
    }
    gd_subdivision_release(surface);
    gd_control_mesh_free(&mesh);
}

/* Uses four infinitely sharp edges around the top. On the surface, these edges become the uniform
 * cubic B-spline of the square, and the top stays in the plane z = 1. */
static void creased_cube(void **state)
{
    (void)state;
    struct gd_subdivision *cube =
        surface_from(CUBE "t crease 5/1/0 4 5 7 6 4 10\n", GD_SCHEME_CATMULL_CLARK);
    for (int k = 0; k <= 16; k++) {
        double t = k / 16.0, w = 1 - t;
        double x = -basis(0, t) - basis(1, t) + basis(2, t) + basis(3, t),
               y = basis(0, t) - basis(1, t) - basis(2, t) + basis(3, t);
        check_near(jet_at(cube, 0, 0, t, 0).position, x, y, 1, 1e-14);
        check_near(jet_at(cube, 2, 0, w, 1).position, -x, y, 1, 1e-14);
    }
    check_near(jet_at(cube, 0, 0, 0.3, 0.6).normal, 0, 0, 1, 1e-14);
    check_near(jet_at(cube, 0, 0, 0.3, 0.6).position, jet_at(cube, 0, 0, 0.3, 0.6).position.x,
               jet_at(cube, 0, 0, 0.3, 0.6).position.y, 1, 1e-14);
    gd_subdivision_release(cube);
    cube = surface_from(CUBE "t crease 5/1/0 4 5 7 6 4 10\nt corner 4/1/0 4 5 6 7 10\n",
                        GD_SCHEME_CATMULL_CLARK);
    check_near(jet_at(cube, 0, 0, 0, 0).position, -1, -1, 1, 0);
    check_near(jet_at(cube, 0, 0, 0.25, 0).position, -0.5, -1, 1,
               1e-14); /* between two corners the edge is a straight line at uniform speed */
    gd_subdivision_release(cube);
}

/* The height grows with the sharpness of the tag. */
static void semi_sharp(void **state)
{
    (void)state;
    double before = 0;
    for (int k = 0; k <= 12; k++) {
        char text[1024];
        snprintf(text, sizeof text, "%st crease 5/1/0 4 5 7 6 4 %g\n", CUBE, 0.7 * k);
        struct gd_subdivision *cube = surface_from(text, GD_SCHEME_CATMULL_CLARK);
        double z = jet_at(cube, 0, 0, 0.5, 0).position.z;
        assert_true(z > before && z <= 1);
        before = z;
        gd_subdivision_release(cube);
    }
    check_close(before, 1, 2e-3);
}

/* For sharpness s <= 1 the tag acts in one refinement step, which blends smooth and sharp rules by
 * s. The surface is therefore linear in s. */
static void fractional(void **state)
{
    (void)state;
    struct gd_subdivision *cubes[3];
    for (int k = 0; k < 3; k++) {
        char text[1024];
        snprintf(text, sizeof text, "%st crease 4/1/0 4 5 7 3 %g\nt corner 1/1/0 0 %g\n", SKEW_CUBE,
                 k / 2.0, k / 2.0);
        cubes[k] = surface_from(text, GD_SCHEME_CATMULL_CLARK);
    }
    for (uint32_t face = 0; face < 6; face++) {
        struct gd_vec3 none = jet_at(cubes[0], face, 0, 0.3, 0.2).position,
                       whole = jet_at(cubes[2], face, 0, 0.3, 0.2).position;
        struct gd_vec3 middle = gd_vec3_scale(gd_vec3_add(none, whole), 0.5);
        assert_true(gd_vec3_distance(none, whole) > 1e-3);
        check_near(jet_at(cubes[1], face, 0, 0.3, 0.2).position, middle.x, middle.y, middle.z,
                   1e-14);
    }
    for (int k = 0; k < 3; k++) gd_subdivision_release(cubes[k]);
}

/* Compares first derivatives with central differences of positions, and second derivatives with
 * central differences of first derivatives. */
static void check_derivatives(const struct gd_subdivision *surface, uint32_t face, double u,
                              double v)
{
    const double h = 1e-5;
    struct gd_limit_jet jet = jet_at(surface, face, 0, u, v);
    struct gd_limit_jet a = jet_at(surface, face, 0, u - h, v),
                        b = jet_at(surface, face, 0, u + h, v);
    struct gd_limit_jet c = jet_at(surface, face, 0, u, v - h),
                        d = jet_at(surface, face, 0, u, v + h);
    struct gd_vec3 du = gd_vec3_scale(gd_vec3_sub(b.position, a.position), 0.5 / h);
    struct gd_vec3 dv = gd_vec3_scale(gd_vec3_sub(d.position, c.position), 0.5 / h);
    struct gd_vec3 duu = gd_vec3_scale(gd_vec3_sub(b.du, a.du), 0.5 / h);
    struct gd_vec3 duv = gd_vec3_scale(gd_vec3_sub(d.du, c.du), 0.5 / h);
    struct gd_vec3 dvv = gd_vec3_scale(gd_vec3_sub(d.dv, c.dv), 0.5 / h);
    check_near(jet.du, du.x, du.y, du.z, 1e-8);
    check_near(jet.dv, dv.x, dv.y, dv.z, 1e-8);
    check_near(jet.duu, duu.x, duu.y, duu.z, 1e-6);
    check_near(jet.duv, duv.x, duv.y, duv.z, 1e-6);
    check_near(jet.dvv, dvv.x, dvv.y, dvv.z, 1e-6);
}

static void derivatives(void **state)
{
    (void)state;
    struct gd_subdivision *cube =
        surface_from(CUBE "t crease 3/1/0 4 5 7 1.6\n", GD_SCHEME_CATMULL_CLARK);
    struct gd_subdivision *octahedron =
        surface_from(OCTAHEDRON "t crease 2/1/0 0 1 10\n", GD_SCHEME_LOOP);
    const double at[][2] = {{0.11, 0.22}, {0.3, 0.13}, {0.41, 0.33}, {0.07, 0.81}, {0.03, 0.04}};
    for (uint32_t face = 0; face < 6; face++) {
        for (int k = 0; k < 5; k++) {
            check_derivatives(cube, face, at[k][0], at[k][1]);
            check_derivatives(octahedron, face, at[k][0], at[k][1]);
        }
    }
    gd_subdivision_release(cube);
    gd_subdivision_release(octahedron);
}

/* Both faces of an edge give the same position, normal and curvatures along this edge. The pairs of
 * parameters below denote the same point. */
static void borders(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    struct gd_subdivision *octahedron = surface_from(OCTAHEDRON, GD_SCHEME_LOOP);
    for (int k = 1; k < 32; k++) {
        double t = k / 32.0;
        struct gd_limit_jet pairs[2][2] = {
            {jet_at(cube, 0, 0, t, 0), jet_at(cube, 2, 0, 1 - (1 - t), 1)},
            {jet_at(octahedron, 0, 0, t, 0), jet_at(octahedron, 4, 0, 1 - t, 0)}};
        for (int n = 0; n < 2; n++) {
            struct gd_limit_jet a = pairs[n][0], b = pairs[n][1];
            check_near(a.position, b.position.x, b.position.y, b.position.z, 1e-14);
            check_near(a.normal, b.normal.x, b.normal.y, b.normal.z, 1e-13);
            check_close(a.curvatures[0], b.curvatures[0], 1e-11);
            check_close(a.curvatures[1], b.curvatures[1], 1e-11);
        }
    }
    gd_subdivision_release(cube);
    gd_subdivision_release(octahedron);
}

/* Checks that position and normal converge towards a vertex to their values at the vertex. Normals
 * at a crease vertex with one face converge only with the logarithm of the distance. */
static void check_limit(const struct gd_subdivision *surface, uint32_t face, const double corner[2],
                        const double inner[2], double tolerance)
{
    struct gd_limit_jet at = jet_at(surface, face, 0, corner[0], corner[1]);
    double r = ldexp(1, -44);
    struct gd_limit_jet by = jet_at(surface, face, 0, corner[0] + r * (inner[0] - corner[0]),
                                    corner[1] + r * (inner[1] - corner[1]));
    check_near(by.position, at.position.x, at.position.y, at.position.z, 1e-8);
    check_near(by.normal, at.normal.x, at.normal.y, at.normal.z, tolerance);
    check_close(gd_vec3_length(at.normal), 1, 1e-14);
}

static void vertices(void **state)
{
    (void)state;
    static const char *const tags[] = {"", "t crease 2/1/0 4 5 10\n", "t crease 3/1/0 4 5 7 10\n",
                                       "t crease 4/1/0 4 5 7 6 2.5\n", "t crease 2/1/0 0 4 3.3\n"};
    static const char *const triangle_tags[] = {"", "t crease 2/1/0 0 1 10\n",
                                                "t crease 3/1/0 0 1 2 10\n"};
    const double quad[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, middle[2] = {0.52, 0.47};
    const double triangle[3][2] = {{0, 0}, {1, 0}, {0, 1}}, inner[2] = {0.31, 0.36};
    char text[1024];
    for (int k = 0; k < 5; k++) {
        snprintf(text, sizeof text, "%s%s", SKEW_CUBE, tags[k]);
        struct gd_subdivision *cube = surface_from(text, GD_SCHEME_CATMULL_CLARK);
        for (uint32_t i = 0; i < 24; i++)
            check_limit(cube, i / 4, quad[i % 4], middle, k == 2 && i == 1 ? 0.05 : 1e-5);
        gd_subdivision_release(cube);
    }
    for (int k = 0; k < 3; k++) {
        snprintf(text, sizeof text, "%s%s", OCTAHEDRON, triangle_tags[k]);
        struct gd_subdivision *octahedron = surface_from(text, GD_SCHEME_LOOP);
        for (uint32_t i = 0; i < 24; i++)
            check_limit(octahedron, i / 3, triangle[i % 3], inner, 1e-5);
        gd_subdivision_release(octahedron);
    }
}

/* An L-shaped mesh has boundary vertices with one, two and three faces. If edges are interpolated
 * but corners are not, normals near a vertex with one face converge only with the logarithm of the
 * distance. */
static void boundary_vertices(void **state)
{
    (void)state;
    static const char ell[] =
        "v 0 0 0\nv 1 0 .3\nv 2 0 .1\nv 0 1 .2\nv 1 1 .6\nv 2 1 -.1\nv 0 2 0\nv 1 2 .1\n"
        "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\n";
    static const char fan[] = "v 0 0 .2\nv 1 0 .3\nv .6 .8 0\nv -.2 1 .4\nv -.9 .5 0\nv -1 -.2 .3\n"
                              "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 6\n";
    char text[1024];
    snprintf(text, sizeof text, "%st interpolateboundary 1/0/0 2\n", ell);
    struct gd_subdivision *surface = surface_from(text, GD_SCHEME_CATMULL_CLARK);
    const double corner[4][2] = {{1, 1}, {0, 1}, {1, 0}, {0, 0}}, middle[2] = {0.52, 0.47};
    check_limit(surface, 0, corner[0], middle, 1e-4);
    check_limit(surface, 1, corner[1], middle, 1e-4);
    check_limit(surface, 2, corner[2], middle, 1e-4);
    check_limit(surface, 0, corner[3], middle, 0.05);
    gd_subdivision_release(surface);
    surface = surface_from(fan, GD_SCHEME_LOOP);
    for (uint32_t face = 0; face < 4; face++)
        check_limit(surface, face, corner[3], (const double[2]){0.31, 0.36}, 1e-5);
    gd_subdivision_release(surface);
}

/* The pieces of an n-gon meet in its middle. These pieces are faces of the control mesh after one
 * refinement. */
static void polygons(void **state)
{
    (void)state;
    struct gd_subdivision *wedge =
        surface_from("v 0 0 0\nv 2 0 0\nv 1 2 0\nv 0 0 3\nv 2 0 3\nv 1 2 3\nf 3 2 1\nf 4 5 6\nf 1 "
                     "2 5 4\nf 2 3 6 5\nf 3 1 4 6\n",
                     GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_jet middle = jet_at(wedge, 1, 0, 1, 1);
    for (uint32_t corner = 1; corner < 3; corner++) {
        struct gd_limit_jet other = jet_at(wedge, 1, corner, 1, 1);
        check_near(other.position, middle.position.x, middle.position.y, middle.position.z, 1e-14);
        check_near(other.normal, 0, 0, 1, 1e-13);
    }
    struct gd_limit_jet a = jet_at(wedge, 1, 0, 0.6, 0), b = jet_at(wedge, 2, 0, 0.3, 1);
    check_near(a.position, b.position.x, b.position.y, b.position.z, 1e-14);
    check_near(a.normal, b.normal.x, b.normal.y, b.normal.z, 1e-13);
    check_derivatives(wedge, 3, 0.3, 0.6);
    struct gd_limit_jet out;
    assert_int_equal(gd_limit_evaluate(wedge, &(struct gd_limit_point){1, 3, 0, 0}, &out, NULL),
                     GD_OUT_OF_RANGE);
    assert_int_equal(gd_limit_evaluate(wedge, &(struct gd_limit_point){2, 1, 0, 0}, &out, NULL),
                     GD_OUT_OF_RANGE);
    assert_int_equal(gd_limit_evaluate(wedge, &(struct gd_limit_point){5, 0, 0, 0}, &out, NULL),
                     GD_OUT_OF_RANGE);
    assert_int_equal(gd_limit_evaluate(wedge, &(struct gd_limit_point){0, 0, 1.1, 0}, &out, NULL),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_limit_evaluate(wedge, &(struct gd_limit_point){0, 0, NAN, 0}, &out, NULL),
                     GD_INVALID_ARGUMENT);
    gd_subdivision_release(wedge);
}

/* Checks a sharp corner inside a smooth surface (a spike). The corner stays fixed, all paths leave
 * it along the same axis, and it has no normal. */
static void check_spike(const char *text, enum gd_scheme scheme, uint32_t face, uint32_t corner)
{
    struct gd_subdivision *surface = surface_from(text, scheme);
    const double at[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    double u = scheme == GD_SCHEME_LOOP && corner == 2 ? 0 : at[corner][0],
           v = scheme == GD_SCHEME_LOOP && corner == 2 ? 1 : at[corner][1];
    struct gd_limit_jet tip = jet_at(surface, face, 0, u, v);
    assert_true(isnan(tip.normal.x) && isnan(tip.curvatures[0]) && tip.singular);
    struct gd_vec3 axis = isnan(tip.du.x) ? tip.dv : tip.du;
    check_close(gd_vec3_length(axis), 1, 1e-14);
    if (!isnan(tip.du.x) && !isnan(tip.dv.x))
        check_close(fabs(gd_vec3_dot(tip.du, tip.dv)), 1, 1e-14);
    double r = ldexp(1, -24), inwards = scheme == GD_SCHEME_LOOP ? 1.0 / 3 : 0.5;
    struct gd_vec3 beside =
        jet_at(surface, face, 0, u + r * (inwards - u), v + r * (inwards - v)).position;
    struct gd_vec3 way = gd_vec3_sub(beside, tip.position);
    way = gd_vec3_scale(way, 1 / gd_vec3_length(way));
    check_close(gd_vec3_dot(way, axis), u + v > 0 ? -1 : 1, 1e-3);
    gd_subdivision_release(surface);
}

static void spikes(void **state)
{
    (void)state;
    struct gd_subdivision *cube =
        surface_from(SKEW_CUBE "t corner 1/1/0 4 10\n", GD_SCHEME_CATMULL_CLARK);
    check_near(jet_at(cube, 0, 0, 0, 0).position, -1, -0.6, 1, 0);
    gd_subdivision_release(cube);
    check_spike(SKEW_CUBE "t corner 1/1/0 4 10\n", GD_SCHEME_CATMULL_CLARK, 0, 0);
    check_spike(SKEW_CUBE "t corner 1/1/0 7 10\n", GD_SCHEME_CATMULL_CLARK, 0, 2);
    check_spike(OCTAHEDRON "t corner 1/1/0 0 10\n", GD_SCHEME_LOOP, 0, 0);
    check_spike(OCTAHEDRON "t corner 1/1/0 4 10\n", GD_SCHEME_LOOP, 0, 2);
    /* a corner of finite sharpness is smooth in the limit */
    cube = surface_from(SKEW_CUBE "t corner 1/1/0 4 9.9\n", GD_SCHEME_CATMULL_CLARK);
    check_close(gd_vec3_length(jet_at(cube, 0, 0, 0, 0).normal), 1, 1e-14);
    gd_subdivision_release(cube);
}

/* A sharp corner is not a spike if it is already the centre of its ring. A regular planar sheet
 * with such a corner has the same surface as without it. */
static void corner_in_a_plane(void **state)
{
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        struct gd_control_mesh mesh;
        make_sheet(4, triangles, &mesh);
        for (uint32_t k = 0; k < 25; k++) {
            const double even[3] = {k / 5, k % 5, 0};
            memcpy(mesh.polygons.positions[k], even, sizeof even);
        }
        struct gd_corner corner = {12, 10};
        mesh.corners = &corner, mesh.corner_count = 1;
        struct gd_subdivision *sheet =
            surface_of(&mesh, triangles ? GD_SCHEME_LOOP : GD_SCHEME_CATMULL_CLARK);
        uint32_t face = triangles ? 20 : 10; /* this face begins at vertex 12 */
        check_near(jet_at(sheet, face, 0, 0, 0).position, 2, 2, 0, 1e-15);
        check_near(jet_at(sheet, face, 0, 0, 0).normal, 0, 0, 1, 1e-14);
        check_near(jet_at(sheet, face, 0, 0.25, 0.5).position, 2.25, 2.5, 0, 1e-14);
        gd_subdivision_release(sheet);
        mesh.corners = NULL, mesh.corner_count = 0;
        gd_control_mesh_free(&mesh);
    }
}

/* For collinear control points the surface has positions but no normals. */
static void collinear_control_points(void **state)
{
    (void)state;
    struct gd_subdivision *line =
        surface_from("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n", GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_jet jet = jet_at(line, 0, 0, 0.5, 0.5);
    check_near(jet.position, 1.5, 0, 0, 1e-15);
    assert_true(isnan(jet.normal.x) && isnan(jet.curvatures[0]) && isnan(jet.curvatures[1]) &&
                !jet.singular);
    gd_subdivision_release(line);
}

/* Tests every face of real control meshes with quads, triangles, polygons and boundaries. */
static void real_meshes(void **state)
{
    (void)state;
    static const char *const paths[] = {"../shared/meshes/suzanne.obj",
                                        "../shared/meshes/beast.obj"};
    for (int n = 0; n < 2; n++) {
        struct gd_subdivision *surface = surface_from_file(paths[n], GD_SCHEME_CATMULL_CLARK);
        if (!surface) {
            print_message("# %s is not here: skipped\n", paths[n]);
            continue;
        }
        uint32_t faces = gd_subdivision_summary(surface).face_count;
        struct gd_limit_point *places = malloc(4 * faces * sizeof *places);
        struct gd_limit_jet *jets = malloc(4 * faces * sizeof *jets);
        for (uint32_t i = 0; i < 4 * faces; i++)
            places[i] = (struct gd_limit_point){i / 4, 0, i % 4 == 0 ? 0 : 0.21 * (i % 4),
                                                i % 4 == 0 ? 0 : 0.3};
        struct gd_detail detail = {0};
        check_ok(gd_limit_evaluate_many(surface, &(struct gd_limit_places){places, 4 * faces}, NULL,
                                        jets, &detail),
                 &detail);
        for (uint32_t i = 0; i < 4 * faces; i++)
            check_close(gd_vec3_length(jets[i].normal), 1, 1e-13);
        free(places);
        free(jets);
        gd_subdivision_release(surface);
    }
}

/* The result is the same at scales from 1e-6 to 1e6. */
static void scales(void **state)
{
    (void)state;
    for (int e = -6; e <= 6; e += 3) {
        struct gd_control_mesh mesh;
        check_ok(gd_read_control_mesh(CUBE, strlen(CUBE),
                                      &(struct gd_read_options){.format = GD_FORMAT_OBJ}, &mesh,
                                      NULL),
                 NULL);
        double scale = pow(10, e);
        for (uint32_t i = 0; i < 24; i++) mesh.polygons.positions[i / 3][i % 3] *= scale;
        struct gd_subdivision *cube = surface_of(&mesh, GD_SCHEME_CATMULL_CLARK);
        struct gd_limit_jet jet = jet_at(cube, 0, 0, 0.1, 0.2);
        check_near(jet.position, -0.470313871571 * scale, -0.354383536694 * scale,
                   0.629845143176 * scale, 1e-12 * scale);
        gd_subdivision_release(cube);
        gd_control_mesh_free(&mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cube_values),
        cmocka_unit_test(valence_five),
        cmocka_unit_test(regular_grid),
        cmocka_unit_test(creased_cube),
        cmocka_unit_test(semi_sharp),
        cmocka_unit_test(fractional),
        cmocka_unit_test(derivatives),
        cmocka_unit_test(borders),
        cmocka_unit_test(vertices),
        cmocka_unit_test(boundary_vertices),
        cmocka_unit_test(polygons),
        cmocka_unit_test(real_meshes),
        cmocka_unit_test(scales),
        cmocka_unit_test(spikes),
        cmocka_unit_test(corner_in_a_plane),
        cmocka_unit_test(collinear_control_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
