/* USD: a control mesh as JSON with the names of Universal Scene Description (SubdivisionJson).
 * `creaseSharpnesses` has one number for each chain, or one for each edge of all chains. This
 * header does not expose the JSON library. */
#pragma once

#include "gd/subdivision.h"
#include "proto/json/problem.h"

struct proto_usd {
    struct gd_control_mesh control_mesh;
    bool has_scheme;
    enum gd_scheme scheme;
};

/* Returns whether the bytes (may be NULL) are JSON of this form. Distinguishes it from {"vertices",
 * "faces"} by the names of the members. */
bool proto_usd_is(const void *bytes, size_t size);

/* Reads a control mesh. Problems: invalid_request; invalid_mesh with a reason (index, empty);
 * too_large by limits->max_faces and max_vertices (`limits` may be NULL); insufficient_memory. The
 * caller frees out->control_mesh. */
bool proto_usd_read(const void *bytes, size_t size, const struct gd_read_options *limits,
                    struct proto_usd *out, struct proto_problem *problem);
