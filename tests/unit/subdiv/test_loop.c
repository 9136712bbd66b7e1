#include "tests/unit/subdiv/surfaces.h"

enum { N = 6, ROW = N + 1, FINE = 2 * N + 1 };

struct lattice {
    const double (*p)[3];
};

static double at(struct lattice lattice, int i, int j, int axis)
{
    return lattice.p[i * ROW + j][axis];
}

/* Returns coordinate `axis` of vertex (a, b) after one step of Loop's rules on the regular lattice.
 * The triangles of the lattice are (i,j),(i+1,j),(i,j+1) and (i+1,j),(i+1,j+1),(i,j+1). */
static double refined(struct lattice l, int a, int b, int axis)
{
    int i = a / 2, j = b / 2;
    if (a % 2 == 0 && b % 2 == 0)
        return 0.625 * at(l, i, j, axis) +
               (at(l, i + 1, j, axis) + at(l, i - 1, j, axis) + at(l, i, j + 1, axis) +
                at(l, i, j - 1, axis) + at(l, i + 1, j - 1, axis) + at(l, i - 1, j + 1, axis)) /
                   16;
    if (b % 2 == 0)
        return 0.375 * (at(l, i, j, axis) + at(l, i + 1, j, axis)) +
               0.125 * (at(l, i, j + 1, axis) + at(l, i + 1, j - 1, axis));
    if (a % 2 == 0)
        return 0.375 * (at(l, i, j, axis) + at(l, i, j + 1, axis)) +
               0.125 * (at(l, i + 1, j, axis) + at(l, i - 1, j + 1, axis));
    return 0.375 * (at(l, i + 1, j, axis) + at(l, i, j + 1, axis)) +
           0.125 * (at(l, i, j, axis) + at(l, i + 1, j + 1, axis));
}

/* A sheet and its refinement are the same surface. Only box splines have this property among
 * bounded functions. */
static void refinement(void **state)
{
    (void)state;
    struct gd_control_mesh coarse, fine;
    make_sheet(N, true, &coarse);
    make_sheet(2 * N, true, &fine);
    struct lattice lattice = {(const double(*)[3])coarse.polygons.positions};
    for (int a = 2; a < FINE - 2; a++) {
        for (int b = 2; b < FINE - 2; b++) {
            for (int axis = 0; axis < 3; axis++)
                fine.polygons.positions[a * FINE + b][axis] = refined(lattice, a, b, axis);
        }
    }
    struct gd_subdivision *one = surface_of(&coarse, GD_SCHEME_LOOP),
                          *two = surface_of(&fine, GD_SCHEME_LOOP);
    struct rng rng = {3};
    for (int n = 0; n < 300; n++) {
        uint32_t i = 2 + rng_below(&rng, 2), j = 2 + rng_below(&rng, 2);
        double u = rng_unit(&rng) / 2, v = rng_unit(&rng) * (0.5 - u);
        struct gd_limit_jet a = jet_at(one, 2 * (i * N + j), 0, u, v);
        struct gd_limit_jet b = jet_at(two, 2 * (2 * i * 2 * N + 2 * j), 0, 2 * u, 2 * v);
        check_near(a.position, b.position.x, b.position.y, b.position.z, 1e-13);
        check_near(a.normal, b.normal.x, b.normal.y, b.normal.z, 1e-13);
        check_close(a.curvatures[0], b.curvatures[0], 1e-10);
    }
    gd_subdivision_release(one);
    gd_subdivision_release(two);
    gd_control_mesh_free(&coarse);
    gd_control_mesh_free(&fine);
}

/* On a regular planar lattice, S(u,v) is linear in (u,v), also at a straight boundary. */
static void linear_precision(void **state)
{
    (void)state;
    struct gd_control_mesh mesh;
    make_sheet(4, true, &mesh);
    for (uint32_t k = 0; k < 25; k++) {
        mesh.polygons.positions[k][0] = k / 5;
        mesh.polygons.positions[k][1] = k % 5;
        mesh.polygons.positions[k][2] = 0;
    }
    struct gd_subdivision *surface = surface_of(&mesh, GD_SCHEME_LOOP);
    check_near(jet_at(surface, 10, 0, 0.2, 0.3).position, 1.2, 1.3, 0, 1e-14); /* cell (1,1) */
    /* cell (1,0), at the boundary */
    check_near(jet_at(surface, 8, 0, 0.2, 0.3).position, 1.2, 0.3, 0, 1e-14);
    check_near(jet_at(surface, 8, 0, 0.2, 0).du, 1, 0, 0, 1e-13);
    check_near(jet_at(surface, 8, 0, 0.2, 0).normal, 0, 0, 1, 1e-14);
    gd_subdivision_release(surface);
    gd_control_mesh_free(&mesh);
}

/* Compares with the limit mask at a vertex of the octahedron. For valence 4, beta = (5/8 - (3/8)^2)
 * / 4 and w = 3 / (8 beta). The vertex has the weight w / (w + 4), and the positions of its
 * neighbours cancel each other. */
static void octahedron(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(OCTAHEDRON, GD_SCHEME_LOOP);
    double beta = (0.625 - 0.375 * 0.375) / 4, w = 0.375 / beta;
    struct gd_limit_jet jet = jet_at(surface, 0, 0, 0, 0);
    check_near(jet.position, w / (w + 4), 0, 0, 1e-14);
    check_near(jet.normal, 1, 0, 0, 1e-14);
    gd_subdivision_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(refinement),
                                       cmocka_unit_test(linear_precision),
                                       cmocka_unit_test(octahedron)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
