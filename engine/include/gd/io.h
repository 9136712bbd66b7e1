/* Mesh files: bytes in memory -> indexed polygons, and back.
 *
 *     struct gd_polygons polygons;
 *     enum gd_status status = gd_read_polygons(bytes, size, GD_FORMAT_ANY, &limits, &polygons, &detail);
 *
 * The readers are bounded: memory is at most ten times `size` and a few KiB, every count that a header declares is checked against the
 * length of the input before anything is allocated for it, every index is checked, nothing is opened, nothing is recursive. Coordinates
 * keep double precision. Only positions and faces are read; the rest of a file (normals, colours, materials) is skipped.
 *
 * OBJ: v and f statements, one-based and relative indices. PLY 1.0: text and binary of either byte order, no triangle strips. STL: text and
 * binary, equal corners welded into vertices in order of first appearance. OFF: text, with or without colours, normals and texture
 * coordinates. JSON: {"vertices": [[x,y,z]...], "faces": [[i,j,k...]...]}, no other keys. */
#ifndef GD_IO_H
#define GD_IO_H

#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/polygons.h"
#include "gd/status.h"

/* X(NAME, name = spelling in ?format=, media type) */
#define GD_FORMAT_MAP(X)                                                                                               \
    X(OBJ, obj, "model/obj")                                                                                           \
    X(PLY, ply, "application/x-ply")                                                                                   \
    X(STL, stl, "model/stl")                                                                                           \
    X(OFF, off, "text/x-off")                                                                                          \
    X(JSON, json, "application/json")

enum gd_format {
    GD_FORMAT_ANY, /* recognise the bytes */
#define GD_FORMAT_ENUM(NAME, name, media) GD_FORMAT_##NAME,
    GD_FORMAT_MAP(GD_FORMAT_ENUM)
#undef GD_FORMAT_ENUM
};

/* Format by its name ("obj") or media type ("model/obj", parameters ignored, case-insensitive); GD_FORMAT_ANY when unknown. */
enum gd_format gd_format_by_name(const char *name);
enum gd_format gd_format_by_media_type(const char *media_type);

/* GD_FORMAT_ANY is "any" and "application/octet-stream". */
const char *gd_format_name(enum gd_format format);
const char *gd_format_media_type(enum gd_format format);

/* The format that the bytes are in, told from content and size alone; GD_FORMAT_ANY when none fits. Reads no further than the
 * first word behind leading space and comments. */
enum gd_format gd_format_recognise(const void *bytes, size_t size);

struct gd_read_limits {
    uint32_t
        max_faces; /* triangles after triangulation (a polygon of n corners counts n - 2); 0, or more than 2^30: 2^30 */
    uint32_t max_vertices;            /* 0, or more than 2^30: 2^30 */
    const struct gd_control *control; /* borrowed for the call, NULL: none; its budget is not looked at */
};

/* Reads a mesh file. `bytes` are borrowed for the call, `limits` may be NULL, `detail` may be NULL; the caller frees `*out` by
 * gd_polygons_free. Thread-safe; time linear in `size` (STL: expected linear, a hash welds equal corners).
 * Errors: GD_UNRECOGNIZED, GD_TRUNCATED, GD_SYNTAX, GD_UNSUPPORTED, GD_INDEX, GD_NON_FINITE, GD_EMPTY (no faces, or no bytes at all),
 * GD_TOO_LARGE, GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. The detail names the line; the byte in binary files and in JSON, which is often one long line. A face may
 * still repeat a vertex: that is for the mesh builder to refuse by name. */
GD_MUST_USE enum gd_status gd_read_polygons(const void *bytes, size_t size, enum gd_format format,
                                            const struct gd_read_limits *limits, struct gd_polygons *out,
                                            struct gd_detail *detail);

/* Writes polygons, whose coordinates are finite, as OBJ, OFF or JSON text (doubles shortest round-trip), PLY (binary little-endian,
 * doubles) or STL (binary, floats). `*out` is malloc'ed and owned by the caller. Thread-safe; time linear in the output. Read again, all but STL
 * give the same positions to the last bit and the same polygons.
 * Errors: GD_NOT_TRIANGLES (STL: a polygon of more than three corners), GD_NON_FINITE (STL: beyond the range of floats),
 * GD_INVALID_ARGUMENT (GD_FORMAT_ANY), GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd_write_polygons(const struct gd_polygons *polygons, enum gd_format format, char **out,
                                             size_t *size);

#endif
