/* Compares every kernel that this machine supports with the plain kernel, bit for bit. Compares the
 * plain kernel with a computation of one window at a time. */
#include "tests/unit/window/model.h"

#include <stdlib.h>
#include <string.h>

#include "gd/cpu.h"
#include "gd/polygons.h"
#include "kernel/kernel.h"

enum { MOST = 40, ROUNDS = 60, GUARD = 2 * GD__WINDOWS_GROUP };

/* --- kernels ---------------------------------------------------------------------------------- */

static const struct gd__kernel *kernels[3];
static int kernel_count;

static int find_kernels(void **state)
{
    (void)state;
    static const char *const names[] = {"baseline", "avx2", "avx512"};
    kernel_count = 0;
    for (int i = 0; i < 3; i++)
        if (gd_cpu_select(names[i]) == GD_OK) kernels[kernel_count++] = gd__kernel_in_use();
    if (gd_cpu_select("auto")) return -1;
    print_message("# %d kernels compared\n", kernel_count);
    return 0;
}

/* --- lists as propagation makes them, and harder ones ----------------------------------------- */

enum kind { ANY, CONTINUOUS, TIED, RUNS, GRAZING, NARROW, KINDS };

static double pick(struct rng *rng, const double *values, uint32_t count)
{
    return values[rng_below(rng, count)];
}

#define PICK(rng, ...)                                                                             \
    pick(rng, (const double[]){__VA_ARGS__}, sizeof((double[]){__VA_ARGS__}) / sizeof(double))

/* Returns a source for the window that begins where `before` ends. */
static struct gd__window next_source(struct rng *rng, enum kind kind, double length,
                                     const struct gd__window *before, uint32_t number)
{
    double joint = before->b1;
    struct gd__window w = {.x = rng_between(rng, -1, 2) * length,
                           .y = exp(rng_between(rng, -7, 1)) * length,
                           .sigma = rng_between(rng, 0, 2) * length,
                           .source = number};
    if (kind == GRAZING) {
        w.y = PICK(rng, 0, 1e-18, 1e-14, 1e-13, 1e-12, 1e-7, 0.5) * length;
        w.x = PICK(rng, -1, -1e-6, 0, 0.3, 1, 1.0000005, 2) * length;
    }
    /* the source is as far from the common end as the source of `before` */
    if (kind == TIED && rng_unit(rng) < 0.7) {
        w = *before;
        w.source = number;
        if (rng_unit(rng) < 0.8) w.x = 2 * joint - w.x;
    }
    if (kind == RUNS && rng_unit(rng) < 0.8) {
        w = *before;
        w.x *= 1 + PICK(rng, 0, 0, 1e-16, -1e-13, 1e-12, 9e-12, -1.1e-11, 3e-11);
        w.y *= 1 + PICK(rng, 0, 0, 1e-16, -1e-13, 1e-12, 9e-12, -1.1e-11, 3e-11);
    }
    if (kind == CONTINUOUS || (kind == NARROW && rng_unit(rng) < 0.7))
        w.sigma += fmax(0, gd__window_distance(before, joint) - gd__window_distance(&w, joint));
    return w;
}

static double width_of(struct rng *rng, enum kind kind)
{
    return kind == NARROW || rng_unit(rng) < 0.02 ? pow(10, rng_between(rng, -15, -1))
                                                  : 0.01 + rng_unit(rng);
}

/* Makes a sorted list of disjoint windows on an edge of this length. Most lists have no gaps. */
static void random_list(struct rng *rng, enum kind kind, uint32_t count, double length,
                        struct gd__stack *out)
{
    double end[MOST + 2] = {rng_unit(rng) < 0.5 ? 0 : rng_unit(rng)};
    bool to_the_end = rng_unit(rng) < 0.5, gaps = rng_unit(rng) < 0.3;
    for (uint32_t i = 0; i <= count; i++) end[i + 1] = end[i] + width_of(rng, kind);
    double scale = length / end[to_the_end ? count : count + 1];
    struct gd__window before = {
        .b1 = end[0] * scale, .x = 0.4 * length, .y = 0.6 * length, .sigma = length};
    out->count = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct gd__window w = next_source(rng, kind, length, &before, i);
        w.b0 = end[i] * scale;
        w.b1 = i + 1 == count && to_the_end ? length : end[i + 1] * scale;
        if (gaps && rng_unit(rng) < 0.3) w.b0 += 0.3 * (w.b1 - w.b0);
        append_window(out, w);
        before = w;
    }
}

