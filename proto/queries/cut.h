/* Cut: the query that cuts a mesh along a curve. */
#ifndef PROTO_CUT_H
#define PROTO_CUT_H

#include "gd/cut.h"
#include "generated/requests.h"
#include "proto/http/options.h"

/* Begin and end the answer; proto_cut_piece_encode writes each piece in between. `fields` has the
 * meaning of the member in struct proto_options. */
void proto_cut_begin(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields);
void proto_cut_end(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields);

/* Writes a piece. `name` is the name of its new mesh; NULL means that faces were only selected. */
void proto_cut_piece_encode(struct proto_writer *writer, const struct gd_cut_piece *piece,
                            const char *name, uint32_t fields);

#endif
