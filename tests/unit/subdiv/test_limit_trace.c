#include "tests/unit/subdiv/surfaces.h"

#include "gd/limit_mesh.h"
#include "gd/limit_path.h"
#include "gd/limit_place.h"
#include "gd/trace.h"

static struct gd_limit_path trace(const struct gd_subdivision *surface, struct gd_limit_point start,
                                  struct gd_vec3 direction, double length)
{
    struct gd_limit_path path = {0};
    struct gd_detail detail = {0};
    check_ok(gd_limit_trace(surface, &(struct gd_limit_trace_request){start, direction, length},
                            NULL, &path, &detail),
             &detail);
    return path;
}

static const struct gd_limit_step *last(const struct gd_limit_path *path)
{
    return &path->steps[path->step_count - 1];
}

static double gap(const struct gd_limit_path *path)
{
    return gd_vec3_distance(path->steps[0].position, last(path)->position);
}

/* Tests the two closed geodesics in mirror planes of the smoothed cube. Their lengths were computed
 * by quadrature of |S'|. The quadrature for the second length, 5.384418260817, used Gauss nodes
 * graded towards the four vertices of valence 3. */
static void closed_geodesics(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_path path = trace(cube, (struct gd_limit_point){0, 0, 0.3, 0.5},
                                      (struct gd_vec3){1, 0, 0}, 5.344803240448);
    assert_true(gap(&path) < 1e-11);
    for (uint32_t i = 0; i < path.step_count; i++)
        assert_true(fabs(path.steps[i].position.y) < 1e-13);
    gd_limit_path_free(&path);

    const struct gd_limit_point starts[] = {{0, 0, 0.5, 0.5}, {0, 0, 0.25, 0.25}, {0, 0, 0, 0}};
    for (int k = 0; k < 3; k++) {
        path = trace(cube, starts[k], (struct gd_vec3){1, 1, 0}, 5.384418260817);
        assert_int_equal(path.end, GD_LIMIT_END_LENGTH);
        double off = 0;
        for (uint32_t i = 0; i < path.step_count; i++)
            off = fmax(off, fabs(path.steps[i].position.x - path.steps[i].position.y));
        print_message("# through four vertices: gap %.1e, off the plane %.1e\n", gap(&path), off);
        assert_true(gap(&path) < 1e-10 && off < 1e-10);
        gd_limit_path_free(&path);
    }
    gd_subdivision_release(cube);
}

/* Checks that a geodesic traced backwards returns to its start, with and without creases and
 * boundaries, in both schemes. */
static void check_back(const struct gd_subdivision *surface, double length, uint32_t faces,
                       int count)
{
    struct rng rng = {11};
    double worst = 0;
    for (int n = 0; n < count; n++) {
        struct gd_limit_point start = {rng_below(&rng, faces), 0, rng_between(&rng, 0, 0.5),
                                       rng_between(&rng, 0, 0.5)};
        struct gd_limit_jet jet = jet_at(surface, start.face, 0, start.u, start.v);
        double angle = rng_between(&rng, 0, 2 * M_PI);
        struct gd_vec3 direction =
            gd_vec3_along(gd_vec3_scale(jet.du, cos(angle)), sin(angle), jet.dv);
        struct gd_limit_path there = trace(surface, start, direction, length);
        if (there.end == GD_LIMIT_END_LENGTH) {
            struct gd_limit_path back =
                trace(surface, last(&there)->place, gd_vec3_scale(there.direction, -1), length);
            assert_int_equal(back.end, GD_LIMIT_END_LENGTH);
            worst = fmax(worst, gd_vec3_distance(last(&back)->position, jet.position));
            double chords = 0;
            for (uint32_t i = 1; i < there.step_count; i++)
                chords += gd_vec3_distance(there.steps[i].position, there.steps[i - 1].position);
            assert_true(chords <= length * (1 + 1e-12) && chords > 0.9 * length);
            gd_limit_path_free(&back);
        }
        gd_limit_path_free(&there);
    }
    print_message("# there and back: worst %.1e\n", worst);
    assert_true(worst < 1e-8);
}

static void there_and_back(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    check_back(surface, 5, 6, 40);
    gd_subdivision_release(surface);
    surface = surface_from(CUBE "t crease 5/1/0 4 5 7 6 4 10\n", GD_SCHEME_CATMULL_CLARK);
    check_back(surface, 5, 6, 40);
    gd_subdivision_release(surface);
    surface = surface_from(OCTAHEDRON, GD_SCHEME_LOOP);
    check_back(surface, 3, 8, 40);
    gd_subdivision_release(surface);
}