/* Returns a side of a random triangle, sometimes a thin one. */
static struct gd_side random_side(struct rng *rng)
{
    double length = exp(rng_between(rng, -2, 2)), px = rng_between(rng, -0.5, 1.5) * length,
           py = length * (rng_unit(rng) < 0.2 ? pow(10, rng_between(rng, -6, -1))
                                              : rng_between(rng, 0.1, 1.5));
    struct gd_side s = {
        .length = length, .left_length = hypot(px, py), .right_length = hypot(length - px, py)};
    s.left_x = px / s.left_length;
    s.left_y = py / s.left_length;
    s.right_x = (length - px) / s.right_length;
    s.right_y = -py / s.right_length;
    return s;
}

/* --- comparison ------------------------------------------------------------------------------- */

static void check_same_windows(const struct gd__windows *a, const struct gd__windows *b,
                               uint32_t count)
{
    assert_memory_equal(a->b0, b->b0, count * sizeof(double));
    assert_memory_equal(a->b1, b->b1, count * sizeof(double));
    assert_memory_equal(a->x, b->x, count * sizeof(double));
    assert_memory_equal(a->y, b->y, count * sizeof(double));
    assert_memory_equal(a->sigma, b->sigma, count * sizeof(double));
    assert_memory_equal(a->source, b->source, count * sizeof(uint32_t));
}

/* The state of a test: the random list, and the results of the plain kernel and of another
 * kernel. */
static struct gd__stack list, actual;
static struct gd__window_builder plain, other;

static int free_lists(void **state)
{
    (void)state;
    gd__stack_destroy(&list);
    gd__stack_destroy(&actual);
    gd__window_builder_destroy(&plain);
    gd__window_builder_destroy(&other);
    return 0;
}

/* Fills `list` with lists of every kind and size, and calls `test` for each of these lists. */
static void for_all_lists(uint64_t seed, void (*test)(struct rng *rng, double length))
{
    struct rng rng = {seed};
    for (enum kind kind = 0; kind < KINDS; kind++)
        for (uint32_t count = 1; count <= MOST; count++)
            for (int round = 0; round < ROUNDS; round++) {
                double length = exp(rng_between(&rng, -2, 2));
                random_list(&rng, kind, count, length, &list);
                test(&rng, length);
            }
}

/* --- filter ----------------------------------------------------------------------------------- */

static uint64_t offered, kept;

/* Returns a distance for an end of the edge. It equals the distance that the list gives there, or
 * is larger or smaller. */
static double end_distance(struct rng *rng, double length, bool at_end)
{
    double t = at_end ? length : 0, least = GD_NONE * length;
    for (uint32_t i = 0; i < list.count; i++) {
        const struct gd__window *w = &list.windows[i];
        double at = fmin(fmax(t, w->b0), w->b1);
        least = fmin(least, gd__window_distance(w, at) + fabs(t - at));
    }
    return rng_unit(rng) < 0.1 ? 1e300
                               : least * PICK(rng, 1, 1, 1 - 1e-15, 1 + 1e-14, 0.9, 0.5, 0, 1.1);
}

static double least_round_an_end(const struct gd__stack *windows, double length, double d0,
                                 double d1, double t)
{
    return fmin(least_distance(windows, t), fmin(d0 + t, d1 + length - t));
}

