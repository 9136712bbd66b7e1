/* Control mesh: polygons with the tags of a subdivision surface, before anyone asked whether it can
 * be subdivided. io reads them, subdiv builds from them. */
#ifndef GD_CONTROL_MESH_H
#define GD_CONTROL_MESH_H

#include "gd/io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* From this sharpness on a tag is infinitely sharp, as in OpenSubdiv and USD. */
#define GD_SHARPNESS_INFINITE 10.0

struct gd_crease {
    uint32_t vertices[2]; /* the ends of an edge */
    double sharpness;     /* >= 0; 0: none; from GD_SHARPNESS_INFINITE on: for ever */
};

struct gd_corner {
    uint32_t vertex;
    double sharpness; /* as a crease's */
};

/* What the limit surface does at the boundary of the mesh; the names are USD's. Boundary edges are
 * infinitely sharp creases. */
enum gd_interpolate_boundary {
    GD_INTERPOLATE_EDGE_AND_CORNER, /* vertices of one face are corners */
    GD_INTERPOLATE_EDGE_ONLY,       /* the boundary curve is smooth there too */
    /* no surface next to the boundary: taken only where there is no boundary */
    GD_INTERPOLATE_NONE
};

struct gd_control_mesh {
    struct gd_polygons polygons;
    struct gd_crease *creases; /* NULL: none */
    struct gd_corner *corners; /* NULL: none */
    uint32_t crease_count, corner_count;
    enum gd_interpolate_boundary boundary;
};

/* Frees the arrays and zeroes the struct. NULL and half-built ones are harmless. */
void gd_control_mesh_free(struct gd_control_mesh *mesh);

/* Reads a mesh file as gd_read_polygons does and, in OBJ, the tags that OpenSubdiv writes behind
 * it: `t crease N/M/0 v0 v1 ... s ...` (a chain of N vertices, one sharpness for all of it or one
 * an edge), `t corner N/M/0 v ... s ...`, `t interpolateboundary 1/0/0 i` (0 none, 1 edge and
 * corner, 2 edge only). Vertices of tags are counted from zero, although those of faces are counted
 * from one. Tags that concern texture coordinates are skipped. `options` and `detail` may be NULL;
 * the caller frees `*out`. Thread-safe; time and memory as gd_read_polygons. Errors: those of
 * gd_read_polygons; GD_UNSUPPORTED (any other tag, such as holes), GD_SYNTAX, GD_INDEX. That a
 * crease is an edge and its sharpness a fit one is for gd_subdivision_create to say. */
GD_MUST_USE enum gd_status gd_read_control_mesh(const void *bytes, size_t size,
                                                const struct gd_read_options *options,
                                                struct gd_control_mesh *out,
                                                struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
