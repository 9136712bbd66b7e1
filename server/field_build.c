/* See field_build.h. */
#include "server/field_build.h"

#include "server/call.h"
#include "server/team.h"

#define BYTES_AN_EDGE 1024 /* while two threads build it; what is kept of it: 50 on flat meshes, 200 to 400 on scans */
#define BYTES_A_FIELD ((size_t)1 << 20) /* of any size: the queue, and what is taken in advance */

size_t server_field_build_grant(const struct gd_mesh *mesh)
{
    return BYTES_A_FIELD + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE;
}

struct build {
    const struct gd_mesh *mesh;
    struct gd_field_request request;
    const struct gd_executor *executor;
    struct gd_field **out;
};

static enum gd_status build(void *user, const struct gd_control *control, size_t *kept)
{
    struct build *wanted = user;
    enum gd_status status =
        gd_field_build(wanted->mesh, &wanted->request, control, wanted->executor, wanted->out, NULL);
    if (!status) *kept = gd_field_memsize(*wanted->out);
    return status;
}

enum gd_status server_field_build_request(struct server_monitor *part, const struct gd_mesh *mesh,
                                          const struct gd_field_request *request, struct gd_field **out)
{
    struct server *server = part->exchange->server;
    struct server_team *team = server_team_call(server->workers, part->exchange->job.deadline_ns);
    struct build wanted = {.mesh = mesh, .request = *request, .executor = server_team_executor(team), .out = out};
    const struct server_call call = {.make = build,
                                     .user = &wanted,
                                     .control = server_exchange_control(part),
                                     .grant = server_field_build_grant(mesh)};
    enum gd_status status = server_call_make(server, &call);
    server_team_dismiss(team);
    return status;
}