/* In a flat sheet with uneven parameters, geodesics are straight lines to the boundary. */
static void flat(void **state)
{
    (void)state;
    struct gd_control_mesh mesh;
    make_sheet(4, false, &mesh);
    for (uint32_t i = 0; i < mesh.polygons.position_count; i++) mesh.polygons.positions[i][2] = 0;
    struct gd_subdivision *sheet = surface_of(&mesh, GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_point start = {5, 0, 0.3, 0.4};
    struct gd_vec3 from = jet_at(sheet, 5, 0, 0.3, 0.4).position;
    for (int k = 0; k < 36; k++) {
        struct gd_vec3 direction = {cos(k * M_PI / 18), sin(k * M_PI / 18), 0};
        struct gd_limit_path path = trace(sheet, start, direction, 10);
        assert_int_equal(path.end, GD_LIMIT_END_BOUNDARY);
        struct gd_vec3 to = gd_vec3_along(from, path.length, direction);
        check_near(last(&path)->position, to.x, to.y, 0, 1e-11);
        gd_limit_path_free(&path);
    }
    gd_subdivision_release(sheet);
    gd_control_mesh_free(&mesh);
}

/* Creates a bent sheet that is 2^exponent times as large as that of make_sheet. */
static struct gd_subdivision *scaled_sheet(bool triangles, int exponent)
{
    struct gd_control_mesh mesh;
    make_sheet(4, triangles, &mesh);
    for (uint32_t i = 0; i < mesh.polygons.position_count; i++) {
        for (int axis = 0; axis < 3; axis++)
            mesh.polygons.positions[i][axis] = ldexp(mesh.polygons.positions[i][axis], exponent);
    }
    struct gd_subdivision *sheet =
        surface_of(&mesh, triangles ? GD_SCHEME_LOOP : GD_SCHEME_CATMULL_CLARK);
    gd_control_mesh_free(&mesh);
    return sheet;
}

/* A power of two as scale changes no digit of a path. */
static void scales(void **state)
{
    (void)state;
    static const int exponents[] = {-200, -60, 60, 120, 200};
    struct gd_limit_point start = {5, 0, 0.3, 0.4};
    for (int i = 0; i < 10; i++) {
        int exponent = exponents[i / 2];
        struct gd_subdivision *one = scaled_sheet(i % 2, 0), *other = scaled_sheet(i % 2, exponent);
        for (int k = 0; k < 36; k++) {
            struct gd_vec3 direction = {cos(k * M_PI / 18), sin(k * M_PI / 18), 0};
            struct gd_limit_path a = trace(one, start, direction, 10),
                                 b = trace(other, start, direction, ldexp(10, exponent));
            assert_true(a.end == b.end && a.step_count == b.step_count);
            for (uint32_t n = 0; n < a.step_count; n++) {
                assert_true(a.steps[n].place.u == b.steps[n].place.u);
                assert_true(a.steps[n].place.v == b.steps[n].place.v);
                assert_true(a.steps[n].length == ldexp(b.steps[n].length, -exponent));
            }
            gd_limit_path_free(&a);
            gd_limit_path_free(&b);
        }
        gd_subdivision_release(one);
        gd_subdivision_release(other);
    }
}

/* A path that leads to the tip of a spike ends at the tip. Other paths pass the tip. */
static void spike(void **state)
{
    (void)state;
    struct gd_subdivision *cube =
        surface_from(CUBE "t corner 1/1/0 4 10\n", GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_point at = {0, 0, 0.4, 0.4};
    struct gd_limit_path path = trace(cube, at, (struct gd_vec3){-1, -1, 0}, 3);
    assert_int_equal(path.end, GD_LIMIT_END_SINGULAR);
    check_near(last(&path)->position, -1, -1, 1, 1e-15);
    check_close(path.length, 1.2073125, 1e-6); /* length of the curve in the mirror plane */
    double chords = 0;
    for (uint32_t i = 1; i < path.step_count; i++)
        chords += gd_vec3_distance(path.steps[i].position, path.steps[i - 1].position);
    assert_true(chords <= path.length * (1 + 1e-12) && chords > 0.999 * path.length);
    print_message("# to the tip of a spike: %u steps\n", path.step_count);
    assert_true(path.step_count < 400);
    gd_limit_path_free(&path);
    for (int k = 1; k <= 40; k++) {
        double angle = 1.25 * M_PI + 1e-3 * k * (k % 2 ? 1 : -1);
        path = trace(cube, at, (struct gd_vec3){cos(angle), sin(angle), 0}, 3);
        assert_int_equal(path.end, GD_LIMIT_END_LENGTH);
        gd_limit_path_free(&path);
    }
    path = trace(cube, (struct gd_limit_point){0, 0, 0, 0}, (struct gd_vec3){1, 1, 0}, 1);
    assert_int_equal(path.end, GD_LIMIT_END_SINGULAR);
    assert_int_equal(path.step_count, 1);
    gd_limit_path_free(&path);
    gd_subdivision_release(cube);
}

/* Tests paths from the inner corner of a flat L, which has three faces. The start names one of
 * these faces. The paths are straight lines for each of them. */
static void from_corners(void **state)
{
    (void)state;
    struct gd_subdivision *l =
        surface_from("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\nv 1 2 0\n"
                     "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\n",
                     GD_SCHEME_CATMULL_CLARK);
    const struct gd_limit_point inner[] = {{0, 0, 1, 1}, {1, 0, 0, 1}, {2, 0, 1, 0}};
    for (int n = 0; n < 3; n++) {
        struct gd_vec3 from = jet_at(l, inner[n].face, 0, inner[n].u, inner[n].v).position;
        for (int k = 0; k < 36; k++) {
            double angle = 0.1 + k * M_PI / 18;
            struct gd_vec3 direction = {cos(angle), sin(angle), 0};
            struct gd_limit_path path = trace(l, inner[n], direction, 0.2);
            bool out =
                angle < 0.75 * M_PI - 0.2 || angle > 1.75 * M_PI + 0.2 ? path.length == 0 : false;
            bool in = angle > 0.75 * M_PI + 0.2 && angle < 1.75 * M_PI - 0.2;
            if (in) {
                assert_int_equal(path.end, GD_LIMIT_END_LENGTH);
                struct gd_vec3 to = gd_vec3_along(from, 0.2, direction);
                check_near(last(&path)->position, to.x, to.y, 0, 1e-10);
            } else if (out) {
                assert_int_equal(path.end, GD_LIMIT_END_BOUNDARY);
            }
            gd_limit_path_free(&path);
        }
    }
    gd_subdivision_release(l);
}

/* A vertex with a semi-sharp tag is smooth in the limit. A path passes through the vertex in both
 * directions. */
static void semi_sharp_vertex(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(
        CUBE "t corner 1/1/0 4 2.5\nt crease 2/1/0 4 5 1.2\n", GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_point at = {0, 0, 0, 0};
    struct gd_limit_jet jet = jet_at(cube, 0, 0, 0, 0);
    for (int k = 0; k < 12; k++) {
        double angle = 0.2 + k * M_PI / 6;
        struct gd_vec3 direction = gd_vec3_along(gd_vec3_scale(jet.du, cos(angle)), sin(angle),
                                                 gd_vec3_cross(jet.normal, jet.du));
        struct gd_limit_path there = trace(cube, at, direction, 0.5);
        assert_int_equal(there.end, GD_LIMIT_END_LENGTH);
        struct gd_limit_path through =
            trace(cube, last(&there)->place, gd_vec3_scale(there.direction, -1), 1);
        assert_int_equal(through.end, GD_LIMIT_END_LENGTH);
        struct gd_limit_path back =
            trace(cube, last(&through)->place, gd_vec3_scale(through.direction, -1), 0.5);
        check_near(last(&back)->position, jet.position.x, jet.position.y, jet.position.z, 1e-8);
        gd_limit_path_free(&there);
        gd_limit_path_free(&through);
        gd_limit_path_free(&back);
    }
    gd_subdivision_release(cube);
}

static void refusals(void **state)
{
    (void)state;
    struct gd_subdivision *cube = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    struct gd_limit_path path;
    struct gd_limit_point at = {0, 0, 0.5, 0.5};
    struct gd_vec3 up = {0, 0, 1}, none = {0, 0, 0}, along = {1, 0, 0};
    assert_int_equal(
        gd_limit_trace(cube, &(struct gd_limit_trace_request){at, up, 1}, NULL, &path, NULL),
        GD_INVALID_ARGUMENT);
    assert_int_equal(
        gd_limit_trace(cube, &(struct gd_limit_trace_request){at, none, 1}, NULL, &path, NULL),
        GD_INVALID_ARGUMENT);
    assert_int_equal(
        gd_limit_trace(cube, &(struct gd_limit_trace_request){at, along, -1}, NULL, &path, NULL),
        GD_INVALID_ARGUMENT);
    assert_int_equal(
        gd_limit_trace(cube, &(struct gd_limit_trace_request){at, along, NAN}, NULL, &path, NULL),
        GD_INVALID_ARGUMENT);
    struct gd_control late = {.deadline_ns = 1}, small = {.budget_bytes = 100};
    assert_int_equal(
        gd_limit_trace(cube, &(struct gd_limit_trace_request){at, along, 1}, &late, &path, NULL),
        GD_DEADLINE);
    assert_int_equal(
        gd_limit_trace(cube, &(struct gd_limit_trace_request){at, along, 1}, &small, &path, NULL),
        GD_BUDGET);
    path = trace(cube, at, along, 0);
    assert_int_equal(path.step_count, 1);
    gd_limit_path_free(&path);
    gd_subdivision_release(cube);
}

/* Traces a thousand random geodesics on a real control mesh and on its discretization. No trace may
 * fail. Every tenth geodesic starts at a vertex. `part` is the length relative to the bounding
 * box's diagonal. */
static void check_thousand(const char *path, double part)
{
    struct gd_subdivision *surface = surface_from_file(path, GD_SCHEME_CATMULL_CLARK);
    if (!surface) {
        print_message("# %s is not here: skipped\n", path);
        return;
    }
    struct gd_limit_mesh *fine;
    struct gd_detail detail = {0};
    check_ok(gd_limit_mesh_build(
                 surface,
                 &(struct gd_limit_mesh_options){.level = gd_limit_mesh_usual_level(surface)}, NULL,
                 &fine, &detail),
             &detail);
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(fine);
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    double length = part * gd_vec3_distance(summary->min, summary->max);
    const struct gd_trace_options options = {.vertex_rule = GD_VERTEX_RULE_NORMAL,
                                             .normals = gd_limit_mesh_normals(fine)};
    struct rng rng = {17};
    uint32_t ends[4] = {0}, faces = gd_subdivision_summary(surface).face_count;
    for (int k = 0; k < 1000; k += TEST_STRIDE) {
        struct gd_limit_point start = {rng_below(&rng, faces), 0, rng_unit(&rng), rng_unit(&rng)};
        if (k / TEST_STRIDE % 10 == 0) start.u = start.v = 0;
        struct gd_limit_jet jet = jet_at(surface, start.face, 0, start.u, start.v);
        struct gd_vec3 direction = gd_limit_direction(&jet, rng_between(&rng, 0, 2 * M_PI));
        struct gd_limit_path smooth = trace(surface, start, direction, length);
        ends[smooth.end]++;
        assert_true(smooth.end != GD_LIMIT_END_STEPS);
        gd_limit_path_free(&smooth);
        struct gd_point from;
        struct gd_direction ahead;
        struct gd_trace line;
        check_ok(gd_limit_mesh_point(fine, &start, &from, &detail), &detail);
        enum gd_status status = gd_direction_along(mesh, &from, direction, &ahead, &detail);
        if (status == GD_NOT_ON_SURFACE) continue; /* the direction leads over the boundary */
        check_ok(status, &detail);
        check_ok(gd_trace_follow(
                     mesh,
                     &(struct gd_trace_request){
                         .start = &from, .ahead = &ahead, .length = length, .options = &options},
                     NULL, &line, &detail),
                 &detail);
        gd_trace_free(&line);
    }
    print_message("# %s: %u geodesics end by length, %u at the boundary, %u at corners "
                  "and creases\n",
                  path, ends[0], ends[1], ends[2]);
    gd_limit_mesh_free(fine);
    gd_subdivision_release(surface);
}

static void real_meshes(void **state)
{
    (void)state;
    check_thousand("../shared/meshes/suzanne.obj", 0.5);
    /* a path of the same length crosses ten times as many patches */
    check_thousand("../shared/meshes/beast.obj", 0.03);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(closed_geodesics),
                                       cmocka_unit_test(there_and_back),
                                       cmocka_unit_test(flat),
                                       cmocka_unit_test(scales),
                                       cmocka_unit_test(spike),
                                       cmocka_unit_test(from_corners),
                                       cmocka_unit_test(semi_sharp_vertex),
                                       cmocka_unit_test(refusals),
                                       cmocka_unit_test(real_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
