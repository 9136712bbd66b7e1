#include "tests/unit/mesh/shapes.h"

#include <stdlib.h>

#include "mesh/topology.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static struct gd_vec3 direction(const struct gd_mesh *mesh, uint32_t from, uint32_t to)
{
    struct gd_vec3 d = gd_vec3_sub(mesh->position[to], mesh->position[from]);
    return gd_vec3_scale(d, 1 / gd_vec3_length(d));
}

/* Checks the frame of a side against the positions of its face. */
static void expect_frame(const struct gd_mesh *mesh, uint32_t h)
{
    const struct gd_side *side = &mesh->side[h];
    uint32_t a = mesh->origin[h], b = gd__side_destination(mesh, h), p = gd__side_apex(mesh, h);
    expect_near(side->length, gd_vec3_distance(mesh->position[a], mesh->position[b]),
                1e-15 * side->length);
    expect_near(side->left_length, gd_vec3_distance(mesh->position[a], mesh->position[p]),
                1e-15 * side->left_length);
    expect_near(side->right_length, gd_vec3_distance(mesh->position[b], mesh->position[p]),
                1e-15 * side->right_length);
    expect_near(hypot(side->left_x, side->left_y), 1, 1e-14);
    expect_near(hypot(side->right_x, side->right_y), 1, 1e-14);
    expect_near(side->left_x, gd_vec3_dot(direction(mesh, a, b), direction(mesh, a, p)), 1e-14);
    expect_near(side->right_x, gd_vec3_dot(direction(mesh, a, b), direction(mesh, p, b)), 1e-14);
    assert_true(side->left_y >= 0 && side->right_y <= 0);
    double scale = side->left_length + side->right_length;
    expect_near(side->left_length * side->left_x + side->right_length * side->right_x, side->length,
                1e-14 * scale);
    expect_near(side->left_length * side->left_y + side->right_length * side->right_y, 0,
                1e-14 * scale);
}

/* Checks that left, right, next and previous lead to the sides that topology.h defines. */
static void expect_links(const struct gd_mesh *mesh, uint32_t h)
{
    const struct gd_side *side = &mesh->side[h];
    uint32_t a = mesh->origin[h], b = gd__side_destination(mesh, h), p = gd__side_apex(mesh, h);
    assert_true(a != b && b != p && p != a);
    assert_int_equal(mesh->origin[side->left], a);
    assert_int_equal(gd__side_destination(mesh, side->left), p);
    assert_int_equal(gd__side_destination(mesh, side->right), b);
    uint32_t next = gd__side_next(mesh, h), previous = gd__side_previous(mesh, h);
    assert_int_equal(gd__side_next(mesh, next), previous);
    assert_int_equal(gd__side_next(mesh, previous), h);
    assert_int_equal(mesh->side_face[next], mesh->side_face[h]);
    assert_int_equal(mesh->fan[gd__fan_entry(mesh, h)].side, h);
}

static void expect_face(const struct gd_mesh *mesh, const struct gd_polygons *input, uint32_t face)
{
    uint32_t index = mesh->index_of_face[face], flipped = mesh->face_flipped[face];
    assert_int_equal(mesh->face_of_index[index], face);
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t h = mesh->face_side[face][k], corner = flipped ? (3 - k) % 3 : k;
        assert_int_equal(mesh->side_face[h], face);
        assert_int_equal(mesh->index_of_vertex[mesh->origin[h]],
                         input->corners[3 * index + corner]);
        assert_int_equal(gd__side_next(mesh, h), mesh->face_side[face][(k + 1) % 3]);
    }
}

static void expect_topology(const struct gd_polygons *input)
{
    struct gd_mesh *mesh = build(input);
    int exponent;
    assert_true(frexp(mesh->unit, &exponent) == 0.5);
    double mean = mesh->summary.edge_length.mean / mesh->unit;
    assert_true(mean > 0.25 && mean < 2);
    for (uint32_t h = 0; h < 2 * mesh->edge_count; h++) {
        assert_int_equal(gd__side_is_boundary(mesh, h), mesh->side_face[h] == GD_NONE);
        assert_true(mesh->side[h].length == mesh->side[h ^ 1].length);
        assert_int_equal(gd__side_between(mesh, mesh->origin[h], mesh->origin[h ^ 1]), h);
        if (gd__side_is_boundary(mesh, h)) {
            assert_int_equal(mesh->side[h].right, GD_NONE);
            continue;
        }
        expect_links(mesh, h);
        expect_frame(mesh, h);
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) expect_face(mesh, input, f);
    gd_mesh_release(mesh);
}

