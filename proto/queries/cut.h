/* Cut: a mesh cut along a curve. The answer is {"separates", "pieces": [{"name", "vertices", "faces", "area",
 * "vertex_map", "face_map"}], "largest_shift"}, without "name", "vertices" and "vertex_map" when
 * nothing but faces was selected. */
#ifndef PROTO_CUT_H
#define PROTO_CUT_H

#include "gd/cut.h"
#include "generated/requests.h"
#include "proto/http/options.h"

/* Its request, without names where none are made. invalid_request, too_large, insufficient_memory.
 * Freed by proto_cut_request_free. */
bool proto_cut_decode(const json_t *document, struct proto_cut_request *out,
                      struct proto_problem *problem);

/* The answer is begin, proto_cut_piece_encode for each piece in turn, end; `fields` as in the
 * options. */
void proto_cut_begin(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields);
void proto_cut_end(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields);

/* `name`: of the mesh that the piece has become; NULL: faces were selected only. */
void proto_cut_piece_encode(struct proto_writer *writer, const struct gd_cut_piece *piece,
                            const char *name, uint32_t fields);

#endif
