/* Mesh files: reads mesh files in memory as indexed polygons, and writes polygons as mesh files.
 *
 *     struct gd_polygons polygons;
 *     enum gd_status status =
 *         gd_read_polygons(bytes, size, &options, &polygons, &detail);
 *
 * The readers use bounded memory: for most formats at most ten times `size` and a few KiB
 * (gd_read_cost). Counts in headers are checked against the length of the input before memory is
 * allocated. Every index is checked. No files are opened; no parser is recursive. Coordinates keep
 * double precision. Only positions and faces are read; the rest of a file (normals, colours,
 * materials) is skipped.
 *
 * OBJ: v and f statements, one-based and relative indices. PLY 1.0: text and binary of either byte
 * order, faces and triangle strips. STL: text and binary, equal corners welded into vertices in
 * order of first appearance. OFF: text, with or without colours, normals and texture coordinates.
 * JSON: {"vertices": [[x,y,z]...], "faces": [[i,j,k...]...]}, no other keys. Text formats except
 * PLY may be UTF-16 with a byte order mark. Positions in error texts are then those in the text
 * converted to UTF-8.
 *
 * 3MF: the objects of the build section with their components, which may be in other model parts.
 * Objects that touch stay separate. Lengths are in the unit of the package. Supports, colours,
 * beams and slices are skipped. Files with document types, with encrypted parts, or with parts that
 * are more than 256 times as large as the package are rejected.
 *
 * glTF 2.0, as GLB or as JSON whose buffers are base64 data: URIs: the triangles, strips and fans
 * of the meshes of the default scene, transformed by their nodes. Without a default scene, the
 * first scene is read. Without scenes, all root nodes are read. Without nodes, all meshes are read.
 * Points and lines are skipped. Positions are floats or integers (KHR_mesh_quantization), sparse or
 * not, and are transformed in double precision. A mirroring transform reverses the faces. glTF
 * repeats a vertex wherever normals or texture coordinates differ, so equal positions are welded as
 * in STL. Meshes are read in their bind pose, without morphing. Files that are compressed (Draco,
 * meshopt) or refer to external bytes are rejected. A file may use the same bytes many times, so
 * its meshes can be much larger than the file; gd_read_cost returns a bound. */
#ifndef GD_IO_H
#define GD_IO_H

#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/polygons.h"
#include "gd/status.h"

GD_EXTERN_C_BEGIN

/* X(NAME, name = spelling in ?format=, media type) */
#define GD_FORMAT_MAP(X)                                                                           \
    GD_WRITTEN_FORMAT_MAP(X)                                                                       \
    X(3MF, 3mf, "model/3mf")

/* The formats that gd_write_polygons writes. */
#define GD_WRITTEN_FORMAT_MAP(X)                                                                   \
    X(OBJ, obj, "model/obj")                                                                       \
    X(PLY, ply, "application/x-ply")                                                               \
    X(STL, stl, "model/stl")                                                                       \
    X(OFF, off, "text/x-off")                                                                      \
    X(JSON, json, "application/json")                                                              \
    X(GLB, glb, "model/gltf-binary")                                                               \
    X(GLTF, gltf, "model/gltf+json")

enum gd_format {
    GD_FORMAT_ANY, /* the format is recognised from the bytes */
#define GD_FORMAT_ENUM(NAME, name, media) GD_FORMAT_##NAME,
    GD_FORMAT_MAP(GD_FORMAT_ENUM)
#undef GD_FORMAT_ENUM
};

/* Return the format with a name ("obj") or a media type ("model/obj"; case and parameters are
 * ignored). Return GD_FORMAT_ANY if it is unknown. */
enum gd_format gd_format_by_name(const char *name);
enum gd_format gd_format_by_media_type(const char *media_type);

/* Return the name and the media type of a format; for GD_FORMAT_ANY, "any" and
 * "application/octet-stream". */
const char *gd_format_name(enum gd_format format);
const char *gd_format_media_type(enum gd_format format);

