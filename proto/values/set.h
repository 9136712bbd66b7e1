/* Set: the set to which distances are measured. Its members are points, curves and boundaries,
 * numbered in this order. Each member has a label, and an offset that is added to the distances
 * from the member. */
#pragma once

#include <jansson.h>

#include "gd/field.h"
#include "proto/values/point.h"

#define PROTO_SET_MEMBERS 65536
/* limit on the curves and boundaries that a set names, and on the boundaries that "all" selects */
#define PROTO_SET_CURVES 4096
#define PROTO_SET_LABEL  128 /* bytes of UTF-8 */
/* the same limit as for coordinates, so that sums with distances stay finite */
#define PROTO_SET_OFFSET 1e150

struct proto_curve; /* generated/requests.h */

/* Offset and label of a member. */
struct proto_naming {
    double offset;     /* 0 to PROTO_SET_OFFSET */
    const char *label; /* borrowed from the document; may be NULL */
};

/* All zero is an empty set. */
struct proto_set {
    uint32_t point_count, curve_count; /* named boundaries count as curves */
    struct proto_point *points;        /* owned, as all arrays */
    struct proto_curve *curves;
    struct proto_naming *namings; /* one for each point, then one for each curve */
    bool all_boundaries;          /* all boundaries of the mesh follow as further members */
    json_t *document;             /* retained, because it contains the labels */
};

/* Decodes a set of at least one member. `pointer` is the JSON Pointer of `value`. Problems:
 * invalid_request, too_large, insufficient_memory. The caller frees the result by
 * proto_set_free. */
bool proto_set_decode(const json_t *value, const char *pointer, struct proto_set *out,
                      struct proto_problem *problem);

/* Decodes a curve, the object's value with the key `member`, as the only member of the set. */
bool proto_set_decode_curve(const json_t *object, const char *member, struct proto_set *out,
                            struct proto_problem *problem);

/* Creates a set that consists of one point. Problem: insufficient_memory. */
bool proto_set_of_point(const struct proto_point *point, struct proto_set *out,
                        struct proto_problem *problem);
void proto_set_free(struct proto_set *set); /* may be called repeatedly */

/* Returns true if the set has only points. Locating it then takes microseconds. */
bool proto_set_is_quick(const struct proto_set *set);

/* A set on its mesh, in one allocation, which free() frees. Equal seeds have equal bytes. */
struct proto_located_set {
    uint32_t count; /* members */
    uint32_t seed_count;
    /* true if the seeds include segments, which come from members other than points */
    bool has_segments;
    const struct gd_seed *seeds; /* member by member */
    const uint32_t *members;     /* the member of each seed */
    /* for each member: offset of its label in `labels`, or UINT32_MAX if there is none */
    const uint32_t *label_offsets;
    const char *labels;
    size_t label_size; /* bytes of all labels, with their NULs */
    size_t bytes;      /* bytes of the whole allocation */
};

/* Locates the members on the mesh: points by proto_point_locate, curves by gd_curve_resolve.
 * `control` limits time and memory; NULL means no limits. Landmarks are not used, because they
 * would change the rounding errors of a curve. Equal sets must have equal seeds, so that they share
 * a field. On failure `*out` is untouched and the problem is filled in. Errors: GD_INVALID_ARGUMENT
 * (a faulty point or curve), and those of gd_curve_resolve. */
GD_MUST_USE enum gd_status proto_set_locate(const struct gd_mesh *mesh, const struct proto_set *set,
                                            const struct gd_control *control,
                                            struct proto_located_set **out,
                                            struct proto_problem *problem);

/* Returns a member's label, or NULL. */
const char *proto_located_set_label(const struct proto_located_set *set, uint32_t member);
