/* Isolines: a field's lines at given levels, and the arcs of an answer. */
#pragma once

#include <jansson.h>

#include "gd/isoline.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/queries/field.h"

#define PROTO_ISOLINES_LEVELS 1000   /* most levels of a request */
#define PROTO_ISOLINES_POINTS 500000 /* most points, and most arcs, of an answer */

/* All zero means empty. */
struct proto_isolines {
    /* owned; if the request has only a count, NULL until proto_isolines_settle */
    double *levels;
    uint32_t level_count; /* at least 1 */
    double tolerance;     /* 0 if not given */
    bool wants_arcs;
    const char *place; /* place of `levels` or `count` in the request, static */
};

/* Decode the body of POST and the query string of GET. Problems: invalid_request, too_large (with
 * the limit), insufficient_memory. The caller frees the result by proto_isolines_free. */
bool proto_isolines_decode(const json_t *document, struct proto_isolines *out,
                           struct proto_problem *problem);
bool proto_isolines_parse(const struct proto_parameters *parameters, struct proto_isolines *out,
                          struct proto_problem *problem);
void proto_isolines_free(struct proto_isolines *isolines); /* may be called repeatedly */

/* Completes the request for its field. A count n becomes n levels at equal steps between 0 and the
 * field's maximum, without these two ends. If the maximum is unknown, max_distance replaces it. No
 * level may exceed max_distance. Problems: invalid_request, insufficient_memory. */
bool proto_isolines_settle(struct proto_isolines *isolines,
                           const struct proto_field_description *field,
                           struct proto_problem *problem);

/* Returns the tolerance of the request. If it is 0, returns 1/2000 of the diagonal of the mesh's
 * bounding box, which is half a pixel in a picture of 1,000 pixels. */
double proto_isolines_tolerance(double tolerance, const struct gd_mesh *mesh);

/* Writes an arc. Its angles are measured like directions in its face (gd/direction.h), its start in
 * [0, 2 pi). A straight arc is {"face", "straight": true}. */
void proto_arc_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                      const struct gd_isoline_arc *arc);
