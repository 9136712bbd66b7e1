/* Shortening: a curve on its way to a geodesic, moved across the surface as a taut string would be.
 *
 *     struct gd_shortening_request request = {.curve = &curve};
 *     struct gd_shortening shortening;
 *     if (gd_curve_shorten(mesh, &request, NULL, &shortening, &detail) == GD_OK) {
 *         printf("%g long\n", gd_curve_length(mesh, &shortening.curve));
 *         gd_shortening_free(&shortening);
 *     }
 *
 * Source: G. D. Birkhoff's curve shortening: pieces of the curve are replaced by geodesics between
 * their ends. Pieces are pulled tight within the faces that they run through, and round vertices on
 * the shorter side, so that the curve is never moved over a hole, and what it becomes is the
 * locally shortest one. */
#ifndef GD_SHORTENING_H
#define GD_SHORTENING_H

#include "gd/curve.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GD_SHORTENING_PIECES 16   /* when no number is given */
#define GD_SHORTENING_ROUNDS 1000 /* most of them on the way to a closed geodesic */

struct gd_shortening_request {
    const struct gd_curve *curve;
    uint32_t rounds; /* 0: until the curve is a geodesic */
    uint32_t pieces; /* of equal lengths; 0: GD_SHORTENING_PIECES */
};

struct gd_shortening {
    struct gd_curve curve; /* owned */
    /* radians by which the curve misses being straight at most where pieces meet; bends round
       vertices that make it shorter don't count */
    double turn;
    uint32_t rounds;
    bool is_geodesic; /* the turn is less than 1e-9 */
};

void gd_shortening_free(struct gd_shortening *shortening); /* NULL is harmless */

/* The curve after `rounds` of shortening in `pieces`, which are moved by half a piece in every
 * other round. The ends of an open curve stay. `rounds` 0: until it is a geodesic; an open one is
 * pulled tight at once, of a closed one each round takes the place at which it bends as the
 * beginning, and after GD_SHORTENING_ROUNDS it is what it is. `control` and `detail` may be NULL.
 * Errors: GD_INVALID_ARGUMENT (a closed curve that shrinks to a point: nothing holds it),
 * GD_TOO_LARGE (more than 65536 pieces), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE,
 * GD_INTERNAL (two points that follow each other have no face in common). Cost: a round is linear
 * in the faces that the curve crosses, times what they are moved. Thread-safe. */
GD_MUST_USE enum gd_status gd_curve_shorten(const struct gd_mesh *mesh,
                                            const struct gd_shortening_request *request,
                                            const struct gd_control *control,
                                            struct gd_shortening *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
