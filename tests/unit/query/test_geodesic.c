#include "gd/geodesic.h"

#include <math.h>
#include <string.h>

#include "tests/support/test.h"

static const char square[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
static const char islands[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\n"
                              "f 1 2 3\nf 4 5 6\n";
/* three triangles that share one edge */
static const char fins[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\n"
                           "f 1 2 3\nf 2 1 4\nf 1 2 5\n";

static struct gd_mesh *loaded(const char *text, const struct gd_load_options *options)
{
    struct gd_mesh *mesh;
    struct gd_detail error;
    check_ok(gd_mesh_load(text, strlen(text), options, &mesh, &error), &error);
    return mesh;
}

static void distance_and_path_of_a_square(void **state)
{
    (void)state;
    struct gd_mesh *mesh = loaded(square, NULL);
    struct gd_point a = test_vertex(mesh, 1), b = test_vertex(mesh, 3);
    double distance;
    struct gd_path path;
    check_ok(gd_distance(mesh, &a, &b, &distance), NULL);
    check_close(distance, sqrt(2), 1e-14);
    check_ok(gd_path(mesh, &a, &b, &path), NULL);
    check_close(path.length, sqrt(2), 1e-14);
    assert_true(gd_point_equal(&path.points[0], &a));
    assert_true(gd_point_equal(&path.points[path.count - 1], &b));
    gd_path_free(&path);
    gd_mesh_release(mesh);
}

static void no_path_between_components(void **state)
{
    (void)state;
    struct gd_mesh *mesh = loaded(islands, NULL);
    struct gd_point a = test_vertex(mesh, 0), b = test_vertex(mesh, 3);
    double distance;
    struct gd_path path = {.count = 77};
    check_ok(gd_distance(mesh, &a, &b, &distance), NULL);
    assert_true(isinf(distance));
    assert_int_equal(gd_path(mesh, &a, &b, &path), GD_NOT_ON_SURFACE);
    assert_int_equal(path.count, 77);
    gd_mesh_release(mesh);
}

static void a_path_from_a_point_to_itself_is_that_point(void **state)
{
    (void)state;
    struct gd_mesh *mesh = loaded(square, NULL);
    struct gd_point a = test_vertex(mesh, 2);
    struct gd_path path;
    check_ok(gd_path(mesh, &a, &a, &path), NULL);
    assert_true(path.count >= 1);
    assert_true(path.length == 0);
    gd_path_free(&path);
    gd_mesh_release(mesh);
}

static void options_reach_the_reader_and_the_builder(void **state)
{
    (void)state;
    struct gd_mesh *mesh = NULL;
    struct gd_detail error;
    struct gd_load_options options = {.mesh.refuse_polygons = true};
    assert_int_equal(gd_mesh_load(square, strlen(square), &options, &mesh, &error),
                     GD_NOT_TRIANGLES);
    options = (struct gd_load_options){.max_faces = 1};
    assert_int_equal(gd_mesh_load(square, strlen(square), &options, &mesh, &error), GD_TOO_LARGE);
    options = (struct gd_load_options){.format = GD_FORMAT_PLY};
    assert_int_not_equal(gd_mesh_load(square, strlen(square), &options, &mesh, NULL), GD_OK);
    assert_int_equal(gd_mesh_load(fins, strlen(fins), NULL, &mesh, &error), GD_NON_MANIFOLD_EDGE);
    assert_int_equal(error.kind, GD_ELEMENT_EDGE);
    assert_null(mesh);
    options = (struct gd_load_options){.mesh.repair_split = true};
    mesh = loaded(fins, &options);
    assert_int_equal(gd_mesh_summary(mesh)->faces, 3);
    gd_mesh_release(mesh);
}

static void every_failure_has_a_sentence(void **state)
{
    (void)state;
    struct gd_mesh *mesh;
    const struct gd_control tight = {.budget_bytes = 1}, late = {.deadline_ns = 1};
    const struct {
        const char *text;
        struct gd_load_options options;
        enum gd_status status;
    } cases[] = {
        {"", {0}, GD_EMPTY},
        {"nonsense", {0}, GD_UNRECOGNIZED},
        {square, {.control = &tight}, GD_BUDGET},
        {square, {.control = &late}, GD_DEADLINE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct gd_detail error;
        memset(&error, 0xee, sizeof error);
        assert_int_equal(
            gd_mesh_load(cases[i].text, strlen(cases[i].text), &cases[i].options, &mesh, &error),
            cases[i].status);
        assert_non_null(memchr(error.text, 0, sizeof error.text));
        assert_true(error.text[0] != 0);
    }
}

struct watched {
    double last;
    bool is_growing;
};

static bool watch(void *user, double fraction)
{
    struct watched *watched = user;
    watched->is_growing = watched->is_growing && fraction >= watched->last;
    watched->last = fraction;
    return true;
}

static void progress_grows_to_one(void **state)
{
    (void)state;
    struct watched watched = {0, true};
    const struct gd_control control = {.progress = watch, .user = &watched};
    gd_mesh_release(loaded(square, &(struct gd_load_options){.control = &control}));
    assert_true(watched.is_growing);
    assert_true(watched.last == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distance_and_path_of_a_square),
        cmocka_unit_test(no_path_between_components),
        cmocka_unit_test(a_path_from_a_point_to_itself_is_that_point),
        cmocka_unit_test(options_reach_the_reader_and_the_builder),
        cmocka_unit_test(every_failure_has_a_sentence),
        cmocka_unit_test(progress_grows_to_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
