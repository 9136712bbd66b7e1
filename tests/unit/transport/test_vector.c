#include "lines.h"

#include "gd/query.h"

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {{"terrain", {24, 0.8, 3}}, {"torus", {30, 15, 2, 0.7}}, {"genus2", {6, 0.1}},
                {"box", {1, 2, 3, 3}},     {"saddle", {1, 0.7, 12, 6}}, {"tangle", {150, 11}},
                {"tangle", {150, 4}},      {"grid", {9, 9, 1, 1}}};

static struct gd_path shortest(const struct gd_mesh *mesh, struct gd_point from, struct gd_point to,
                               double *distance)
{
    struct gd_pair_answer answer;
    struct gd_detail detail = {0};
    check_ok(gd_pair_solve(
                 mesh, &(struct gd_pair_request){.from = &from, .to = &to, .output = GD_PAIR_PATH},
                 NULL, &answer, &detail),
             &detail);
    *distance = answer.distance;
    return answer.path;
}

static struct gd_log log_of(const struct gd_mesh *mesh, const struct gd_path *path)
{
    struct gd_log log;
    struct gd_detail detail = {0};
    check_ok(gd_vector_log(mesh, path, &log, &detail), &detail);
    return log;
}

/* --- exp and log ------------------------------------------------------------------------------ */

static void check_pair(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q)
{
    double distance, sum = 0;
    struct gd_path path = shortest(mesh, p, q, &distance);
    if (isinf(distance)) return;
    struct gd_log log = log_of(mesh, &path);
    check_close(log.vector.length, distance, promise);
    for (uint32_t i = 0; i < log.count; i++) sum += log.segments[i].length;
    check_close(sum, log.vector.length, exact);
    struct gd_trace trace;
    struct gd_detail detail = {0};
    check_ok(gd_vector_exp(mesh,
                           &(struct gd_exp_request){
                               .start = &p, .segments = log.segments, .count = log.count},
                           NULL, &trace, &detail),
             &detail);
    struct gd_point end = end_of(&trace);
    struct gd_vec3 to = gd_point_position(mesh, &q);
    assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
    expect_place(gd_point_position(mesh, &end), to.x, to.y, to.z, promise * distance);
    gd_trace_free(&trace);
    gd_log_free(&log);
    gd_path_free(&path);
}

static void exp_of_log(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < COUNT(surfaces); s++) {
        struct surface surface = surface_of(surfaces[s].name, surfaces[s].values);
        struct rng rng = {s};
        for (int i = 0; i < 300; i++)
            check_pair(surface.mesh,
                       test_point(surface.mesh, test_random_place(&surface.polygons, &rng)),
                       test_point(surface.mesh, test_random_place(&surface.polygons, &rng)));
        surface_free(&surface);
    }
}

static struct gd_point random_point(const struct gd_mesh *mesh, struct rng *rng)
{
    struct gd_face face;
    struct gd_point point;
    double a = rng_between(rng, 0.05, 0.45), b = rng_between(rng, 0.05, 0.45);
    do face.index = (uint32_t)(rng_next(rng) % gd_mesh_summary(mesh)->face_index_count);
    while (!gd_mesh_has_face(mesh, face));
    check_ok(gd_point_in_face(mesh, face, (double[3]){a, b, 1 - a - b}, &point, NULL), NULL);
    return point;
}

/* Runs on meshes of ../shared/meshes. Missing files are skipped. */
static void exp_of_log_on_shared_meshes(void **state)
{
    (void)state;
    static const char *const names[] = {"beast",          "beetle", "cow",        "fandisk",
                                        "homer",          "spot",   "rocker-arm", "teapot",
                                        "stanford-bunny", "suzanne"};
    for (uint32_t i = 0; i < COUNT(names); i++) {
        struct surface surface;
        if (!surface_read(names[i], &surface)) continue;
        struct rng rng = {i};
        int pairs = gd_mesh_summary(surface.mesh)->faces > 50000 ? 10 : 60;
        for (int k = 0; k < pairs; k++)
            check_pair(surface.mesh, random_point(surface.mesh, &rng),
                       random_point(surface.mesh, &rng));
        surface_free(&surface);
    }
}

