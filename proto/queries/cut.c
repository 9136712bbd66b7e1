#include "proto/queries/cut.h"

#include "proto/json/writer.h"

bool proto_cut_request_check(const struct proto_object *object, struct proto_cut_request *read)
{
    return !read->select_only || !read->names.count ||
           proto_problem_refuse(
               object->problem, "/names",
               "\"select_only\" makes no meshes, so there is nothing to name; leave one out");
}

/* --- the answer ------------------------------------------------------------------------------- */

#define PIECE_FIELDS                                                                               \
    (PROTO_CUT_FIELD_NAME | PROTO_CUT_FIELD_VERTICES | PROTO_CUT_FIELD_FACES |                     \
     PROTO_CUT_FIELD_AREA | PROTO_CUT_FIELD_VERTEX_MAP | PROTO_CUT_FIELD_FACE_MAP)

/* Returns the selected fields of a piece; 0 means no pieces. */
static uint32_t piece_fields(uint32_t fields)
{
    return proto_fields_within(fields, PROTO_CUT_FIELD_PIECES, PIECE_FIELDS);
}

void proto_cut_begin(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields)
{
    proto_write_object_begin(writer);
    if (fields & PROTO_CUT_FIELD_SEPARATES) proto_member_bool(writer, "separates", cut->separates);
    if (!piece_fields(fields)) return;
    proto_member_array(writer, "pieces");
}

void proto_cut_end(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields)
{
    if (piece_fields(fields)) proto_write_array_end(writer);
    if (fields & PROTO_CUT_FIELD_LARGEST_SHIFT)
        proto_member_number(writer, "largest_shift", cut->largest_shift);
    proto_write_object_end(writer);
}

void proto_cut_piece_encode(struct proto_writer *writer, const struct gd_cut_piece *piece,
                            const char *name, uint32_t fields)
{
    static const uint32_t of_meshes =
        PROTO_CUT_FIELD_NAME | PROTO_CUT_FIELD_VERTICES | PROTO_CUT_FIELD_VERTEX_MAP;
    uint32_t wanted = piece_fields(fields);
    if (!wanted) return;
    if (!name) wanted &= ~of_meshes;
    const struct proto_options options = {.fields = wanted, .names = proto_cut_fields};
    uint32_t vertices = piece->polygons.position_count;
    proto_write_object_begin(writer);
    if (proto_field(writer, &options, PROTO_CUT_FIELD_NAME)) proto_write_string(writer, name);
    proto_field_uint(writer, &options, PROTO_CUT_FIELD_VERTICES, vertices);
    proto_field_uint(writer, &options, PROTO_CUT_FIELD_FACES, piece->face_count);
    proto_field_number(writer, &options, PROTO_CUT_FIELD_AREA, piece->area);
    if (proto_field(writer, &options, PROTO_CUT_FIELD_VERTEX_MAP))
        proto_write_indices(writer, piece->vertex_map, vertices);
    if (proto_field(writer, &options, PROTO_CUT_FIELD_FACE_MAP))
        proto_write_indices(writer, piece->face_map, piece->face_count);
    proto_write_object_end(writer);
}