static void filter(struct rng *rng, double length)
{
    double d0 = end_distance(rng, length, false), d1 = end_distance(rng, length, true);
    build_windows(&list, &plain);
    uint32_t count = kernels[0]->filter(&plain.at, list.count, length, d0, d1);
    for (int k = 1; k < kernel_count; k++) {
        build_windows(&list, &other);
        assert_int_equal(kernels[k]->filter(&other.at, list.count, length, d0, d1), count);
        check_same_windows(&plain.at, &other.at, count);
    }
    load_windows(&plain.at, count, &actual);
    for (int i = 0; i < 20; i++) { /* the filter changes no distance */
        double t = rng_unit(rng) * length;
        check_close(least_round_an_end(&actual, length, d0, d1, t),
                    least_round_an_end(&list, length, d0, d1, t), 1e-12);
    }
    for (uint32_t i = 0; i < count; i++)
        assert_true(actual.windows[i].b0 >= 0 && actual.windows[i].b1 <= length &&
                    (!i || actual.windows[i].b0 >= actual.windows[i - 1].b1));
    offered += list.count;
    kept += count;
}

static void filters(void **state)
{
    (void)state;
    offered = kept = 0;
    for_all_lists(1, filter);
    print_message("# filter: %llu windows, %llu kept\n", (unsigned long long)offered,
                  (unsigned long long)kept);
    assert_true(kept > offered / 10 && kept < offered * 9 / 10);
}

/* --- within ----------------------------------------------------------------------------------- */

static void within(struct rng *rng, double length)
{
    double bound = rng_unit(rng) < 0.5
                       ? rng_between(rng, 0, 4) * length
                       /* a bound that one window reaches exactly */
                       : gd__window_nearest(&list.windows[rng_below(rng, list.count)]);
    build_windows(&list, &plain);
    uint32_t count = kernels[0]->within(&plain.at, list.count, bound);
    for (int k = 1; k < kernel_count; k++) {
        build_windows(&list, &other);
        assert_int_equal(kernels[k]->within(&other.at, list.count, bound), count);
        check_same_windows(&plain.at, &other.at, count);
    }
    actual.count = 0;
    for (uint32_t i = 0; i < list.count; i++)
        if (gd__window_nearest(&list.windows[i]) <= bound) append_window(&actual, list.windows[i]);
    assert_int_equal(count, actual.count);
    build_windows(&actual, &other);
    check_same_windows(&plain.at, &other.at, count);
}

static void keeps_windows_within_a_bound(void **state)
{
    (void)state;
    for_all_lists(2, within);
}

/* --- store ------------------------------------------------------------------------------------ */

struct store_counts {
    uint64_t stored, ends, refused, off_by_one, packed;
};

static struct store_counts stores;

/* Memory for one chunk of up to MOST wedges, and a guard after it, which must stay unchanged. */
union shelf {
    struct gd__chunk chunk;
    struct {
        double room[2 + 3 * 3 * MOST];
        uint64_t guard[GUARD];
    };
};

static struct gd__chunk *on_shelf(union shelf *shelf, enum gd__wedge_form form)
{
    memset(shelf, 0x5a, sizeof *shelf);
    shelf->chunk = (struct gd__chunk){.form = form};
    return &shelf->chunk;
}

/* Checks that the chunks are equal, and that at most one group is written beyond them. */
static void check_as_stored(const union shelf *stored, const union shelf *expected)
{
    size_t bytes = gd__chunk_bytes(&expected->chunk),
           end = bytes + GD__WINDOWS_GROUP * sizeof(double);
    assert_memory_equal(stored, expected, bytes);
    for (size_t i = end; i < sizeof *stored; i++)
        assert_int_equal(((const unsigned char *)stored)[i], 0x5a);
}

static void check_as_written(const struct gd__wedges *stored, const struct gd__wedges *written,
                             uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        assert_true(gd__wedge_x(stored, i) == gd__wedge_x(written, i));
        assert_true(gd__wedge_y(stored, i) == gd__wedge_y(written, i));
        assert_int_equal(gd__wedge_source(stored, i), gd__wedge_source(written, i));
        int64_t off = (int64_t)stored->start[i] - (int64_t)written->start[i];
        assert_true(off >= -1 && off <= 1); /* one kernel divides, the other multiplies */
        if (off) stores.off_by_one++;
        if (i) assert_true(stored->start[i] >= stored->start[i - 1]);
    }
    assert_int_equal(stored->start[0], 0);
}

