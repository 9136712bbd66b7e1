#include "mesh/image_header.h"

#include <string.h>

#include "tests/samples/samples.h"
#include "tests/support/test.h"

static const char magic[8] = "GDTESTS", other_magic[8] = "GDTESTT";

static struct gd_mesh *terrain(uint64_t seed)
{
    struct gd_polygons polygons;
    check_ok(sample_terrain(6, 0.5, seed, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

static void check_refusal(const struct gd_mesh *mesh, const struct gd__image_header *image_header,
                          enum gd_status expected, const char *words)
{
    struct gd_detail detail = {.text = ""};
    assert_int_equal(gd__image_header_check(mesh, image_header, magic, 7, &detail), expected);
    assert_non_null(strstr(detail.text, words));
    assert_int_equal(gd__image_header_check(mesh, image_header, magic, 7, NULL), expected);
}

static void refuses_other_headers(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(1), *same = terrain(1), *another = terrain(2);
    struct gd__image_header image_header = gd__image_header(mesh, magic, 7), changed;
    check_ok(gd__image_header_check(mesh, &image_header, magic, 7, NULL), NULL);
    check_ok(gd__image_header_check(same, &image_header, magic, 7, NULL), NULL);
    check_refusal(another, &image_header, GD_INVALID_ARGUMENT, "another mesh");
    changed = gd__image_header(mesh, other_magic, 7);
    check_refusal(mesh, &changed, GD_UNRECOGNIZED, "not a GDTESTS image");
    changed = gd__image_header(mesh, magic, 6);
    check_refusal(mesh, &changed, GD_UNRECOGNIZED, "version 6");
    changed = image_header;
    changed.byte_order = __builtin_bswap32(image_header.byte_order);
    check_refusal(mesh, &changed, GD_UNRECOGNIZED, "this machine can read");
    mesh->position[mesh->vertex_count - 1].z += 1e-12; /* only this mesh object changes */
    check_refusal(mesh, &image_header, GD_INVALID_ARGUMENT, "another mesh");
    gd_mesh_release(mesh);
    gd_mesh_release(same);
    gd_mesh_release(another);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(refuses_other_headers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
