/* See pair_search.h. */
#include "server/pair_search.h"

#include "server/call.h"

#define BYTES_AN_EDGE  224               /* the arrays of a workspace and the windows of a far pair; see doc/003 */
#define BYTES_A_SEARCH ((size_t)1 << 20) /* on any mesh: the queue, and what is taken in advance */

struct search {
    const struct gd_mesh *mesh;
    const struct gd_point *from, *to;
    bool want_path;
    const struct gd_landmarks *landmarks;
    struct gd_pair_answer *out;
};

static enum gd_status search(void *user, const struct gd_control *control, size_t *kept)
{
    const struct search *wanted = user;
    *kept = 0; /* a path is small, and soon gone */
    return gd_pair_solve(wanted->mesh, wanted->from, wanted->to, wanted->want_path, wanted->landmarks, control,
                         wanted->out, NULL);
}

enum gd_status server_pair_search(struct server_exchange *exchange, const struct gd_mesh *mesh,
                                  const struct gd_point *from, const struct gd_point *to, bool want_path,
                                  const struct gd_landmarks *landmarks, struct gd_pair_answer *out)
{
    struct search wanted = {mesh, from, to, want_path, landmarks, out};
    struct server_monitor monitor = {.exchange = exchange};
    const struct server_call call = {.make = search,
                                     .user = &wanted,
                                     .control = server_exchange_control(&monitor),
                                     .grant = BYTES_A_SEARCH + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE};
    return server_call_make(exchange->server, &call);
}
