/* Field: the distances from a set as a resource: its description, values and wedges. */
#pragma once

#include <jansson.h>

#include "gd/field.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/values/point.h"

#define PROTO_FIELD_ID  32   /* characters, without the NUL */
#define PROTO_FIELD_SET 4096 /* limit on the characters of a set in a description */

struct proto_field_description {
    const char *id;
    uint64_t wedges, bytes;
    double build_ms;
    double max_distance; /* 0 means no limit */
    uint32_t members;
    double max;               /* largest distance; NAN means beyond max_distance */
    struct gd_point farthest; /* the farthest point, if max is known */
    const char *set; /* JSON, as the first client sent it; NULL means longer than PROTO_FIELD_SET */
    int64_t created; /* seconds since 1970 */
    uint64_t uses;   /* number of requests that named the field; only in lists */
};

/* Writes the text of a set for a description into *out, which the caller frees by free(). *out is
 * NULL if the text is longer than PROTO_FIELD_SET. Returns false if out of memory. */
bool proto_field_write_set(const json_t *set, char **out);

/* Writes the selected fields of the description. */
void proto_field_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct proto_field_description *description, uint32_t wanted);

/* Writes the whole description and the uses, for a list. */
void proto_field_encode_listed(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct proto_field_description *description);

void proto_values_encode(struct proto_writer *writer, const double *values, size_t count);

/* Reads the query-string parameter edge=3-9: two vertices. The answer has the lower one first. */
bool proto_wedges_parse(const struct proto_parameters *parameters, struct gd_vertex ends[2],
                        struct proto_problem *problem);

void proto_wedges_encode(struct proto_writer *writer, const struct gd_vertex ends[2],
                         const struct gd_wedge *wedges, uint32_t count, uint32_t wanted);
