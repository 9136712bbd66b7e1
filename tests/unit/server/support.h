/* Helpers of the tests of server: meshes, fields, and jobs that record how they end. */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "server/fields/cache.h"
#include "server/exchange/exchange.h"
#include "server/work/workers.h"
#include "tests/samples/samples.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* --- meshes and fields ------------------------------------------------------------------------ */

static inline struct gd_mesh *new_mesh(void)
{
    struct gd_polygons polygons;
    struct gd_mesh *mesh = NULL;
    assert_int_equal(sample_icosphere(2, 1.0, &polygons), GD_OK);
    assert_int_equal(gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL), GD_OK);
    gd_polygons_free(&polygons);
    return mesh;
}

static inline struct gd_point vertex_point(const struct gd_mesh *mesh, uint32_t vertex)
{
    struct gd_point point;
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){vertex}, &point, NULL), GD_OK);
    return point;
}

static inline struct gd_field *new_field(const struct gd_mesh *mesh, const struct gd_point *source)
{
    const struct gd_seed seed = {.point = *source};
    struct gd_field *field = NULL;
    assert_int_equal(gd_field_build(mesh,
                                    &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                                    NULL, &field, NULL),
                     GD_OK);
    return field;
}

/* --- jobs ------------------------------------------------------------------------------------- */

struct test_job {
    struct server_job job; /* must be the first member */
    sem_t began, done;
    sem_t *hold; /* `run` waits for this semaphore; NULL if it does not wait */
    int runs;
    int refusals;
    enum server_refusal why;
};

static inline void test_job_run(struct server_job *job)
{
    struct test_job *test = (struct test_job *)job;
    sem_post(&test->began);
    if (test->hold) sem_wait(test->hold);
    test->runs++;
    sem_post(&test->done);
}

static inline void test_job_refuse(struct server_job *job, enum server_refusal why)
{
    struct test_job *test = (struct test_job *)job;
    test->why = why;
    test->refusals++;
    sem_post(&test->done);
}

static inline void test_job_init(struct test_job *job, sem_t *hold)
{
    *job = (struct test_job){
        .job = {.run = test_job_run, .refuse = test_job_refuse, .deadline_ns = UINT64_MAX},
        .hold = hold};
    sem_init(&job->began, 0, 0);
    sem_init(&job->done, 0, 0);
}

/* --- the cache -------------------------------------------------------------------------------- */

/* Queries a source so often that its field may be built. */
static inline void ask_often(struct server_mesh_cache *fields, const struct gd_point *source)
{
    for (int i = 0; i < SERVER_CACHE_SEARCHES; i++) server_cache_note(fields, source);
}