static bool has_gap_inside(const struct gd__windows *w, uint32_t count, double length)
{
    for (uint32_t i = 1; i < count; i++)
        if (w->b0[i] > w->b1[i - 1] + GD_TOL_ADJACENT * length) return true;
    return false;
}

static void store(struct rng *rng, double length)
{
    static union shelf shelves[3], general;
    bool mirrored = rng_unit(rng) < 0.5;
    enum gd__wedge_form form = rng_below(rng, 3);
    build_windows(&list, &plain);
    bool stored =
        kernels[0]->store(&plain.at, list.count, length, mirrored, on_shelf(&shelves[0], form));
    for (int k = 1; k < kernel_count; k++) {
        assert_int_equal(
            kernels[k]->store(&plain.at, list.count, length, mirrored, on_shelf(&shelves[k], form)),
            stored);
        if (stored) check_as_stored(&shelves[k], &shelves[0]);
    }
    gd__chunk_write(&plain.at, list.count, length, mirrored, on_shelf(&general, form));
    uint32_t count = general.chunk.count, by_kernel = shelves[0].chunk.count;
    assert_true(count <= gd__wedges_bound(list.count));
    assert_true(!stored == has_gap_inside(&plain.at, list.count, length));
    stores.refused += !stored;
    if (!stored) return;
    stores.stored += by_kernel == list.count;
    stores.ends += by_kernel > list.count;
    assert_int_equal(by_kernel, count);
    assert_true(general.chunk.form == form || general.chunk.form == GD__WEDGE_WIDE);
    assert_int_equal(general.chunk.form, shelves[0].chunk.form);
    stores.packed += general.chunk.form != GD__WEDGE_WIDE;
    struct gd__wedges first = gd__chunk_wedges(&shelves[0].chunk),
                      written = gd__chunk_wedges(&general.chunk);
    check_as_written(&first, &written, count);
}

static void stores_lists_without_gaps(void **state)
{
    (void)state;
    stores = (struct store_counts){0};
    for_all_lists(3, store);
    print_message("# store: %llu lists stored, %llu with gaps at their ends, %llu refused for gaps "
                  "inside, %llu packed, %llu starts one unit off the general form's\n",
                  (unsigned long long)stores.stored, (unsigned long long)stores.ends,
                  (unsigned long long)stores.refused, (unsigned long long)stores.packed,
                  (unsigned long long)stores.off_by_one);
    assert_true(stores.stored > 1000 && stores.ends > 300 && stores.refused > 1000 &&
                stores.packed > 1000);
}

/* --- cast ------------------------------------------------------------------------------------- */

static struct gd__pool pool;
static struct gd__children left[2], right[2];
static struct gd__scratch scratch;
static uint64_t cast_children, cast_joined, cast_tangled;

static int open_pool(void **state)
{
    (void)state;
    gd__pool_init(&pool, GD__LIST_POOL_ITEM, NULL);
    return 0;
}

static int close_pool(void **state)
{
    gd__pool_destroy(&pool);
    gd__scratch_destroy(&scratch);
    return free_lists(state);
}

/* Casts windows [first, first + count) of `plain`. Stores the resulting windows (children) in set
 * `result`. */
static struct gd__apex cast(const struct gd__kernel *kernel, const struct gd_side *side,
                            uint32_t first, uint32_t count, bool coalesce, double known, int result)
{
    struct gd__windows w = plain.at;
    w.b0 += first, w.b1 += first, w.x += first, w.y += first, w.sigma += first, w.source += first;
    check_ok(gd__children_open(&left[result], &pool, count), NULL);
    check_ok(gd__children_open(&right[result], &pool, count), NULL);
    struct gd__apex apex = {.distance = known};
    kernel->cast(side, &w, count, coalesce, &apex, &left[result], &right[result]);
    return apex;
}

