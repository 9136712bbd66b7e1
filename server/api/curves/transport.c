/* Transport: vectors moved from one point to another along the shortest path, by a worker. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/evaluation.h"
#include "proto/member.h"
#include "proto/vector.h"
#include "server/query/query.h"
#include "server/query/shortest.h"

#define WHAT "the search"

struct transport {
    struct server_query query; /* first */
    struct proto_located_points ends;
    struct proto_vectors wanted; /* its factors are used up in decoding */
    struct gd_vector *vectors;   /* at from, then at to */
    double distance;             /* INFINITY: no path */
};

static void release(struct server_query *query)
{
    struct transport *transport = (struct transport *)query;
    proto_located_points_free(&transport->ends);
    proto_vectors_free(&transport->wanted);
    free(transport->vectors);
}

/* --- the question ----------------------------------------------------------------------------- */

static bool locate_vectors(struct transport *transport, struct proto_problem *problem)
{
    const struct gd_mesh *mesh = transport->ends.mesh;
    struct proto_vectors *wanted = &transport->wanted;
    transport->vectors = calloc(wanted->count, sizeof *transport->vectors);
    if (!transport->vectors) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < wanted->count; i++) {
        const struct proto_segment *segment = &wanted->segments[wanted->first[i]];
        if (wanted->first[i + 1] == wanted->first[i]) continue;
        if (wanted->first[i + 1] - wanted->first[i] > 1)
            return proto_problem_refuse(
                problem, "/vectors",
                "segments alone can't be moved; send the vector's direction and length as "
                "well");
        if (!proto_segment_locate(mesh, transport->ends.points, segment, &transport->vectors[i],
                                  problem))
            return false;
    }
    if (!wanted->factors) return true;
    transport->vectors[0] = gd_vector_combine(mesh, transport->ends.points, transport->vectors,
                                              wanted->factors, wanted->count);
    wanted->count = 1;
    return true;
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct transport *transport = (struct transport *)query;
    struct proto_transport wanted;
    if (!proto_transport_decode(document, &wanted, problem)) return false;
    transport->wanted = wanted.vectors;
    bool ok = proto_points_locate(query->surface->mesh, &wanted.ends, &transport->ends, problem);
    proto_points_free(&wanted.ends);
    return ok && locate_vectors(transport, problem);
}

/* --- the answer ------------------------------------------------------------------------------- */

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct transport *transport = (struct transport *)query;
    struct server_monitor part = server_query_monitor(query, 0, 1);
    struct gd_pair_answer answer;
    enum gd_status status = server_shortest_path(query, &part, &transport->ends.points[0],
                                                 &transport->ends.points[1], GD_PAIR_PATH, &answer);
    if (status) return server_query_fail(query, status, WHAT, problem);
    transport->distance = answer.distance;
    if (isfinite(answer.distance))
        status = gd_vector_transport(transport->ends.mesh, &answer.path, transport->vectors,
                                     transport->wanted.count, transport->vectors, NULL);
    gd_pair_answer_free(&answer);
    return status ? server_query_fail(query, status, WHAT, problem) : SERVER_QUERY_DONE;
}

static void encode_end(const struct transport *transport, struct proto_writer *writer,
                       const char *key, uint32_t end)
{
    proto_member_point(writer, key, transport->ends.mesh, &transport->ends.points[end],
                       transport->ends.snaps[end]);
}

/* A vector that has no direction keeps none; one that does not exist still does not. */
static void encode_vector(const struct transport *transport, struct proto_writer *writer,
                          uint32_t i)
{
    const struct proto_vectors *wanted = &transport->wanted;
    const struct gd_vector *vector = &transport->vectors[i];
    bool exists = wanted->factors || wanted->first[i] < wanted->first[i + 1],
         has_direction =
             exists && (wanted->factors || wanted->segments[wanted->first[i]].has_direction);
    proto_vector_encode(writer, has_direction ? &vector->direction : NULL,
                        exists ? vector->length : INFINITY);
}

static void encode_vectors(const struct transport *transport, struct proto_writer *writer)
{
    proto_write_key(writer, "vectors");
    if (!isfinite(transport->distance)) {
        proto_write_null(writer);
        return;
    }
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < transport->wanted.count; i++) encode_vector(transport, writer, i);
    proto_write_array_end(writer);
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct transport *transport = (const struct transport *)query;
    uint32_t fields = query->options.fields;
    proto_write_object_begin(writer);
    if (fields & PROTO_TRANSPORT_FIELD_FROM) encode_end(transport, writer, "from", 0);
    if (fields & PROTO_TRANSPORT_FIELD_TO) encode_end(transport, writer, "to", 1);
    if (fields & PROTO_TRANSPORT_FIELD_DISTANCE)
        proto_member_number(writer, "distance", transport->distance);
    if (fields) proto_reason_encode(writer, transport->distance);
    if (fields & PROTO_TRANSPORT_FIELD_VECTORS) encode_vectors(transport, writer);
    proto_write_object_end(writer);
}

static const struct server_query_kind transport_kind = {.name = "transport",
                                                        .size = sizeof(struct transport),
                                                        .fields = proto_transport_fields,
                                                        .decode = decode,
                                                        .solve = solve,
                                                        .encode = encode,
                                                        .release = release};

void server_handle_transport(struct server_exchange *exchange)
{
    server_query_handle(exchange, &transport_kind);
}
