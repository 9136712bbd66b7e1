/* Tests the index from each face to the seeds in it. The index has all seeds, in the order of their
 * numbers. */
#include "tests/support/test.h"

#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "mesh/segment.h"
#include "tests/samples/samples.h"

/* A field that has only seeds. */
static struct gd_field field;
static struct gd_polygons polygons;
static struct gd_mesh *mesh;

static void open_terrain(uint32_t cells)
{
    check_ok(sample_terrain(cells, 0.2, 3, &polygons), NULL);
    mesh = test_mesh(&polygons);
}

static void close_terrain(void)
{
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Returns a point, or a segment from a point of a random face to one of its sides. */
static struct gd__seed random_seed(struct rng *rng)
{
    struct test_place place = test_random_place(&polygons, rng), end = {place.face, {0, 0, 0}};
    struct gd__seed seed = {.point = test_point(mesh, place), .is_segment = rng_below(rng, 2)};
    double part = rng_below(rng, 2) ? rng_unit(rng) : 1;
    int k = (int)rng_below(rng, 3);
    end.weight[k] = part;
    end.weight[(k + 1) % 3] = 1 - part;
    seed.end = test_point(mesh, end);
    seed.is_segment &= !gd_point_equal(&seed.point, &seed.end);
    return seed;
}

static bool lies_in(const struct gd__seed *seed, uint32_t face)
{
    struct gd__segment_location home;
    const struct gd_point *point = &seed->point;
    if (!seed->is_segment)
        return point->kind != GD_POINT_VERTEX && gd__face_contains(mesh, face, point);
    assert_true(gd__segment_locate(mesh, &seed->point, &seed->end, &home));
    if (home.face != GD_NONE) return home.face == face;
    return mesh->side_face[2 * home.edge] == face || mesh->side_face[2 * home.edge + 1] == face;
}

static void check_face(uint32_t face)
{
    struct gd__face_seeds f = gd__field_seeds_in(&field, face);
    for (uint32_t i = 0; i < field.seed_count; i++) {
        if (!lies_in(&field.seeds[i], face)) continue;
        assert_true(f.at < f.end);
        assert_int_equal(f.at->face, face);
        assert_int_equal(f.at->seed, i);
        f.at++;
    }
    assert_true(f.at == f.end);
}

static void check_seeds(uint32_t count, struct rng *rng)
{
    field = (struct gd_field){.mesh = mesh, .seed_count = count};
    field.seeds = malloc(count * sizeof *field.seeds);
    assert_non_null(field.seeds);
    for (uint32_t i = 0; i < count; i++) field.seeds[i] = random_seed(rng);
    check_ok(gd__field_index_seeds(&field), NULL);
    for (uint32_t i = 0; i < 400; i++) check_face(rng_below(rng, mesh->face_count));
    for (uint32_t i = 0; i < field.face_seed_count; i++) check_face(field.face_seeds[i].face);
    free(field.face_seeds);
    free(field.seeds);
}

/* Small and large numbers of seeds are sorted by different algorithms. Radix sort needs one to
 * three digits for these faces. */
static void finds_the_seeds_of_each_face(void **state)
{
    (void)state;
    static const uint32_t cells[] = {4, 60, 200}, counts[] = {1, 2, 15, 33, 150, 700};
    struct rng rng = {5};
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
        open_terrain(cells[i]);
        for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) check_seeds(counts[k], &rng);
        close_terrain();
    }
}

/* Radix sort needs four digits for this number of faces. All seeds are points inside faces. */
static void faces_of_four_digits(void **state)
{
    (void)state;
    enum { COUNT = 5000 };
    struct gd_mesh huge = {.face_count = UINT32_C(1) << 31};
    struct rng rng = {6};
    field = (struct gd_field){
        .mesh = &huge, .seed_count = COUNT, .seeds = calloc(COUNT, sizeof *field.seeds)};
    assert_non_null(field.seeds);
    for (uint32_t i = 0; i < COUNT; i++) {
        uint32_t near = i ? field.seeds[rng_below(&rng, i)].point.element : 0;
        field.seeds[i].point = (struct gd_point){
            .kind = GD_POINT_FACE,
            .element = rng_below(&rng, 2) ? near : rng_below(&rng, huge.face_count)};
    }
    check_ok(gd__field_index_seeds(&field), NULL);
    assert_int_equal(field.face_seed_count, COUNT);
    for (uint32_t i = 0; i < COUNT; i++) {
        const struct gd__face_seed *at = &field.face_seeds[i];
        assert_int_equal(at->face, field.seeds[at->seed].point.element);
        assert_true(!i || at[-1].face < at->face ||
                    (at[-1].face == at->face && at[-1].seed < at->seed));
    }
    free(field.face_seeds);
    free(field.seeds);
}

/* Tests that segments are rejected if their ends are equal or have no common face. */
static void segments_without_a_common_face_are_refused(void **state)
{
    (void)state;
    open_terrain(4);
    struct gd_point a = test_vertex(mesh, 0), b = test_vertex(mesh, polygons.position_count - 1);
    struct gd__seed seeds[2] = {{.point = a}, {.point = a, .is_segment = true}};
    for (int i = 0; i < 2; i++) {
        seeds[1].end = i ? b : a;
        field = (struct gd_field){.mesh = mesh, .seeds = seeds, .seed_count = 2};
        assert_int_equal(gd__field_index_seeds(&field), GD_INVALID_ARGUMENT);
        free(field.face_seeds);
    }
    close_terrain();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_seeds_of_each_face),
        cmocka_unit_test(faces_of_four_digits),
        cmocka_unit_test(segments_without_a_common_face_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
