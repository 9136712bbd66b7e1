#include "proto/queries/pair.h"

#include <math.h>

#include "generated/requests.h"
#include "proto/json/writer.h"
#include "proto/queries/evaluation.h"
#include "proto/values/path.h"

#define ENDS_BYTES 800 /* approximate bytes of an answer without the path */

/* --- the request ------------------------------------------------------------------------------ */

static bool decode_stops(const json_t *document, struct proto_points *stops,
                         struct proto_problem *problem)
{
    if (!proto_decode_object(document, "", proto_pair_request_members, problem)) return false;
    if (!proto_points_decode_member(stops, document, "/from", problem)) return false;
    const json_t *via = json_object_get(document, "via");
    if (via && !proto_points_decode(stops, via, "/via", PROTO_PAIR_VIA, problem)) return false;
    return proto_points_decode_member(stops, document, "/to", problem);
}

static bool parse_end(struct proto_points *stops, const struct proto_parameters *parameters,
                      const char *name, struct proto_problem *problem)
{
    const char *text = proto_parameters_require(parameters, name, problem);
    struct proto_point *end = text ? proto_points_add(stops, problem) : NULL;
    return end && proto_point_parse(text, name, end, problem);
}

static bool parse_stops(const struct proto_parameters *parameters, struct proto_points *stops,
                        struct proto_problem *problem)
{
    if (!parse_end(stops, parameters, "from", problem)) return false;
    const char *via = proto_parameters_get(parameters, "via");
    if (via && !proto_points_parse(stops, via, "via", PROTO_PAIR_VIA, problem)) return false;
    return parse_end(stops, parameters, "to", problem);
}

/* Moves the stops to the caller if they were read, otherwise frees them. */
static bool hand_over(struct proto_points *stops, bool was_read, struct proto_points *out)
{
    if (was_read)
        *out = *stops;
    else
        proto_points_free(stops);
    return was_read;
}

bool proto_pair_decode(const json_t *document, struct proto_points *out,
                       struct proto_problem *problem)
{
    struct proto_points stops = {0};
    return hand_over(&stops, decode_stops(document, &stops, problem), out);
}

bool proto_pair_parse(const struct proto_parameters *parameters, struct proto_points *out,
                      struct proto_problem *problem)
{
    struct proto_points stops = {0};
    return hand_over(&stops, parse_stops(parameters, &stops, problem), out);
}

/* --- the answer ------------------------------------------------------------------------------- */

void proto_pair_encode(struct proto_writer *writer, const struct proto_located_points *stops,
                       const struct gd_pair_answer *answer, const struct proto_options *options)
{
    uint32_t fields = options->fields, last = stops->count - 1;
    size_t path_bytes = fields & PROTO_PATH_FIELD_PATH
                            ? proto_path_bytes(answer->path.count, options->geometry)
                            : 0;
    /* reserved at once, because the path is most of the answer's memory */
    proto_writer_expect(writer, ENDS_BYTES + path_bytes);
    proto_write_object_begin(writer);
    proto_distance_encode(writer, answer->distance, fields & PROTO_PATH_FIELD_DISTANCE,
                          fields & PROTO_PATH_FIELD_REASON);
    if (fields & PROTO_PATH_FIELD_FROM)
        proto_member_point(writer, "from", stops->mesh, stops->points, stops->snaps[0]);
    if (fields & PROTO_PATH_FIELD_TO)
        proto_member_point(writer, "to", stops->mesh, &stops->points[last], stops->snaps[last]);
    if (fields & PROTO_PATH_FIELD_VIA && last > 1) {
        proto_write_key(writer, "via");
        proto_located_points_encode(writer, stops, 1, last - 1);
    }
    if (fields & PROTO_PATH_FIELD_PATH) {
        proto_write_key(writer, "path");
        proto_path_encode(writer, stops->mesh, isfinite(answer->distance) ? &answer->path : NULL,
                          options->geometry);
    }
    proto_write_object_end(writer);
}
