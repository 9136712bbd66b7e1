/* Field: the distances from a set as a resource: its request, its description, lists of
 * descriptions, its values and wedges. */
#ifndef PROTO_FIELD_H
#define PROTO_FIELD_H

#include "gd/field.h"
#include "proto/http/options.h"
#include "proto/values/set.h"
#include "proto/json/writer.h"

struct proto_field_request {
    struct proto_set set;
    double max_distance; /* 0: no limit */
};

/* From {"set", "max_distance"?}. invalid_request, too_large, insufficient_memory. The set is freed
 * by proto_set_free before the document is. */
bool proto_field_decode(const json_t *document, struct proto_field_request *out,
                        struct proto_problem *problem);

#define PROTO_FIELD_ID 32 /* characters, without the NUL */

struct proto_field_description {
    const char *id;
    uint64_t wedges, bytes;
    double build_ms;
    double max_distance; /* 0: no limit */
    uint32_t members;
    double max;               /* largest distance; NAN: it is beyond max_distance */
    struct gd_point farthest; /* where it is, if it is known */
};

/* Fields of the description, as bits of proto_options.fields; in the order of
 * proto_field_fields. */
enum proto_field_field {
    PROTO_FIELD_FIELD_ID = 1 << 0,
    PROTO_FIELD_FIELD_WEDGES = 1 << 1,
    PROTO_FIELD_FIELD_BYTES = 1 << 2,
    PROTO_FIELD_FIELD_BUILD_MS = 1 << 3,
    PROTO_FIELD_FIELD_MAX = 1 << 4,
    PROTO_FIELD_FIELD_FARTHEST = 1 << 5,
    PROTO_FIELD_FIELD_MEMBERS = 1 << 6,
    PROTO_FIELD_FIELD_MAX_DISTANCE = 1 << 7,
    PROTO_FIELD_FIELD_ALL = (1 << 8) - 1
};
extern const char *const proto_field_fields[]; /* NULL-terminated, for proto_options_parse */

/* Writes the description, of its fields the wanted ones. */
void proto_field_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct proto_field_description *description, uint32_t wanted);

extern const char *const proto_values_fields[]; /* NULL-terminated, for proto_options_parse */

/* Writes {"values"}: what is not finite is null. */
void proto_values_encode(struct proto_writer *writer, const double *values, size_t count);

/* The query-string parameter of wedges, edge=3-9: two vertices, the lower one first in the answer.
 * NULL-terminated, for proto_options_parse. */
extern const char *const proto_wedges_parameters[];
bool proto_wedges_parse(const struct proto_parameters *parameters, struct gd_vertex ends[2],
                        struct proto_problem *problem);

enum proto_wedges_field { PROTO_WEDGES_FIELD_EDGE = 1 << 0, PROTO_WEDGES_FIELD_WEDGES = 1 << 1 };
extern const char *const proto_wedges_fields[]; /* NULL-terminated, for proto_options_parse */

/* Writes {"edge", "wedges": [{"b0", "b1", "d0", "d1", "sigma", "tau", "linear"?, "source"}]}, of
 * these the wanted ones; a source is {"vertex"} or {"member"}. */
void proto_wedges_encode(struct proto_writer *writer, const struct gd_vertex ends[2],
                         const struct gd_wedge *wedges, uint32_t count, uint32_t wanted);

#endif
