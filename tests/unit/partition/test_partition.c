#include "tests/support/test.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "gd/field.h"
#include "tests/samples/samples.h"

/* Two wavefronts that share a surface give the distances of one wavefront up to rounding. The
 * result is the same bit for bit for every order of the tasks. */

struct task {
    void (*task)(void *context, uint32_t index);
    void *context;
    uint32_t index;
};

static void *run_task(void *user)
{
    const struct task *task = user;
    task->task(task->context, task->index);
    return NULL;
}

static void run_on_threads(void *user, void (*task)(void *context, uint32_t index), void *context,
                           uint32_t count)
{
    pthread_t thread[8];
    struct task tasks[8];
    assert_true(count <= 8);
    for (uint32_t i = 0; i < count; i++) {
        tasks[i] = (struct task){task, context, i};
        assert_int_equal(pthread_create(&thread[i], NULL, run_task, &tasks[i]), 0);
    }
    for (uint32_t i = 0; i < count; i++) pthread_join(thread[i], NULL);
    ++*(uint32_t *)user;
}

static void run_backwards(void *user, void (*task)(void *context, uint32_t index), void *context,
                          uint32_t count)
{
    while (count--) task(context, count);
    ++*(uint32_t *)user;
}

static struct gd_field *
build_from(const struct gd_mesh *mesh, struct gd_seed seed,
           void (*run)(void *, void (*)(void *, uint32_t), void *, uint32_t), uint32_t *turns)
{
    struct gd_executor executor = {.width = 2, .run = run, .user = turns};
    struct gd_field *field;
    struct gd_detail detail = {0};
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                            &(struct gd_control){.executor = run ? &executor : NULL}, &field,
                            &detail),
             &detail);
    return field;
}

static struct gd_field *build(const struct gd_mesh *mesh, struct gd_point source,
                              void (*run)(void *, void (*)(void *, uint32_t), void *, uint32_t),
                              uint32_t *turns)
{
    return build_from(mesh, (struct gd_seed){.point = source, .offset = 0.25}, run, turns);
}

static void check_same_bits(const struct gd_field *a, const struct gd_field *b)
{
    const struct gd_mesh *mesh = a->mesh;
    assert_memory_equal(a->distance, b->distance, mesh->vertex_count * sizeof *a->distance);
    assert_memory_equal(a->newest, b->newest, mesh->edge_count * sizeof *a->newest);
    assert_int_equal(a->wedge_bytes, b->wedge_bytes);
    assert_memory_equal(a->wedges, b->wedges, a->wedge_bytes);
}

/* Compares distances and paths at random points. Returns the largest relative difference. */
static double compare(const struct gd_polygons *polygons, const struct gd_field *one,
                      const struct gd_field *two, struct rng *rng)
{
    double worst = 0;
    for (int i = 0; i < 300; i += TEST_STRIDE) {
        struct gd_point point = test_point(one->mesh, test_random_place(polygons, rng));
        double a, b;
        struct gd_path path;
        check_ok(gd_field_distance(one, &point, &a), NULL);
        check_ok(gd_field_distance(two, &point, &b), NULL);
        check_close(b, a, 1e-12);
        worst = fmax(worst, fabs(a - b) / a);
        check_ok(gd_field_path(two, &point, &path), NULL);
        check_close(path.length + 0.25, b, 1e-9);
        gd_path_free(&path);
    }
    return worst;
}

static void check_surface(const char *name, struct gd_polygons *polygons)
{
    struct gd_mesh *mesh = test_mesh(polygons);
    struct rng rng = {5};
    uint32_t turns = 0;
    double worst = 0;
    for (int k = 0; k < 3; k++) {
        struct gd_point source = test_point(mesh, test_random_place(polygons, &rng));
        struct gd_field *one = build(mesh, source, NULL, NULL),
                        *two = build(mesh, source, run_on_threads, &turns),
                        *again = build(mesh, source, run_backwards, &turns);
        check_same_bits(two, again);
        worst = fmax(worst, compare(polygons, one, two, &rng));
        gd_field_release(one);
        gd_field_release(two);
        gd_field_release(again);
    }
    assert_true(turns > 30);
    print_message("# %s: %u turns, worst difference %.2g\n", name, turns, worst);
    gd_mesh_release(mesh);
    gd_polygons_free(polygons);
}

