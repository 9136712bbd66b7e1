/* Helpers of the tests of isolines. They trace an isoline and check the properties of every
 * line. */
#pragma once

#include <math.h>
#include <stdlib.h>

#include "gd/isoline.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"
#include "tests/support/test.h"

static const double promise = 1e-9;

static inline double total_length(const struct gd_isoline *isoline)
{
    double length = 0;
    for (uint32_t i = 0; i < isoline->line_count; i++) length += isoline->lines[i].length;
    return length;
}

static inline struct gd_vec3 arc_place(const struct gd_mesh *mesh, const struct gd_isoline_arc *arc,
                                       double angle)
{
    struct gd_vec3 x, y;
    gd_isoline_arc_axes(mesh, arc, &x, &y);
    return gd_vec3_along(gd_vec3_along(arc->centre, arc->radius * cos(angle), x),
                         arc->radius * sin(angle), y);
}

/* Returns the difference of the point's distance and the level, relative to the level. */
static inline double misfit(const struct gd_field *field, const struct gd_point *point,
                            double level)
{
    double distance;
    check_ok(gd_field_distance(field, point, &distance), NULL);
    return fabs(distance - level) / level;
}

/* Returns the point of the face halfway between two positions in the face. */
static inline struct gd_point halfway(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 a,
                                      struct gd_vec3 b)
{
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){face}, corners);
    struct gd_vec3 o = gd_mesh_position(mesh, corners[0]),
                   e = gd_vec3_sub(gd_mesh_position(mesh, corners[1]), o),
                   f = gd_vec3_sub(gd_mesh_position(mesh, corners[2]), o), n = gd_vec3_cross(e, f),
                   p = gd_vec3_scale(gd_vec3_add(gd_vec3_sub(a, o), gd_vec3_sub(b, o)), 0.5);
    double v = gd_vec3_dot(gd_vec3_cross(p, f), n) / gd_vec3_dot(n, n),
           w = gd_vec3_dot(gd_vec3_cross(e, p), n) / gd_vec3_dot(n, n);
    v = fmin(fmax(v, 0), 1);
    w = fmin(fmax(w, 0), 1 - v);
    return test_point(mesh, (struct test_place){face, {1 - v - w, v, w}});
}

/* Checks the line's length, and that arcs begin and end in points of the line. Returns the largest
 * misfit of the line's points and of points on its arcs. */
static inline double check_line(const struct gd_field *field, const struct gd_isoline_line *line,
                                double level)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    double worst = 0, length = 0;
    assert_int_equal(line->point_count, line->arc_count + !line->closed);
    for (uint32_t i = 0; i < line->point_count; i++)
        worst = fmax(worst, misfit(field, &line->points[i], level));
    for (uint32_t i = 0; i < line->arc_count; i++) {
        const struct gd_isoline_arc *arc = &line->arcs[i];
        uint32_t next = i + 1 < line->point_count ? i + 1 : 0;
        struct gd_vec3 start = gd_point_position(mesh, &line->points[i]),
                       stop = gd_point_position(mesh, &line->points[next]);
        double scale = level + arc->radius + gd_vec3_length(start);
        assert_true(gd_vec3_distance(arc_place(mesh, arc, arc->from), start) < promise * scale);
        length += gd_isoline_arc_length(arc);
        if (arc->radius > 0) {
            assert_true(gd_vec3_distance(arc_place(mesh, arc, arc->to), stop) < promise * scale);
            continue;
        }
        assert_true(fabs(gd_vec3_distance(start, stop) - fabs(arc->to)) <
                    promise * (scale + arc->to));
        struct gd_point middle = halfway(mesh, arc->face.index, start, stop);
        worst = fmax(worst, misfit(field, &middle, level));
    }
    check_close(line->length, length, 1e-12);
    struct gd_path path;
    check_ok(gd_isoline_flatten(mesh, line, 1e-3 * level, NULL, &path), NULL);
    assert_true(path.count >= line->arc_count + 1);
    assert_int_equal(path.count, gd_isoline_flat_points(line, 1e-3 * level));
    assert_true(path.length <= line->length * (1 + promise));
    assert_true(gd_point_equal(&path.points[0], &line->points[0]));
    for (uint32_t i = 0; i < path.count; i++)
        worst = fmax(worst, misfit(field, &path.points[i], level));
    gd_path_free(&path);
    return worst;
}

static inline double check_isoline(const struct gd_field *field, const struct gd_isoline *isoline)
{
    double worst = 0;
    for (uint32_t i = 0; i < isoline->line_count; i++)
        worst = fmax(worst, check_line(field, &isoline->lines[i], isoline->level));
    if (!(worst <= promise)) print_error("level %.17g: off by %.3g\n", isoline->level, worst);
    assert_true(worst <= promise);
    return worst;
}

static inline struct gd_isoline trace(const struct gd_field *field, double level)
{
    struct gd_isoline isoline;
    check_ok(gd_isoline_trace(field, level, NULL, &isoline), NULL);
    check_isoline(field, &isoline);
    return isoline;
}
