/* Compares pruning with the model. A window is removed where stored wedges give strictly shorter
 * distances, and kept where the window itself gives strictly shorter distances. */
#include "tests/unit/window/model.h"

#include "wavefront/wavefront.h"

enum { CHUNKS = 3, MOST = 6 };

/* larger than any difference by rounding, including the 2^-32 of stored ends */
#define CLEAR 1e-7

/* A wavefront with the data that pruning reads: distances, and the wedges of edge 0 of one face. */
static struct gd_mesh *mesh;
static struct gd_workspace *work;
static struct gd__wavefront front;
static double *distances, length;
static uint32_t *newest;
static struct gd__stack stored[2], windows, actual; /* stored: by side, in the frame of that side */

static int open_front(void **state)
{
    (void)state;
    double positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.8, 0}};
    uint32_t corners[3] = {0, 1, 2};
    mesh = test_mesh(&(struct gd_polygons){
        .positions = positions, .position_count = 3, .polygon_count = 1, .corners = corners});
    work = gd_workspace_create();
    if (!work) return -1;
    check_ok(gd__workspace_open(work, mesh, 1, NULL), NULL);
    distances = work->distance;
    newest = work->newest;
    front =
        (struct gd__wavefront){.mesh = mesh, .work = work, .distance = distances, .newest = newest};
    length = mesh->side[0].length;
    return 0;
}

static int close_front(void **state)
{
    (void)state;
    gd_workspace_destroy(work);
    gd_mesh_release(mesh);
    for (int k = 0; k < 2; k++) gd__stack_destroy(&stored[k]);
    gd__stack_destroy(&windows);
    gd__stack_destroy(&actual);
    return 0;
}

/* Makes up to MOST sorted and disjoint windows of the three vertices, some with gaps. */
static void draw(struct rng *rng, struct gd__stack *out)
{
    uint32_t count = 1 + rng_below(rng, MOST);
    out->count = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct gd__window w = random_window(rng, rng_below(rng, 3));
        w.b0 = length * i / count;
        w.b1 = length * (i + 1) / count;
        w.sigma = distances[w.source];
        if (rng_unit(rng) < 0.2) w.b1 -= 0.5 * length / count;
        append_window(out, w);
    }
}

/* Stores a list of a side as the propagation does. */
static void store_chunk(uint32_t side, const struct gd__stack *list)
{
    struct gd__window_builder builder = {0};
    build_windows(list, &builder);
    check_ok(gd__region_reserve(&work->wedges, gd__chunk_bound(list->count)), NULL);
    struct gd__chunk *chunk = (struct gd__chunk *)(work->wedges.base + work->wedges.used);
    *chunk = (struct gd__chunk){.form = GD__WEDGE_20};
    gd__chunk_write(&builder.at, list->count, length, side & 1, chunk);
    size_t bytes = gd__chunk_link(chunk, newest[0]);
    newest[0] = (uint32_t)(work->wedges.used / GD__CHUNK_UNIT);
    work->wedges.used += bytes;
    gd__window_builder_destroy(&builder);
}

/* Prunes the windows of side 0 by the wedges of its own side and of the twin. Result: `actual`. */
static void prune(bool own, bool twin)
{
    struct gd__window_builder builder = {0};
    build_windows(&windows, &builder);
    struct gd__windows list = builder.at;
    uint32_t count = windows.count;
    check_ok(gd__prune_by_stored(&front, 0,
                                 (own ? GD__PRUNE_BY_OWN : 0) | (twin ? GD__PRUNE_BY_OTHER : 0),
                                 &list, &count),
             NULL);
    load_windows(&list, count, &actual);
    gd__window_builder_destroy(&builder);
}

static double stored_distance(double t, bool own, bool twin)
{
    double least = own ? least_distance(&stored[0], t) : INFINITY;
    return twin ? fmin(least, least_distance(&stored[1], length - t)) : least;
}

