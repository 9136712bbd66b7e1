#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "gd/cpu.h"
#include "gd/field.h"
#include "tests/samples/samples.h"
#include "tests/support/watch.h"

enum { POINTS = 5000 };

static struct gd_field *field_of(const struct gd_mesh *mesh, const struct gd_field_request *request)
{
    struct gd_field *field;
    struct gd_detail detail = {0};
    check_ok(gd_field_build(mesh, request, NULL, &field, &detail), &detail);
    return field;
}

static struct gd_mesh *terrain(struct gd_polygons *polygons)
{
    check_ok(sample_terrain(24, 0.3, 7, polygons), NULL);
    return test_mesh(polygons);
}

/* Returns random points of all kinds in random order. */
static struct gd_point *random_points(const struct gd_mesh *mesh,
                                      const struct gd_polygons *polygons, struct rng *rng,
                                      uint32_t count)
{
    struct gd_point *points = malloc(sizeof *points * (count + 1));
    for (uint32_t i = 0; i < count; i++)
        points[i] = test_point(mesh, test_random_place(polygons, rng));
    return points;
}

/* Returns the value that gd_field_distances must write for one point. */
static double one_distance(const struct gd_field *field, const struct gd_point *point)
{
    double distance = 0;
    enum gd_status status = gd_field_distance(field, point, &distance);
    if (status == GD_BEYOND_REACH) return NAN;
    check_ok(status, NULL);
    return distance;
}

static void check_batch(const struct gd_field *field, const struct gd_point *points, uint32_t count)
{
    double *out = malloc(sizeof *out * (count + 1));
    out[count] = -1;
    check_ok(gd_field_distances(field, points, count, NULL, out), NULL);
    for (uint32_t i = 0; i < count; i++) {
        double expected = one_distance(field, &points[i]);
        if (isnan(expected))
            assert_true(isnan(out[i]));
        else
            assert_memory_equal(&out[i], &expected, sizeof expected);
    }
    assert_true(out[count] == -1);
    free(out);
}

static void a_batch_equals_single_calls(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = terrain(&polygons);
    struct rng rng = {1};
    struct gd_point *points = random_points(mesh, &polygons, &rng, POINTS);
    struct gd_seed seeds[3] = {
        {.point = points[0]}, {.point = points[1], .offset = 0.1}, {.point = points[2]}};
    struct gd_field *whole =
        field_of(mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = 3});
    struct gd_field *partial =
        field_of(mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = 1, .radius = 0.4});
    const uint32_t counts[] = {0, 1, 2, 15, 16, 17, 64, 1023, POINTS};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        check_batch(whole, points, counts[i]);
    check_batch(partial, points, POINTS);
    double *out = malloc(sizeof *out * POINTS);
    uint32_t beyond = 0;
    check_ok(gd_field_distances(partial, points, POINTS, NULL, out), NULL);
    for (uint32_t i = 0; i < POINTS; i++) beyond += isnan(out[i]);
    print_message("# batches: %u of %u points beyond a partial field's reach\n", beyond,
                  (unsigned)POINTS);
    assert_true(beyond > POINTS / 10 && beyond < POINTS - POINTS / 10);
    free(out);
    gd_field_release(whole);
    gd_field_release(partial);
    free(points);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void another_component_is_infinitely_far(void **state)
{
    (void)state;
    double positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    uint32_t corners[6] = {0, 1, 2, 3, 4, 5};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 6, .polygon_count = 2, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){0, {0.25, 0.25, 0.5}})};
    struct gd_field *field =
        field_of(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1});
    struct gd_point points[4] = {seed.point,
                                 test_point(mesh, (struct test_place){1, {0.25, 0.25, 0.5}}),
                                 test_point(mesh, (struct test_place){1, {1, 0, 0}}),
                                 test_point(mesh, (struct test_place){1, {0, 0.5, 0.5}})};
    double out[4];
    check_ok(gd_field_distances(field, points, 4, NULL, out), NULL);
    assert_true(out[0] == 0 && isinf(out[1]) && isinf(out[2]) && isinf(out[3]));
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* Computes the distance in a face without seeds by definition: the minimum over the face's corners
 * and wedges. */
