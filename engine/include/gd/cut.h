/* Cut: a mesh along a curve, into pieces that are meshes again, or into regions of its faces.
 *
 *     struct gd_cut_request request = {.curve = &curve};
 *     struct gd_cut cut;
 *     if (gd_cut_along(mesh, &request, NULL, &cut, &detail) == GD_OK) {
 *         for (uint32_t i = 0; i < cut.piece_count; i++) gd_mesh_build(&cut.pieces[i].polygons, …);
 *         gd_cut_free(&cut);
 *     }
 *
 * The pieces lie on the surface of the mesh to rounding and cover it: their areas add up to its
 * area. Faces that the curve crosses are cut into smaller ones; the curve's own points become
 * vertices, each of both pieces that meet there. */
#ifndef GD_CUT_H
#define GD_CUT_H

#include "gd/curve.h"
#include "gd/polygons.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_cut_request { /* all borrowed */
    /* closed, or from one boundary point to another; may cross itself */
    const struct gd_curve *curve;
    const struct gd_point *inside; /* the only piece wanted is the one that holds it; NULL: all */
    bool select_only;              /* no new meshes: pieces of the faces as they are */
};

struct gd_cut_piece {
    /* Triangles in the caller's unit, vertices by their index in the parent, then the new ones.
     * select_only: empty. */
    struct gd_polygons polygons;
    /* per position: index of the parent's vertex; GD_NONE: a new one. select_only: NULL */
    uint32_t *vertex_map;
    /* Per triangle: the parent's face that it lies in, in ascending order. select_only: the faces
     * of the region. Each face of the parent is in one region then: a crossed one where most of its
     * area is, in the first of equal ones. */
    uint32_t *face_map;
    uint32_t face_count;
    double area; /* of what lies on this side of the curve exactly, also with select_only */
};

struct gd_cut {
    bool separates; /* the mesh falls into more components than before; false: it is only opened */
    uint32_t piece_count;
    /* a component each, also of those that the curve does not meet; by their lowest faces */
    struct gd_cut_piece *pieces;
    double largest_shift; /* length by which the curve was moved at most, see gd_cut_along */
    size_t bytes;         /* of all the above */
};

void gd_cut_free(struct gd_cut *cut); /* frees the pieces and zeroes; NULL is harmless */

/* Cuts `mesh` along a curve.
 *
 * Where the curve passes a vertex, an edge or itself by less than a millionth of the longest edge
 * of the face, it is moved there, so that no face becomes too flat to measure across; in faces that
 * are nearly flat themselves by up to a hundredth. Where it runs there and back on the same line
 * without enclosing anything, or along the boundary, nothing is cut. Where it crosses itself each
 * loop is cut out: a figure of eight gives three pieces. Crossings and the triangulation of crossed
 * faces are decided by exact integer arithmetic.
 *
 * Errors: GD_INVALID_ARGUMENT (an open curve whose ends are not both on the boundary, consecutive
 * points that share no face, a curve that cuts nothing, `inside` on the curve, a face too flat to
 * be cut), GD_TOO_LARGE (too many crossings), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE,
 * GD_INTERNAL (a self-check: areas that do not add up). Cost: linear in the mesh, about 150 bytes a
 * face; in each crossed face quadratic in the points of the curve. Thread-safe. */
GD_MUST_USE enum gd_status gd_cut_along(const struct gd_mesh *mesh,
                                        const struct gd_cut_request *request,
                                        const struct gd_control *control, struct gd_cut *out,
                                        struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