/* The log of a path over a saddle's apex has two segments, each as long as its part of the path. */
static void bends_are_kept(void **state)
{
    (void)state;
    struct surface saddle = surface_of("saddle", (double[SAMPLE_PARAMETERS]){1, 0.9, 12, 4});
    struct gd_point p = nearest(saddle.mesh, 0.5, 0.01, 0.3),
                    q = nearest(saddle.mesh, -0.5, 0.02, 0.3);
    double distance;
    struct gd_path path = shortest(saddle.mesh, p, q, &distance);
    struct gd_log log = log_of(saddle.mesh, &path);
    struct gd_vec3 apex = {0, 0, 0};
    assert_int_equal(log.count, 2);
    check_close(log.segments[0].length, gd_vec3_distance(gd_point_position(saddle.mesh, &p), apex),
                exact);
    check_close(log.segments[1].length, gd_vec3_distance(gd_point_position(saddle.mesh, &q), apex),
                exact);
    gd_log_free(&log);
    gd_path_free(&path);
    /* a path of a single point has a zero vector; a path with a gap is an error */
    path = (struct gd_path){.length = 1, .count = 1, .points = &p};
    log = log_of(saddle.mesh, &path);
    assert_true(log.count == 0 && log.vector.length == 0);
    struct gd_point apart[2] = {p, q};
    path = (struct gd_path){.length = 1, .count = 2, .points = apart};
    assert_int_equal(gd_vector_log(saddle.mesh, &path, &log, NULL), GD_INTERNAL);
    struct gd_trace trace;
    check_ok(gd_vector_exp(saddle.mesh, &(struct gd_exp_request){.start = &p}, NULL, &trace, NULL),
             NULL);
    assert_true(trace.path.count == 1 && gd_point_equal(trace.path.points, &p));
    gd_trace_free(&trace);
    surface_free(&saddle);
}

/* If a segment ends at a vertex up to rounding, the next segment starts in that vertex. The same
 * holds if a segment reaches the boundary and its remaining length is a rounding error. */
static void a_segment_that_ends_near_a_vertex_continues_there(void **state)
{
    (void)state;
    struct surface saddle = surface_of("saddle", (double[SAMPLE_PARAMETERS]){1, 0.9, 12, 4});
    struct gd_point p = nearest(saddle.mesh, 0.5, 0.01, 0.3),
                    q = nearest(saddle.mesh, -0.5, 0.02, 0.3);
    double distance;
    struct gd_path path = shortest(saddle.mesh, p, q, &distance);
    struct gd_log log = log_of(saddle.mesh, &path);
    for (int k = -1; k <= 1; k += 2) {
        struct gd_vector segments[2] = {log.segments[0], log.segments[1]};
        struct gd_trace trace;
        segments[0].length *= 1 + k * 2e-10;
        check_ok(
            gd_vector_exp(saddle.mesh,
                          &(struct gd_exp_request){.start = &p, .segments = segments, .count = 2},
                          NULL, &trace, NULL),
            NULL);
        struct gd_point end = end_of(&trace);
        struct gd_vec3 to = gd_point_position(saddle.mesh, &q);
        expect_place(gd_point_position(saddle.mesh, &end), to.x, to.y, to.z, promise);
        gd_trace_free(&trace);
    }
    gd_log_free(&log);
    gd_path_free(&path);
    surface_free(&saddle);
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){3, 3, 1, 1});
    struct gd_point start = nearest(grid.mesh, 0.4, 0.7, 0), corner = nearest(grid.mesh, 1, 1, 0);
    const struct gd_vector over[2] = {
        {along(grid.mesh, start, 0.6, 0.3, 0), hypot(0.6, 0.3) * (1 + 2e-10)},
        {along(grid.mesh, corner, -1, 0, 0), 0.25}};
    struct gd_trace trace;
    check_ok(gd_vector_exp(grid.mesh,
                           &(struct gd_exp_request){.start = &start, .segments = over, .count = 2},
                           NULL, &trace, NULL),
             NULL);
    struct gd_point end = end_of(&trace);
    assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
    expect_place(gd_point_position(grid.mesh, &end), 0.75, 1, 0, promise);
    gd_trace_free(&trace);
    surface_free(&grid);
}

