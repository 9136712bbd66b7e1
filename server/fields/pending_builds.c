/* See pending_builds.h. */
#include "server/fields/pending_builds.h"

#include <stdlib.h>

struct server_pending_build *server_pending_builds_find(const struct server_pending_builds *builds,
                                                        const struct server_mesh_cache *fields,
                                                        const struct server_field_key *key)
{
    struct server_pending_build *found = NULL;
    for (struct server_pending_build *build = builds->first; build; build = build->next) {
        if (build->fields != fields || !server_field_key_equal(&build->key, key)) continue;
        if (!server_field_key_covers(key, &build->key)) continue;
        if (!found || server_field_key_covers(&build->key, &found->key)) found = build;
    }
    return found;
}

struct server_pending_build *server_pending_builds_start(struct server_pending_builds *builds,
                                                         struct server_mesh_cache *fields,
                                                         const struct server_field_key *key)
{
    struct server_pending_build *build = malloc(sizeof *build);
    if (!build) return NULL;
    *build = (struct server_pending_build){.fields = fields, .next = builds->first};
    if (!server_field_key_copy(key, &build->key)) {
        free(build);
        return NULL;
    }
    builds->first = build;
    return build;
}

void server_pending_build_park(struct server_pending_build *build, struct server_job *job)
{
    job->next = build->parked;
    build->parked = job;
}

void server_pending_builds_end(struct server_pending_builds *builds,
                               struct server_pending_build *build)
{
    struct server_pending_build **link = &builds->first;
    while (*link != build) link = &(*link)->next;
    *link = build->next;
}

struct server_job *server_pending_build_free(struct server_pending_build *build)
{
    struct server_job *parked = build->parked;
    server_field_key_free(&build->key);
    free(build);
    return parked;
}

struct server_job *server_pending_builds_expire(struct server_pending_builds *builds,
                                                uint64_t now_ns)
{
    struct server_job *expired = NULL, **end = &expired;
    for (struct server_pending_build *build = builds->first; build; build = build->next) {
        *end = server_jobs_expire(&build->parked, now_ns);
        while (*end) end = &(*end)->next;
    }
    return expired;
}