static void two_wavefronts_equal_one(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_torus(160, 80, 2, 1, &polygons), NULL);
    check_surface("torus", &polygons);
    check_ok(sample_terrain(104, 0.3, 7, &polygons), NULL);
    check_surface("terrain", &polygons);
    check_ok(sample_terrain(104, 20, 3, &polygons), NULL);
    check_surface("steep terrain", &polygons);
    check_ok(sample_genus2(16, 0.05, &polygons), NULL);
    check_surface("genus 2", &polygons);
    check_ok(sample_box((double[3]){1, 2, 3}, (uint32_t[3]){44, 44, 44}, &polygons), NULL);
    check_surface("box", &polygons);
}

static bool stop_soon(void *user, double fraction)
{
    (void)fraction;
    return ++*(int *)user < 5;
}

static void limits(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_torus(160, 80, 2, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point =
                               test_point(mesh, test_random_place(&polygons, &(struct rng){3}))};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    uint32_t turns = 0;
    int calls = 0;
    struct gd_executor executor = {.width = 2, .run = run_on_threads, .user = &turns};
    struct gd_field *field = NULL;
    struct gd_control cancel = {.progress = stop_soon, .user = &calls, .executor = &executor},
                      late = {.deadline_ns = 1, .executor = &executor};
    assert_int_equal(gd_field_build(mesh, &request, &cancel, &field, NULL), GD_CANCELLED);
    assert_int_equal(calls, 5);
    assert_int_equal(gd_field_build(mesh, &request, &late, &field, NULL), GD_DEADLINE);
    /* the budget may be too small for two wavefronts */
    uint32_t before = turns;
    struct gd_control tight = {.budget_bytes = 900 * (size_t)mesh->edge_count,
                               .executor = &executor};
    check_ok(gd_field_build(mesh, &request, &tight, &field, NULL), NULL);
    assert_int_equal(turns, before);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* The budget is enough for one wavefront but not for two. The build falls back to one wavefront and
 * gives the same result. */
static void falls_back_to_one_wavefront(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    /* the faces are long, so there are many wedges on each edge */
    check_ok(sample_torus(40, 320, 2, 0.7, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {
        .point = test_point(mesh, test_random_place(&polygons, &(struct rng){3})), .offset = 0.25};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    uint32_t turns = 0;
    struct gd_executor executor = {.width = 2, .run = run_backwards, .user = &turns};
    struct gd_field *one = build(mesh, seed.point, NULL, NULL), *two = NULL;
    struct gd_control enough = {.budget_bytes = gd_field_memsize(one) * 5 / 4,
                                .executor = &executor};
    assert_true(enough.budget_bytes > 1000 * (size_t)mesh->edge_count);
    check_ok(gd_field_build(mesh, &request, &enough, &two, NULL), NULL);
    assert_true(turns > 1);
    check_same_bits(one, two);
    gd_field_release(one);
    gd_field_release(two);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Uses a seed close to a vertex of a steep slope. Both wavefronts share the windows that this
 * vertex emits. */
static void both_emit_beside_a_vertex(void **state)
{
    (void)state;
    const double apart = 2 * pow(10, -12), weight[3] = {0.6 * apart, 1 - apart, 0.4 * apart};
    struct gd_polygons polygons;
    struct gd_point source;
    struct rng rng = {11};
    uint32_t turns = 0;
    check_ok(sample_terrain(104, 20, 3, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    check_ok(gd_point_in_face(mesh, (struct gd_face){15203}, weight, &source, NULL), NULL);
    struct gd_field *one = build(mesh, source, NULL, NULL),
                    *two = build(mesh, source, run_backwards, &turns);
    assert_true(turns > 0);
    compare(&polygons, one, two, &rng);
    gd_field_release(one);
    gd_field_release(two);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_wavefronts_equal_one), cmocka_unit_test(limits),
        cmocka_unit_test(falls_back_to_one_wavefront), cmocka_unit_test(both_emit_beside_a_vertex)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
