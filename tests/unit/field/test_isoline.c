#include "isolines.h"

#include <float.h>
#include <time.h>

#include "gd/locate.h"
#include "tests/support/watch.h"

/* --- closed forms ----------------------------------------------------------------------------- */

/* Returns the length of the circle about (x, y) inside the rectangle [0, width] x [0, height]. */
static double circle_in_rectangle(double x, double y, double radius, double width, double height)
{
    double cuts[10] = {0, 2 * M_PI}, lines[4] = {-x, width - x, -y, height - y}, length = 0;
    int count = 2;
    for (int i = 0; i < 4; i++) {
        double q = lines[i] / radius;
        if (fabs(q) >= 1) continue;
        double half = i < 2 ? acos(q) : asin(q), other = i < 2 ? -half : M_PI - half;
        cuts[count++] = half < 0 ? half + 2 * M_PI : half;
        cuts[count++] = other < 0 ? other + 2 * M_PI : other;
    }
    for (int i = 0; i < count; i++)
        for (int k = i + 1; k < count; k++)
            if (cuts[k] < cuts[i]) {
                double swap = cuts[i];
                cuts[i] = cuts[k];
                cuts[k] = swap;
            }
    for (int i = 0; i + 1 < count; i++) {
        double middle = 0.5 * (cuts[i] + cuts[i + 1]), px = x + radius * cos(middle),
               py = y + radius * sin(middle);
        if (px > 0 && px < width && py > 0 && py < height)
            length += radius * (cuts[i + 1] - cuts[i]);
    }
    return length;
}

static void circles_in_the_plane(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(9, 7, 3, 2, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct rng rng = {1};
    double worst = 0;
    for (int s = 0; s < 30; s++) {
        struct gd_seed seed = {.point = test_point(mesh, test_random_place(&polygons, &rng))};
        struct gd_vec3 at = gd_point_position(mesh, &seed.point);
        struct gd_field *field = test_field(mesh, &seed, 1, 0);
        for (int k = 0; k < 12; k++) {
            double level = k ? rng_between(&rng, 0.001, 2.5) : 1e-5;
            struct gd_isoline isoline = trace(field, level);
            double expected = circle_in_rectangle(at.x, at.y, level, 3, 2);
            if (expected > 1e-9 || total_length(&isoline) > 1e-9)
                worst = fmax(worst, check_close(total_length(&isoline), expected, promise));
            gd_isoline_free(&isoline);
        }
        gd_field_release(field);
    }
    print_message("# circles in the plane: lengths off by %.1e at most\n", worst);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Tests levels whose lines pass through vertices, touch edges in vertices, or end in corners. */
static void levels_through_vertices(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(8, 8, 8, 8, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {0};
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){4 * 9 + 4}, &seed.point, NULL), NULL);
    struct gd_field *field = test_field(mesh, &seed, 1, 0);
    const double levels[] = {1, sqrt(2),  2,        sqrt(5),         sqrt(8),
                             3, sqrt(10), sqrt(13), nextafter(3, 0), nextafter(3, 4)};
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        struct gd_isoline isoline = trace(field, levels[i]);
        assert_int_equal(isoline.line_count, 1);
        assert_true(isoline.lines[0].closed);
        check_close(isoline.lines[0].length, 2 * M_PI * levels[i], promise);
        gd_isoline_free(&isoline);
    }
    struct gd_isoline corner = trace(field, sqrt(32)), inner = trace(field, 5),
                      none = trace(field, 6);
    assert_true(total_length(&corner) < 1e-6);
    assert_int_equal(inner.line_count, 4);
    check_close(total_length(&inner), circle_in_rectangle(4, 4, 5, 8, 8), promise);
    for (uint32_t i = 0; i < 4; i++) assert_false(inner.lines[i].closed);
    assert_int_equal(none.line_count, 0);
    gd_isoline_free(&corner);
    gd_isoline_free(&inner);
    gd_isoline_free(&none);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* About the apex of a cone the isoline's length is the total angle times the radius. The surface's
 * rim is a polygon. */
