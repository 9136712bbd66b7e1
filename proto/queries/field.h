/* Field: the distances from a set as a resource: its description, values and wedges. */
#ifndef PROTO_FIELD_H
#define PROTO_FIELD_H

#include <jansson.h>

#include "gd/field.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/values/point.h"

#define PROTO_FIELD_ID  32   /* characters, without the NUL */
#define PROTO_FIELD_SET 4096 /* most characters of a set that is told */

struct proto_field_description {
    const char *id;
    uint64_t wedges, bytes;
    double build_ms;
    double max_distance; /* 0: no limit */
    uint32_t members;
    double max;               /* largest distance; NAN: it is beyond max_distance */
    struct gd_point farthest; /* where it is, if it is known */
    const char *set;          /* as the first client wrote it, JSON; NULL: too long to be told */
    int64_t created;          /* seconds since 1970 */
    uint64_t uses;            /* requests that named it; in lists only */
};

/* Writes the text of a set for a description into *out, the caller's to free(). *out is NULL if the
 * text is longer than PROTO_FIELD_SET. False: out of memory. */
bool proto_field_write_set(const json_t *set, char **out);

/* Writes the description, of its fields the wanted ones. */
void proto_field_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct proto_field_description *description, uint32_t wanted);

/* Writes the description for a list: all of it, and the uses. */
void proto_field_encode_listed(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct proto_field_description *description);

/* Writes {"values"}: what is not finite is null. */
void proto_values_encode(struct proto_writer *writer, const double *values, size_t count);

/* The query-string parameter of wedges, edge=3-9: two vertices, the lower one first in the answer.
 * NULL-terminated, for proto_options_parse. */
bool proto_wedges_parse(const struct proto_parameters *parameters, struct gd_vertex ends[2],
                        struct proto_problem *problem);

/* Writes {"edge", "wedges": [{"b0", "b1", "d0", "d1", "sigma", "tau", "linear"?, "source"}]}, of
 * these the wanted ones; a source is {"vertex"} or {"member"}. */
void proto_wedges_encode(struct proto_writer *writer, const struct gd_vertex ends[2],
                         const struct gd_wedge *wedges, uint32_t count, uint32_t wanted);

#endif
