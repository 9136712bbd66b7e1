/* Result files: what was found on a surface, for other programs: distances of vertices, and lines,
 * with the mesh or without it.
 *
 *     struct gd_result result = {.mesh = &polygons, .distances = distances};
 *     enum gd_status status = gd_write_result(&result, GD_RESULT_PLY, &bytes, &size);
 *
 * PLY: the mesh, binary little-endian, all in doubles, and `distance` as another property of its
 * vertices (NaN: there is none). Lines are left out. OBJ: the lines, as `v` and `l` statements,
 * doubles to the last digit; behind the mesh if there is one; those of a level in a group `g
 * level_0.5`. Distances are left out. CSV: of lines a row `line,point,x,y,z,along` for each point,
 * `along` being the length of the line up to there, and behind it `level` if they have such; else a
 * row `vertex,x,y,z,distance` for each vertex, the last cell empty where there is no distance. Rows
 * end with CR LF (RFC 4180). GLB: mesh and lines in one scene, in floats from an origin that the
 * node's translation keeps as doubles (gd/io.h). Distances are both COLOR_0, by gd/colour_map.h
 * with the largest distance at its end (grey: there is none), and _DISTANCE, in floats (-1: there
 * is none). A line is a LINE_STRIP, whose level is in its primitive's extras: {"level": 0.5}. */
#ifndef GD_RESULT_FILE_H
#define GD_RESULT_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "gd/polygons.h"
#include "gd/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* X(NAME, name = spelling in ?format=, media type) */
#define GD_RESULT_FORMAT_MAP(X)                                                                    \
    X(PLY, ply, "application/x-ply")                                                               \
    X(OBJ, obj, "model/obj")                                                                       \
    X(CSV, csv, "text/csv")                                                                        \
    X(GLB, glb, "model/gltf-binary")

enum gd_result_format {
#define GD_RESULT_ENUM(NAME, name, media) GD_RESULT_##NAME,
    GD_RESULT_FORMAT_MAP(GD_RESULT_ENUM)
#undef GD_RESULT_ENUM
};

/* All borrowed; what there is not is NULL or 0. */
struct gd_result {
    const struct gd_polygons *mesh; /* triangles, whose coordinates are finite */
    const double *distances;        /* one for each of its positions; not finite: there is none */
    const double (*points)[3];      /* of the lines, one line after the other; finite */
    /* line_count + 1 offsets into `points`; a line has at least one point */
    const uint32_t *first;
    uint32_t line_count;
    /* of isolines: the distance that each line lies at, finite; lines of a level stand together */
    const double *levels;
};

/* Writes a result. `*out` is malloc'ed and owned by the caller. Thread-safe; time linear in the
 * output.
 * Errors: GD_INVALID_ARGUMENT (nothing that the format can hold: PLY without mesh, OBJ without
 * lines, distances without mesh), GD_NOT_TRIANGLES, GD_NON_FINITE (GLB: beyond the range of
 * floats), GD_TOO_LARGE (GLB: 4 GiB), GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd_write_result(const struct gd_result *result,
                                           enum gd_result_format format, char **out, size_t *size);

/* Upper bound of the bytes that writing takes, the result included. */
size_t gd_result_cost(const struct gd_result *result);

#ifdef __cplusplus
}
#endif

#endif
