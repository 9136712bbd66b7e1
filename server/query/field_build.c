/* See field_build.h. */
#include "server/query/field_build.h"

#include "server/fields/cache.h"
#include "server/work/budgeted_call.h"
#include "server/work/executor.h"
#include "server/query/api.h"

/* while two threads build it; what is kept of it: 50 on flat meshes, 200 to 400 on scans */
#define BYTES_AN_EDGE 1024
#define BYTES_A_FIELD ((size_t)1 << 20) /* of any size: the queue, and what is taken in advance */

size_t server_field_build_grant(const struct gd_mesh *mesh)
{
    return BYTES_A_FIELD + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE;
}

struct build {
    const struct gd_mesh *mesh;
    struct gd_field_request request;
    const struct gd_field *nearer; /* to be resumed; or NULL */
    const struct gd_executor *executor;
    struct gd_field **out;
};

static enum gd_status build(void *user, const struct gd_control *control, size_t *kept)
{
    struct build *wanted = user;
    enum gd_status status = wanted->nearer
                                ? gd_field_resume(wanted->nearer, wanted->request.radius, control,
                                                  wanted->executor, wanted->out, NULL)
                                : gd_field_build(wanted->mesh, &wanted->request, control,
                                                 wanted->executor, wanted->out, NULL);
    if (!status) *kept = gd_field_memsize(*wanted->out);
    return status;
}

/* Of a field that was resumed, what came to the nearer one's. */
static uint64_t count_windows(const struct build *built)
{
    uint64_t all = gd_field_statistics(*built->out)->windows_propagated;
    uint64_t before = built->nearer ? gd_field_statistics(built->nearer)->windows_propagated : 0;
    return all > before ? all - before : 0;
}

static enum gd_status call(struct server_monitor *part, struct build *wanted)
{
    struct server_host *host = part->exchange->host;
    wanted->executor = server_executor_start(host->workers, 2, part->exchange->job.deadline_ns);
    const struct server_budgeted_call call = {.make = build,
                                              .user = wanted,
                                              .control = server_exchange_control(part),
                                              .grant = server_field_build_grant(wanted->mesh)};
    enum gd_status status = server_budgeted_call_run(host->workspaces, &call);
    server_executor_stop(wanted->executor);
    if (!status) server_metrics_count_windows(host->metrics, count_windows(wanted));
    return status;
}

/* Where there is no room beside the nearer field, or rounding has spoilt it, the farther one is
 * built from its seeds. */
enum gd_status server_field_build_request(struct server_monitor *part, const struct gd_mesh *mesh,
                                          const struct gd_field_request *request,
                                          struct gd_field **out)
{
    const struct server_cached *nearer = part->build ? server_cache_find_nearer(part->build) : NULL;
    struct build wanted = {
        .mesh = mesh, .request = *request, .nearer = nearer ? nearer->field : NULL, .out = out};
    enum gd_status status = call(part, &wanted);
    server_cache_unpin(nearer);
    if (!nearer || (status != GD_BUDGET && status != GD_INTERNAL)) return status;
    wanted.nearer = NULL;
    return call(part, &wanted);
}
