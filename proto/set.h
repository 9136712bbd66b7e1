/* Set: what distances are measured to. Members are points, each with an offset that is added to distances from it and a
 * label to know it by. */
#ifndef PROTO_SET_H
#define PROTO_SET_H

#include <jansson.h>

#include "gd/field.h"
#include "proto/point.h"

#define PROTO_SET_MEMBERS 65536
#define PROTO_SET_LABEL   128   /* bytes of UTF-8 */
#define PROTO_SET_OFFSET  1e150 /* as coordinates: sums with distances stay finite */

struct proto_member {
    struct proto_point point;
    double offset;     /* 0 to PROTO_SET_OFFSET */
    const char *label; /* NULL: none; else borrowed from the document */
};

/* All zero is an empty set. */
struct proto_set {
    uint32_t count;
    struct proto_member *members; /* owned */
};

/* From {"points": [point with "offset"? and "label"?]}. `pointer`: the JSON Pointer of `value`. invalid_request (curves and
 * boundaries are not taken as yet), too_large, insufficient_memory. `value` outlives the set, which is
 * freed by proto_set_free. */
bool proto_set_decode(const json_t *value, const char *pointer, struct proto_set *out, struct proto_problem *problem);
void proto_set_free(struct proto_set *set); /* a second time is harmless */

/* A set on its mesh, in one piece of memory: free it by free(). Equal seeds are equal bytes. */
struct proto_located_set {
    uint32_t count;
    const struct gd_seed *seeds;   /* by member */
    const uint32_t *label_offsets; /* by member: of its label in `labels`; UINT32_MAX: none */
    const char *labels;
    size_t label_size; /* of them all, with their NULs */
    size_t bytes;      /* of the whole */
};

/* proto_point_locate for each member. NULL with the problem: its, insufficient_memory. */
struct proto_located_set *proto_set_locate(const struct gd_mesh *mesh, const struct proto_set *set,
                                           struct proto_problem *problem);

/* A member's label, or NULL. */
const char *proto_located_set_label(const struct proto_located_set *set, uint32_t member);

#endif