/* --- transport -------------------------------------------------------------------------------- */

static struct gd_vector moved(const struct gd_mesh *mesh, struct gd_point from, struct gd_point to,
                              struct gd_vector vector)
{
    double distance;
    struct gd_path path = shortest(mesh, from, to, &distance);
    struct gd_detail detail = {0};
    check_ok(gd_vector_transport(mesh, &path, &vector, 1, &detail), &detail);
    gd_path_free(&path);
    return vector;
}

/* Computes the angle defect of a vertex from positions: 2 pi minus the total angle. */
static double defect_at(const struct surface *surface, uint32_t index)
{
    double defect = 2 * M_PI;
    struct gd_vec3 v = gd_mesh_position(surface->mesh, (struct gd_vertex){index});
    for (uint32_t i = 0; i < 3 * surface->polygons.polygon_count; i++) {
        const uint32_t *corner = surface->polygons.corners + i - i % 3;
        if (corner[i % 3] != index) continue;
        struct gd_vec3 a = gd_mesh_position(surface->mesh, (struct gd_vertex){corner[(i + 1) % 3]}),
                       b = gd_mesh_position(surface->mesh, (struct gd_vertex){corner[(i + 2) % 3]});
        a = gd_vec3_sub(a, v), b = gd_vec3_sub(b, v);
        defect -= atan2(gd_vec3_length(gd_vec3_cross(a, b)), gd_vec3_dot(a, b));
    }
    return defect;
}

/* Finds three points around a vertex, close to the vertex and inside faces. Returns false if one of
 * them is not inside a face, or if the vertex is on the boundary. */
static bool triangle_around(const struct gd_mesh *mesh, struct gd_point centre,
                            struct gd_point corner[3])
{
    struct gd_direction out;
    double small = 0.05 * gd_mesh_summary(mesh)->edge_length.min;
    if (gd_direction_at_angle(mesh, &centre, -0.1, &out, NULL)) return false;
    for (int k = 0; k < 3; k++) {
        check_ok(gd_direction_at_angle(mesh, &centre, 0.3 + 2 * M_PI * k / 3, &out, NULL), NULL);
        struct gd_trace trace = follow(mesh, centre, out, small, NULL);
        corner[k] = end_of(&trace);
        gd_trace_free(&trace);
        if (corner[k].kind != GD_POINT_FACE) return false;
    }
    return true;
}

/* Tests the theorem of Gauss-Bonnet: transport around a small triangle turns a vector by the
 * enclosed curvature, which is the angle defect of the vertex inside. Saddles are omitted, because
 * the triangle's sides would bend at them. */
static void turns_by_the_angle_defect(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < 4; s++) {
        struct surface surface = surface_of(surfaces[s].name, surfaces[s].values);
        struct rng rng = {s};
        uint32_t tried = 0;
        for (uint32_t i = 0; i < 400 && tried < 30; i++) {
            uint32_t index =
                (uint32_t)(rng_next(&rng) % gd_mesh_summary(surface.mesh)->index_count);
            struct gd_point corner[3];
            double defect = defect_at(&surface, index);
            if (defect < 1e-6 || defect > 1.6 ||
                !triangle_around(surface.mesh, vertex(surface.mesh, index), corner))
                continue;
            struct gd_vector vector = {random_direction(surface.mesh, corner[0], &rng), 1},
                             turned = vector;
            for (uint32_t k = 0; k < 3; k++)
                turned = moved(surface.mesh, corner[k], corner[(k + 1) % 3], turned);
            expect_near(
                remainder(turned.direction.angle - vector.direction.angle - defect, 2 * M_PI), 0,
                promise);
            tried++;
        }
        assert_true(tried > 3);
        surface_free(&surface);
    }
}

/* In a plane, transport does not change a vector. On any surface, transport forth and back along a
 * path without bends restores the vector's angle. */