static bool is_near_an_end(const struct gd__stack *list, double t)
{
    for (uint32_t i = 0; i < list->count; i++)
        if (fabs(t - list->windows[i].b0) < CLEAR || fabs(t - list->windows[i].b1) < CLEAR)
            return true;
    return false;
}

static void check_pruned(struct rng *rng, bool own, bool twin)
{
    for (uint32_t i = 0; i < actual.count; i++) {
        assert_true(actual.windows[i].b1 > actual.windows[i].b0);
        if (i) assert_true(actual.windows[i].b0 >= actual.windows[i - 1].b1);
    }
    for (int k = 0; k < 60; k++) {
        double t = rng_between(rng, 0, length), offered = least_distance(&windows, t),
               known = stored_distance(t, own, twin), left = least_distance(&actual, t);
        if (is_near_an_end(&windows, t) || is_near_an_end(&stored[0], t) ||
            is_near_an_end(&stored[1], length - t))
            continue;
        /* better: stays */
        if (offered < known * (1 - CLEAR)) assert_true(left == offered);
        if (known < offered * (1 - CLEAR)) assert_true(isinf(left)); /* worse: removed */
        assert_true(isinf(left) || left == offered);
    }
}

/* Uses several chunks of both sides in one chain. Prunes by the own side, by the twin, by both or
 * by neither. */
static void agrees_with_the_model(void **state)
{
    (void)state;
    struct rng rng = {5};
    struct gd__stack list = {0};
    uint64_t offered = 0, left = 0;
    for (int round = 0; round < 4000; round++) {
        work->wedges.used = 0;
        newest[0] = GD_NONE;
        stored[0].count = stored[1].count = 0;
        for (int v = 0; v < 3; v++) distances[v] = rng_between(&rng, 0, 0.5);
        uint32_t chunks = rng_below(&rng, CHUNKS + 1);
        for (uint32_t i = 0; i < chunks; i++) {
            uint32_t side = rng_below(&rng, 2);
            draw(&rng, &list);
            store_chunk(side, &list);
            for (uint32_t k = 0; k < list.count; k++) append_window(&stored[side], list.windows[k]);
        }
        draw(&rng, &windows);
        bool own = round & 1, twin = round & 2;
        prune(own, twin);
        check_pruned(&rng, own, twin);
        offered += windows.count;
        left += actual.count;
    }
    print_message("# prune: %llu windows, %llu left\n", (unsigned long long)offered,
                  (unsigned long long)left);
    gd__stack_destroy(&list);
}

/* Tests windows that equal a stored window. If their own side stores it, they are removed; if the
 * twin stores it, they are kept. If both sides removed them, a tie would leave no window. */
static void ties(void **state)
{
    (void)state;
    struct rng rng = {6};
    for (int round = 0; round < 200; round++) {
        work->wedges.used = 0;
        newest[0] = GD_NONE;
        for (int v = 0; v < 3; v++) distances[v] = rng_between(&rng, 0, 0.5);
        draw(&rng, &windows);
        store_chunk(0, &windows);
        prune(true, false);
        assert_int_equal(actual.count, 0);
        newest[0] = GD_NONE;
        stored[0].count = 0;
        for (uint32_t i = windows.count; i--;)
            append_window(&stored[0], gd__window_mirrored(&windows.windows[i], length));
        store_chunk(1, &stored[0]);
        prune(false, true);
        assert_int_equal(actual.count, windows.count);
        /* except where the end of a stored neighbour was rounded into a window */
        for (uint32_t i = 0; i < actual.count; i++) {
            assert_true(fabs(actual.windows[i].b0 - windows.windows[i].b0) <=
                        2 * length * GD__WEDGE_UNIT);
            assert_true(fabs(actual.windows[i].b1 - windows.windows[i].b1) <=
                        2 * length * GD__WEDGE_UNIT);
        }
    }
    stored[0].count = 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_the_model),
        cmocka_unit_test(ties),
    };
    return cmocka_run_group_tests(tests, open_front, close_front);
}