static double plain_distance(const struct gd_field *field, const struct gd_point *point)
{
    const struct gd_mesh *mesh = field->mesh;
    double least = INFINITY;
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[point->element][k];
        double length = mesh->side[side].length;
        struct gd__local at = gd__face_local(
            mesh, side,
            (double[3]){point->weight[k], point->weight[(k + 1) % 3], point->weight[(k + 2) % 3]});
        least = fmin(least, field->distance[mesh->origin[side]] + hypot(at.x, at.y));
        for (uint32_t next = field->newest[side >> 1]; next != GD_NONE;
             next = gd__chunk_previous(gd__field_chunk(field, next))) {
            const struct gd__chunk *chunk = gd__field_chunk(field, next);
            for (uint32_t i = 0; i < chunk->count; i++) {
                struct gd__wedges wedges = gd__chunk_wedges(chunk);
                struct gd__window w = gd__wedge_window(&wedges, i, length);
                if (w.source == GD_NONE || w.tags != (side & 1 ? GD__WINDOW_FAR_SIDE : 0u))
                    continue;
                if (side & 1) w = gd__window_mirrored(&w, length);
                double t = w.x + (at.x - w.x) * w.y / (at.y + w.y),
                       bend = fmin(fmax(t, w.b0), w.b1);
                least = fmin(least, gd__field_sigma(field, w.source) + hypot(bend - w.x, w.y) +
                                        hypot(at.x - bend, at.y));
            }
        }
    }
    return least * mesh->unit;
}

static bool has_seed(const struct gd_field *field, uint32_t face)
{
    for (uint32_t i = 0; i < field->face_seed_count; i++)
        if (field->face_seeds[i].face == face) return true;
    return false;
}

/* Returns a weighted sum of all numbers that describe the paths' last segments (`leg`). The sum
 * differs if any segment differs. */
static double legs_sum(const struct gd_field *field, const struct gd_point *points)
{
    double sum = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        struct gd__leg leg = gd__field_leg(field, &points[i]);
        sum +=
            (leg.kind + leg.from + leg.side + leg.source + leg.parameter + leg.x + leg.y) * (1 + i);
    }
    return sum;
}

/* The kernel of each instruction set agrees with the definition, and bit for bit with the baseline
 * kernel. */
static void kernels_agree(void **state)
{
    (void)state;
    const char *names[] = {"baseline", "avx2", "avx512"}, *before = gd_cpu_name();
    struct gd_polygons polygons;
    struct gd_mesh *mesh = terrain(&polygons);
    struct rng rng = {2};
    struct gd_point *points = random_points(mesh, &polygons, &rng, POINTS);
    struct gd_seed seeds[2] = {{.point = points[0]}, {.point = points[1], .offset = 0.05}};
    struct gd_field *field =
        field_of(mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = 2});
    double *out[3], legs = 0, worst = 0;
    for (int k = 0; k < 3; k++) {
        out[k] = malloc(sizeof **out * POINTS);
        if (gd_cpu_select(names[k])) continue;
        check_ok(gd_field_distances(field, points, POINTS, NULL, out[k]), NULL);
        assert_memory_equal(out[k], out[0], sizeof **out * POINTS);
        if (!k) legs = legs_sum(field, points);
        assert_true(legs == legs_sum(field, points));
        for (uint32_t i = 0; i < POINTS; i++) {
            if (points[i].kind != GD_POINT_FACE || has_seed(field, points[i].element)) continue;
            double expected = plain_distance(field, &points[i]);
            worst = fmax(worst, fabs(out[k][i] - expected) / expected);
        }
    }
    check_ok(gd_cpu_select(before), NULL);
    print_message("# distances against the definition: worst %.1e\n", worst);
    assert_true(worst < 1e-12);
    for (int k = 0; k < 3; k++) free(out[k]);
    gd_field_release(field);
    free(points);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Appends a chunk that has only wedge `i` of `chunk`, with gaps on both sides. The form of the
 * chunk depends on `at`. */
static uint32_t append_part(char *wedges, uint32_t at, uint32_t previous,
                            const struct gd__chunk *chunk, uint32_t i)
{
    struct gd__wedges from = gd__chunk_wedges(chunk);
    bool before = from.start[i] > 0, behind = i + 1 < chunk->count;
    struct gd__chunk *part = (struct gd__chunk *)(wedges + (size_t)at * GD__CHUNK_UNIT);
    *part = (struct gd__chunk){.count = 1u + before + behind,
                               .exponent = chunk->exponent,
                               .is_far = chunk->is_far,
                               .form = chunk->form == GD__WEDGE_WIDE ? GD__WEDGE_WIDE : at % 3};
    struct gd__wedges to = gd__chunk_wedges(part);
    for (uint32_t k = 0; k < part->count; k++)
        gd__wedge_put(&to, k, k ? from.start[i + 1 < chunk->count ? i + 1 : i] : 0, 0, 0, GD_NONE);
    gd__wedge_put(&to, before, from.start[i], gd__wedge_x(&from, i), gd__wedge_y(&from, i),
                  gd__wedge_source(&from, i));
    return at + (uint32_t)(gd__chunk_link(part, previous) / GD__CHUNK_UNIT);
}

