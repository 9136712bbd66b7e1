#include "field/isoline_parts.h"
#include "gd/isoline.h"

#include <stdlib.h>

/* Approximates an isoline's arcs by chords. */

enum { SEGMENTS_MOST = 1024 /* segments of an arc */, STEPS_A_POINT = 4 };

/* Returns the number of equal segments for which the arc rises above each chord by at most the
 * tolerance: radius (1 - cos(step / 2)) = 2 radius sin^2(step / 4). */
static uint32_t segments_of(const struct gd_isoline_arc *arc, double tolerance)
{
    if (arc->radius == 0) return 1;
    double extent = fabs(arc->to - arc->from), rise = tolerance / (2 * arc->radius);
    double step = rise < 1 ? 4 * asin(sqrt(rise)) : 2 * M_PI;
    /* at most a quarter turn each, so that a circle looks like a circle */
    double segments = ceil(extent / fmin(step, M_PI_2));
    return segments < 1 ? 1 : segments < SEGMENTS_MOST ? (uint32_t)segments : SEGMENTS_MOST;
}

/* Appends the points of an arc between its ends; returns the length of its chords. */
static void append_arc(const struct gd_mesh *mesh, const struct gd_isoline_arc *arc,
                       uint32_t segments, struct gd_path *path)
{
    uint32_t face = mesh->face_of_index[arc->face.index];
    struct gd__face_frame frame = gd__face_frame_of(mesh, face);
    double step = (arc->to - arc->from) / segments;
    for (uint32_t i = 1; i < segments; i++) {
        double angle = arc->from + i * step;
        struct gd__local at = {(arc->u + arc->radius * cos(angle)) / mesh->unit,
                               (arc->v + arc->radius * sin(angle)) / mesh->unit};
        path->points[path->count++] = gd__face_frame_point(mesh, face, &frame, at);
    }
    path->length +=
        arc->radius > 0 ? segments * 2 * arc->radius * fabs(sin(0.5 * step)) : fabs(step);
}

static enum gd_status append_line(const struct gd_mesh *mesh, const struct gd_isoline_line *line,
                                  double tolerance, struct gd__pace *pace, struct gd_path *path)
{
    enum gd_status status = gd__pace_step(pace, GD__PACE_STEPS);
    for (uint32_t i = 0; i < line->arc_count && !status; i++) {
        uint32_t segments = segments_of(&line->arcs[i], tolerance);
        path->points[path->count++] = line->points[i];
        append_arc(mesh, &line->arcs[i], segments, path);
        pace->fraction = (double)i / line->arc_count;
        status = gd__pace_step(pace, STEPS_A_POINT * segments);
    }
    path->points[path->count++] = line->points[line->closed ? 0 : line->arc_count];
    return status;
}

uint64_t gd_isoline_flat_points(const struct gd_isoline_line *line, double tolerance)
{
    uint64_t count = 1;
    for (uint32_t i = 0; i < line->arc_count; i++) count += segments_of(&line->arcs[i], tolerance);
    return count;
}

enum gd_status gd_isoline_flatten(const struct gd_mesh *mesh, const struct gd_isoline_line *line,
                                  double tolerance, const struct gd_control *control,
                                  struct gd_path *out)
{
    if (!(tolerance > 0)) return GD_INVALID_ARGUMENT;
    uint64_t count = gd_isoline_flat_points(line, tolerance);
    struct gd_path path = {0};
    struct gd__pace pace = {.control = control, .held = count * sizeof *path.points};
    if (count > UINT32_MAX) return GD_NO_MEMORY;
    path.points = malloc(pace.held);
    if (!path.points) return GD_NO_MEMORY;
    enum gd_status status = append_line(mesh, line, tolerance, &pace, &path);
    if (status)
        gd_path_free(&path);
    else
        *out = path;
    return status;
}
