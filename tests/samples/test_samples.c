/* Tests that the engine accepts each sample as a mesh, and that the mesh has the expected topology
 * and area. */
#include "tests/samples/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/mesh.h"
#include "tests/samples/transform.h"
#include "tests/support/test.h"

struct expectation {
    const char *name;
    double values[SAMPLE_PARAMETERS];
    uint32_t faces;
    int64_t genus;
    uint32_t boundaries, saddles;
    /* expected area and permitted relative error; an error of 1 disables the check */
    double area, area_error;
};

static const struct expectation expectations[] = {
    {"grid", {7, 5, 2, 3}, 70, 0, 1, 0, 6, 1e-14},
    {"box", {1, 2, 3, 4}, 192, 0, 0, 0, 22, 1e-14},
    {"icosphere", {0, 1}, 20, 0, 0, 0, 9.5745413832768, 1e-12},
    {"icosphere", {4, 2}, 5120, 0, 0, 0, 16 * M_PI, 1e-2},
    {"torus", {64, 32, 1, 0.4}, 4096, 1, 0, GD_NONE, 4 * M_PI *M_PI * 0.4, 1e-2},
    {"torus", {3, 3, 1, 0.4}, 18, 1, 0, GD_NONE, 1, 1},
    {"cone", {1, 1, 64, 3}, 320, 0, 1, 0, M_PI *M_SQRT2, 1e-2},
    {"saddle", {1, 0.5, 8, 2}, 48, 0, 1, 1, 1, 1},
    {"cylinder", {1, 2, 64, 3}, 384, 0, 2, 0, 4 * M_PI, 1e-2},
    {"graded", {1, 6, 4, 10, 0, 0, 1}, 54, 0, 1, GD_NONE, 2.598076211353316, 1e-12},
    {"graded", {2, 5, 6, 10, 0.5, 0.3, 1}, 130, 0, 0, GD_NONE, 1, 1},
    {"terrain", {33, 0.2, 5}, 2178, 0, 1, GD_NONE, 1, 1},
    {"genus2", {1, 0}, 100, 2, 0, GD_NONE, 1, 1},
    {"genus2", {8, 0.02}, 6400, 2, 0, GD_NONE, 1, 1},
    {"eight", {600, 0.6, 0, 0, 0, 1}, 600, 2, 0, GD_NONE, 1, 1},
    {"ball", {2000, 0, 0, 30, 0, 1}, 2000, 0, 0, GD_NONE, 4 * M_PI, 1e-2},
    {"ball", {1998, 0.7, 1, 4, 0, 7}, 1998, 0, 0, GD_NONE, 4 * M_PI, 2e-2},
    {"pot", {3000, 1, 1, 2, 0.5, 1}, 3000, 1, 0, GD_NONE, 1, 1},
    {"scan", {3000, 0, 0.4, 0, 1, 1}, 3000, 0, 0, GD_NONE, 1, 1},
    {"tetrahedron", {2, 0}, 4, 0, 0, 0, 6.9282032302755088, 1e-14},
    {"tetrahedron", {2, 3}, 256, 0, 0, 0, 6.9282032302755088, 1e-14},
};

static struct gd_polygons generate(const char *name, const double *values)
{
    const struct sample *sample = sample_find(name);
    assert_non_null(sample);
    struct gd_polygons polygons;
    assert_int_equal(sample->generate(values, &polygons), GD_OK);
    return polygons;
}