static void check_same_children(const struct gd__children *a, const struct gd__children *b)
{
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->tangled, b->tangled);
    if (a->tangled != GD_NONE) assert_int_equal(a->tangled_last, b->tangled_last);
    check_same_windows(&a->at, &b->at, a->count);
}

/* Computes by definition which windows pass to the left of the apex, and which pass to the right.
 * The other windows see the apex; also computes the shortest straight path through them to the
 * apex. */
static struct gd__apex look_at_apex(const struct gd_side *s, double known)
{
    struct gd__apex best = {.distance = known, .last_left = GD_NONE, .first_right = GD_NONE};
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y;
    for (uint32_t i = 0; i < list.count; i++) {
        const struct gd__window *w = &list.windows[i];
        double k0 = (w->b0 - w->x) * (py + w->y) - w->y * (px - w->x),
               k1 = (w->b1 - w->x) * (py + w->y) - w->y * (px - w->x);
        if (k1 < 0) best.last_left = i;
        if (k0 > 0 && best.first_right == GD_NONE) best.first_right = i;
        if (k0 > 0 || k1 < 0) continue;
        best.distance = fmin(best.distance, w->sigma + hypot(px - w->x, py + w->y));
    }
    return best;
}

/* Checks that the children before `tangled` are sorted and disjoint. The other children have no
 * order. */
static void check_order(const struct gd__children *children, double length)
{
    uint32_t end = children->tangled < children->count ? children->tangled : children->count;
    const struct gd__windows *w = &children->at;
    for (uint32_t i = 0; i < end; i++) {
        assert_true(w->b1[i] - w->b0[i] > GD_TOL_WIDTH * length && w->b0[i] >= 0 &&
                    w->b1[i] <= length);
        if (i) assert_true(w->b0[i] >= w->b1[i - 1] - GD_TOL_WIDTH * length);
    }
}

/* Checks that the sorted children give the same distances as `alone`, which has the children of
 * windows that were cast one at a time. */
static void check_against_single(struct rng *rng, struct gd__children *children, double length,
                                 const struct gd__stack *alone)
{
    if (children->tangled != GD_NONE)
        check_ok(gd__children_sort(children, &pool, GD_TOL_WIDTH * length, &scratch), NULL);
    load_windows(&children->at, children->count, &actual);
    for (int i = 0; i < 8; i++) {
        double t = rng_unit(rng) * length;
        check_close(least_distance(&actual, t), least_distance(alone, t), 1e-10);
    }
}

