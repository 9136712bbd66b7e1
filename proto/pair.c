#include "proto/pair.h"

#include <math.h>

#include "proto/decode.h"
#include "proto/path.h"

const char *const proto_distance_fields[] = {"distance", "reason", "from", "to", NULL};
const char *const proto_path_fields[] = {"distance", "reason", "from", "to", "path", NULL};
const char *const proto_pair_parameters[] = {"from", "to", NULL};

/* --- the request
 * -------------------------------------------------------------------------------------------------------- */

bool proto_pair_decode(const json_t *document, struct proto_pair *out, struct proto_problem *problem)
{
    struct proto_pair pair;
    if (!proto_decode_object(document, "", proto_pair_parameters, problem)) return false;
    const json_t *from = proto_decode_member(document, "", "from", problem);
    if (!from || !proto_point_decode(from, "/from", &pair.from, problem)) return false;
    const json_t *to = proto_decode_member(document, "", "to", problem);
    if (!to || !proto_point_decode(to, "/to", &pair.to, problem)) return false;
    *out = pair;
    return true;
}

bool proto_pair_parse(const struct proto_parameters *parameters, struct proto_pair *out, struct proto_problem *problem)
{
    struct proto_pair pair;
    const char *from = proto_parameters_require(parameters, "from", problem);
    if (!from || !proto_point_parse(from, "from", &pair.from, problem)) return false;
    const char *to = proto_parameters_require(parameters, "to", problem);
    if (!to || !proto_point_parse(to, "to", &pair.to, problem)) return false;
    *out = pair;
    return true;
}

bool proto_pair_locate(const struct gd_mesh *mesh, const struct proto_pair *pair, struct proto_located_pair *out,
                       struct proto_problem *problem)
{
    struct proto_located_pair located = {.mesh = mesh};
    if (!proto_point_locate(mesh, &pair->from, &located.from, &located.from_snap, problem)) return false;
    if (!proto_point_locate(mesh, &pair->to, &located.to, &located.to_snap, problem)) return false;
    *out = located;
    return true;
}

/* --- the answer
 * --------------------------------------------------------------------------------------------------------- */

static void encode_path(struct proto_writer *writer, const struct gd_mesh *mesh, const struct gd_pair_answer *answer,
                        enum proto_geometry geometry)
{
    proto_write_key(writer, "path");
    if (isfinite(answer->distance))
        proto_path_encode(writer, mesh, &answer->path, geometry);
    else
        proto_write_null(writer);
}

static void encode_point(struct proto_writer *writer, const char *key, const struct gd_mesh *mesh,
                         const struct gd_point *point, double snap_distance)
{
    proto_write_key(writer, key);
    proto_point_encode(writer, mesh, point, snap_distance);
}

void proto_pair_encode(struct proto_writer *writer, const struct proto_located_pair *pair,
                       const struct gd_pair_answer *answer, const struct proto_options *options)
{
    uint32_t fields = options->fields;
    proto_write_object_begin(writer);
    if (fields & PROTO_PAIR_FIELD_DISTANCE) {
        proto_write_key(writer, "distance");
        proto_write_number(writer, answer->distance);
    }
    if ((fields & (PROTO_PAIR_FIELD_DISTANCE | PROTO_PAIR_FIELD_REASON)) && !isfinite(answer->distance)) {
        proto_write_key(writer, "reason");
        proto_write_string(writer, "no_path");
    }
    if (fields & PROTO_PAIR_FIELD_FROM) encode_point(writer, "from", pair->mesh, &pair->from, pair->from_snap);
    if (fields & PROTO_PAIR_FIELD_TO) encode_point(writer, "to", pair->mesh, &pair->to, pair->to_snap);
    if (fields & PROTO_PAIR_FIELD_PATH) encode_path(writer, pair->mesh, answer, options->geometry);
    proto_write_object_end(writer);
}