/* Every wedge gets a chunk of its own, so the chains are long. Distances must stay the same bit for
 * bit. Lengths of paths may differ by rounding. */
static void long_chains_give_the_same(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = terrain(&polygons);
    struct rng rng = {3};
    struct gd_point *points = random_points(mesh, &polygons, &rng, POINTS);
    struct gd_seed seed = {.point = points[0]};
    struct gd_field *field =
        field_of(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1});
    uint32_t at = 0, longest = 0, *newest = malloc(sizeof *newest * mesh->edge_count);
    char *wedges = malloc(6 * field->wedge_bytes + GD__CHUNK_SLACK);
    for (uint32_t e = 0; e < mesh->edge_count; e++) {
        uint32_t length = 0;
        newest[e] = GD_NONE;
        for (uint32_t next = field->newest[e]; next != GD_NONE;
             next = gd__chunk_previous(gd__field_chunk(field, next))) {
            const struct gd__chunk *chunk = gd__field_chunk(field, next);
            for (uint32_t i = 0; i < chunk->count; i++) {
                struct gd__wedges from = gd__chunk_wedges(chunk);
                if (gd__wedge_source(&from, i) == GD_NONE) continue;
                uint32_t part = at;
                at = append_part(wedges, at, newest[e], chunk, i);
                newest[e] = part;
                length++;
            }
        }
        if (length > longest) longest = length;
    }
    struct gd_field split = {.mesh = mesh,
                             .reach = field->reach,
                             .distance = field->distance,
                             .predecessor = field->predecessor,
                             .newest = newest,
                             .wedges = wedges,
                             .seeds = field->seeds,
                             .seed_count = field->seed_count,
                             .face_seeds = field->face_seeds,
                             .face_seed_count = field->face_seed_count};
    print_message("# chains of up to %u chunks\n", longest);
    assert_true(longest > 10); /* the longest chain exceeds one group of wedges */
    for (uint32_t i = 0; i < POINTS; i++) {
        struct gd__leg a = gd__field_leg(field, &points[i]), b = gd__field_leg(&split, &points[i]);
        assert_memory_equal(&a.distance, &b.distance, sizeof a.distance);
        if (a.kind != GD__LEG_WEDGE || b.kind != GD__LEG_WEDGE) continue;
        struct gd_path p, q; /* the last segments may differ if both paths have the same length */
        check_ok(gd_field_path(field, &points[i], &p), NULL);
        check_ok(gd_field_path(&split, &points[i], &q), NULL);
        check_close(q.length, p.length, 1e-12);
        gd_path_free(&p);
        gd_path_free(&q);
    }
    free(wedges);
    free(newest);
    gd_field_release(field);
    free(points);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void a_failed_batch_keeps_its_output(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = terrain(&polygons);
    struct rng rng = {4};
    struct gd_point *points = random_points(mesh, &polygons, &rng, POINTS);
    struct gd_seed seed = {.point = points[0]};
    struct gd_field *field =
        field_of(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1});
    double *out = malloc(sizeof *out * POINTS), *untouched = malloc(sizeof *out * POINTS);
    for (uint32_t i = 0; i < POINTS; i++) out[i] = untouched[i] = -1;
    struct gd_control budget = {.budget_bytes = 1000}, late = {.deadline_ns = 1},
                      cancel = {.progress = test_cancel},
                      enough = {.budget_bytes = 16 * (size_t)POINTS + 1000};
    assert_int_equal(gd_field_distances(field, points, POINTS, &budget, out), GD_BUDGET);
    assert_int_equal(gd_field_distances(field, points, POINTS, &late, out), GD_DEADLINE);
    assert_int_equal(gd_field_distances(field, points, POINTS, &cancel, out), GD_CANCELLED);
    assert_memory_equal(out, untouched, sizeof *out * POINTS);
    check_ok(gd_field_distances(field, points, POINTS, &enough, out), NULL);
    free(out);
    free(untouched);
    gd_field_release(field);
    free(points);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_batch_equals_single_calls),
        cmocka_unit_test(another_component_is_infinitely_far),
        cmocka_unit_test(kernels_agree),
        cmocka_unit_test(long_chains_give_the_same),
        cmocka_unit_test(a_failed_batch_keeps_its_output),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
