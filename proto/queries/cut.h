/* Cut: a mesh cut along a curve. The request is {"curve", "inside"?: point, "select_only"?: bool,
 * "names"?: [name]}; the answer {"separates", "pieces": [{"name", "vertices", "faces", "area",
 * "vertex_map", "face_map"}], "largest_shift"}, without "name", "vertices" and "vertex_map" when
 * nothing but faces was selected. */
#ifndef PROTO_CUT_H
#define PROTO_CUT_H

#include "gd/cut.h"
#include "proto/values/curve.h"
#include "proto/values/mesh.h"
#include "proto/http/options.h"

#define PROTO_CUT_NAMES 64

/* All zero is an empty one. */
struct proto_cut {
    struct proto_curve curve;
    bool has_inside, select_only;
    struct proto_point inside;
    char (*names)[PROTO_MESH_NAME + 1]; /* owned; NULL: none were given */
    uint32_t name_count;
};

/* invalid_request, too_large, insufficient_memory. Freed by proto_cut_free. */
bool proto_cut_decode(const json_t *document, struct proto_cut *out, struct proto_problem *problem);
void proto_cut_free(struct proto_cut *cut); /* leaves an empty one; a second time is harmless */

/* Fields of the answer, as bits of proto_options.fields: its own, of which `pieces` alone is all of
 * each piece, and those of a piece. */
enum proto_cut_field {
    PROTO_CUT_FIELD_SEPARATES = 1 << 0,
    PROTO_CUT_FIELD_PIECES = 1 << 1,
    PROTO_CUT_FIELD_NAME = 1 << 2,
    PROTO_CUT_FIELD_VERTICES = 1 << 3,
    PROTO_CUT_FIELD_FACES = 1 << 4,
    PROTO_CUT_FIELD_AREA = 1 << 5,
    PROTO_CUT_FIELD_VERTEX_MAP = 1 << 6,
    PROTO_CUT_FIELD_FACE_MAP = 1 << 7,
    PROTO_CUT_FIELD_LARGEST_SHIFT = 1 << 8,
};
extern const char *const proto_cut_fields[]; /* NULL-terminated, for proto_options_parse */

/* The answer is begin, proto_cut_piece_encode for each piece in turn, end; `fields` as in the
 * options. */
void proto_cut_begin(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields);
void proto_cut_end(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields);

/* `name`: of the mesh that the piece has become; NULL: faces were selected only. */
void proto_cut_piece_encode(struct proto_writer *writer, const struct gd_cut_piece *piece,
                            const char *name, uint32_t fields);

#endif
