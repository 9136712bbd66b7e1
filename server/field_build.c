/* See field_build.h.
 *
 * How large a field gets is not known before it is built. So a build is granted what most fields need, taken from
 * the budget in full before it begins, and started again with several times as much when that was too little: the
 * work done in vain is a fraction of the last attempt's. */
#include "server/field_build.h"

#include "server/server.h"

#define BYTES_AN_EDGE                                                                                                  \
    512 /* while it is built: 75 to 110 before it begins, then what is kept: 50 on flat meshes, 400 on scans */
#define BYTES_A_FIELD ((size_t)1 << 20) /* of any size: the queue, and what is taken in advance */
#define GRANT_FACTOR  4

/* One field that is wanted. */
struct build {
    struct server_exchange *exchange;
    struct server_flight *flight;
    const struct gd_mesh *mesh;
    const struct gd_field_request *request;
    struct server_loan loan;
};

/* The workspace's bytes are in flight beside the grant: what it holds from before and what the call may take overlap, but by
 * how much only the engine knows. */
static enum gd_status build_within(struct build *build, size_t grant, struct gd_field **out)
{
    struct server_budget *budget = &build->exchange->server->budget;
    struct server_monitor monitor = {.exchange = build->exchange, .flight = build->flight};
    struct gd_control control = server_exchange_control(&monitor, grant);
    control.workspace = build->loan.workspace;
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, grant)) return GD_BUDGET;
    enum gd_status status = gd_field_build(build->mesh, build->request, &control, NULL, out, NULL);
    size_t field = status ? 0 : gd_field_memsize(*out),
           left = control.workspace ? gd_workspace_bytes(control.workspace) : 0;
    server_budget_adjust(budget, SERVER_BUDGET_FLIGHT, grant + build->loan.bytes, field + left);
    build->loan.bytes = left;
    return status;
}

/* Each grant in turn, until one is enough or all that can be had was not. */
static enum gd_status build_field(struct build *build, struct gd_field **out)
{
    struct server *server = build->exchange->server;
    size_t grant = BYTES_A_FIELD + (size_t)gd_mesh_summary(build->mesh)->edges * BYTES_AN_EDGE;
    for (;; grant *= GRANT_FACTOR) {
        size_t most = server_budget_available(&server->budget);
        if (grant >= most) {
            server_workspaces_trim(server->workspaces, &build->loan);
            most = server_budget_available(&server->budget);
        }
        bool is_last = grant >= most;
        enum gd_status status = build_within(build, is_last ? most : grant, out);
        if (status != GD_BUDGET || is_last) return status;
    }
}

enum gd_status server_field_build(struct server_exchange *exchange, struct server_flight *flight,
                                  const struct gd_mesh *mesh, const struct gd_point *source,
                                  const struct gd_point *target, struct gd_field **out)
{
    const struct gd_seed seed = {.point = *source};
    const struct gd_field_request request = {.seeds = &seed, .seed_count = 1, .target = target};
    struct server_workspaces *workspaces = exchange->server->workspaces;
    struct build build = {.exchange = exchange,
                          .flight = flight,
                          .mesh = mesh,
                          .request = &request,
                          .loan = server_workspaces_borrow(workspaces)};
    enum gd_status status = build_field(&build, out);
    server_workspaces_return(workspaces, &build.loan);
    return status;
}
