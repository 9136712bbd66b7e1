#include "cut/lattice.h"
#include "cut/planar.h"

#include "tests/support/test.h"

/* Starts a triangulation of the right triangle (0,0), (1,0), (0,1). In this triangle, planar
 * coordinates equal lattice coordinates. */
static void begin(struct gd__planar *planar, struct gd__budget *budget,
                  const struct gd__site *sites, uint32_t count)
{
    *planar = (struct gd__planar){.budget = budget};
    check_ok(gd__planar_begin(planar, count), NULL);
    for (uint32_t i = 0; i < count; i++) {
        planar->plane.sites[i] = sites[i];
        planar->places[i] =
            (struct gd__local){gd__from_lattice(sites[i].u), gd__from_lattice(sites[i].v)};
    }
}

static bool has_side(const struct gd__planar *planar, uint32_t a, uint32_t b)
{
    for (uint32_t t = 0; t < planar->plane.triangle_count; t++)
        for (uint32_t k = 0; k < 3; k++)
            if (planar->plane.triangles[t].corner[k] == a &&
                planar->plane.triangles[t].corner[(k + 1) % 3] == b)
                return true;
    return false;
}

/* Checks that triangles are counter-clockwise, tile the face exactly, and agree about their
 * neighbours. */
static void check_tiling(const struct gd__planar *planar)
{
    __int128 area = 0;
    for (uint32_t t = 0; t < planar->plane.triangle_count; t++) {
        const struct gd__plane_triangle *triangle = &planar->plane.triangles[t];
        __int128 part = gd__site_area(planar->plane.sites[triangle->corner[0]],
                                      planar->plane.sites[triangle->corner[1]],
                                      planar->plane.sites[triangle->corner[2]]);
        assert_true(part > 0);
        area += part;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t other = triangle->across[k], m = 0;
            if (other == GD_NONE) continue;
            while (planar->plane.triangles[other].across[m] != t) assert_true(++m < 3);
            assert_int_equal(planar->plane.triangles[other].corner[m],
                             triangle->corner[(k + 1) % 3]);
            assert_int_equal(planar->plane.triangles[other].corner[(m + 1) % 3],
                             triangle->corner[k]);
            assert_int_equal(planar->plane.triangles[other].is_fixed[m], triangle->is_fixed[k]);
        }
    }
    assert_true(area == (__int128)GD__LATTICE * GD__LATTICE);
}

#define L GD__LATTICE

/* Uses sites on a circle, where all diagonals are equally likely. Inserting a chord that crosses
 * most diagonals needs many flips. */
static void a_segment_across_many_diagonals(void **state)
{
    (void)state;
    struct gd__budget budget = {0};
    struct gd__planar planar;
    struct gd__site sites[3 + 24] = {{0, 0}, {L, 0}, {0, L}};
    for (int i = 0; i < 24; i++)
        sites[3 + i] = (struct gd__site){gd__to_lattice(0.28 + 0.25 * cos(0.26 * i + 0.1)),
                                         gd__to_lattice(0.28 + 0.25 * sin(0.26 * i + 0.1))};
    begin(&planar, &budget, sites, 27);
    check_ok(gd__planar_triangulate(&planar), NULL);
    check_tiling(&planar);
    gd__plane_improve(&planar.plane);
    check_tiling(&planar);
    for (uint32_t i = 0; i < 12; i++) {
        check_ok(gd__plane_fix(&planar.plane, 3 + i, 3 + 23 - i), NULL);
        check_tiling(&planar);
    }
    gd__plane_improve(&planar.plane);
    check_tiling(&planar);
    for (uint32_t i = 0; i < 12; i++) assert_true(has_side(&planar, 3 + i, 3 + 23 - i));
    assert_int_equal(gd__plane_fix(&planar.plane, 3, 4 + 11), GD_RUNAWAY); /* crosses a segment */
    gd__planar_free(&planar);
}

/* Inserts random segments that do not cross earlier segments. Their ends are random sites, some of
 * them on the sides. All segments are in the final triangulation. */