static void cast_list(struct rng *rng, double unused)
{
    (void)unused;
    struct gd_side side = random_side(rng);
    bool coalesce = rng_unit(rng) < 0.7;
    /* scales the list from its own length to the length of the side */
    for (uint32_t i = 0; i < list.count; i++) {
        struct gd__window *w = &list.windows[i];
        double scale = side.length / unused;
        w->b0 *= scale, w->b1 = fmin(w->b1 * scale, side.length), w->x *= scale, w->y *= scale,
                        w->sigma *= scale;
    }
    build_windows(&list, &plain);
    double known = rng_unit(rng) < 0.5 ? 1e300 : rng_between(rng, 0, 3) * side.length;
    struct gd__apex apex = cast(kernels[0], &side, 0, list.count, coalesce, known, 0);
    for (int k = 1; k < kernel_count; k++) {
        struct gd__apex again = cast(kernels[k], &side, 0, list.count, coalesce, known, 1);
        assert_memory_equal(&again.distance, &apex.distance, sizeof apex.distance);
        assert_true(again.improved == apex.improved);
        assert_true(again.last_left == apex.last_left && again.first_right == apex.first_right);
        if (apex.improved)
            assert_true(again.x == apex.x && again.y == apex.y && again.source == apex.source);
        check_same_children(&left[1], &left[0]);
        check_same_children(&right[1], &right[0]);
    }
    check_order(&left[0], side.left_length);
    check_order(&right[0], side.right_length);
    struct gd__apex best = look_at_apex(&side, known);
    struct gd__stack alone[2] = {{0}, {0}};
    for (uint32_t i = 0; i < list.count; i++) {
        cast(kernels[0], &side, i, 1, false, 1e300, 1);
        for (uint32_t k = 0; k < left[1].count; k++)
            append_window(&alone[0], gd__windows_get(&left[1].at, k));
        for (uint32_t k = 0; k < right[1].count; k++)
            append_window(&alone[1], gd__windows_get(&right[1].at, k));
    }
    check_close(apex.distance, best.distance, 3e-14);
    assert_true(apex.last_left == best.last_left && apex.first_right == best.first_right);
    assert_true(apex.improved == (apex.distance < known));
    cast_children += left[0].count + right[0].count;
    cast_joined += alone[0].count + alone[1].count - left[0].count - right[0].count;
    cast_tangled += (left[0].tangled != GD_NONE) + (right[0].tangled != GD_NONE);
    check_against_single(rng, &left[0], side.left_length, &alone[0]);
    check_against_single(rng, &right[0], side.right_length, &alone[1]);
    gd__stack_destroy(&alone[0]);
    gd__stack_destroy(&alone[1]);
}

static void casts(void **state)
{
    (void)state;
    cast_children = cast_joined = cast_tangled = 0;
    for_all_lists(4, cast_list);
    print_message("# cast: %llu children, %llu more were joined, %llu of %d lists tangled\n",
                  (unsigned long long)cast_children, (unsigned long long)cast_joined,
                  (unsigned long long)cast_tangled, 2 * KINDS * MOST * ROUNDS);
    assert_true(cast_children > 100000 && cast_joined > 1000 && cast_tangled > 1000);
}

/* --- rings ------------------------------------------------------------------------------------ */

enum { RING_GROUPS = 5 };

static double sag(double d, double part, double own)
{
    double both = part + own;
    return both > 0 ? (part * part + own * own) / 8 * d / fmax(d * d - both * both, both * d / 8)
                    : 0;
}

/* Computes the bound in double precision, point by point. */
static float ring_by_single(const struct gd__ring_group *groups, uint32_t count, struct gd__place p,
                            float own)
{
    double least = GD__RING_NOWHERE;
    for (uint32_t i = 0; i < count * GD__RING_LANES; i++) {
        const struct gd__ring_group *g = &groups[i / GD__RING_LANES];
        uint32_t lane = i % GD__RING_LANES;
        double x = (double)g->x[lane] - p.x, y = (double)g->y[lane] - p.y,
               z = (double)g->z[lane] - p.z, d = sqrt(x * x + y * y + z * z);
        least = fmin(least, d + g->lower[lane] - sag(d, g->part[lane], own));
    }
    return (float)least;
}

/* Fills a ring with random groups of edges. The last group has empty lanes. */
static void random_ring(struct rng *rng, struct gd__ring_group *groups, uint32_t count)
{
    uint32_t taken = (count - 1) * GD__RING_LANES + 1 + (uint32_t)rng_below(rng, GD__RING_LANES);
    for (uint32_t i = 0; i < count * GD__RING_LANES; i++) {
        float *first = &groups[i / GD__RING_LANES].x[i % GD__RING_LANES];
        for (int k = 0; k < 4; k++)
            first[k * GD__RING_LANES] =
                i < taken ? (float)rng_between(rng, -1, 1) : GD__RING_NOWHERE;
        first[4 * GD__RING_LANES] = i < taken ? (float)rng_between(rng, 0, 0.3) : 0;
    }
}

