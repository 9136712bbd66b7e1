#include "field/frame.h"
#include "gd/isoline.h"

#include <stdlib.h>

/* An isoline's arcs as chords. */

enum { SEGMENTS_MOST = 1024 /* of an arc */ };

/* Segments whose arcs rise no higher above their chords than the tolerance: radius (1 - cos(step / 2)) = 2 radius sin^2(step / 4). */
static uint32_t segments_of(const struct gd_isoline_arc *arc, double tolerance)
{
    double extent = fabs(arc->to - arc->from), rise = tolerance / (2 * arc->radius);
    double step = rise < 1 ? 4 * asin(sqrt(rise)) : 2 * M_PI;
    double segments = ceil(extent / fmin(step, M_PI_2)); /* a circle keeps its shape */
    return segments < 1 ? 1 : segments < SEGMENTS_MOST ? (uint32_t)segments : SEGMENTS_MOST;
}

/* Appends the points of an arc behind its start, and the length of its chords. */
static void append_arc(const struct gd_mesh *mesh, const struct gd_isoline_arc *arc, uint32_t segments,
                       struct gd_path *path)
{
    uint32_t face = mesh->face_of_index[arc->face.index];
    struct gd__frame frame = gd__frame_of_face(mesh, face);
    double step = (arc->to - arc->from) / segments;
    for (uint32_t i = 1; i < segments; i++) {
        double angle = arc->from + i * step;
        struct gd__local at = {(arc->u + arc->radius * cos(angle)) / mesh->unit,
                               (arc->v + arc->radius * sin(angle)) / mesh->unit};
        path->points[path->count++] = gd__frame_point(mesh, face, &frame, at);
    }
    path->length += segments * 2 * arc->radius * fabs(sin(0.5 * step));
}

enum gd_status gd_isoline_flatten(const struct gd_mesh *mesh, const struct gd_isoline_line *line, double tolerance,
                                  struct gd_path *out)
{
    if (!(tolerance > 0)) return GD_INVALID_ARGUMENT;
    size_t count = 1;
    for (uint32_t i = 0; i < line->arc_count; i++) count += segments_of(&line->arcs[i], tolerance);
    struct gd_path path = {.points = malloc(sizeof *path.points * count)};
    if (!path.points || count > UINT32_MAX) {
        gd_path_free(&path);
        return GD_NO_MEMORY;
    }
    for (uint32_t i = 0; i < line->arc_count; i++) {
        path.points[path.count++] = line->points[i];
        append_arc(mesh, &line->arcs[i], segments_of(&line->arcs[i], tolerance), &path);
    }
    path.points[path.count++] = line->points[line->closed ? 0 : line->arc_count];
    *out = path;
    return GD_OK;
}