/* Recognises the format only from the content and the size. Returns GD_FORMAT_ANY if no format
 * fits. In a text, reads only the leading space and comments and the first word, and nothing after
 * the first MiB. Thread-safe. */
enum gd_format gd_format_recognise(const void *bytes, size_t size);

/* If all members are zero, the format is recognised, and the limits are 2^30. */
struct gd_read_options {
    enum gd_format format;
    /* largest number of triangles, where a polygon of n corners counts as n - 2 triangles; 0 or a
       value above 2^30 means 2^30 */
    uint32_t max_faces;
    uint32_t max_vertices; /* 0 or a value above 2^30 means 2^30 */
    /* borrowed for the call; may be NULL; its budget is ignored */
    const struct gd_control *control;
    /* Owned by the caller; may be NULL. Receives the lines (in binary files, the bytes) of skipped
       elements: faces with fewer than three corners, excess values in a record of PLY text, unknown
       lines of a PLY header, corners of a glTF primitive after its last whole triangle. If NULL,
       such elements are errors. */
    struct gd_mended *skipped;
};

/* Returns an upper bound of the bytes that gd_read_polygons holds for an input, including the
 * result: eight bytes for each byte of the file, or 32 for PLY with triangle strips. For glTF and
 * 3MF, the bound depends on the sizes of the transformed meshes, which options->max_vertices and
 * options->max_faces limit. To compute it, the function parses the JSON document of a glTF, or a
 * whole 3MF. It does not report errors in them; gd_read_polygons does. Thread-safe. */
size_t gd_read_cost(const void *bytes, size_t size, const struct gd_read_options *options);

/* Reads a mesh file. `bytes` are borrowed for the call. `options` and `detail` may be NULL. The
 * caller frees `*out` by gd_polygons_free. Errors: GD_UNRECOGNIZED, GD_TRUNCATED, GD_SYNTAX,
 * GD_UNSUPPORTED, GD_INDEX, GD_NON_FINITE, GD_EMPTY (no faces, or no bytes), GD_TOO_LARGE,
 * GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. The detail names the line of the error; in binary files
 * and in JSON, it names the byte. For an error in the numbers of a glTF, it names the byte of their
 * accessor. The result may contain faces that repeat a vertex, which gd_mesh_build rejects. Time:
 * linear in `size`. For STL it is expected linear, because a hash table welds equal corners.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_read_polygons(const void *bytes, size_t size,
                                            const struct gd_read_options *options,
                                            struct gd_polygons *out, struct gd_detail *detail);

/* Writes polygons with finite coordinates as OBJ, OFF or JSON text (shortest decimals that read
 * back the same doubles), PLY (binary little-endian, doubles), STL (binary, floats), GLB or glTF
 * (floats). GLB and glTF store positions relative to an origin, which is the node's translation, in
 * doubles. So a mesh far from (0, 0, 0) loses no precision, and coordinates that are floats stay
 * exact. `*out` is allocated by malloc and owned by the caller. All formats except STL, GLB and
 * glTF read back as the same polygons, with positions equal to the last bit. Errors:
 * GD_NOT_TRIANGLES (STL, GLB, glTF: a polygon of more than three corners), GD_EXTENT (STL, GLB,
 * glTF: coordinates too large or too small for floats), GD_TOO_LARGE (GLB: more than 4 GiB),
 * GD_INVALID_ARGUMENT (GD_FORMAT_ANY), GD_NO_MEMORY. Time: linear in the output. Thread-safe. */
GD_MUST_USE enum gd_status gd_write_polygons(const struct gd_polygons *polygons,
                                             enum gd_format format, char **out, size_t *size);

/* Like gd_write_polygons, but respects the deadline and the cancellation of `control`, which may be
 * NULL. Its budget is ignored. Additional errors: GD_DEADLINE, GD_CANCELLED. */
GD_MUST_USE enum gd_status gd_write_polygons_within(const struct gd_polygons *polygons,
                                                    enum gd_format format,
                                                    const struct gd_control *control, char **out,
                                                    size_t *size);

GD_EXTERN_C_END

#endif
