/* Query: questions people ask, each answered by the cheapest exact means.
 *
 * An answer is checked before it is given: a path's own length equals the distance to 1e-9, or the
 * status is GD_INTERNAL. */
#ifndef GD_QUERY_H
#define GD_QUERY_H

#include "gd/field.h"
#include "gd/landmarks.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is wanted of a pair; `false` and `true` are a distance and a path. */
enum gd_pair_wish {
    GD_PAIR_DISTANCE,
    GD_PAIR_PATH, /* the path too */
    /* and whether it is the only one, which takes some times as long as the path */
    GD_PAIR_PATH_AND_CUT
};

struct gd_pair_answer {
    double distance;     /* INFINITY: no path */
    struct gd_path path; /* from `from` to `to`; count 0 when none was wanted or there is none */
    /* the ends lie on each other's cut locus: other paths are as short. False where it was not
     * wanted */
    bool is_cut;
};

void gd_pair_answer_free(struct gd_pair_answer *answer);

/* Point to point from a field that has its single seed, without offset, at one of the two points
 * (the metric is symmetric). Errors: GD_INVALID_ARGUMENT (neither point is the seed),
 * GD_BEYOND_REACH, GD_NO_MEMORY, GD_INTERNAL. Cost: see gd_field_distance, _path. */
GD_MUST_USE enum gd_status gd_pair_from_field(const struct gd_field *field,
                                              const struct gd_point *from,
                                              const struct gd_point *to, enum gd_pair_wish wish,
                                              struct gd_pair_answer *out);

struct gd_pair_request {
    const struct gd_point *from, *to;
    enum gd_pair_wish wish;
    /* of this mesh; they narrow the search, and the answer is the same. NULL: none */
    const struct gd_landmarks *landmarks;
};

/* Point to point from nothing: propagates only what can lie on a shortest path. Points of different
 * components: INFINITY, at once. `control` and `detail` may be NULL. Errors: those of
 * gd_field_build. Cost: a small part of a field's; with a workspace in `control`, nothing that
 * grows with the mesh. */
GD_MUST_USE enum gd_status gd_pair_solve(const struct gd_mesh *mesh,
                                         const struct gd_pair_request *request,
                                         const struct gd_control *control,
                                         struct gd_pair_answer *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
