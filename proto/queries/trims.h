/* Trimming loops of a surface file (schema Trims). */
#ifndef PROTO_TRIMS_H
#define PROTO_TRIMS_H

#include <jansson.h>

#include "gd/parametric.h"
#include "proto/json/problem.h"

/* Replaces *surface by its trimmed surface if the document has the member `trims`. Problems:
 * invalid_request (not JSON of this form), invalid_mesh with the reason `trims` (faulty loops),
 * both at the place of the curve; insufficient_memory, deadline_exceeded. On failure *surface is
 * unchanged. */
bool proto_trims_apply(const json_t *document, const struct gd_control *control,
                       struct gd_parametric **surface, struct proto_problem *problem);

#endif
