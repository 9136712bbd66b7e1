#include "gd/flat_strip.h"

#include <math.h>
#include <stdlib.h>

#include "line/strip.h"
#include "mesh/canonical.h"
#include "mesh/segment.h"

void gd_flat_strip_free(struct gd_flat_strip *strip)
{
    if (!strip) return;
    free(strip->faces);
    free(strip->points);
    *strip = (struct gd_flat_strip){0};
}

/* A similarity transform of the plane. It maps the path's beginning to the origin, and the path's
 * end to the x axis. */
struct turning {
    struct gd__local begin, along;
    double unit;
};

static struct turning turning_of(const struct gd_mesh *mesh, struct gd__local begin,
                                 struct gd__local end)
{
    struct gd__local way = {end.x - begin.x, end.y - begin.y};
    double length = hypot(way.x, way.y);
    struct gd__local along =
        length > 0 ? (struct gd__local){way.x / length, way.y / length} : (struct gd__local){1, 0};
    return (struct turning){begin, along, mesh->unit};
}

static void flat_strip_turn(const struct turning *turning, struct gd__local at, double out[2])
{
    struct gd__local from = {at.x - turning->begin.x, at.y - turning->begin.y},
                     along = turning->along;
    out[0] = turning->unit * (from.x * along.x + from.y * along.y);
    out[1] = turning->unit * (from.y * along.x - from.x * along.y);
}

/* A strip that is being unfolded. A portal is the unfolded edge by which the strip enters a face.
 * The portal of the first face is `entrance`. */
struct laying {
    const struct gd_mesh *mesh;
    const struct gd_path *path;
    const struct gd__strip *strip;
    struct gd__portal entrance;
};

static const struct gd__portal *gate_of(const struct laying *laying, uint32_t number)
{
    return number ? &laying->strip->portals[number - 1] : &laying->entrance;
}

static struct gd__local flat_strip_corner(const struct laying *laying, uint32_t number, int k)
{
    const struct gd__portal *portal = gate_of(laying, number);
    uint32_t face = laying->mesh->side_face[portal->side];
    struct gd_point point =
        gd__point_of_vertex(laying->mesh->origin[laying->mesh->face_side[face][k]]);
    return gd__portal_place(laying->mesh, portal, &point);
}

/* Advances *number to the next face of the strip that contains the point. The current face is kept
 * if it contains the point, because a path only leaves a face if its next point is not in that
 * face. */
static bool find_face(const struct laying *laying, const struct gd_point *point, uint32_t *number)
{
    for (; *number <= laying->strip->count; ++*number) {
        uint32_t face = laying->mesh->side_face[gate_of(laying, *number)->side];
        if (gd__face_contains(laying->mesh, face, point)) return true;
    }
    return false;
}

static enum gd_status lay_points(const struct laying *laying, const struct turning *turning,
                                 const struct gd_control *control, double (*out)[2])
{
    uint32_t number = 0;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < laying->path->count && !status; i++) {
        const struct gd_point *point = &laying->path->points[i];
        if (!find_face(laying, point, &number)) return GD_INTERNAL;
        flat_strip_turn(turning, gd__portal_place(laying->mesh, gate_of(laying, number), point),
                        out[i]);
        if (i % 1024 == 0) status = gd_control_check(control, 0.5 + 0.5 * i / laying->path->count);
    }
    return status;
}

static void lay_faces(const struct laying *laying, const struct turning *turning,
                      struct gd_flat_face *out)
{
    for (uint32_t i = 0; i <= laying->strip->count; i++)
        for (int k = 0; k < 3; k++)
            flat_strip_turn(turning, flat_strip_corner(laying, i, k), out[i].corners[k]);
}

static enum gd_status flat_strip_reserve(const struct laying *laying,
                                         const struct gd_control *control,
                                         struct gd_flat_strip *out)
{
    size_t faces = laying->strip->count + (size_t)1, points = laying->path->count;
    size_t bytes = faces * (sizeof *out->faces + sizeof *laying->strip->portals) +
                   points * sizeof *out->points;
    enum gd_status status = gd_control_afford(control, bytes);
    if (status) return status;
    out->faces = malloc(faces * sizeof *out->faces);
    out->points = malloc(points * sizeof *out->points);
    out->face_count = (uint32_t)faces;
    out->point_count = (uint32_t)points;
    return out->faces && out->points ? GD_OK : GD_NO_MEMORY;
}

static enum gd_status flat_strip_flatten(const struct gd_mesh *mesh, const struct gd_path *path,
                                         const struct gd__strip *strip,
                                         const struct gd_control *control,
                                         struct gd_flat_strip *out)
{
    const struct laying laying = {mesh, path, strip, gd__strip_entrance(mesh, strip)};
    const struct turning turning = turning_of(mesh, strip->begin, strip->end);
    struct gd_flat_strip flat = {0};
    enum gd_status status = flat_strip_reserve(&laying, control, &flat);
    if (!status) lay_faces(&laying, &turning, flat.faces);
    if (!status) status = lay_points(&laying, &turning, control, flat.points);
    if (status)
        gd_flat_strip_free(&flat);
    else
        *out = flat;
    return status;
}

/* Finds the strip of a path. A path of one point is treated as a path from the point to itself. */
static enum gd_status find_strip(const struct gd_mesh *mesh, const struct gd_path *path,
                                 const struct gd_control *control, struct gd__strip *strip)
{
    struct gd_point twice[2] = {path->points[0], path->points[0]};
    const struct gd__route route = {.points = path->count > 1 ? path->points : twice,
                                    .count = path->count > 1 ? path->count : 2};
    enum gd_status status = gd__strip_along(mesh, &route, strip, control);
    return status ? status : gd__strip_lay(mesh, strip);
}

enum gd_status gd_flat_strip_of(const struct gd_mesh *mesh, const struct gd_path *path,
                                const struct gd_control *control, struct gd_flat_strip *out)
{
    if (path->count == 0) return GD_INVALID_ARGUMENT;
    /* a path may turn back at any of its points */
    struct gd__strip strip = {.keeps_ways_back = true};
    enum gd_status status = find_strip(mesh, path, control, &strip);
    if (!status) status = flat_strip_flatten(mesh, path, &strip, control, out);
    gd__strip_free(&strip);
    return status;
}
