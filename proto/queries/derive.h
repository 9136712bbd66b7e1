/* Derive: a new mesh, made from a mesh by edits. Decodes the request, writes its operations, and
 * writes the points of the original that correspond to the vertices. */
#pragma once

#include "gd/edit.h"
#include "gd/io.h"
#include "generated/requests.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

struct proto_edits {
    struct gd_edit_step steps[GD_EDIT_STEPS_MOST];
    uint32_t count;
};

/* Returns the steps in the engine's form, borrowed. */
static inline struct gd_edit_steps proto_edits_steps(const struct proto_edits *edits)
{
    return (struct gd_edit_steps){.items = edits->steps, .count = edits->count};
}

struct proto_derive {
    struct proto_name mesh; /* name of the new mesh; empty if the answer is a file */
    /* true if each component becomes a mesh, whose name is `mesh` and a number */
    bool is_split;
    enum gd_format format; /* format of the file */
    struct proto_edits edits;
};

/* Problem: invalid_request. */
bool proto_derive_decode(const json_t *document, struct proto_derive *out,
                         struct proto_problem *problem);

/* Reads an upload's edits: the parameters components, fill, smooth, subdivide and simplify, in this
 * order. All are optional. Problem: invalid_request. */
bool proto_edits_parse(const struct proto_parameters *parameters, struct proto_edits *out,
                       struct proto_problem *problem);

/* Most bytes that proto_edits_encode writes. */
#define PROTO_EDITS_TEXT (GD_EDIT_STEPS_MOST * 128)

/* Writes the edits as a request's array of operations. */
void proto_edits_encode(struct proto_writer *writer, const struct proto_edits *edits);
