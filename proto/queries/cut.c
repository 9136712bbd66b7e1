#include "proto/queries/cut.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"
#include "proto/json/member.h"

const char *const proto_cut_fields[] = {"separates",     "pieces", "name",       "vertices",
                                        "faces",         "area",   "vertex_map", "face_map",
                                        "largest_shift", NULL};

void proto_cut_free(struct proto_cut *cut)
{
    proto_curve_free(&cut->curve);
    free(cut->names);
    *cut = (struct proto_cut){0};
}

/* --- the request ------------------------------------------------------------------------------ */

static bool decode_name(const json_t *value, char name[PROTO_MESH_NAME + 1],
                        struct proto_problem *problem)
{
    if (!json_is_string(value)) return proto_problem_refuse(problem, "", "expected a name here");
    size_t length = json_string_length(value);
    if (!proto_mesh_name_check(json_string_value(value), length, problem)) return false;
    memcpy(name, json_string_value(value), length);
    name[length] = '\0';
    return true;
}

static bool decode_names(const json_t *names, struct proto_cut *cut, struct proto_problem *problem)
{
    size_t count = json_array_size(names); /* 0 when it is no array */
    if (cut->select_only)
        return proto_problem_refuse(
            problem, "/names",
            "with \"select_only\" no meshes are made that could have names; leave one out");
    if (count == 0 || count > PROTO_CUT_NAMES)
        return proto_problem_refuse(problem, "/names", "expected an array of 1 to %d names",
                                    PROTO_CUT_NAMES);
    cut->names = calloc(count, sizeof *cut->names);
    if (!cut->names) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (cut->name_count = 0; cut->name_count < count; cut->name_count++) {
        char index[24];
        if (decode_name(json_array_get(names, cut->name_count), cut->names[cut->name_count],
                        problem))
            continue;
        snprintf(index, sizeof index, "%u", cut->name_count);
        proto_problem_at(problem, "/names");
        return proto_problem_descend(problem, index);
    }
    return true;
}

static bool decode_members(const json_t *document, struct proto_cut *cut,
                           struct proto_problem *problem)
{
    const json_t *inside = json_object_get(document, "inside"),
                 *names = json_object_get(document, "names"),
                 *curve = proto_decode_member(document, "", "curve", problem);
    if (!curve || !proto_curve_decode(curve, "/curve", &cut->curve, problem)) return false;
    if (!proto_decode_flag(document, "", "select_only", &cut->select_only, problem)) return false;
    cut->has_inside = inside != NULL;
    if (inside && !proto_point_decode(inside, "/inside", &cut->inside, problem)) return false;
    return !names || decode_names(names, cut, problem);
}

bool proto_cut_decode(const json_t *document, struct proto_cut *out, struct proto_problem *problem)
{
    static const char *const members[] = {"curve", "inside", "select_only", "names", NULL};
    struct proto_cut cut = {0};
    if (!proto_decode_object(document, "", members, problem)) return false;
    if (!decode_members(document, &cut, problem)) {
        proto_cut_free(&cut);
        return false;
    }
    *out = cut;
    return true;
}

/* --- the answer ------------------------------------------------------------------------------- */

#define PIECE_FIELDS                                                                               \
    (PROTO_CUT_FIELD_NAME | PROTO_CUT_FIELD_VERTICES | PROTO_CUT_FIELD_FACES |                     \
     PROTO_CUT_FIELD_AREA | PROTO_CUT_FIELD_VERTEX_MAP | PROTO_CUT_FIELD_FACE_MAP)

/* Of a piece; 0: no pieces are wanted. */
static uint32_t piece_fields(uint32_t fields)
{
    return proto_fields_within(fields, PROTO_CUT_FIELD_PIECES, PIECE_FIELDS);
}

void proto_cut_begin(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields)
{
    proto_write_object_begin(writer);
    if (fields & PROTO_CUT_FIELD_SEPARATES) proto_member_bool(writer, "separates", cut->separates);
    if (!piece_fields(fields)) return;
    proto_write_key(writer, "pieces");
    proto_write_array_begin(writer);
}

void proto_cut_end(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields)
{
    if (piece_fields(fields)) proto_write_array_end(writer);
    if (fields & PROTO_CUT_FIELD_LARGEST_SHIFT)
        proto_member_number(writer, "largest_shift", cut->largest_shift);
    proto_write_object_end(writer);
}

static void encode_map(struct proto_writer *writer, const char *key, const uint32_t *map,
                       uint32_t count)
{
    proto_write_key(writer, key);
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < count; i++) {
        if (map[i] == GD_NONE)
            proto_write_null(writer);
        else
            proto_write_uint(writer, map[i]);
    }
    proto_write_array_end(writer);
}

void proto_cut_piece_encode(struct proto_writer *writer, const struct gd_cut_piece *piece,
                            const char *name, uint32_t fields)
{
    static const uint32_t of_meshes =
        PROTO_CUT_FIELD_NAME | PROTO_CUT_FIELD_VERTICES | PROTO_CUT_FIELD_VERTEX_MAP;
    uint32_t wanted = piece_fields(fields);
    if (!wanted) return;
    if (!name) wanted &= ~of_meshes;
    proto_write_object_begin(writer);
    if (wanted & PROTO_CUT_FIELD_NAME) proto_member_string(writer, "name", name);
    if (wanted & PROTO_CUT_FIELD_VERTICES)
        proto_member_uint(writer, "vertices", piece->polygons.position_count);
    if (wanted & PROTO_CUT_FIELD_FACES) proto_member_uint(writer, "faces", piece->face_count);
    if (wanted & PROTO_CUT_FIELD_AREA) proto_member_number(writer, "area", piece->area);
    if (wanted & PROTO_CUT_FIELD_VERTEX_MAP)
        encode_map(writer, "vertex_map", piece->vertex_map, piece->polygons.position_count);
    if (wanted & PROTO_CUT_FIELD_FACE_MAP)
        encode_map(writer, "face_map", piece->face_map, piece->face_count);
    proto_write_object_end(writer);
}