static void transport_forth_and_back_changes_nothing(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){9, 7, 1, 1});
    struct rng rng = {8};
    for (int i = 0; i < 100; i++) {
        struct gd_point p = random_point(grid.mesh, &rng), q = random_point(grid.mesh, &rng);
        struct gd_vector vector = {random_direction(grid.mesh, p, &rng), 0.5},
                         there = moved(grid.mesh, p, q, vector);
        struct gd_vec3 v = vector.direction.xyz;
        expect_place(there.direction.xyz, v.x, v.y, v.z, 1e-12);
        assert_true(there.length == 0.5);
    }
    surface_free(&grid);
    for (uint32_t s = 0; s < COUNT(surfaces); s++) {
        struct surface surface = surface_of(surfaces[s].name, surfaces[s].values);
        for (int i = 0; i < 30; i++) {
            struct gd_point p = random_point(surface.mesh, &rng),
                            q = random_point(surface.mesh, &rng);
            double distance;
            struct gd_path path = shortest(surface.mesh, p, q, &distance);
            gd_path_free(&path);
            if (isinf(distance)) continue;
            struct gd_vector vector = {random_direction(surface.mesh, p, &rng), 1};
            double angle =
                moved(surface.mesh, q, p, moved(surface.mesh, p, q, vector)).direction.angle;
            struct gd_log log;
            path = shortest(surface.mesh, p, q, &distance);
            log = log_of(surface.mesh, &path);
            if (log.count == 1)
                expect_near(remainder(angle - vector.direction.angle, 2 * M_PI), 0, promise);
            /* the path's own direction remains tangent to the path */
            struct gd_vector tangent = log.vector;
            check_ok(gd_vector_transport(surface.mesh, &path, &tangent, 1, NULL), NULL);
            struct gd_trace trace;
            check_ok(gd_vector_exp(surface.mesh,
                                   &(struct gd_exp_request){
                                       .start = &p, .segments = log.segments, .count = log.count},
                                   NULL, &trace, NULL),
                     NULL);
            if (end_of(&trace).kind == q.kind)
                expect_near(remainder(tangent.direction.angle - trace.direction.angle, 2 * M_PI), 0,
                            promise);
            gd_trace_free(&trace);
            gd_log_free(&log);
            gd_path_free(&path);
        }
        surface_free(&surface);
    }
}

static void sums_of_vectors(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){3, 3, 1, 1});
    struct gd_point p = nearest(grid.mesh, 0.4, 0.3, 0), corner = nearest(grid.mesh, 1, 1, 0);
    const struct gd_vector vectors[3] = {{along(grid.mesh, p, 1, 0, 0), 2},
                                         {along(grid.mesh, p, 0, 1, 0), 3},
                                         {along(grid.mesh, p, 3, 4, 0), 5}};
    struct gd_vector sum = gd_vector_combine(grid.mesh, &p, vectors, (const double[]){1, -1, 2}, 3);
    expect_place(gd_vec3_scale(sum.direction.xyz, sum.length), 2 + 6, -3 + 8, 0, 1e-13);
    sum = gd_vector_combine(grid.mesh, &p, vectors, (const double[]){0, 0, 0}, 3);
    assert_true(sum.length == 0);
    /* at a boundary vertex, where angles end at the total angle */
    const struct gd_vector inward[2] = {{along(grid.mesh, corner, -1, 0, 0), 1},
                                        {along(grid.mesh, corner, 0, -1, 0), 1}};
    sum = gd_vector_combine(grid.mesh, &corner, inward, (const double[]){1, 1}, 2);
    expect_place(sum.direction.xyz, -M_SQRT1_2, -M_SQRT1_2, 0, 1e-13);
    /* the sum leads off the surface */
    sum = gd_vector_combine(grid.mesh, &corner, inward, (const double[]){-1, 0}, 2);
    expect_place(sum.direction.xyz, 1, 0, 0, 1e-13);
    surface_free(&grid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exp_of_log),
        cmocka_unit_test(exp_of_log_on_shared_meshes),
        cmocka_unit_test(bends_are_kept),
        cmocka_unit_test(a_segment_that_ends_near_a_vertex_continues_there),
        cmocka_unit_test(turns_by_the_angle_defect),
        cmocka_unit_test(transport_forth_and_back_changes_nothing),
        cmocka_unit_test(sums_of_vectors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
