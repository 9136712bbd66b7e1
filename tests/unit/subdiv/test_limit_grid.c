/* Compares traces on a grid with those of gd_trace_follow on the mesh of the same level. */
#include "tests/unit/subdiv/surfaces.h"

#include "gd/limit_grid.h"
#include "gd/limit_place.h"

struct scene {
    struct gd_subdivision *surface;
    struct gd_limit_mesh *mesh;
    struct gd_limit_grid *grid;
    uint32_t traced, left; /* number of traces on the grid, and of traces that need the mesh */
};

static struct scene open_scene(struct gd_subdivision *surface, uint32_t level)
{
    struct scene scene = {.surface = surface};
    const struct gd_limit_mesh_options options = {.level = level};
    struct gd_detail detail = {0};
    check_ok(gd_limit_mesh_build(surface, &options, NULL, &scene.mesh, &detail), &detail);
    check_ok(gd_limit_grid_build(surface, &options, NULL, &scene.grid, &detail), &detail);
    assert_int_equal(gd_limit_grid_level(scene.grid), level);
    assert_true(gd_limit_grid_memsize(scene.grid) <= gd_limit_grid_cost(surface, level));
    return scene;
}

static void close_scene(struct scene *scene)
{
    gd_limit_mesh_free(scene->mesh);
    gd_limit_grid_free(scene->grid);
    gd_subdivision_release(scene->surface);
}

static const enum gd_limit_end ends[] = {[GD_TRACE_END_LENGTH] = GD_LIMIT_END_LENGTH,
                                         [GD_TRACE_END_BOUNDARY] = GD_LIMIT_END_BOUNDARY,
                                         [GD_TRACE_END_STEP_LIMIT] = GD_LIMIT_END_STEPS};

/* Checks that a path has the points of a trace, up to rounding errors. A line across many faces
 * amplifies these errors. */
static void check_path(const struct scene *scene, const struct gd_limit_path *path,
                       const struct gd_trace *trace)
{
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(scene->mesh);
    assert_int_equal(path->step_count, trace->path.count);
    assert_int_equal(path->end, ends[trace->end]);
    assert_true(fabs(path->length - trace->path.length) <= 1e-9);
    for (uint32_t i = 0; i < path->step_count; i++) {
        struct gd_vec3 at = gd_point_position(mesh, &trace->path.points[i]);
        check_near(path->steps[i].position, at.x, at.y, at.z, 1e-9);
        struct gd_point point;
        check_ok(gd_limit_mesh_point(scene->mesh, &path->steps[i].place, &point, NULL), NULL);
        at = gd_point_position(mesh, &point);
        check_near(path->steps[i].position, at.x, at.y, at.z, 1e-12);
    }
    if (path->end == GD_LIMIT_END_STEPS) return;
    check_near(path->direction, trace->direction.xyz.x, trace->direction.xyz.y,
               trace->direction.xyz.z, 1e-8);
}

static void compare(struct scene *scene, const struct gd_limit_grid_request *request)
{
    struct gd_limit_path path;
    struct gd_trace trace;
    struct gd_point start;
    struct gd_direction ahead;
    struct gd_detail detail = {0};
    check_ok(gd_limit_grid_trace(scene->grid, request, NULL, &path, &detail), &detail);
    bool is_traced = path.step_count > 0;
    scene->traced += is_traced;
    scene->left += !is_traced;
    if (!is_traced) return;
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(scene->mesh);
    const struct gd_trace_options options = {.vertex_rule = request->vertex_rule,
                                             .normals = gd_limit_mesh_normals(scene->mesh),
                                             .step_limit = request->step_limit};
    check_ok(gd_limit_mesh_point(scene->mesh, &request->start, &start, NULL), NULL);
    check_ok(gd_direction_along(mesh, &start, request->direction, &ahead, NULL), NULL);
    check_ok(gd_trace_follow(mesh,
                             &(struct gd_trace_request){.start = &start,
                                                        .ahead = &ahead,
                                                        .length = request->length,
                                                        .options = &options},
                             NULL, &trace, &detail),
             &detail);
    check_path(scene, &path, &trace);
    gd_trace_free(&trace);
    gd_limit_path_free(&path);
}

