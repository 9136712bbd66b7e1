/* Log: the vectors of the shortest paths from a point to others. A few are searched one by one,
 * unless the field of the point is cached; for many, and for all vertices, the field is found,
 * built or waited for (field_query.h). */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/vector.h"
#include "server/query/field_query.h"
#include "server/query/shortest.h"
#include "server/http/reply.h"

#define FEW          8    /* targets that take less time to search than a field takes to build */
#define CHUNK        1024 /* vectors between two looks at the control */
#define BYTES_A_NODE 16   /* angle and length of a vertex */
#define WHAT         "the answer"

struct log_map {
    struct server_field_query field; /* first */
    struct gd_seed from;
    struct proto_located_set set;   /* `from` alone */
    double snap;                    /* how far it was moved; NAN: not at all */
    struct proto_located_points to; /* empty: all vertices */
    bool first_vector_only;
};

static void release(struct server_query *query)
{
    struct log_map *map = (struct log_map *)query;
    proto_located_points_free(&map->to);
    server_field_query_release(query);
}

/* --- the answer ------------------------------------------------------------------------------- */

static bool wants_vectors(const struct log_map *map)
{
    return map->field.query.options.fields & PROTO_LOG_FIELD_VECTORS;
}

static void begin_answer(struct log_map *map)
{
    struct proto_writer *writer = &map->field.query.draft;
    proto_write_object_begin(writer);
    if (map->field.query.options.fields & PROTO_LOG_FIELD_FROM)
        proto_member_point(writer, "from", map->field.query.surface->mesh, &map->from.point,
                           map->snap);
    if (!wants_vectors(map)) return;
    proto_write_key(writer, "vectors");
    proto_write_array_begin(writer);
}

static enum server_query_turn end_answer(struct log_map *map, enum gd_status status,
                                         struct proto_problem *problem)
{
    struct proto_writer *writer = &map->field.query.draft;
    if (wants_vectors(map)) proto_write_array_end(writer);
    proto_write_object_end(writer);
    return server_query_end_draft(&map->field.query, status, WHAT, problem);
}

/* The answer of a pair, which is used up, as a vector. */
static enum gd_status write_pair(struct log_map *map, struct gd_pair_answer *answer)
{
    struct proto_writer *writer = &map->field.query.draft;
    struct gd_log vectors = {0};
    enum gd_status status = GD_OK;
    if (isinf(answer->distance)) {
        proto_vector_encode(writer, NULL, answer->distance);
        return server_query_check_draft(&map->field.query);
    }
    status = gd_vector_log(map->field.query.surface->mesh, &answer->path, &vectors, NULL);
    gd_pair_answer_free(answer);
    if (status) return status;
    if (map->first_vector_only && vectors.count) {
        vectors.vector = vectors.segments[0];
        vectors.count = 1;
    }
    proto_log_encode(writer, &vectors, answer->is_cut);
    gd_log_free(&vectors);
    return server_query_check_draft(&map->field.query);
}

/* --- from the field --------------------------------------------------------------------------- */

static enum gd_status write_targets(struct log_map *map, const struct gd_field *field,
                                    struct server_monitor *part)
{
    const struct gd_control control = server_exchange_control(part);
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < map->to.count && !status; i++) {
        struct gd_pair_answer answer;
        status = gd_pair_from_field(field, &map->from.point, &map->to.points[i],
                                    GD_PAIR_PATH_AND_CUT, &answer);
        if (!status) status = write_pair(map, &answer);
        if (!status) status = gd_control_check(&control, (double)(i + 1) / map->to.count);
    }
    return status;
}

static void write_vertex(struct log_map *map, double angle, double length)
{
    const struct gd_mesh *mesh = map->field.query.surface->mesh;
    struct gd_direction direction;
    if (isnan(length)) {
        proto_write_null(&map->field.query.draft); /* no face has it */
        return;
    }
    bool has_direction =
        !isnan(angle) && !gd_direction_at_angle(mesh, &map->from.point, angle, &direction, NULL);
    proto_vector_encode(&map->field.query.draft, has_direction ? &direction : NULL, length);
}

