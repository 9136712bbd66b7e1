/* Cut: divides a mesh along a curve into pieces, which are meshes or regions of whole faces.
 *
 *     struct gd_cut_request request = {.curve = &curve};
 *     struct gd_cut cut;
 *     if (gd_cut_along(mesh, &request, NULL, &cut, &detail) == GD_OK) {
 *         for (uint32_t i = 0; i < cut.piece_count; i++) gd_mesh_build(&cut.pieces[i].polygons, …);
 *         gd_cut_free(&cut);
 *     }
 *
 * The pieces lie on the mesh's surface up to rounding and cover it: their areas sum to its area.
 * Faces that the curve crosses are divided. The curve's points become vertices of the pieces on
 * both sides. */
#ifndef GD_CUT_H
#define GD_CUT_H

#include "gd/curve.h"
#include "gd/polygons.h"

GD_EXTERN_C_BEGIN

struct gd_cut_request { /* all borrowed */
    /* closed, or from one boundary point to another; may cross itself */
    const struct gd_curve *curve;
    /* if not NULL, only the piece that contains this point is returned */
    const struct gd_point *inside;
    bool select_only; /* true if whole faces are assigned to pieces, and no meshes are made */
};

struct gd_cut_piece {
    /* Triangles in the caller's unit. First come vertices of the parent mesh (the mesh that is cut)
       in order of their indices, then new vertices. Empty if select_only is set. */
    struct gd_polygons polygons;
    /* for each position, index of the parent's vertex, or GD_NONE for a new vertex; NULL if
       select_only is set */
    uint32_t *vertex_map;
    /* For each triangle, the parent's face that contains it, in ascending order. If select_only is
       set, the faces of the region. Each face of the parent then belongs to one region. A face that
       the curve crosses belongs to the region that has the largest part of the face's area. In a
       tie, it belongs to the first of these regions. */
    uint32_t *face_map;
    uint32_t face_count;
    double area; /* exact area of the part that the curve bounds, even if select_only is set */
};

struct gd_cut {
    /* true if the cut increases the number of components; false if it only opens the mesh */
    bool separates;
    uint32_t piece_count;
    /* One piece for each component of the cut mesh, even for a component that the curve does not
       meet. Ordered by their lowest faces. */
    struct gd_cut_piece *pieces;
    double largest_shift; /* largest distance by which the curve was moved, see gd_cut_along */
    size_t bytes;         /* size of all arrays above */
};

void gd_cut_free(struct gd_cut *cut); /* Frees the pieces and zeroes the struct. NULL is allowed. */

/* Cuts `mesh` along a curve.
 *
 * If the curve passes a vertex, an edge or another part of itself at a distance below a millionth
 * of the face's longest edge, the curve is moved onto this vertex, edge or part. In faces that are
 * nearly degenerate, this also happens at distances up to a hundredth of the longest edge.
 * Therefore no new face is too flat for computations. A part of the curve does not cut the mesh if
 * it runs along the boundary, or if it runs back along itself without enclosing an area. If the
 * curve crosses itself, each of its loops is cut out: a figure of eight gives three pieces.
 * Crossings and the triangulation of crossed faces are computed in exact integer arithmetic.
 *
 * The caller frees `*out` by gd_cut_free. Errors: GD_INVALID_ARGUMENT (an open curve whose ends are
 * not both on the boundary, consecutive points without a common face, a curve that does not cut the
 * mesh, `inside` on the curve, a face that is too flat), GD_TOO_LARGE (too many crossings),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL (the areas fail the self-check).
 * Cost: linear in the mesh, about 150 bytes a face; in each crossed face, quadratic in the number
 * of curve points. Thread-safe. */
GD_MUST_USE enum gd_status gd_cut_along(const struct gd_mesh *mesh,
                                        const struct gd_cut_request *request,
                                        const struct gd_control *control, struct gd_cut *out,
                                        struct gd_detail *detail);

GD_EXTERN_C_END

#endif