/* Traces from places in cells, on their edges and at vertices. */
static void compare_many(struct scene *scene, uint32_t faces, uint32_t corners, bool triangles)
{
    struct rng rng = {7};
    for (uint32_t n = 0; n < 400; n++) {
        struct gd_limit_point place = {rng_below(&rng, faces), rng_below(&rng, corners),
                                       rng_between(&rng, 0, 1), rng_between(&rng, 0, 1)};
        if (n % 3 == 0) place.u = rng_below(&rng, 9) / 8.0;
        if (n % 2 == 0) place.v = rng_below(&rng, 9) / 8.0;
        if (triangles && place.u + place.v > 1) place.u = 1 - place.u, place.v = 1 - place.v;
        struct gd_limit_jet jet =
            jet_at(scene->surface, place.face, place.corner, place.u, place.v);
        if (isnan(jet.normal.x)) continue;
        const struct gd_limit_grid_request request = {
            .start = place,
            .direction = n % 5 ? gd_limit_direction(&jet, rng_between(&rng, 0, 2 * M_PI)) : jet.du,
            .length = rng_between(&rng, 0, 4),
            .vertex_rule = n % 7 < 3 ? GD_VERTEX_RULE_BISECT : GD_VERTEX_RULE_NORMAL,
            .step_limit = n % 11 ? 0 : 5};
        compare(scene, &request);
    }
}

static void as_on_the_mesh(void **state)
{
    (void)state;
    for (uint32_t level = 0; level <= 4; level += 2) {
        struct scene cube = open_scene(surface_from(CUBE, GD_SCHEME_CATMULL_CLARK), level),
                     skew = open_scene(surface_from(SKEW_CUBE, GD_SCHEME_CATMULL_CLARK), level),
                     loop = open_scene(surface_from(OCTAHEDRON, GD_SCHEME_LOOP), level);
        compare_many(&cube, 6, 1, false);
        compare_many(&skew, 6, 1, false);
        compare_many(&loop, 8, 1, true);
        assert_true(cube.traced > 300 && skew.traced > 390 && loop.traced > 300);
        close_scene(&cube);
        close_scene(&skew);
        close_scene(&loop);
    }
}

static void sheets_have_a_boundary(void **state)
{
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        struct gd_control_mesh sheet;
        make_sheet(4, triangles, &sheet);
        struct scene scene =
            open_scene(surface_of(&sheet, triangles ? GD_SCHEME_LOOP : GD_SCHEME_CATMULL_CLARK), 3);
        gd_control_mesh_free(&sheet);
        compare_many(&scene, triangles ? 32 : 16, 1, triangles);
        assert_true(scene.traced > 250 && scene.left > 0);
        close_scene(&scene);
    }
}

static void polygons_are_split_first(void **state)
{
    (void)state;
    static const char prism[] =
        "v 1 0 0\nv -.5 .8 0\nv -.5 -.9 .1\nv 1 0 1.5\nv -.5 .8 1.4\n"
        "v -.5 -.9 1.6\nf 3 2 1\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n";
    struct scene scene = open_scene(surface_from(prism, GD_SCHEME_CATMULL_CLARK), 4);
    compare_many(&scene, 2, 3, false);
    assert_true(scene.traced > 300);
    close_scene(&scene);
}

static void invalid_requests_are_refused(void **state)
{
    (void)state;
    struct scene scene = open_scene(surface_from(CUBE, GD_SCHEME_CATMULL_CLARK), 2);
    struct gd_limit_path path;
    struct gd_limit_grid *grid;
    const struct gd_limit_grid_request wrong[] = {{{9, 0, 0.5, 0.5}, {1, 0, 0}, 1, 0, 0},
                                                  {{0, 0, 0.5, 1.5}, {1, 0, 0}, 1, 0, 0},
                                                  {{0, 0, 0.5, 0.5}, {1, 0, 0}, -1, 0, 0},
                                                  {{0, 0, 0.5, 0.5}, {NAN, 0, 0}, 1, 0, 0}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_not_equal(gd_limit_grid_trace(scene.grid, &wrong[i], NULL, &path, NULL), GD_OK);
    const struct gd_limit_grid_request good = {{0, 0, 0.5, 0.4}, {1, 0.3, 0}, 9, 0, 0};
    const struct gd_control late = {.deadline_ns = 1}, poor = {.budget_bytes = 1000};
    assert_int_equal(gd_limit_grid_trace(scene.grid, &good, &late, &path, NULL), GD_DEADLINE);
    assert_int_equal(gd_limit_grid_trace(scene.grid, &good, &poor, &path, NULL), GD_BUDGET);
    const struct gd_limit_mesh_options deep = {.level = 13}, fine = {.level = 5, .max_faces = 100},
                                       usual = {.level = 5};
    assert_int_equal(gd_limit_grid_build(scene.surface, &deep, NULL, &grid, NULL),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_limit_grid_build(scene.surface, &fine, NULL, &grid, NULL), GD_TOO_LARGE);
    assert_int_equal(gd_limit_grid_build(scene.surface, &usual, &poor, &grid, NULL), GD_BUDGET);
    assert_int_equal(gd_limit_grid_build(scene.surface, &usual, &late, &grid, NULL), GD_DEADLINE);
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_on_the_mesh),
        cmocka_unit_test(sheets_have_a_boundary),
        cmocka_unit_test(polygons_are_split_first),
        cmocka_unit_test(invalid_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
