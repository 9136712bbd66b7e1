/* Shortening: moves a curve across the surface towards a geodesic, like a string that is pulled
 * tight.
 *
 *     struct gd_shortening_request request = {.curve = &curve};
 *     struct gd_shortening shortening;
 *     if (gd_curve_shorten(mesh, &request, NULL, &shortening, &detail) == GD_OK) {
 *         printf("%g long\n", gd_curve_length(mesh, &shortening.curve));
 *         gd_shortening_free(&shortening);
 *     }
 *
 * Source: G. D. Birkhoff's curve shortening: pieces of the curve are replaced by geodesics between
 * their ends. A piece is pulled tight within the faces that it crosses. At a vertex, it moves to
 * the side on which it is shorter. Therefore the curve never moves across a hole, and its limit is
 * a locally shortest curve. */
#ifndef GD_SHORTENING_H
#define GD_SHORTENING_H

#include "gd/curve.h"

GD_EXTERN_C_BEGIN

#define GD_SHORTENING_PIECES 16   /* default number of pieces */
#define GD_SHORTENING_ROUNDS 1000 /* largest number of rounds for a closed geodesic */

struct gd_shortening_request {
    const struct gd_curve *curve;
    uint32_t rounds; /* 0 means as many as the curve needs to become a geodesic */
    uint32_t pieces; /* number of pieces, of equal lengths; 0 means GD_SHORTENING_PIECES */
};

struct gd_shortening {
    struct gd_curve curve; /* owned */
    /* largest angle by which the curve differs from a geodesic at a point where two pieces meet, in
       radians; a bend at a vertex counts as 0 if both sides of the curve have an angle of at least
       pi */
    double turn;
    uint32_t rounds;
    bool is_geodesic; /* true if `turn` is less than 1e-9 */
};

void gd_shortening_free(struct gd_shortening *shortening); /* NULL is allowed */

/* Shortens the curve in `rounds` rounds. Each round divides the curve into `pieces` pieces and
 * straightens them. Every second round shifts the divisions by half a piece. The ends of an open
 * curve are fixed. If `rounds` is 0, the result is a geodesic: an open curve is straightened in one
 * step, and a closed curve in up to GD_SHORTENING_ROUNDS rounds. Each of these rounds begins at
 * another point of the curve, and thus straightens the bend at the beginning of the previous round.
 * `control` and `detail` may be NULL. The caller frees `*out` by gd_shortening_free. Errors:
 * GD_INVALID_ARGUMENT (a closed curve that shrinks to a point), GD_TOO_LARGE (more than 65536
 * pieces), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL (two consecutive points
 * without a common face). Cost: a round is linear in the number of faces that the curve crosses or
 * moves across. Thread-safe. */
GD_MUST_USE enum gd_status gd_curve_shorten(const struct gd_mesh *mesh,
                                            const struct gd_shortening_request *request,
                                            const struct gd_control *control,
                                            struct gd_shortening *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
