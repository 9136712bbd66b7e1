/* Mesh files: bytes in memory -> indexed polygons, and back.
 *
 *     struct gd_polygons polygons;
 *     enum gd_status status =
 *         gd_read_polygons(bytes, size, &options, &polygons, &detail);
 *
 * The readers are bounded: memory is at most ten times `size` and a few KiB, every count that a
 * header declares is checked against the length of the input before anything is allocated for it,
 * every index is checked, nothing is opened, nothing is recursive. Coordinates keep double
 * precision. Only positions and faces are read; the rest of a file (normals, colours, materials) is
 * skipped.
 *
 * OBJ: v and f statements, one-based and relative indices. PLY 1.0: text and binary of either byte
 * order, no triangle strips. STL: text and binary, equal corners welded into vertices in order of
 * first appearance. OFF: text, with or without colours, normals and texture coordinates. JSON:
 * {"vertices": [[x,y,z]...], "faces": [[i,j,k...]...]}, no other keys.
 *
 * glTF 2.0, as GLB or as JSON whose buffers are base64 data: URIs: the triangles, strips and fans
 * of the scene's meshes (of the default scene, else the first; without scenes all root nodes;
 * without nodes all meshes), placed by their nodes; points and lines are left out. Positions are
 * floats, or whole numbers (KHR_mesh_quantization), sparse or not, and are turned in double
 * precision; a place that mirrors turns the faces round. glTF repeats a vertex wherever normals or
 * texture coordinates differ, so equal positions are welded, as in STL: vertices are numbered in
 * order of first appearance. Meshes are taken in their bind pose, without morphing. Files that are
 * compressed (Draco, meshopt) or have their bytes elsewhere are refused. A file may use its bytes
 * many times, so its memory is what gd_read_cost says. */
#ifndef GD_IO_H
#define GD_IO_H

#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/polygons.h"
#include "gd/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* X(NAME, name = spelling in ?format=, media type) */
#define GD_FORMAT_MAP(X)                                                                           \
    X(OBJ, obj, "model/obj")                                                                       \
    X(PLY, ply, "application/x-ply")                                                               \
    X(STL, stl, "model/stl")                                                                       \
    X(OFF, off, "text/x-off")                                                                      \
    X(JSON, json, "application/json")                                                              \
    X(GLB, glb, "model/gltf-binary")                                                               \
    X(GLTF, gltf, "model/gltf+json")

enum gd_format {
    GD_FORMAT_ANY, /* recognise the bytes */
#define GD_FORMAT_ENUM(NAME, name, media) GD_FORMAT_##NAME,
    GD_FORMAT_MAP(GD_FORMAT_ENUM)
#undef GD_FORMAT_ENUM
};

/* Format by its name ("obj") or media type ("model/obj", parameters ignored, case-insensitive);
 * GD_FORMAT_ANY when unknown. */
enum gd_format gd_format_by_name(const char *name);
enum gd_format gd_format_by_media_type(const char *media_type);

/* GD_FORMAT_ANY is "any" and "application/octet-stream". */
const char *gd_format_name(enum gd_format format);
const char *gd_format_media_type(enum gd_format format);

/* The format that the bytes are in, told from content and size alone; GD_FORMAT_ANY when none fits.
 * Reads no further than the first word behind leading space and comments, which has to be in the
 * first MiB. */
enum gd_format gd_format_recognise(const void *bytes, size_t size);

/* All zero: the format is recognised, and the limits are 2^30. */
struct gd_read_options {
    enum gd_format format;
    /* triangles after triangulation (a polygon of n corners counts n - 2); 0, or more than 2^30:
       2^30 */
    uint32_t max_faces;
    uint32_t max_vertices; /* 0, or more than 2^30: 2^30 */
    /* borrowed for the call, NULL: none; its budget is not looked at */
    const struct gd_control *control;
};

/* Bytes that gd_read_polygons holds at most for that input, its result included: eight for each of
 * the file's, and of glTF as many as the file's meshes take wherever they are placed
 * (options->max_vertices counts, faces beyond options->max_faces don't: they are refused). Reads a
 * glTF's document; what is wrong with it is for gd_read_polygons to say. Thread-safe. */
size_t gd_read_cost(const void *bytes, size_t size, const struct gd_read_options *options);

/* Reads a mesh file. `bytes` are borrowed for the call, `options` and `detail` may be NULL;
 * the caller frees `*out` by gd_polygons_free. Thread-safe; time linear in `size` (STL: expected
 * linear, a hash welds equal corners). Errors: GD_UNRECOGNIZED, GD_TRUNCATED, GD_SYNTAX,
 * GD_UNSUPPORTED, GD_INDEX, GD_NON_FINITE, GD_EMPTY (no faces, or no bytes at all), GD_TOO_LARGE,
 * GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. The detail names the line; the byte in binary files and
 * in JSON, which is often one long line (of a glTF's numbers the byte of what describes them). A
 * face may still repeat a vertex: that is for the mesh builder to refuse by name. */
GD_MUST_USE enum gd_status gd_read_polygons(const void *bytes, size_t size,
                                            const struct gd_read_options *options,
                                            struct gd_polygons *out, struct gd_detail *detail);

/* Writes polygons, whose coordinates are finite, as OBJ, OFF or JSON text (doubles shortest
 * round-trip), PLY (binary little-endian, doubles), STL (binary, floats), GLB or glTF (floats, from
 * an origin that the node's translation keeps as doubles: a mesh far from the origin loses no more
 * than one that is near; coordinates that are floats already stay as they are). `*out` is malloc'ed
 * and owned by the caller. Thread-safe; time linear in the output. Read again, all but STL, GLB and
 * glTF give the same positions to the last bit and the same polygons. Errors: GD_NOT_TRIANGLES
 * (STL, GLB, glTF: a polygon of more than three corners), GD_NON_FINITE (the same: beyond the range
 * of floats), GD_TOO_LARGE (GLB: 4 GiB), GD_INVALID_ARGUMENT (GD_FORMAT_ANY), GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd_write_polygons(const struct gd_polygons *polygons,
                                             enum gd_format format, char **out, size_t *size);

/* The same, until a deadline or a cancel of `control` (NULL: none; its budget is not looked at).
 * Errors besides: GD_DEADLINE, GD_CANCELLED. */
GD_MUST_USE enum gd_status gd_write_polygons_within(const struct gd_polygons *polygons,
                                                    enum gd_format format,
                                                    const struct gd_control *control, char **out,
                                                    size_t *size);

#ifdef __cplusplus
}
#endif

#endif
