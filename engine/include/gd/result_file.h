/* Result files for other programs: distances of vertices, and lines, with or without the mesh.
 *
 *     struct gd_result result = {.mesh = &polygons, .distances = distances};
 *     enum gd_status status = gd_write_result(&result, GD_RESULT_PLY, &bytes, &size);
 *
 * PLY: the mesh, binary little-endian, in doubles, with a vertex property `distance` (NaN if there
 * is none). Lines are not written.
 *
 * OBJ: the mesh, if there is one, then the lines as `v` and `l` statements with exact doubles. The
 * lines of one level form a group, for example `g level_0.5`. Distances are not written.
 *
 * CSV: if there are lines, a row `line,point,x,y,z,along` for each point, where `along` is the
 * length of the line up to this point. If there are levels, there is another column `level`.
 * Without lines, there is a row `vertex,x,y,z,distance` for each vertex; its last cell is empty if
 * there is no distance. Rows end with CR LF (RFC 4180).
 *
 * GLB: mesh and lines in one scene. Positions are floats relative to an origin, as in gd/io.h.
 * Distances are stored twice. COLOR_0 is the colour that gd/colour_map.h gives to the distance as a
 * fraction of the largest one, or grey if there is no distance. _DISTANCE is the distance as a
 * float, or -1 if there is none. A line is a LINE_STRIP; the extras of its primitive contain its
 * level: {"level": 0.5}. With poses, the node `object` moves along the line in GD_RESULT_SECONDS at
 * constant speed: its animation has a translation and a rotation (a unit quaternion) for each pose,
 * interpolated linearly. As in any glTF model, the front of the object is its +Z axis and its top
 * is +Y: these axes become tangent and normal, and +X becomes normal x tangent, to the left. The
 * object itself consists of three lines: tangent red, normal blue, +X green. A layer is a node with
 * the layer's name, below the first node. Its mesh has one primitive, LINES or POINTS, and its
 * `label` and `labels` as extras. Layers without a segment or a mark are left out. */
#ifndef GD_RESULT_FILE_H
#define GD_RESULT_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "gd/colour_map.h"
#include "gd/polygons.h"
#include "gd/status.h"
#include "gd/vec.h"

GD_EXTERN_C_BEGIN

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

#define GD_RESULT_SECONDS 10 /* time in which the object moves from the first to the last pose */

/* The position and the orientation of an object that moves along a line. */
struct gd_pose {
    double along; /* length of the line up to this pose */
    struct gd_vec3 position;
    struct gd_vec3 tangent, normal; /* perpendicular unit vectors */
};

/* Lines or marks of one colour in a scene. Texts are printable ASCII. */
struct gd_result_layer {
    const double (*points)[3]; /* finite */
    /* For lines: count + 1 ascending offsets into `points`. NULL means that the points are
       marks. */
    const uint32_t *first;
    uint32_t count; /* number of lines or marks */
    struct gd_colour colour;
    const char *name;  /* name of the node */
    const char *label; /* the extra `label`; NULL if there is none */
    /* The extra `labels`: one label for each mark, or NULL for a mark without a label. The array is
       NULL if no mark has a label. */
    const char *const *labels;
};

/* All borrowed; missing parts are NULL or 0. */
struct gd_result {
    const struct gd_polygons *mesh; /* triangles with finite coordinates */
    /* one for each position of the mesh; a value that is not finite means that there is no
       distance */
    const double *distances;
    /* points of all lines, line after line; the coordinates must be finite */
    const double (*points)[3];
    /* line_count + 1 offsets into `points`; a line has at least one point */
    const uint32_t *first;
    uint32_t line_count;
    /* for isolines, the level of each line, which must be finite; lines of one level must be
       consecutive */
    const double *levels;
    /* For a moving object: poses on the line, in ascending order of `along`. If the times of
       several poses are equal when rounded to floats, only the first of these poses is written. If
       the line has the length 0, no object is written. */
    const struct gd_pose *poses;
    uint32_t pose_count;
    /* layers of a scene; only GLB files have them */
    const struct gd_result_layer *layers;
    uint32_t layer_count;
    const struct gd_colour *colour; /* for a mesh without distances; NULL means white */
};

/* Writes a result. `*out` is allocated by malloc and owned by the caller. Errors:
 * GD_INVALID_ARGUMENT (the format cannot represent the result: PLY without mesh, OBJ without lines,
 * distances without mesh), GD_NOT_TRIANGLES, GD_EXTENT (GLB: too large or too small for floats),
 * GD_TOO_LARGE (GLB: 4 GiB), GD_NO_MEMORY. Time linear in the output. Thread-safe. */
GD_MUST_USE enum gd_status gd_write_result(const struct gd_result *result,
                                           enum gd_result_format format, char **out, size_t *size);

/* Returns an upper bound of the bytes that are needed to write a result, including the output. */
size_t gd_result_cost(const struct gd_result *result);

GD_EXTERN_C_END

#endif
