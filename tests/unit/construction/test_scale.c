#include "tests/unit/mesh/shapes.h"

#include "mesh/topology.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

/* Scaling by a power of two changes the unit and no other internal number. */
static void internal_numbers_do_not_depend_on_scale(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_torus(9, 7, 3, 1, &polygons), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    const int exponents[] = {-400, -20, 3, 20, 400};
    for (uint32_t i = 0; i < COUNT(exponents); i++) {
        double factor = ldexp(1, exponents[i]);
        sample_scale(&polygons, factor, factor, factor);
        struct gd_mesh *scaled = build(&polygons);
        assert_true(scaled->unit == mesh->unit * factor);
        assert_memory_equal(scaled->position, mesh->position,
                            mesh->vertex_count * sizeof *mesh->position);
        assert_memory_equal(scaled->side, mesh->side, 2 * mesh->edge_count * sizeof *mesh->side);
        assert_true(scaled->summary.area == mesh->summary.area * factor * factor);
        gd_mesh_release(scaled);
        sample_scale(&polygons, 1 / factor, 1 / factor, 1 / factor);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void any_scale_between_the_extents_is_accepted(void **state)
{
    (void)state;
    const double factors[] = {1e-149, 1e-6, 1e6, 1e149};
    for (uint32_t i = 0; i < COUNT(factors); i++) {
        struct gd_polygons polygons;
        assert_int_equal(sample_tetrahedron(factors[i], 2, &polygons), GD_OK);
        struct gd_mesh *mesh = build(&polygons);
        expect_near(mesh->summary.area / factors[i] / factors[i], sqrt(3), 1e-14);
        expect_near(mesh->summary.edge_length.min / factors[i], 0.25, 1e-15);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* Edge vectors far from the origin are as accurate as the input coordinates. */
static void an_offset_costs_no_more_than_the_rounding_of_coordinates(void **state)
{
    (void)state;
    double positions[][3] = {{1e7, 1e7, 1e7}, {1e7 + 0.25, 1e7, 1e7}, {1e7, 1e7 + 0.5, 1e7}};
    uint32_t corners[] = {0, 1, 2};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = build(&polygons);
    assert_true(mesh->summary.edge_length.min == 0.25);
    assert_true(mesh->summary.area == 0.0625);
    gd_mesh_release(mesh);
}

static void too_small_and_too_large_extents_are_refused(void **state)
{
    (void)state;
    double small[][3] = {{0, 0, 0}, {1e-160, 0, 0}, {0, 1e-160, 0}};
    double wide[][3] = {{-8e149, 0, 0}, {8e149, 0, 0}, {0, 1e149, 0}};
    double uneven[][3] = {{0, 0, 0}, {1e-90, 0, 0}, {0, 1, 0}};
    double far[][3] = {{1e100, 0, 0}, {1e100, 1, 0}, {1e100, 0, 1}};
    uint32_t corners[] = {0, 1, 2};
    struct gd_polygons polygons[] = {TRIANGLES(small, corners), TRIANGLES(wide, corners),
                                     TRIANGLES(uneven, corners), TRIANGLES(far, corners)};
    for (uint32_t i = 0; i < COUNT(polygons); i++) {
        struct gd_detail detail = refuse(&polygons[i], GD_EXTENT);
        assert_true(strlen(detail.text) > 0);
    }
}

/* Uses two components of very different size in one mesh. */
static void a_tiny_part_in_a_large_assembly_is_accepted(void **state)
{
    (void)state;
    struct gd_polygons polygons, tiny;
    assert_int_equal(sample_icosphere(2, 1e6, &polygons), GD_OK);
    assert_int_equal(sample_icosphere(1, 1e-6, &tiny), GD_OK);
    assert_int_equal(sample_append(&polygons, &tiny), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(mesh->summary.components, 2);
    assert_int_equal(mesh->summary.degenerate_faces, 0);
    gd_mesh_release(mesh);
    gd_polygons_free(&tiny);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(internal_numbers_do_not_depend_on_scale),
        cmocka_unit_test(any_scale_between_the_extents_is_accepted),
        cmocka_unit_test(an_offset_costs_no_more_than_the_rounding_of_coordinates),
        cmocka_unit_test(too_small_and_too_large_extents_are_refused),
        cmocka_unit_test(a_tiny_part_in_a_large_assembly_is_accepted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
