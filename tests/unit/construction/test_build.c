#include "tests/unit/mesh/shapes.h"

#include <stdlib.h>

#include "tests/samples/samples.h"
#include "tests/support/test.h"
#include "tests/support/two_threads.h"
#include "mesh/bvh.h"

static void a_budget_below_the_cost_is_refused(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_icosphere(3, 1, &polygons), GD_OK);
    size_t cost = gd_mesh_build_cost(polygons.polygon_count, polygons.position_count);
    struct gd_control control = {.budget_bytes = cost - 1};
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, &detail), GD_BUDGET);
    assert_true(strlen(detail.text) > 0);
    assert_null(mesh);
    control.budget_bytes = cost;
    assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, NULL), GD_OK);
    assert_true(gd_mesh_memsize(mesh) < cost);
    assert_true(gd_mesh_memsize(mesh) > 200 * (size_t)polygons.polygon_count);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Returns `pairs` pairs of triangles. The triangles of a pair share one vertex. */
static struct gd_polygons new_bow_ties(uint32_t pairs)
{
    struct gd_polygons ties = {.positions = calloc(5 * pairs, sizeof *ties.positions),
                               .corners = calloc(6 * pairs, sizeof *ties.corners),
                               .position_count = 5 * pairs,
                               .polygon_count = 2 * pairs};
    for (uint32_t i = 0; i < pairs; i++) {
        const double shape[5][3] = {{0, 0, i}, {1, 0, i}, {1, 1, i}, {-1, 0, i}, {-1, 1, i}};
        const uint32_t corners[6] = {5 * i, 5 * i + 1, 5 * i + 2, 5 * i, 5 * i + 3, 5 * i + 4};
        memcpy(ties.positions[5 * i], shape, sizeof shape);
        memcpy(ties.corners + 6 * (size_t)i, corners, sizeof corners);
    }
    return ties;
}

static void a_budget_that_many_copies_exceed_is_refused(void **state)
{
    (void)state;
    struct gd_polygons ties = new_bow_ties(5000);
    size_t cost = gd_mesh_build_cost(ties.polygon_count, ties.position_count);
    struct gd_control control = {.budget_bytes = cost};
    struct gd_mesh_options options = {.repair_split = true};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&ties, &options, &control, &mesh, NULL), GD_BUDGET);
    assert_null(mesh);
    control.budget_bytes = gd_mesh_build_cost(ties.polygon_count, 6 * 5000);
    assert_int_equal(gd_mesh_build(&ties, &options, &control, &mesh, NULL), GD_OK);
    assert_int_equal(gd_mesh_repair(mesh)->copies, 5000);
    assert_true(gd_mesh_memsize(mesh) < control.budget_bytes);
    gd_mesh_release(mesh);
    gd_polygons_free(&ties);
}

struct stopwatch {
    uint32_t calls, stop_at;
    double last;
};

static bool count_calls(void *user, double fraction)
{
    struct stopwatch *watch = user;
    assert_true(fraction >= watch->last && fraction <= 1);
    watch->last = fraction;
    return ++watch->calls != watch->stop_at;
}

/* A build that is cancelled at any report stops and leaks nothing (checked by LeakSanitizer). */
static void it_can_be_cancelled_at_every_report(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct stopwatch watch = {0};
    struct gd_control control = {.progress = count_calls, .user = &watch};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, NULL), GD_OK);
    assert_true(watch.last == 1);
    gd_mesh_release(mesh);
    mesh = NULL;
    uint32_t reports = watch.calls;
    assert_true(reports > 10);
    for (uint32_t i = 1; i <= reports; i++) {
        watch = (struct stopwatch){.stop_at = i};
        assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, NULL), GD_CANCELLED);
        assert_null(mesh);
    }
}

/* Returns a sphere, a square and four defects: a bow tie, a cap, an edge with too many faces, and a
 * duplicate face. Each loop over the elements checks the control several times. */