static void circles_about_an_apex(void **state)
{
    (void)state;
    const char *names[] = {"cone", "saddle"};
    const double values[][SAMPLE_PARAMETERS] = {{1, 0.7, 7, 6}, {1, 0.9, 6, 5}};
    for (int i = 0; i < 2; i++) {
        struct gd_polygons polygons;
        check_ok(sample_find(names[i])->generate(values[i], &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        uint32_t apex = polygons.position_count - 1;
        if (i) {
            apex = 0;
            while (polygons.positions[apex][0] != 0 || polygons.positions[apex][1] != 0) apex++;
        }
        struct gd_seed seed = {.offset = 0.25};
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){apex}, &seed.point, NULL), NULL);
        struct gd_field *field = test_field(mesh, &seed, 1, 0);
        double total = 0; /* total angle of the faces around the apex */
        for (uint32_t f = 0; f < polygons.polygon_count; f++) {
            const uint32_t *corner = &polygons.corners[3 * f];
            for (uint32_t k = 0; k < 3; k++) {
                if (corner[k] != apex) continue;
                struct gd_vec3 p = gd_mesh_position(mesh, (struct gd_vertex){apex}),
                               a = gd_vec3_sub(
                                   gd_mesh_position(mesh, (struct gd_vertex){corner[(k + 1) % 3]}),
                                   p),
                               b = gd_vec3_sub(
                                   gd_mesh_position(mesh, (struct gd_vertex){corner[(k + 2) % 3]}),
                                   p);
                total += atan2(gd_vec3_length(gd_vec3_cross(a, b)), gd_vec3_dot(a, b));
            }
        }
        for (double radius = 0.01; radius < 0.8; radius += 0.0637) {
            struct gd_isoline isoline = trace(field, 0.25 + radius);
            assert_int_equal(isoline.line_count, 1);
            assert_true(isoline.lines[0].closed);
            check_close(isoline.lines[0].length, total * radius, promise);
            gd_isoline_free(&isoline);
        }
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* The isoline of two seeds is two lines while their circles are disjoint. At larger levels it is a
 * single line, whose arcs meet on the bisector. */
static void two_seeds_in_the_plane(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(5, 4, 10, 8, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    const struct gd_vec3 at[2] = {{4, 4, 0}, {6.1, 4.3, 0}};
    struct gd_seed seeds[2] = {{.offset = 0}, {.offset = 0.2}};
    for (int i = 0; i < 2; i++) {
        check_ok(gd_locate_nearest(mesh, at[i], 1, &seeds[i].point, NULL), NULL);
    }
    struct gd_field *field = test_field(mesh, seeds, 2, 0);
    double apart = gd_vec3_distance(at[0], at[1]);
    for (double level = 0.25; level < 3; level += 0.131) {
        double r = level, s = level - 0.2, length = 2 * M_PI * (r + s);
        uint32_t lines = 2;
        if (r + s > apart) {
            lines = 1;
            length -= 2 * r * acos((apart * apart + r * r - s * s) / (2 * apart * r));
            length -= 2 * s * acos((apart * apart + s * s - r * r) / (2 * apart * s));
        }
        struct gd_isoline isoline = trace(field, level);
        assert_int_equal(isoline.line_count, lines);
        check_close(total_length(&isoline), length, promise);
        uint32_t joints = 0;
        for (uint32_t i = 0; i < isoline.line_count; i++)
            for (uint32_t k = 0; k < isoline.lines[i].point_count; k++) {
                struct gd_vec3 p = gd_point_position(mesh, &isoline.lines[i].points[k]);
                double d = gd_vec3_distance(p, at[0]), e = gd_vec3_distance(p, at[1]) + 0.2;
                joints += fabs(d - e) < 1e-9;
            }
        assert_int_equal(joints, lines == 1 ? 2 : 0);
        gd_isoline_free(&isoline);
    }
    /* the circles touch in one point */
    struct gd_isoline touching = trace(field, 0.5 * (apart + 0.2));
    check_close(total_length(&touching), 2 * M_PI * apart, 1e-6);
    gd_isoline_free(&touching);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Tests circles and holes inside a face that cross no edge. */
static void loops_within_one_face(void **state)
{
    (void)state;
    double positions[3][3] = {{0, 0, 0}, {4, 0, 0}, {2, 3, 0}};
    uint32_t corners[3] = {0, 1, 2};
    struct gd_polygons one = {
        .positions = positions, .position_count = 3, .polygon_count = 1, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&one);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){0, {0.5, 0.25, 0.25}})};
    struct gd_field *field = test_field(mesh, &seed, 1, 0);
    struct gd_isoline isoline = trace(field, 0.3);
    assert_int_equal(isoline.line_count, 1);
    assert_true(isoline.lines[0].closed && isoline.lines[0].arc_count == 1);
    check_close(isoline.lines[0].length, 0.6 * M_PI, 1e-14);
    gd_isoline_free(&isoline);
    gd_field_release(field);
    /* Seeds are the midpoints of the sides. The distance has a maximum at the centre of the circle
     * through these midpoints. */
    struct gd_seed round[3] = {{.point = test_point(mesh, (struct test_place){0, {0.5, 0.5, 0}})},
                               {.point = test_point(mesh, (struct test_place){0, {0, 0.5, 0.5}})},
                               {.point = test_point(mesh, (struct test_place){0, {0.5, 0, 0.5}})}};
    field = test_field(mesh, round, 3, 0); /* (2, 0), (3, 1.5), (1, 1.5): 13/12 from (2, 13/12) */
    isoline = trace(field, 1.05);
    uint32_t holes = 0;
    for (uint32_t i = 0; i < isoline.line_count; i++) {
        if (!isoline.lines[i].closed) continue;
        holes++;
        assert_int_equal(isoline.lines[i].arc_count, 3);
        for (uint32_t k = 0; k < isoline.lines[i].point_count; k++)
            assert_int_equal(isoline.lines[i].points[k].kind, GD_POINT_FACE);
    }
    assert_int_equal(holes, 1);
    gd_isoline_free(&isoline);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* Tests isolines on a cube about the middle of a face. The expected lengths follow from the cube's
 * net. */
static void on_a_cube(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    const double size[3] = {1, 1, 1};
    const uint32_t cells[3] = {3, 3, 3};
    check_ok(sample_box(size, cells, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {0};
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){0.5, 0.5, 1}, 1, &seed.point, NULL), NULL);
    struct gd_field *field = test_field(mesh, &seed, 1, 0);
    struct gd_isoline on_top = trace(field, 0.4), over = trace(field, 0.6),
                      holes = trace(field, 1.9);
    assert_true(on_top.line_count == 1 && over.line_count == 1 && holes.line_count == 1);
    check_close(on_top.lines[0].length, 0.8 * M_PI, promise);
    /* no corner is nearer than this level, so the surface is flat up to this level */
    check_close(over.lines[0].length, 1.2 * M_PI, promise);
    /* the line around the middle of the opposite face has four arcs about images of the seed at
       distance 2 */
    double t = 1 - sqrt(1.9 * 1.9 / 2 - 1), quarter = 2 * 1.9 * asin(t / 1.9);
    check_close(holes.lines[0].length, 4 * quarter, promise);
    gd_isoline_free(&on_top);
    gd_isoline_free(&over);
    gd_isoline_free(&holes);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void refusals(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(2, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){0, {0.2, 0.3, 0.5}})};
    struct gd_field *whole = test_field(mesh, &seed, 1, 0),
                    *partial = test_field(mesh, &seed, 1, 1);
    struct gd_isoline isoline = {.level = 7};
    const double bad[] = {-1, NAN, INFINITY};
    for (int i = 0; i < 3; i++)
        assert_int_equal(gd_isoline_trace(whole, bad[i], NULL, &isoline), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_isoline_trace(partial, 1.5, NULL, &isoline), GD_BEYOND_REACH);
    struct gd_control late = {.deadline_ns = 1}, cancel = {.progress = test_cancel},
                      poor = {.budget_bytes = 64};
    assert_int_equal(gd_isoline_trace(whole, 1, &late, &isoline), GD_DEADLINE);
    assert_int_equal(gd_isoline_trace(whole, 1, &cancel, &isoline), GD_CANCELLED);
    assert_int_equal(gd_isoline_trace(whole, 1, &poor, &isoline), GD_BUDGET);
    assert_true(isoline.level == 7);
    struct gd_isoline zero = trace(whole, 0), far = trace(whole, 100), a = trace(whole, 0.9),
                      b = trace(partial, 0.9);
    assert_true(zero.line_count == 0 && far.line_count == 0 && a.line_count == 1 &&
                b.line_count == 1);
    const double huge[] = {1e299, 1e300, DBL_MAX};
    for (int i = 0; i < 3; i++) {
        struct gd_isoline none = trace(whole, huge[i]);
        assert_int_equal(none.line_count, 0);
        gd_isoline_free(&none);
        assert_int_equal(gd_isoline_trace(partial, huge[i], NULL, &isoline), GD_BEYOND_REACH);
    }
    check_close(a.lines[0].length, b.lines[0].length, 1e-12);
    struct gd_path path;
    assert_int_equal(gd_isoline_flatten(mesh, &a.lines[0], 0, NULL, &path), GD_INVALID_ARGUMENT);
    check_ok(gd_isoline_flatten(mesh, &a.lines[0], 1e-9, NULL, &path), NULL);
    check_close(path.length, a.lines[0].length, 1e-7);
    gd_path_free(&path);
    assert_int_equal(gd_isoline_flatten(mesh, &a.lines[0], 1, &late, &path), GD_DEADLINE);
    assert_int_equal(gd_isoline_flatten(mesh, &a.lines[0], 1, &cancel, &path), GD_CANCELLED);
    assert_int_equal(gd_isoline_flatten(mesh, &a.lines[0], 1, &poor, &path), GD_BUDGET);
    gd_isoline_free(&zero);
    gd_isoline_free(&far);
    gd_isoline_free(&a);
    gd_isoline_free(&b);
    gd_field_release(whole);
    gd_field_release(partial);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- control ---------------------------------------------------------------------------------- */

