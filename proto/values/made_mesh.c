#include "proto/values/made_mesh.h"

#include <string.h>

#include "proto/json/decode.h"
#include "proto/json/member.h"

bool proto_made_mesh_decode(const json_t *document, char out[PROTO_MESH_NAME + 1],
                            struct proto_problem *problem)
{
    const json_t *value = proto_decode_member(document, "", "mesh", problem);
    if (!value) return false;
    if (!json_is_string(value))
        return proto_problem_refuse(problem, "/mesh", "expected the name of the mesh, a string");
    size_t length = json_string_length(value);
    if (!proto_mesh_name_check(json_string_value(value), length, problem))
        return proto_problem_at(problem, "/mesh");
    memcpy(out, json_string_value(value), length);
    out[length] = '\0';
    return true;
}

bool proto_made_tolerance_decode(const json_t *document, double *out, struct proto_problem *problem)
{
    double tolerance;
    if (!proto_decode_number(document, "", "tolerance", &tolerance, problem)) return false;
    if (!(tolerance > 0))
        return proto_problem_refuse(problem, "/tolerance",
                                    "a tolerance is a length of more than 0");
    *out = tolerance;
    return true;
}

void proto_made_of_encode(struct proto_writer *writer, const char *key, const char *name,
                          const char *etag)
{
    proto_write_key(writer, key);
    proto_write_object_begin(writer);
    proto_member_string(writer, "name", name);
    proto_member_string(writer, "etag", etag);
    proto_write_object_end(writer);
}