static struct gd_polygons new_damaged_sphere(void)
{
    struct gd_polygons sphere;
    assert_int_equal(sample_icosphere(5, 1, &sphere), GD_OK);
    uint32_t vertices = sphere.position_count, corners = 3 * sphere.polygon_count;
    const double more[10][3] = {{5, 0, 0}, {6, 0, 0}, {6, 1, 0},     {4, 0, 0}, {4, 1, 0},
                                {5, 0, 9}, {7, 0, 9}, {6, 1e-14, 9}, {6, 1, 9}, {6, -1, 9}};
    const uint32_t faces[] = {0, 1, 2, 0, 3, 4, 5, 6, 8, 5, 7, 6, 5, 9, 7, 7, 9, 6, 0, 1, 2};
    struct gd_polygons damaged = {
        .positions = malloc((vertices + COUNT(more)) * sizeof *damaged.positions),
        .position_count = vertices + COUNT(more),
        .corners = malloc((corners + COUNT(faces) + 4) * sizeof *damaged.corners),
        .polygon_count = sphere.polygon_count + COUNT(faces) / 3 + 1,
    };
    damaged.first = malloc((damaged.polygon_count + 1) * sizeof *damaged.first);
    memcpy(damaged.positions, sphere.positions, vertices * sizeof *damaged.positions);
    memcpy(damaged.positions + vertices, more, sizeof more);
    memcpy(damaged.corners, sphere.corners, corners * sizeof *damaged.corners);
    for (uint32_t i = 0; i < COUNT(faces); i++) damaged.corners[corners++] = vertices + faces[i];
    for (uint32_t i = 0; i < damaged.polygon_count; i++) damaged.first[i] = 3 * i;
    const uint32_t square[4] = {vertices + 3, vertices + 4, vertices + 2, vertices + 1};
    memcpy(damaged.corners + corners, square, sizeof square);
    damaged.first[damaged.polygon_count] = corners + 4;
    gd_polygons_free(&sphere);
    return damaged;
}

static uint32_t count_reports(const struct gd_polygons *polygons,
                              const struct gd_mesh_options *options)
{
    struct stopwatch watch = {0};
    struct gd_control control = {.progress = count_calls, .user = &watch};
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    if (gd_mesh_build(polygons, options, &control, &mesh, &detail)) fail_msg("%s", detail.text);
    gd_mesh_release(mesh);
    return watch.calls;
}

/* Each loop over elements checks the control. A build that checks the control only between its
 * steps would check it far less than 100 times. */
static void it_can_be_cancelled_within_every_loop(void **state)
{
    (void)state;
    const struct gd_mesh_options ways[] = {
        {0}, {.repair_split = true}, {.weld = true}, {.weld = true, .repair_split = true}};
    struct gd_polygons damaged = new_damaged_sphere(), sphere;
    assert_int_equal(sample_icosphere(5, 1, &sphere), GD_OK);
    for (uint32_t way = 0; way < COUNT(ways); way++) {
        const struct gd_polygons *polygons = ways[way].repair_split ? &damaged : &sphere;
        uint32_t reports = count_reports(polygons, &ways[way]);
        assert_true(reports > 100);
        for (uint32_t i = 1; i <= reports; i += TEST_STRIDE) {
            struct stopwatch watch = {.stop_at = i};
            struct gd_control control = {.progress = count_calls, .user = &watch};
            struct gd_mesh *mesh = NULL;
            struct gd_detail detail = {0};
            assert_int_equal(gd_mesh_build(polygons, &ways[way], &control, &mesh, &detail),
                             GD_CANCELLED);
            assert_null(mesh);
            assert_int_equal(watch.calls, i);
            assert_int_equal(detail.total, 0);
        }
    }
    gd_polygons_free(&damaged);
    gd_polygons_free(&sphere);
}

static void a_deadline_in_the_past_stops_the_build(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_control control = {.deadline_ns = gd_now_ns()};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, NULL), GD_DEADLINE);
    assert_null(mesh);
}

/* --- two threads ------------------------------------------------------------------------------ */