static enum gd_status write_vertices(struct log_map *map, const double *angles,
                                     const double *lengths, const struct gd_control *control)
{
    uint32_t count = gd_mesh_summary(map->field.query.surface->mesh)->index_count;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < count && !status; i++) {
        write_vertex(map, angles[i], lengths[i]);
        if (i % CHUNK) continue;
        status = server_query_check_draft(&map->field.query);
        if (!status) status = gd_control_check(control, (double)i / count);
    }
    return status ? status : server_query_check_draft(&map->field.query);
}

static enum gd_status write_all(struct log_map *map, const struct gd_field *field,
                                struct server_monitor *part)
{
    struct server_monitor first = server_monitor_portion(part, 0, 0.5),
                          second = server_monitor_portion(part, 0.5, 0.5);
    const struct gd_control mapping = server_exchange_control(&first),
                            writing = server_exchange_control(&second);
    size_t count = gd_mesh_summary(map->field.query.surface->mesh)->index_count,
           bytes = 2 * count * BYTES_A_NODE;
    enum gd_status status = server_query_take(&map->field.query, bytes);
    if (status) return status;
    double *angles = malloc(2 * count * sizeof *angles);
    status =
        angles ? gd_vector_log_all(field, &mapping, angles, angles + count, NULL) : GD_NO_MEMORY;
    if (!status) status = write_vertices(map, angles, angles + count, &writing);
    free(angles);
    return status;
}

static enum server_query_turn answer(struct server_field_query *query, const struct gd_field *field,
                                     struct server_monitor *part, struct proto_problem *problem)
{
    struct log_map *map = (struct log_map *)query;
    begin_answer(map);
    return end_answer(map,
                      map->to.count ? write_targets(map, field, part) : write_all(map, field, part),
                      problem);
}

/* --- the steps -------------------------------------------------------------------------------- */

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct log_map *map = (struct log_map *)query;
    const struct gd_mesh *mesh = query->surface->mesh;
    struct proto_log wanted;
    if (!proto_log_decode(document, &wanted, problem)) return false;
    bool ok = proto_point_locate(mesh, &wanted.from, &map->from.point, &map->snap, problem) &&
              (!wanted.to.count || proto_points_locate(mesh, &wanted.to, &map->to, problem));
    proto_points_free(&wanted.to);
    map->first_vector_only = wanted.first_vector_only;
    map->set = (struct proto_located_set){.count = 1, .seed_count = 1, .seeds = &map->from};
    server_field_query_of_located(&map->field, &map->set, 0);
    map->field.answer = answer;
    return ok;
}

static bool is_searched(const struct log_map *map)
{
    return !wants_vectors(map) || (!map->field.pin && map->to.count && map->to.count <= FEW);
}

static bool join(struct server_query *query)
{
    return !is_searched((const struct log_map *)query) && server_field_query_join(query);
}

static enum gd_status search(struct log_map *map)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < map->to.count && !status; i++) {
        struct server_monitor part =
            server_query_monitor(&map->field.query, (double)i / map->to.count, 1.0 / map->to.count);
        struct gd_pair_answer answer;
        status = server_shortest_path(&map->field.query, &part, &map->from.point,
                                      &map->to.points[i], GD_PAIR_PATH_AND_CUT, &answer);
        if (!status) status = write_pair(map, &answer);
    }
    return status;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct log_map *map = (struct log_map *)query;
    if (!is_searched(map)) return server_field_query_solve(query, problem);
    begin_answer(map);
    return end_answer(map, wants_vectors(map) ? search(map) : GD_OK, problem);
}

static const struct server_query_kind log_kind = {.name = "log",
                                                  .size = sizeof(struct log_map),
                                                  .fields = proto_log_fields,
                                                  .decode = decode,
                                                  .glance = server_field_query_glance,
                                                  .join = join,
                                                  .solve = solve,
                                                  .release = release};

void server_handle_log(struct server_exchange *exchange)
{
    server_query_handle(exchange, &log_kind);
}
