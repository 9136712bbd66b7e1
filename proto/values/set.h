/* Set: what distances are measured to. Members are points, curves and boundaries, numbered in this
 * order, each with an offset that is added to distances from it and a label to know it by. */
#ifndef PROTO_SET_H
#define PROTO_SET_H

#include <jansson.h>

#include "gd/field.h"
#include "proto/values/curve.h"
#include "proto/values/point.h"

#define PROTO_SET_MEMBERS 65536
/* curves and boundaries that are named, and most boundaries of a mesh that are "all" */
#define PROTO_SET_CURVES 4096
#define PROTO_SET_LABEL  128   /* bytes of UTF-8 */
#define PROTO_SET_OFFSET 1e150 /* as coordinates: sums with distances stay finite */

/* What each member has of its own. */
struct proto_naming {
    double offset;     /* 0 to PROTO_SET_OFFSET */
    const char *label; /* NULL: none; else borrowed from the document */
};

/* All zero is an empty set. */
struct proto_set {
    uint32_t point_count, curve_count; /* the boundaries that are named count as curves */
    struct proto_point *points;        /* owned, as all arrays */
    struct proto_curve *curves;
    struct proto_naming *namings; /* of the points, then of the curves */
    bool all_boundaries;          /* these are members too, after all others */
    json_t *document;             /* retained: it has the labels */
};

/* From {"points": [point…], "curves": [curve…], "boundaries": "all" | [index | {"boundary":
 * index}…]}, one member at least; all but the bare index may have "offset" and "label". `pointer`:
 * the JSON Pointer of `value`. invalid_request, too_large, insufficient_memory. Freed by
 * proto_set_free. */
bool proto_set_decode(const json_t *value, const char *pointer, struct proto_set *out,
                      struct proto_problem *problem);

/* From the curve that is a member of that name of an object, as the only member of the set. */
bool proto_set_decode_curve(const json_t *object, const char *member, struct proto_set *out,
                            struct proto_problem *problem);

/* A set of one point. insufficient_memory. */
bool proto_set_of_point(const struct proto_point *point, struct proto_set *out,
                        struct proto_problem *problem);
void proto_set_free(struct proto_set *set); /* a second time is harmless */

/* Points only: to locate it takes no time. */
bool proto_set_is_quick(const struct proto_set *set);

/* A set on its mesh, in one piece of memory: free it by free(). Equal seeds are equal bytes. */
struct proto_located_set {
    uint32_t count; /* members */
    uint32_t seed_count;
    bool has_segments;             /* among the seeds: a member is no point */
    const struct gd_seed *seeds;   /* member by member */
    const uint32_t *members;       /* by seed: whose it is */
    const uint32_t *label_offsets; /* by member: of its label in `labels`; UINT32_MAX: none */
    const char *labels;
    size_t label_size; /* of them all, with their NULs */
    size_t bytes;      /* of the whole */
};

/* Puts the members on the mesh: points by proto_point_locate, curves by gd_curve_resolve, whose
 * time and memory are for `control` (NULL: none) to bound and `landmarks` (NULL: none) to narrow;
 * `*out` is untouched on failure. The status is for who wants to know why: the problem is filled
 * in, too. Errors: GD_INVALID_ARGUMENT (a point's, or a curve's, problem), and those of
 * gd_curve_resolve. */
GD_MUST_USE enum gd_status proto_set_locate(const struct gd_mesh *mesh, const struct proto_set *set,
                                            const struct gd_landmarks *landmarks,
                                            const struct gd_control *control,
                                            struct proto_located_set **out,
                                            struct proto_problem *problem);

/* A member's label, or NULL. */
const char *proto_located_set_label(const struct proto_located_set *set, uint32_t member);

#endif