static void test_expectations(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof expectations / sizeof *expectations; i++) {
        const struct expectation *expected = &expectations[i];
        struct gd_polygons polygons = generate(expected->name, expected->values);
        struct gd_mesh *mesh = test_mesh(&polygons);
        const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
        assert_int_equal(summary->faces, expected->faces);
        assert_int_equal(summary->components, 1);
        assert_int_equal(summary->genus, expected->genus);
        assert_int_equal(summary->boundaries, expected->boundaries);
        assert_int_equal(summary->unreferenced_vertices, 0);
        assert_int_equal(summary->flipped_faces, 0);
        assert_int_equal(summary->degenerate_faces, 0);
        if (expected->saddles != GD_NONE)
            assert_int_equal(summary->saddle_vertices, expected->saddles);
        check_close(summary->area, expected->area, expected->area_error);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* Returns the volume. It is positive if the faces of a closed surface are counter-clockwise seen
 * from outside. */
static double volume(const struct gd_polygons *mesh)
{
    double sum = 0;
    for (uint32_t f = 0; f < mesh->polygon_count; f++) {
        const double *a = mesh->positions[mesh->corners[3 * f]],
                     *b = mesh->positions[mesh->corners[3 * f + 1]],
                     *c = mesh->positions[mesh->corners[3 * f + 2]];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

/* Tests that each list of parameters ends with a parameter without a name. */
static void test_lists_of_parameters_end(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < sample_count; i++) {
        const size_t room = sizeof samples[i].parameters / sizeof *samples[i].parameters;
        assert_null(samples[i].parameters[room - 1].name);
    }
}

static void test_faces_outwards(void **state)
{
    (void)state;
    static const char *const closed[] = {"box",   "icosphere", "torus", "genus2", "tetrahedron",
                                         "eight", "ball",      "pot",   "scan"};
    static const double values[][SAMPLE_PARAMETERS] = {
        {1, 2, 3, 4}, {5, 1}, {96, 96, 1, 0.4}, {4, 0}, {1, 1}, {600}, {2000}, {2000}, {2000}};
    static const double volumes[] = {
        6, 4 * M_PI / 3, 2 * M_PI * M_PI * 0.16, 0, M_SQRT2 / 12, 0, 4 * M_PI / 3, 0, 0};
    for (size_t i = 0; i < sizeof closed / sizeof *closed; i++) {
        struct gd_polygons mesh = generate(closed[i], values[i]);
        assert_true(volume(&mesh) > 0);
        if (volumes[i] > 0) check_close(volume(&mesh), volumes[i], 1e-2);
        gd_polygons_free(&mesh);
    }
}

/* Returns the standard deviation of edge lengths divided by their mean. */
static double unevenness(const struct gd_polygons *polygons)
{
    double sum = 0, squares = 0, count = 3.0 * polygons->polygon_count;
    for (uint32_t slot = 0; slot < 3 * polygons->polygon_count; slot++) {
        const double *a = polygons->positions[polygons->corners[slot]],
                     *b = polygons
                              ->positions[polygons->corners[slot % 3 == 2 ? slot - 2 : slot + 1]];
        double square = (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                        (b[2] - a[2]) * (b[2] - a[2]);
        sum += sqrt(square);
        squares += square;
    }
    return sqrt(squares / count - (sum / count) * (sum / count)) / (sum / count);
}

/* Tests that unevenness grows with fewer passes and more contrast, that the surface fits its cube,
 * and that an odd number of faces is rejected. */
static void test_remeshing(void **state)
{
    (void)state;
    static const double passes[] = {30, 0, 0, 0}, contrast[] = {0, 0, 0.5, 1};
    double before = 0;
    for (size_t i = 0; i < sizeof passes / sizeof *passes; i++) {
        struct gd_polygons polygons =
            generate("pot", (double[]){1000, contrast[i], 0, passes[i], 0, 1});
        double here = unevenness(&polygons), farthest = 0;
        for (uint32_t v = 0; v < polygons.position_count; v++)
            for (int k = 0; k < 3; k++) farthest = fmax(farthest, fabs(polygons.positions[v][k]));
        assert_true(here > before * 1.1);
        check_close(farthest, 1, 1e-14);
        before = here;
        gd_polygons_free(&polygons);
    }
    struct gd_polygons untouched;
    struct remeshing odd = {.faces = 1001};
    assert_int_equal(sample_ball(&odd, 1, &untouched), GD_INVALID_ARGUMENT);
}

static void test_defaults(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < sample_count; i++) {
        double values[SAMPLE_PARAMETERS];
        for (int k = 0; samples[i].parameters[k].name; k++)
            values[k] = samples[i].parameters[k].value;
        struct gd_polygons first = generate(samples[i].name, values),
                           second = generate(samples[i].name, values);
        assert_int_equal(first.position_count, second.position_count);
        assert_int_equal(first.polygon_count, second.polygon_count);
        assert_memory_equal(first.positions, second.positions,
                            first.position_count * sizeof *first.positions);
        assert_memory_equal(first.corners, second.corners,
                            3 * first.polygon_count * sizeof *first.corners);
        gd_mesh_release(test_mesh(&first));
        gd_polygons_free(&first);
        gd_polygons_free(&second);
    }
    assert_null(sample_find("no such sample"));
}

/* Tests that random surfaces are manifold, and that each kind of surface that other tests need
 * occurs. */
static void test_tangles(void **state)
{
    (void)state;
    uint32_t saddles = 0, bounded = 0, closed = 0, unreferenced = 0;
    for (uint64_t seed = 0; seed < 500; seed++) {
        struct gd_polygons polygons;
        assert_int_equal(sample_tangle(4 + seed % 60, seed, &polygons), GD_OK);
        struct gd_mesh *mesh = test_mesh(&polygons);
        const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
        saddles += summary->saddle_vertices > 0;
        bounded += summary->boundaries > 0;
        closed += summary->boundaries == 0;
        unreferenced += summary->unreferenced_vertices > 0;
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    assert_in_range(saddles, 250, 500);
    assert_in_range(bounded, 100, 450);
    assert_in_range(closed, 50, 400);
    assert_in_range(unreferenced, 10, 250);
}

/* Tests that ground, walls and roofs are one surface whose only boundary is the rectangle. The
 * ground and the roofs together must have the rectangle's area. */
static void test_obstacles(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 10, 40, 100};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        struct sample_obstacles scene;
        assert_int_equal(sample_obstacles(counts[i], i % 2, i, &scene), GD_OK);
        assert_int_equal(scene.count, counts[i]);
        struct gd_mesh *mesh = test_mesh(&scene.mesh);
        const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
        assert_int_equal(summary->genus, 0);
        assert_int_equal(summary->boundaries, 1);
        assert_int_equal(summary->components, 1);
        check_close(gd_mesh_boundary(mesh, 0).length, 3.5, 1e-14);
        double around = 0;
        for (uint32_t k = 0; k < counts[i]; k++) {
            uint32_t begin = scene.first[k], end = scene.first[k + 1];
            for (uint32_t c = begin; c < end; c++) {
                const double *a = scene.corners[c], *b = scene.corners[c + 1 < end ? c + 1 : begin];
                around += hypot(b[0] - a[0], b[1] - a[1]);
            }
        }
        check_close(summary->area, 0.75 + 2 * around, 1e-13);
        gd_mesh_release(mesh);
        sample_obstacles_free(&scene);
    }
}

static void test_transforms(void **state)
{
    (void)state;
    struct gd_polygons polygons, other;
    assert_int_equal(sample_torus(12, 8, 1, 0.4, &polygons), GD_OK);
    struct gd_mesh *mesh = test_mesh(&polygons);
    double area = gd_mesh_summary(mesh)->area;
    gd_mesh_release(mesh);
    assert_int_equal(sample_renumber(&polygons, 3, NULL, NULL), GD_OK);
    assert_int_equal(sample_subdivide(&polygons), GD_OK);
    assert_int_equal(sample_tetrahedron(1, 0, &other), GD_OK);
    assert_int_equal(sample_append(&polygons, &other), GD_OK);
    sample_move(&polygons, 5, 4);
    sample_scale(&polygons, 2, 2, 2);
    sample_flip_faces(&polygons, 0.3, 5);
    mesh = test_mesh(&polygons);
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    assert_int_equal(summary->faces, 4 * 192 + 4);
    assert_int_equal(summary->components, 2);
    assert_int_equal(summary->genus, 1);
    assert_true(summary->flipped_faces > 0);
    check_close(summary->area, 4 * (area + sqrt(3)), 1e-13);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    gd_polygons_free(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_expectations), cmocka_unit_test(test_faces_outwards),
        cmocka_unit_test(test_remeshing),    cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_tangles),      cmocka_unit_test(test_obstacles),
        cmocka_unit_test(test_transforms),   cmocka_unit_test(test_lists_of_parameters_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