static enum gd_status build_on_two(const struct gd_polygons *polygons, struct gd_mesh **mesh,
                                   struct gd_detail *detail)
{
    const struct gd_control control = {.executor = &two_threads};
    return gd_mesh_build(polygons, NULL, &control, mesh, detail);
}

static void check_same_mesh(const struct gd_mesh *a, const struct gd_mesh *b)
{
    size_t faces = a->face_count, vertices = a->vertex_count, edges = a->edge_count;
    assert_int_equal(faces, b->face_count);
    assert_int_equal(edges, b->edge_count);
    assert_memory_equal(&a->summary, &b->summary, sizeof a->summary);
    assert_memory_equal(a->side, b->side, 2 * edges * sizeof *a->side);
    assert_memory_equal(a->origin, b->origin, 2 * edges * sizeof *a->origin);
    assert_memory_equal(a->face_side, b->face_side, faces * sizeof *a->face_side);
    assert_memory_equal(a->fan, b->fan, 3 * faces * sizeof *a->fan);
    assert_memory_equal(a->beyond, b->beyond, 3 * faces * sizeof *a->beyond);
    assert_memory_equal(a->fan_first, b->fan_first, (vertices + 1) * sizeof *a->fan_first);
    assert_memory_equal(a->position, b->position, vertices * sizeof *a->position);
    assert_memory_equal(a->total_angle, b->total_angle, vertices * sizeof *a->total_angle);
    assert_memory_equal(a->vertex_kind, b->vertex_kind, vertices * sizeof *a->vertex_kind);
    assert_memory_equal(a->component, b->component, a->summary.components * sizeof *a->component);
    assert_memory_equal(a->bvh->box, b->bvh->box, a->bvh->level_count[0] * sizeof *a->bvh->box);
}

/* Two threads build the same mesh as one thread, to the last bit. Half of the faces are flipped. */
static void two_threads_build_the_same(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_icosphere(6, 1, &polygons), GD_OK);
    for (uint32_t f = 0; f < polygons.polygon_count; f += 2) {
        uint32_t *corner = polygons.corners + 3 * (size_t)f, kept = corner[1];
        corner[1] = corner[2];
        corner[2] = kept;
    }
    struct gd_mesh *one = build(&polygons), *two = NULL;
    assert_int_equal(build_on_two(&polygons, &two, NULL), GD_OK);
    check_same_mesh(one, two);
    gd_mesh_release(one);
    gd_mesh_release(two);
    gd_polygons_free(&polygons);
}

/* Returns the offsets of triangles, as of general polygons. */
static uint32_t *triangle_offsets(uint32_t triangles)
{
    uint32_t *first = malloc((triangles + (size_t)1) * sizeof *first);
    for (uint32_t i = 0; i <= triangles; i++) first[i] = 3 * i;
    return first;
}

/* A build that consumes the polygons makes the same mesh. Polygons other than triangles keep their
 * corners. */
static void consumed_polygons_make_the_same_mesh(void **state)
{
    (void)state;
    for (int general = 0; general < 2; general++) {
        struct gd_polygons polygons, copy;
        assert_int_equal(sample_icosphere(6, 1, &polygons), GD_OK);
        assert_int_equal(sample_icosphere(6, 1, &copy), GD_OK);
        if (general) {
            polygons.first = triangle_offsets(polygons.polygon_count);
            copy.first = triangle_offsets(copy.polygon_count);
        }
        struct gd_mesh *mesh = build(&polygons), *other = NULL;
        assert_int_equal(gd_mesh_build_consuming(&copy, NULL, NULL, &other, NULL), GD_OK);
        assert_null(copy.positions);
        assert_int_equal(copy.corners == NULL, !general);
        check_same_mesh(mesh, other);
        assert_int_equal(gd_mesh_memsize(mesh), gd_mesh_memsize(other));
        gd_mesh_release(mesh);
        gd_mesh_release(other);
        gd_polygons_free(&polygons);
        gd_polygons_free(&copy);
    }
}

