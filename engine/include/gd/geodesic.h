/* Geodesic: the umbrella header of the library libgeodesic, and functions for the most common
 * tasks.
 *
 *     struct gd_mesh *mesh;
 *     struct gd_detail error;
 *     if (gd_mesh_load(bytes, size, NULL, &mesh, &error) != GD_OK) return error.text;
 *     struct gd_point a, b;
 *     double distance;
 *     if (gd_point_at_vertex(mesh, vertex, &a, &error) == GD_OK &&
 *         gd_locate_nearest(mesh, xyz, -1, &b, &error) == GD_OK &&
 *         gd_distance(mesh, &a, &b, &distance) == GD_OK)
 *         printf("%.17g\n", distance);
 *     gd_mesh_release(mesh);
 *
 * Five steps cover most programs. engine/examples/geodesic.c does all of them.
 *
 *   load    gd_mesh_load; gd_mesh_build for polygons that are in memory already
 *   points  gd_point_at_vertex, gd_point_in_face, gd_locate_nearest
 *   pairs   gd_distance, gd_path
 *   fields  gd_field_build; then gd_field_distance, gd_field_vertex_distances, gd_field_path
 *   free    gd_path_free, gd_field_release, gd_mesh_release
 *
 * Units, numbering and exactness: gd/mesh.h. Status codes and details: gd/status.h. Meshes and
 * fields are immutable, so any number of threads may read them; the functions keep no state. */
#ifndef GD_GEODESIC_H
#define GD_GEODESIC_H

#include "gd/colour_map.h"
#include "gd/control_mesh.h"
#include "gd/cpu.h"
#include "gd/curve.h"
#include "gd/curve_distance.h"
#include "gd/cut_locus.h"
#include "gd/direction.h"
#include "gd/field.h"
#include "gd/io.h"
#include "gd/isoline.h"
#include "gd/landmarks.h"
#include "gd/locate.h"
#include "gd/mesh.h"
#include "gd/number.h"
#include "gd/point.h"
#include "gd/query.h"
#include "gd/result_file.h"
#include "gd/sampling.h"
#include "gd/voronoi.h"
#include "gd/workspace.h"

GD_EXTERN_C_BEGIN

/* If all members are zero, the format is recognised, faces and vertices are limited to 2^30,
 * polygons are triangulated, and nothing is repaired. */
struct gd_load_options {
    enum gd_format format;
    uint32_t max_faces, max_vertices; /* see gd_read_options */
    struct gd_mesh_options mesh;      /* triangulation, weld, repair */
    const struct gd_control *control; /* borrowed for the call; may be NULL */
};

/* Reads a mesh file in any format of gd/io.h and builds its mesh. `bytes` are borrowed for the
 * call. `options` and `error` may be NULL. The caller owns one reference of `*out`, which
 * gd_mesh_release releases. On failure `error` contains a sentence, and the first offending
 * elements if there are any.
 *
 * Errors: those of gd_read_polygons and gd_mesh_build. Cost: expected linear time in the size of
 * the file. gd_read_cost and gd_mesh_build_cost return the memory. Thread-safe. */
GD_MUST_USE enum gd_status gd_mesh_load(const void *bytes, size_t size,
                                        const struct gd_load_options *options, struct gd_mesh **out,
                                        struct gd_detail *error);

/* Computes the length of a shortest path between two points of the mesh, in the mesh's unit.
 * INFINITY means that the points lie on different components. gd_pair_solve does the same, and
 * accepts landmarks and a control. For distances of many points from one source, build a field.
 *
 * Errors: GD_NO_MEMORY, GD_RUNAWAY, GD_INTERNAL (see gd_field_build). Cost: a small part of the
 * cost of a field. Thread-safe. */
GD_MUST_USE enum gd_status gd_distance(const struct gd_mesh *mesh, const struct gd_point *from,
                                       const struct gd_point *to, double *out);

/* Computes a shortest path of at least one point; out->length is the distance. The caller frees the
 * path by gd_path_free. gd_points_positions computes the positions of its points. In C++, write
 * `struct gd_path` for the type, because type and function have the same name.
 *
 * Errors: GD_NOT_ON_SURFACE (the points lie on different components), and those of gd_distance.
 * Cost and thread safety: as gd_distance. */
GD_MUST_USE enum gd_status gd_path(const struct gd_mesh *mesh, const struct gd_point *from,
                                   const struct gd_point *to, struct gd_path *out);

GD_EXTERN_C_END

#endif
