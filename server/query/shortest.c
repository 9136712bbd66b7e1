/* See shortest.h. */
#include "server/query/shortest.h"

#include "server/fields/cache.h"
#include "server/surfaces/landmarks.h"
#include "server/query/pair_search.h"
#include "server/query/api.h"

enum gd_status server_shortest_path(const struct server_query *query, struct server_monitor *part,
                                    const struct gd_point *from, const struct gd_point *to,
                                    enum gd_pair_wish wish, struct gd_pair_answer *out)
{
    struct server_surface *surface = query->surface;
    const struct server_cached *cached = server_cache_find(surface->fields, from);
    if (!cached) cached = server_cache_find(surface->fields, to);
    if (cached) {
        enum gd_status status = gd_pair_from_field(cached->field, from, to, wish, out);
        server_cache_unpin(cached);
        return status;
    }
    struct server_landmark_set *set =
        server_landmarks_find(query->exchange->host->api->landmarks, surface);
    enum gd_status status =
        server_pair_search(part, surface->mesh, from, to, wish, set ? set->landmarks : NULL, out);
    server_landmark_set_release(set);
    return status;
}
