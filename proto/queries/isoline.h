/* Isolines: the lines of a field at given levels, and arcs in an answer. */
#ifndef PROTO_ISOLINE_H
#define PROTO_ISOLINE_H

#include <jansson.h>

#include "gd/isoline.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/queries/field.h"

#define PROTO_ISOLINES_LEVELS 1000   /* most levels of a request */
#define PROTO_ISOLINES_POINTS 500000 /* most points, and most arcs, of an answer */

/* All zero is an empty one. */
struct proto_isolines {
    /* owned; NULL until proto_isolines_settle, if their number was asked for */
    double *levels;
    uint32_t level_count; /* at least 1 */
    double tolerance;     /* 0: not said */
    bool wants_arcs;
    const char *place; /* of levels or count in the request, static */
};

/* From the body of POST, and from the query string of GET. invalid_request, too_large (with the
 * limit), insufficient_memory. Freed by proto_isolines_free. */
bool proto_isolines_decode(const json_t *document, struct proto_isolines *out,
                           struct proto_problem *problem);
bool proto_isolines_parse(const struct proto_parameters *parameters, struct proto_isolines *out,
                          struct proto_problem *problem);
void proto_isolines_free(struct proto_isolines *isolines); /* a second time is harmless */

/* Fits the request to its field: n levels lie evenly between 0 and the field's maximum, both left
 * out (if that is not known: its max_distance); none is beyond its max_distance. invalid_request,
 * insufficient_memory. */
bool proto_isolines_settle(struct proto_isolines *isolines,
                           const struct proto_field_description *field,
                           struct proto_problem *problem);

/* The tolerance that was asked for (0: none was), or 1/2000 of the diagonal of the mesh's bounding box: half a
 * pixel in a picture of 1,000. */
double proto_isolines_tolerance(double tolerance, const struct gd_mesh *mesh);

/* Angles of an arc are counted as directions in its face are (gd/direction.h), its start in
 * [0, 2 pi); a straight one is {"face", "straight": true}. */
void proto_arc_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                      const struct gd_isoline_arc *arc);

#endif