static double cpu_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

/* The control is checked once per millisecond on average. The call ends at the first check that
 * returns false. */
static void checks_its_control(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(6, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){0, {0.2, 0.3, 0.5}})};
    struct gd_field *field = test_field(mesh, &seed, 1, 0);
    struct test_watch whole = {0};
    struct gd_control control = {.progress = test_watch, .user = &whole};
    struct gd_isoline isoline;
    double begun = cpu_ms();
    check_ok(gd_isoline_trace(field, 1.5, &control, &isoline), NULL);
    double took = cpu_ms() - begun;
    print_message("# %u looks at the control in %.1f ms\n", whole.calls, took);
    assert_true(whole.calls >= 3 && whole.calls >= took);
    gd_isoline_free(&isoline);
    for (uint32_t most = 1; most <= whole.calls; most += 1 + whole.calls / 20) {
        struct test_watch part = {.most = most};
        control.user = &part;
        assert_int_equal(gd_isoline_trace(field, 1.5, &control, &isoline), GD_CANCELLED);
        assert_int_equal(part.calls, most);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* One index serves every level, and it holds its own reference to the field. */
static void one_index_serves_every_level(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_terrain(40, 0.2, 3, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){700, {0.2, 0.3, 0.5}})};
    struct gd_field *field = test_field(mesh, &seed, 1, 0);
    struct gd_isoline_index *index;
    check_ok(gd_isoline_index_create(field, NULL, &index), NULL);
    for (int k = 0; k < 20; k++) {
        double level = 0.001 + 0.06 * k;
        struct gd_isoline alone, indexed;
        check_ok(gd_isoline_trace(field, level, NULL, &alone), NULL);
        check_ok(gd_isoline_trace_indexed(index, level, NULL, &indexed), NULL);
        assert_int_equal(alone.line_count, indexed.line_count);
        assert_true(total_length(&alone) == total_length(&indexed) && alone.line_count > 0);
        gd_isoline_free(&alone);
        gd_isoline_free(&indexed);
    }
    struct gd_isoline refused;
    assert_int_equal(gd_isoline_trace_indexed(index, -1, NULL, &refused), GD_INVALID_ARGUMENT);
    gd_field_release(field);
    check_ok(gd_isoline_trace_indexed(index, 0.5, NULL, &refused), NULL);
    gd_isoline_free(&refused);
    gd_isoline_index_destroy(index);
    gd_isoline_index_destroy(NULL);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circles_in_the_plane),         cmocka_unit_test(levels_through_vertices),
        cmocka_unit_test(circles_about_an_apex),        cmocka_unit_test(two_seeds_in_the_plane),
        cmocka_unit_test(loops_within_one_face),        cmocka_unit_test(on_a_cube),
        cmocka_unit_test(one_index_serves_every_level), cmocka_unit_test(refusals),
        cmocka_unit_test(checks_its_control),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