static void random_segments(void **state)
{
    (void)state;
    struct rng rng = {3};
    struct gd__budget budget = {0};
    for (int round = 0; round < 60; round++) {
        struct gd__planar planar;
        struct gd__site sites[43] = {{0, 0}, {L, 0}, {0, L}};
        uint32_t segments[200][2], count = 0;
        for (int i = 3; i < 43; i++) {
            double u = rng_unit(&rng), v = rng_unit(&rng) * (1 - u);
            int64_t a = gd__to_lattice(u), b = gd__to_lattice(v);
            sites[i] = i % 7 == 0   ? (struct gd__site){a, 0}
                       : i % 7 == 1 ? (struct gd__site){0, a}
                       : i % 7 == 2 ? (struct gd__site){a, L - a}
                                    : (struct gd__site){a, b};
        }
        begin(&planar, &budget, sites, 43);
        check_ok(gd__planar_triangulate(&planar), NULL);
        for (int i = 0; i < 200; i++) {
            uint32_t a = rng_below(&rng, 43), b = rng_below(&rng, 43);
            bool is_free = a != b;
            for (uint32_t s = 0; s < count; s++)
                is_free &= !gd__sites_cross(sites[a], sites[b], sites[segments[s][0]],
                                            sites[segments[s][1]]);
            for (uint32_t s = 0; s < 43; s++)
                is_free &= s == a || s == b || gd__site_turn(sites[a], sites[b], sites[s]) != 0;
            if (!is_free) continue;
            check_ok(gd__plane_fix(&planar.plane, a, b), NULL);
            segments[count][0] = a;
            segments[count++][1] = b;
        }
        gd__plane_improve(&planar.plane);
        check_tiling(&planar);
        for (uint32_t s = 0; s < count; s++)
            assert_true(has_side(&planar, segments[s][0], segments[s][1]) ||
                        has_side(&planar, segments[s][1], segments[s][0]));
        assert_true(count > 20);
        gd__planar_free(&planar);
    }
}

/* Uses the four corners of a flat rhombus, whose short diagonal gives larger angles. */
static void flips_widen_angles(void **state)
{
    (void)state;
    struct gd__budget budget = {0};
    struct gd__planar planar;
    const struct gd__site sites[] = {{0, 0},
                                     {L, 0},
                                     {0, L},
                                     {L / 8, L / 4},
                                     {L / 2, L / 4},
                                     {L * 5 / 16, L / 4 + L / 64},
                                     {L * 5 / 16, L / 4 - L / 64}};
    begin(&planar, &budget, sites, 7);
    check_ok(gd__planar_triangulate(&planar), NULL);
    gd__plane_improve(&planar.plane);
    assert_true(has_side(&planar, 5, 6));
    assert_false(has_side(&planar, 3, 4));
    check_ok(gd__plane_fix(&planar.plane, 3, 4), NULL);
    gd__plane_improve(&planar.plane);
    assert_true(has_side(&planar, 3, 4));
    check_tiling(&planar);
    gd__planar_free(&planar);
}

static void invalid_sites_are_refused(void **state)
{
    (void)state;
    struct gd__budget budget = {0};
    struct gd__planar planar;
    const struct gd__site twice[] = {{0, 0}, {L, 0}, {0, L}, {L / 4, L / 4}, {L / 4, L / 4}};
    const struct gd__site outside[] = {{0, 0}, {L, 0}, {0, L}, {L / 2, L / 2 + 1}};
    const struct gd__site line[] = {{0, 0},         {L, 0},         {0, L},
                                    {L / 8, L / 8}, {L / 4, L / 4}, {3 * L / 8, 3 * L / 8}};
    begin(&planar, &budget, twice, 5);
    assert_int_equal(gd__planar_triangulate(&planar), GD_RUNAWAY);
    gd__planar_free(&planar);
    begin(&planar, &budget, outside, 4);
    assert_int_equal(gd__planar_triangulate(&planar), GD_RUNAWAY);
    gd__planar_free(&planar);
    begin(&planar, &budget, line, 6);
    check_ok(gd__planar_triangulate(&planar), NULL);
    /* the segment passes through a site */
    assert_int_equal(gd__plane_fix(&planar.plane, 3, 5), GD_RUNAWAY);
    assert_int_equal(gd__planar_begin(&planar, UINT32_MAX), GD_TOO_LARGE);
    gd__planar_free(&planar);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_segment_across_many_diagonals),
        cmocka_unit_test(random_segments),
        cmocka_unit_test(flips_widen_angles),
        cmocka_unit_test(invalid_sites_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