static void rings(void **state)
{
    (void)state;
    struct rng rng = {31};
    struct gd__ring_group groups[RING_GROUPS];
    for (int round = 0; round < ROUNDS; round++) {
        uint32_t count = 1 + (uint32_t)rng_below(&rng, RING_GROUPS);
        random_ring(&rng, groups, count);
        struct gd__place p = {(float)rng_between(&rng, -1, 1), (float)rng_between(&rng, -1, 1), 0};
        float own = round % 2 ? (float)rng_between(&rng, 0, 0.3) : 0;
        float single = ring_by_single(groups, count, p, own),
              first = kernels[0]->ring(groups, groups + count, p, own);
        assert_true(fabsf(first - single) <= 1e-6f);
        for (int k = 1; k < kernel_count; k++)
            assert_true(kernels[k]->ring(groups, groups + count, p, own) == first);
    }
    assert_true(kernels[0]->ring(groups, groups, (struct gd__place){0}, 0) == GD__RING_NOWHERE);
}

static struct gd_vec3 random_vector(struct rng *rng, double length)
{
    struct gd_vec3 v = {rng_between(rng, -1, 1), rng_between(rng, -1, 1), rng_between(rng, -1, 1)};
    return gd_vec3_scale(v, length / gd_vec3_length(v));
}

/* A ring that consists of one edge with lower bounds 0, seen from the points of another edge. */
struct two_edges {
    struct gd_vec3 from, along, to, beside;
};

static double between(const struct two_edges *edges, double t, double u)
{
    struct gd_vec3 p = gd_vec3_along(edges->from, t, edges->along),
                   q = gd_vec3_along(edges->to, u, edges->beside);
    return gd_vec3_length(gd_vec3_sub(q, p));
}

/* Returns the bound that the kernel computes at parameter t of the first edge. */
static double told_at(const struct two_edges *edges, double t, double own)
{
    struct gd__ring_group group;
    for (int i = 0; i < GD__RING_LANES; i++) {
        struct gd_vec3 q = gd_vec3_along(edges->to, i % 2, edges->beside);
        group.x[i] = (float)q.x, group.y[i] = (float)q.y, group.z[i] = (float)q.z;
        group.lower[i] = 0, group.part[i] = (float)gd_vec3_length(edges->beside);
    }
    struct gd_vec3 p = gd_vec3_along(edges->from, t, edges->along);
    return kernels[0]->ring(&group, &group + 1,
                            (struct gd__place){(float)p.x, (float)p.y, (float)p.z}, (float)own);
}

/* The bounds at the two ends of an edge are interpolated along the edge. At each point, the result
 * is a lower bound of the distance to the points of another edge. The test uses near and far edges,
 * with equal lengths and with ratios up to 1000. */
static void ring_bounds_are_below_distances(void **state)
{
    (void)state;
    struct rng rng = {7};
    for (int round = 0; round < 100 * ROUNDS; round++) {
        double own = pow(10, rng_between(&rng, -3, 0)),
               part = round % 3 ? own : pow(10, rng_between(&rng, -3, 0));
        struct two_edges edges = {.from = {0.1, 0.2, 0.3}, .along = random_vector(&rng, own)};
        edges.to =
            gd_vec3_add(edges.from, random_vector(&rng, fmax(own, part) *
                                                            pow(10, rng_between(&rng, -1.5, 1.5))));
        edges.beside = random_vector(&rng, part);
        double first = told_at(&edges, 0, own), last = told_at(&edges, 1, own),
               slack = 1e-6 * (1 + between(&edges, 0, 0));
        for (int i = 0; i <= 8; i++)
            for (int k = 0; k <= 8; k++)
                assert_true(between(&edges, i / 8.0, k / 8.0) >=
                            first + (last - first) * i / 8 - slack);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(filters, free_lists),
        cmocka_unit_test_teardown(keeps_windows_within_a_bound, free_lists),
        cmocka_unit_test_teardown(stores_lists_without_gaps, free_lists),
        cmocka_unit_test_setup_teardown(casts, open_pool, close_pool),
        cmocka_unit_test(rings),
        cmocka_unit_test(ring_bounds_are_below_distances),
    };
    return cmocka_run_group_tests(tests, find_kernels, NULL);
}
