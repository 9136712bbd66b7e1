/* Control mesh: polygons, with the crease and corner tags of a subdivision surface. engine/io reads
 * control meshes; engine/subdiv validates them and builds surfaces. */
#ifndef GD_CONTROL_MESH_H
#define GD_CONTROL_MESH_H

#include "gd/io.h"

GD_EXTERN_C_BEGIN

/* A tag of at least this sharpness is infinitely sharp, as in OpenSubdiv and USD. */
#define GD_SHARPNESS_INFINITE 10.0

struct gd_crease {
    uint32_t vertices[2]; /* the ends of an edge */
    /* >= 0; 0 means smooth, and GD_SHARPNESS_INFINITE or more means infinitely sharp */
    double sharpness;
};

struct gd_corner {
    uint32_t vertex;
    double sharpness; /* as in gd_crease */
};

/* Rules for the limit surface at the boundary of the mesh, with USD's names. Boundary edges are
 * infinitely sharp creases. */
enum gd_interpolate_boundary {
    GD_INTERPOLATE_EDGE_AND_CORNER, /* boundary vertices of only one face are corners */
    /* the boundary curve is also smooth at boundary vertices of only one face */
    GD_INTERPOLATE_EDGE_ONLY,
    /* there is no surface next to the boundary; accepted only for meshes without boundary */
    GD_INTERPOLATE_NONE
};

struct gd_control_mesh {
    struct gd_polygons polygons;
    struct gd_crease *creases; /* NULL if there are none */
    struct gd_corner *corners; /* NULL if there are none */
    uint32_t crease_count, corner_count;
    enum gd_interpolate_boundary boundary;
};

/* Frees the arrays and zeroes the struct. Accepts NULL and partly built structs. */
void gd_control_mesh_free(struct gd_control_mesh *mesh);

/* Reads a mesh file as gd_read_polygons does. From an OBJ file it also reads OpenSubdiv's tags: `t
 * crease N/M/0 v0 v1 ... s ...` (a chain of N vertices, with one sharpness for all edges or one for
 * each edge), `t corner N/M/0 v ... s ...`, `t interpolateboundary 1/0/0 i` (0 none, 1 edge and
 * corner, 2 edge only). Tags number vertices from zero, although faces number them from one. Tags
 * of texture coordinates are skipped. `options` and `detail` may be NULL. The caller frees `*out`
 * by gd_control_mesh_free. Thread-safe. Time and memory are those of gd_read_polygons. Errors:
 * those of gd_read_polygons; GD_UNSUPPORTED (another tag, such as a hole), GD_SYNTAX, GD_INDEX.
 * Later, gd_subdivision_create checks whether a crease is an edge and has a valid sharpness. */
GD_MUST_USE enum gd_status gd_read_control_mesh(const void *bytes, size_t size,
                                                const struct gd_read_options *options,
                                                struct gd_control_mesh *out,
                                                struct gd_detail *detail);

GD_EXTERN_C_END

#endif