static void frames_and_links_agree_with_the_positions(void **state)
{
    (void)state;
    struct gd_polygons polygons = tetrahedron();
    expect_topology(&polygons);
    assert_int_equal(sample_torus(20, 12, 3, 1, &polygons), GD_OK);
    sample_jitter(&polygons, 0.05, 3);
    sample_flip_faces(&polygons, 0.3, 4);
    expect_topology(&polygons);
    assert_int_equal(sample_renumber(&polygons, 5, NULL, NULL), GD_OK);
    expect_topology(&polygons);
    gd_polygons_free(&polygons);
    assert_int_equal(sample_terrain(16, 0.3, 7, &polygons), GD_OK);
    expect_topology(&polygons);
    gd_polygons_free(&polygons);
}

static void random_surfaces_have_a_sane_topology(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 200; seed++) {
        struct gd_polygons polygons;
        assert_int_equal(sample_tangle(60, seed, &polygons), GD_OK);
        expect_topology(&polygons);
        gd_polygons_free(&polygons);
    }
}

/* A face whose corners are collinear is refused. A slightly higher face is accepted, counted as
 * degenerate, and has a frame without NaN. */
static void faces_without_area_are_refused(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {3, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, -2, 0}};
    uint32_t corners[] = {0, 2, 3, 2, 1, 3, 0, 1, 2, 1, 0, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    for (int lift = 0; lift < 2; lift++) {
        positions[2][1] = lift * 1e-7;
        assert_int_equal(gd_mesh_build(&polygons, NULL, NULL, &mesh, &detail), GD_DEGENERATE_FACE);
        assert_int_equal(detail.kind, GD_ELEMENT_FACE);
        assert_int_equal(detail.total, 1);
        assert_int_equal(detail.elements[0][0], 2);
        assert_null(mesh);
    }
    positions[2][1] = 1e-6;
    mesh = build(&polygons);
    assert_int_equal(mesh->summary.degenerate_faces, 1);
    expect_near(mesh->summary.area, 1.5 + 3, 1e-5);
    for (int k = 0; k < 3; k++) {
        const struct gd_side *side = &mesh->side[mesh->face_side[mesh->face_of_index[2]][k]];
        assert_true(side->left_y > 0 && side->left_y < 1e-5 && side->right_y < 0);
        assert_true(side->length > 0 && side->left_length > 0 && side->right_length > 0);
    }
    gd_mesh_release(mesh);
}

static void unconnected_vertices_have_no_side(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_grid(3, 3, 3, 3, &polygons), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    uint32_t edges = 0;
    for (uint32_t a = 0; a < mesh->vertex_count; a++) {
        assert_int_equal(gd__side_between(mesh, a, a), GD_NONE);
        for (uint32_t b = 0; b < mesh->vertex_count; b++) {
            uint32_t h = gd__side_between(mesh, a, b);
            if (h == GD_NONE) continue;
            assert_true(mesh->origin[h] == a && mesh->origin[h ^ 1] == b);
            edges++;
        }
    }
    assert_int_equal(edges, 2 * mesh->edge_count);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* All faces share one vertex and come in shuffled order. The cost of adding a face must not grow
 * with the number of faces at the vertex. */
static void a_shuffled_fan_is_built_fast(void **state)
{
    (void)state;
    enum { FACES = 100000 };
    double(*positions)[3] = calloc(FACES + 1, sizeof *positions);
    uint32_t(*corners)[3] = calloc(FACES, sizeof *corners);
    for (uint32_t i = 0; i < FACES; i++) {
        double angle = 2 * M_PI * i / FACES;
        memcpy(positions[i + 1], (double[3]){cos(angle), sin(angle), i % 2}, sizeof *positions);
        /* the factor and FACES are coprime, so this is a permutation */
        uint32_t at = (uint32_t)(i * UINT64_C(61803) % FACES);
        memcpy(corners[at], (uint32_t[3]){0, i + 1, (i + 1) % FACES + 1}, sizeof *corners);
    }
    struct gd_polygons polygons = {.positions = positions,
                                   .position_count = FACES + 1,
                                   .corners = *corners,
                                   .polygon_count = FACES};
    uint64_t begun = gd_now_ns();
    struct gd_mesh *mesh = build(&polygons);
    double seconds = (double)(gd_now_ns() - begun) * 1e-9;
    print_message("# a shuffled fan of %u faces: %.2f s\n", FACES, seconds);
    assert_true(seconds < 10);
    gd_mesh_release(mesh);
    free(positions);
    free(corners);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_and_links_agree_with_the_positions),
        cmocka_unit_test(random_surfaces_have_a_sane_topology),
        cmocka_unit_test(faces_without_area_are_refused),
        cmocka_unit_test(unconnected_vertices_have_no_side),
        cmocka_unit_test(a_shuffled_fan_is_built_fast),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
