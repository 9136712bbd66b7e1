/* Pair: distance and path between two points. Both take {from, to}; the answer of path has the path too. */
#ifndef PROTO_PAIR_H
#define PROTO_PAIR_H

#include "gd/query.h"
#include "proto/options.h"
#include "proto/point.h"

struct proto_pair {
    struct proto_point from, to;
};

/* Fields of the answers, as bits of proto_options.fields. The reason comes with a distance that is null, asked for or
 * not. */
enum proto_pair_field {
    PROTO_PAIR_FIELD_DISTANCE = 1 << 0,
    PROTO_PAIR_FIELD_REASON = 1 << 1,
    PROTO_PAIR_FIELD_FROM = 1 << 2,
    PROTO_PAIR_FIELD_TO = 1 << 3,
    PROTO_PAIR_FIELD_PATH = 1 << 4 /* set: a path is wanted, so it has to be computed */
};
extern const char *const proto_distance_fields[]; /* NULL-terminated, for proto_options_parse */
extern const char *const proto_path_fields[];

/* Query-string parameters of the GET form: from, to. NULL-terminated, for proto_options_parse; the POST form has none
 * of its own. */
extern const char *const proto_pair_parameters[];

/* From the body of POST, and from the query string of GET. invalid_request. */
bool proto_pair_decode(const json_t *document, struct proto_pair *out, struct proto_problem *problem);
bool proto_pair_parse(const struct proto_parameters *parameters, struct proto_pair *out, struct proto_problem *problem);

/* The two points on their mesh. */
struct proto_located_pair {
    const struct gd_mesh *mesh; /* borrowed */
    struct gd_point from, to;
    double from_snap, to_snap; /* NAN: not snapped */
};

/* proto_point_locate for both. The mesh stays borrowed. */
bool proto_pair_locate(const struct gd_mesh *mesh, const struct proto_pair *pair, struct proto_located_pair *out,
                       struct proto_problem *problem);

/* Writes {"distance", "reason"?, "from", "to", "path"?}, of these the fields that were asked for. An infinite distance
 * is null with the reason no_path, and so is its path. */
void proto_pair_encode(struct proto_writer *writer, const struct proto_located_pair *pair,
                       const struct gd_pair_answer *answer, const struct proto_options *options);

#endif
