/* Repairs of the shared meshes (tests/support/shared.h). */
#include "tests/unit/mesh/shapes.h"

#include "base/tolerance.h"
#include "gd/field.h"
#include "tests/support/shared.h"
#include "tests/support/test.h"

/* Builds a field, and checks its distances within the first face. */
static void check_field(const struct gd_mesh *mesh)
{
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){0}, corners);
    struct gd_seed seed = {0};
    struct gd_field *field = NULL;
    assert_int_equal(gd_point_at_vertex(mesh, corners[0], &seed.point, NULL), GD_OK);
    const struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    assert_int_equal(gd_field_build(mesh, &request, NULL, &field, NULL), GD_OK);
    for (int k = 1; k < 3; k++) {
        struct gd_point target;
        double result = NAN;
        assert_int_equal(gd_point_at_vertex(mesh, corners[k], &target, NULL), GD_OK);
        assert_int_equal(gd_field_distance(field, &target, &result), GD_OK);
        double straight = gd_vec3_distance(gd_mesh_position(mesh, corners[0]),
                                           gd_mesh_position(mesh, corners[k]));
        assert_true(result >= straight * (1 - 1e-12) && result <= straight * (1 + 1e-12));
    }
    gd_field_release(field);
}

static void every_shared_mesh_is_answered(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t edges_split, vertices_split, copies, components;
    } meshes[] = {
        {"teapot", 0, 38, 47, 19},      {"cow", 0, 1, 1, 1},     {"beetle", 47, 40, 49, 13},
        {"suzanne", 0, 0, 0, 3},        {"beast", 0, 0, 0, 1},   {"spot", 0, 0, 0, 1},
        {"stanford-bunny", 0, 0, 0, 1}, {"fandisk", 0, 0, 0, 1}, {"homer", 0, 0, 0, 1},
        {"rocker-arm", 0, 0, 0, 1},
    };
    for (size_t i = 0; i < COUNT(meshes); i++) {
        struct gd_polygons polygons = test_shared_polygons(meshes[i].name);
        struct gd_mesh *mesh = mend(&polygons);
        const struct gd_mesh_repair *repair = gd_mesh_repair(mesh);
        assert_int_equal(repair->edges_split.count, meshes[i].edges_split);
        assert_int_equal(repair->vertices_split.count, meshes[i].vertices_split);
        assert_int_equal(repair->copies, meshes[i].copies);
        assert_int_equal(repair->duplicate_faces.count + repair->degenerate_faces.count, 0);
        assert_true(repair->largest_shift == 0);
        assert_int_equal(gd_mesh_summary(mesh)->components, meshes[i].components);
        check_field(mesh);
        print_message(
            "# %s: %u edges and %u vertices cut, %u copies; %u components, %u boundaries\n",
            meshes[i].name, repair->edges_split.count, repair->vertices_split.count, repair->copies,
            gd_mesh_summary(mesh)->components, gd_mesh_summary(mesh)->boundaries);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* The polygons of a repaired mesh build the same mesh without repair. */
static void a_repaired_mesh_needs_no_repair(void **state)
{
    (void)state;
    static const char *const names[] = {"teapot", "cow", "beetle"};
    for (size_t i = 0; i < COUNT(names); i++) {
        struct gd_polygons polygons = test_shared_polygons(names[i]), again = {0};
        struct gd_mesh *mended = mend(&polygons);
        assert_int_equal(gd_mesh_polygons(mended, &again), GD_OK);
        struct gd_mesh *plain = build(&again);
        const struct gd_mesh_summary *a = gd_mesh_summary(mended), *b = gd_mesh_summary(plain);
        assert_true(a->vertices == b->vertices && a->edges == b->edges &&
                    a->boundaries == b->boundaries);
        assert_true(a->area == b->area);
        gd_mesh_release(mended);
        gd_mesh_release(plain);
        gd_polygons_free(&polygons);
        gd_polygons_free(&again);
    }
}

static uint32_t next_random(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 33);
}

