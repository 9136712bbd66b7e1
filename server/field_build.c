/* See field_build.h. */
#include "server/field_build.h"

#include "server/call.h"

#define BYTES_AN_EDGE 512 /* while it is built; what is kept of it: 50 on flat meshes, 200 to 400 on scans */
#define BYTES_A_FIELD ((size_t)1 << 20) /* of any size: the queue, and what is taken in advance */

struct build {
    const struct gd_mesh *mesh;
    struct gd_field_request request;
    struct gd_field **out;
};

static enum gd_status build(void *user, const struct gd_control *control, size_t *kept)
{
    struct build *wanted = user;
    enum gd_status status = gd_field_build(wanted->mesh, &wanted->request, control, NULL, wanted->out, NULL);
    if (!status) *kept = gd_field_memsize(*wanted->out);
    return status;
}

enum gd_status server_field_build(struct server_exchange *exchange, struct server_flight *flight,
                                  const struct gd_mesh *mesh, const struct gd_point *source, struct gd_field **out)
{
    const struct gd_seed seed = {.point = *source};
    struct build wanted = {.mesh = mesh, .request = {.seeds = &seed, .seed_count = 1}, .out = out};
    struct server_monitor monitor = {.exchange = exchange, .flight = flight};
    const struct server_call call = {.make = build,
                                     .user = &wanted,
                                     .control = server_exchange_control(&monitor),
                                     .grant = BYTES_A_FIELD + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE};
    return server_call_make(exchange->server, &call);
}
