/* See field_build.h.
 *
 * How large a field gets is not known before it is built. So a build is granted what most fields need, taken from
 * the budget in full before it begins, and started again with several times as much when that was too little: the
 * work done in vain is a fraction of the last attempt's. */
#include "server/field_build.h"

#include "server/server.h"

#define BYTES_AN_EDGE 1024 /* while it is built; what is kept of it is a quarter */
#define BYTES_A_FIELD ((size_t)1 << 20)
#define GRANT_FACTOR  4

static enum gd_status build_within(struct server_exchange *exchange, struct server_flight *flight,
                                   const struct gd_mesh *mesh, const struct gd_field_request *request, size_t grant,
                                   struct gd_field **out)
{
    struct server_budget *budget = &exchange->server->budget;
    struct server_monitor monitor = {.exchange = exchange, .flight = flight};
    struct gd_control control = server_exchange_control(&monitor, grant);
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, grant)) return GD_BUDGET;
    enum gd_status status = gd_field_build(mesh, request, &control, NULL, out, NULL);
    server_budget_adjust(budget, SERVER_BUDGET_FLIGHT, grant, status ? 0 : gd_field_memsize(*out));
    return status;
}

enum gd_status server_field_build(struct server_exchange *exchange, struct server_flight *flight,
                                  const struct gd_mesh *mesh, const struct gd_point *source,
                                  const struct gd_point *target, struct gd_field **out)
{
    const struct gd_seed seed = {.point = *source};
    const struct gd_field_request request = {.seeds = &seed, .seed_count = 1, .target = target};
    size_t grant = BYTES_A_FIELD + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE;
    for (;; grant *= GRANT_FACTOR) {
        size_t most = server_budget_available(&exchange->server->budget);
        bool is_last = grant >= most;
        enum gd_status status = build_within(exchange, flight, mesh, &request, is_last ? most : grant, out);
        if (status != GD_BUDGET || is_last) return status;
    }
}
