/* Helpers of the tests of the cache: a cache with one mesh cache, and requests for the fields of
 * two points. */
#pragma once

#include "support.h"

#define AMPLE ((size_t)1 << 30)

struct fixture {
    struct server_budget budget;
    struct server_workers *workers;
    struct server_cache *cache;
    struct gd_mesh *mesh;
    struct server_mesh_cache *fields;
};

static inline int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    server_budget_init(&fixture->budget, AMPLE);
    fixture->workers = server_workers_create(1, 100);
    fixture->cache = server_cache_create(&fixture->budget, fixture->workers);
    fixture->mesh = new_mesh();
    fixture->fields = server_mesh_cache_open(fixture->cache);
    *state = fixture;
    return 0;
}

static inline int tear_down(void **state)
{
    struct fixture *fixture = *state;
    server_mesh_cache_close(fixture->fields);
    server_mesh_cache_release(fixture->fields);
    server_cache_destroy(fixture->cache);
    server_workers_destroy(fixture->workers);
    gd_mesh_release(fixture->mesh);
    assert_int_equal(fixture->budget.total, 0); /* all counted bytes were returned to the budget */
    free(fixture);
    return 0;
}

static inline void reclaim(struct fixture *fixture, size_t bytes)
{
    const struct server_reclaimer *reclaimer = &fixture->budget.reclaimers[SERVER_RECLAIM_FIELDS];
    reclaimer->reclaim(reclaimer->user, bytes);
}

static inline const struct server_cached *find(struct fixture *fixture, uint32_t vertex)
{
    struct gd_point source = vertex_point(fixture->mesh, vertex);
    return server_cache_find(fixture->fields, &source);
}

static inline bool has(struct fixture *fixture, uint32_t vertex)
{
    const struct server_cached *cached = find(fixture, vertex);
    server_cache_unpin(cached);
    return cached != NULL;
}

/* --- fields of sets --------------------------------------------------------------------------- */

struct set {
    struct gd_seed seeds[2];
    struct gd_field_request request;
};

static inline struct gd_field_request *make_set(struct fixture *fixture, struct set *set,
                                                double offset, double radius)
{
    *set = (struct set){.seeds = {{.point = vertex_point(fixture->mesh, 3)},
                                  {.point = vertex_point(fixture->mesh, 8), .offset = offset}}};
    set->request =
        (struct gd_field_request){.seeds = set->seeds, .seed_count = 2, .radius = radius};
    return &set->request;
}

static inline struct server_pending_build *claim(struct fixture *fixture,
                                                 const struct gd_field_request *request)
{
    struct server_pending_build *build = NULL;
    struct test_job job;
    enum gd_status why;
    test_job_init(&job, NULL);
    assert_int_equal(server_cache_claim(fixture->fields, request, &job.job, &build, &why),
                     SERVER_CACHE_BUILD);
    return build;
}

static inline void publish_set(struct fixture *fixture, struct server_pending_build *build,
                               const struct gd_field_request *request)
{
    struct gd_field *field;
    assert_int_equal(gd_field_build(fixture->mesh, request, NULL, &field, NULL), GD_OK);
    assert_true(
        server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_field_memsize(field)));
    server_cache_unpin(server_cache_publish(build, field));
}

static inline bool has_set(struct fixture *fixture, const struct gd_field_request *request)
{
    const struct server_cached *cached = server_cache_find_field(fixture->fields, request);
    server_cache_unpin(cached);
    return cached != NULL;
}
