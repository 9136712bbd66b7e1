/* USD: a control mesh as JSON with the names that Universal Scene Description gives to the parts of
 * its Mesh (see subdivision.h). Creases are chains: `creaseLengths` says how many of
 * `creaseIndices` each has, `creaseSharpnesses` has a number for each chain or one for each edge of
 * them all. No JSON library shows here. */
#ifndef PROTO_USD_H
#define PROTO_USD_H

#include "gd/subdivision.h"
#include "proto/json/problem.h"

struct proto_usd {
    struct gd_control_mesh control_mesh;
    bool has_scheme;
    enum gd_scheme scheme;
};

/* Is it JSON of this form, and not {"vertices", "faces"}? By the names in the bytes (NULL: there
 * are none). */
bool proto_usd_is(const void *bytes, size_t size);

/* invalid_request; invalid_mesh with a reason (index, empty); too_large by limits->max_faces and
 * max_vertices (`limits` may be NULL); insufficient_memory. The caller frees out->control_mesh. */
bool proto_usd_read(const void *bytes, size_t size, const struct gd_read_options *limits,
                    struct proto_usd *out, struct proto_problem *problem);

#endif