/* Uses random triangles over a few lattice points, whose positions are exact or slightly moved. The
 * meshes have every kind of damage. Each mesh is repaired or rejected; at most one mesh is rejected
 * for a degenerate face. */
static void any_damage_is_repaired_or_reported(void **state)
{
    (void)state;
    enum { MESHES = 10000, MOST_VERTICES = 34, MOST_FACES = 60 };
    uint32_t answered = 0, empty = 0, one_sided = 0, flat = 0;
    for (uint64_t seed = 1; seed <= MESHES; seed++) {
        double positions[MOST_VERTICES][3];
        uint32_t corners[3 * MOST_FACES];
        uint64_t random = seed * 7919;
        uint32_t vertices = 4 + next_random(&random) % 30,
                 faces = 1 + next_random(&random) % MOST_FACES;
        uint32_t dimensions = 1 + next_random(&random) % 3, size = 2 + next_random(&random) % 4;
        double jitter = next_random(&random) % 3 ? 0 : 0.1 * GD_TOL_FLAT;
        for (uint32_t i = 0; i < 3 * vertices; i++)
            positions[i / 3][i % 3] =
                i % 3 >= dimensions
                    ? 0
                    : next_random(&random) % size + jitter * (next_random(&random) % 100);
        for (uint32_t i = 0; i < 3 * faces; i++) corners[i] = next_random(&random) % vertices;
        struct gd_polygons polygons = {.positions = positions,
                                       .position_count = vertices,
                                       .corners = corners,
                                       .polygon_count = faces};
        struct gd_mesh_options options = {.repair_split = true,
                                          .weld = seed % 2,
                                          .weld_tolerance = seed % 4 < 2 ? 0 : 10 * GD_TOL_FLAT};
        struct gd_mesh *mesh = NULL;
        enum gd_status status = gd_mesh_build(&polygons, &options, NULL, &mesh, NULL);
        answered += status == GD_OK;
        empty += status == GD_EMPTY;
        one_sided += status == GD_NON_ORIENTABLE;
        flat += status == GD_DEGENERATE_FACE;
        gd_mesh_release(mesh);
    }
    print_message("# of %u damaged soups %u were answered, %u empty, %u one-sided, %u flat\n",
                  MESHES, answered, empty, one_sided, flat);
    assert_int_equal(answered + empty + one_sided + flat, MESHES);
    assert_true(answered > MESHES / 2 && flat < 2);
}

static bool stop_at(void *user, double fraction)
{
    (void)fraction;
    return --*(int *)user != 0;
}

/* A repair that is cancelled at any report leaks nothing (checked by LeakSanitizer). */
static void a_repair_can_be_cancelled_at_every_report(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0},  {2, 0, 0}, {1, 2, 0}, {1, 0, 0},
                             {1, -1, 0}, {0, 0, 1}, {0, 0, 1}};
    uint32_t corners[] = {0, 1, 2, 0, 4, 3, 0, 3, 1, 0, 5, 6, 2, 1, 0, 1, 0, 5};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh_options options = {.repair_split = true, .weld = true, .weld_tolerance = 1e-9};
    enum gd_status status = GD_CANCELLED;
    int reports = 0;
    while (status == GD_CANCELLED) {
        int left = ++reports;
        struct gd_control control = {.progress = stop_at, .user = &left};
        struct gd_mesh *mesh = NULL;
        status = gd_mesh_build(&polygons, &options, &control, &mesh, NULL);
        assert_true((status == GD_OK) == (mesh != NULL));
        gd_mesh_release(mesh);
    }
    assert_int_equal(status, GD_OK);
    assert_true(reports > 15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_shared_mesh_is_answered),
        cmocka_unit_test(a_repaired_mesh_needs_no_repair),
        cmocka_unit_test(any_damage_is_repaired_or_reported),
        cmocka_unit_test(a_repair_can_be_cancelled_at_every_report),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
