/* Levels: builds the discretization of a level of a subdivision surface before a query needs it. A
 * worker builds the missing grid or mesh. The cache keeps and counts this discretization like one
 * that a query built. */
#include "server/api/smooth/smooth.h"

#include "proto/json/writer.h"
#include "proto/queries/limit_paths.h"
#include "server/query/api.h"
#include "server/query/handlers.h"
#include "server/surfaces/kinds.h"

struct level {
    struct server_query query; /* must be the first member */
    struct proto_limit_level wanted;
    size_t bytes; /* bytes of all discretizations that the request names */
    struct gd_detail detail;
};

static bool level_decode(struct server_query *query, const json_t *document)
{
    return proto_limit_level_request(document, server_subdivision_of(query->surface)->surface,
                                     &((struct level *)query)->wanted, query->problem);
}

/* Builds the grid or the mesh. This work is the part [begun, begun + share] of the query's
 * progress. */
static enum gd_status level_build(struct level *level, bool wants_grid, double begun, double share)
{
    struct server_query *query = &level->query;
    struct server_subdivision *subdivision = server_subdivision_of(query->surface);
    struct server_monitor monitor = server_query_monitor(query, begun, share);
    const struct server_discretization_request request = {.slot = &subdivision->slot,
                                                          .surface = subdivision->surface,
                                                          .level = level->wanted.level,
                                                          .wants_grid = wants_grid,
                                                          .control =
                                                              server_exchange_control(&monitor),
                                                          .detail = &level->detail};
    struct server_discretization *built;
    enum gd_status status =
        server_discretizations_get(query->exchange->host->api->discretizations, &request, &built);
    if (status) return status;
    level->bytes += built->item.bytes;
    server_discretization_release(built);
    return GD_OK;
}

static enum server_query_turn level_solve(struct server_query *query)
{
    struct level *level = (struct level *)query;
    const struct proto_limit_level *wanted = &level->wanted;
    double grid_share = wanted->for_paths ? 0.2 : 1;
    enum gd_status status = wanted->for_traces ? level_build(level, true, 0, grid_share) : GD_OK;
    if (!status && wanted->for_paths)
        status = level_build(level, false, wanted->for_traces ? grid_share : 0,
                             wanted->for_traces ? 1 - grid_share : 1);
    if (status) return server_smooth_fail(query, status, &level->detail, "the discretization");
    return SERVER_QUERY_DONE;
}

static void level_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct level *level = (const struct level *)query;
    proto_write_object_begin(writer);
    proto_member_uint(writer, "level", level->wanted.level);
    proto_member_uint(writer, "bytes", level->bytes);
    proto_write_object_end(writer);
}

const struct server_query_kind server_query_subdivision_level = {.name = "levels",
                                                                 .size = sizeof(struct level),
                                                                 .decode = level_decode,
                                                                 .solve = level_solve,
                                                                 .encode = level_encode};
