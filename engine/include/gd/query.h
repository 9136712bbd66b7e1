/* Query: distance and path of one pair of points.
 *
 * Results are checked: if the relative difference between a path's own length and the distance is
 * more than 1e-9, the status is GD_INTERNAL. */
#ifndef GD_QUERY_H
#define GD_QUERY_H

#include "gd/field.h"
#include "gd/landmarks.h"

GD_EXTERN_C_BEGIN

/* The requested output for a pair. GD_PAIR_DISTANCE and GD_PAIR_PATH equal `false` and `true`. */
enum gd_pair_output {
    GD_PAIR_DISTANCE,
    GD_PAIR_PATH, /* distance and path */
    /* distance, path, and whether the path is unique; this takes several times as long as the
       path */
    GD_PAIR_PATH_AND_CUT
};

struct gd_pair_answer {
    double distance;     /* INFINITY means no path */
    struct gd_path path; /* from `from` to `to`; count 0 if no path was requested or none exists */
    /* True if the ends lie on each other's cut locus, so that other paths are equally short. False
       if not requested. */
    bool is_cut;
};

void gd_pair_answer_free(struct gd_pair_answer *answer);

/* Computes distance or path of a pair from a field. One of the two points must be the field's only
 * seed, without offset. The caller frees `*out` by gd_pair_answer_free. Errors: GD_INVALID_ARGUMENT
 * (neither point is the seed), GD_BEYOND_REACH, GD_NO_MEMORY, GD_INTERNAL. Cost: see
 * gd_field_distance and gd_field_path. Thread-safe. */
GD_MUST_USE enum gd_status gd_pair_from_field(const struct gd_field *field,
                                              const struct gd_point *from,
                                              const struct gd_point *to, enum gd_pair_output output,
                                              struct gd_pair_answer *out);

struct gd_pair_request {
    const struct gd_point *from, *to;
    enum gd_pair_output output;
    /* landmarks of the same mesh, which make the search faster and do not change the result; may be
       NULL */
    const struct gd_landmarks *landmarks;
};

/* Computes distance or path of a pair without a field. Propagates only windows that may be part of
 * a shortest path. The distance of points on different components is INFINITY. `control` and
 * `detail` may be NULL. The caller frees `*out` by gd_pair_answer_free. Errors: those of
 * gd_field_build. Cost: a small part of the cost of a field. With a workspace in `control`, it does
 * not depend on the size of the mesh. Thread-safe. */
GD_MUST_USE enum gd_status gd_pair_solve(const struct gd_mesh *mesh,
                                         const struct gd_pair_request *request,
                                         const struct gd_control *control,
                                         struct gd_pair_answer *out, struct gd_detail *detail);

GD_EXTERN_C_END

#endif
