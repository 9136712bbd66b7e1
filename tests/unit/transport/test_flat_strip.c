#include "gd/flat_strip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/query.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static struct gd_mesh *mesh_of(enum gd_status status, struct gd_polygons *polygons)
{
    struct gd_mesh *mesh;
    struct gd_detail detail;
    check_ok(status, NULL);
    check_ok(gd_mesh_build(polygons, NULL, NULL, &mesh, &detail), &detail);
    gd_polygons_free(polygons);
    return mesh;
}

static double span(const double a[2], const double b[2])
{
    return hypot(b[0] - a[0], b[1] - a[1]);
}

static double segment(const struct gd_mesh *mesh, const struct gd_point *a,
                      const struct gd_point *b)
{
    return gd_vec3_distance(gd_point_position(mesh, a), gd_point_position(mesh, b));
}

/* Checks that lengths between consecutive points are the same in the plane and on the surface. */
static void check_points(const struct gd_mesh *mesh, const struct gd_path *path,
                         const struct gd_flat_strip *strip)
{
    assert_int_equal(strip->point_count, path->count);
    for (uint32_t i = 0; i + 1 < path->count; i++) {
        double expected = segment(mesh, &path->points[i], &path->points[i + 1]);
        assert_true(fabs(span(strip->points[i], strip->points[i + 1]) - expected) <=
                    1e-11 * path->length);
    }
}

static double area(const struct gd_flat_face *face)
{
    const double *a = face->corners[0], *b = face->corners[1], *c = face->corners[2];
    return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

static bool has_corner(const struct gd_flat_face *face, const double at[2], double error)
{
    for (int k = 0; k < 3; k++)
        if (span(face->corners[k], at) <= error) return true;
    return false;
}

/* Checks that faces are counter-clockwise and that each face shares an edge with the previous
 * face. */
static void check_faces(const struct gd_flat_strip *strip, double error)
{
    for (uint32_t i = 0; i < strip->face_count; i++) {
        int shared = 0;
        assert_true(area(&strip->faces[i]) > 0);
        for (int k = 0; i && k < 3; k++)
            shared += has_corner(&strip->faces[i - 1], strip->faces[i].corners[k], error);
        assert_int_equal(shared, i ? 2 : 0);
    }
}

static void check_pair(const struct gd_mesh *mesh, const struct gd_point *from,
                       const struct gd_point *to, bool is_straight)
{
    struct gd_pair_answer answer;
    struct gd_flat_strip strip;
    check_ok(gd_pair_solve(
                 mesh, &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH},
                 NULL, &answer, NULL),
             NULL);
    check_ok(gd_flat_strip_of(mesh, &answer.path, NULL, &strip), NULL);
    const double *end = strip.points[strip.point_count - 1];
    check_points(mesh, &answer.path, &strip);
    check_faces(&strip, 1e-9);
    assert_true(fabs(strip.points[0][0]) <= 1e-12 && fabs(strip.points[0][1]) <= 1e-12 &&
                end[0] >= 0);
    if (is_straight)
        for (uint32_t i = 0; i < strip.point_count; i++)
            assert_true(fabs(strip.points[i][1]) <= 1e-9);
    if (is_straight) assert_true(fabs(end[0] - answer.distance) <= 1e-11);
    assert_true(end[0] <= answer.distance * (1 + 1e-11));
    gd_flat_strip_free(&strip);
    gd_pair_answer_free(&answer);
}

/* On a convex surface a shortest path passes through no vertex. Unfolded, it is a straight line. */
static void straight_where_the_surface_is_convex(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = mesh_of(sample_icosphere(3, 1, &polygons), &polygons);
    uint32_t faces = gd_mesh_summary(mesh)->faces, count = gd_mesh_summary(mesh)->index_count;
    for (uint32_t i = 0; i < 60; i++) {
        const double inside[3] = {0.2, 0.3, 0.5};
        struct gd_point from, to;
        check_ok(gd_point_in_face(mesh, (struct gd_face){i * 7 % faces}, inside, &from, NULL),
                 NULL);
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){i * 31 % count}, &to, NULL), NULL);
        check_pair(mesh, &from, &to, true);
    }
    gd_mesh_release(mesh);
}

/* On a terrain paths bend at vertices and run along edges and boundaries. */
static void lengths_are_kept_everywhere(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = mesh_of(sample_terrain(12, 0.9, 3, &polygons), &polygons);
    uint32_t count = gd_mesh_summary(mesh)->index_count;
    for (uint32_t i = 0; i < 300; i++) {
        struct gd_point from, to;
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){i * 37 % count}, &from, NULL), NULL);
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){(i * i + 5 * i) % count}, &to, NULL),
                 NULL);
        check_pair(mesh, &from, &to, false);
    }
    gd_mesh_release(mesh);
}

/* A path that turns back inside a face crosses the same faces again. */
static void paths_that_turn_back(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = mesh_of(sample_icosphere(3, 1, &polygons), &polygons);
    struct gd_point ends[3];
    struct gd_pair_answer there, back;
    const double inside[3] = {0.2, 0.3, 0.5};
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){0}, &ends[0], NULL), NULL);
    check_ok(gd_point_in_face(mesh, (struct gd_face){200}, inside, &ends[1], NULL), NULL);
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){1}, &ends[2], NULL), NULL);
    for (int i = 0; i < 2; i++) {
        struct gd_flat_strip strip;
        check_ok(gd_pair_solve(mesh,
                               &(struct gd_pair_request){
                                   .from = &ends[0], .to = &ends[1], .output = GD_PAIR_PATH},
                               NULL, &there, NULL),
                 NULL);
        check_ok(gd_pair_solve(mesh,
                               &(struct gd_pair_request){
                                   .from = &ends[1], .to = &ends[2 * i], .output = GD_PAIR_PATH},
                               NULL, &back, NULL),
                 NULL);
        struct gd_path path = {there.path.length + back.path.length,
                               there.path.count + back.path.count, NULL};
        path.points = malloc(path.count * sizeof *path.points);
        memcpy(path.points, there.path.points, there.path.count * sizeof *path.points);
        memcpy(path.points + there.path.count, back.path.points,
               back.path.count * sizeof *path.points);
        check_ok(gd_flat_strip_of(mesh, &path, NULL, &strip), NULL);
        check_points(mesh, &path, &strip);
        check_faces(&strip, 1e-9);
        gd_flat_strip_free(&strip);
        gd_path_free(&path);
        gd_pair_answer_free(&there);
        gd_pair_answer_free(&back);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_where_the_surface_is_convex),
        cmocka_unit_test(lengths_are_kept_everywhere),
        cmocka_unit_test(paths_that_turn_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