/* After a failed build, gd_polygons_free frees the arrays that the build did not consume. If the
 * budget is too small, the build changes no array. */
static void failed_builds_leave_polygons_that_can_be_freed(void **state)
{
    (void)state;
    struct gd_polygons polygons = new_bow_ties(5000);
    struct gd_mesh *mesh = NULL;
    const struct gd_control small = {.budget_bytes = 1000};
    assert_int_equal(gd_mesh_build_consuming(&polygons, NULL, &small, &mesh, NULL), GD_BUDGET);
    assert_non_null(polygons.positions);
    assert_non_null(polygons.corners);
    assert_int_equal(gd_mesh_build_consuming(&polygons, NULL, NULL, &mesh, NULL),
                     GD_NON_MANIFOLD_VERTEX);
    assert_null(mesh);
    assert_null(polygons.positions);
    gd_polygons_free(&polygons);
}

/* Appends a vertex in the middle of the edge between two vertices. Returns its number. */
static uint32_t add_middle(struct gd_polygons *polygons, uint32_t a, uint32_t b)
{
    for (int k = 0; k < 3; k++)
        polygons->positions[polygons->position_count][k] =
            (polygons->positions[a][k] + polygons->positions[b][k]) / 2;
    return polygons->position_count++;
}

/* Two threads report the same offending elements as one thread. */
static void two_threads_refuse_the_same(void **state)
{
    (void)state;
    enum { REPEATED, DUPLICATE, CROWDED, FLAT, BOW_TIE, DEFECTS };
    static const enum gd_status expected[DEFECTS] = {GD_DEGENERATE_FACE, GD_DUPLICATE_FACE,
                                                     GD_NON_MANIFOLD_EDGE, GD_DEGENERATE_FACE,
                                                     GD_NON_MANIFOLD_VERTEX};
    for (int defect = 0; defect < DEFECTS; defect++) {
        struct gd_polygons polygons;
        struct gd_mesh *mesh = NULL;
        struct gd_detail one = {0}, two = {0};
        assert_int_equal(sample_icosphere(5, 1, &polygons), GD_OK);
        size_t corners = 3 * (size_t)polygons.polygon_count, vertices = polygons.position_count;
        polygons.corners = realloc(polygons.corners, (corners + 3) * sizeof *polygons.corners);
        polygons.positions =
            realloc(polygons.positions, (vertices + 2) * sizeof *polygons.positions);
        uint32_t *last = polygons.corners + corners, *first = polygons.corners;
        memcpy(last, first, 3 * sizeof *last);
        if (defect == REPEATED) last[1] = last[0];
        if (defect == CROWDED || defect == FLAT || defect == BOW_TIE)
            last[2] = add_middle(&polygons, last[0], last[1]);
        if (defect == CROWDED) polygons.positions[last[2]][0] += 1;
        if (defect == FLAT) first[2] = last[2];
        if (defect == BOW_TIE) {
            last[1] = add_middle(&polygons, last[1], first[2]);
            polygons.positions[last[1]][0] += 1;
        }
        polygons.polygon_count += defect != FLAT;
        assert_int_equal(gd_mesh_build(&polygons, NULL, NULL, &mesh, &one), expected[defect]);
        assert_int_equal(build_on_two(&polygons, &mesh, &two), expected[defect]);
        assert_memory_equal(&one, &two, sizeof one);
        gd_polygons_free(&polygons);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_budget_below_the_cost_is_refused),
        cmocka_unit_test(a_budget_that_many_copies_exceed_is_refused),
        cmocka_unit_test(it_can_be_cancelled_at_every_report),
        cmocka_unit_test(it_can_be_cancelled_within_every_loop),
        cmocka_unit_test(a_deadline_in_the_past_stops_the_build),
        cmocka_unit_test(two_threads_build_the_same),
        cmocka_unit_test(consumed_polygons_make_the_same_mesh),
        cmocka_unit_test(failed_builds_leave_polygons_that_can_be_freed),
        cmocka_unit_test(two_threads_refuse_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
