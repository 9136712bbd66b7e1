#include "tests/unit/transport/lines.h"

#include "line/turn.h"

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {{"terrain", {12, 0.8, 3}},
                {"tangle", {120, 11}},
                {"saddle", {1, 0.7, 12, 3}},
                {"box", {1, 2, 3, 2}}};

/* Checks that angles and turns (line/turn.h) convert into each other, and that the ray of a turn
 * has the same turn in its face. */
static void check_point(const struct gd_mesh *mesh, struct gd_point point, struct rng *rng)
{
    bool is_closed = gd__turn_is_closed(mesh, &point);
    for (int i = 0; i < 8; i++) {
        struct gd_direction direction = random_direction(mesh, point, rng);
        double turn = gd__turn_of_angle(mesh, &point, direction.angle);
        assert_true(!is_closed || (turn >= 0 && turn < gd__turn_total(mesh, &point)));
        expect_near(remainder(gd__turn_to_angle(mesh, &point, turn) - direction.angle, 2 * M_PI), 0,
                    exact);
        struct gd_direction again = gd__turn_direction(mesh, &point, turn);
        expect_place(again.xyz, direction.xyz.x, direction.xyz.y, direction.xyz.z, 1e-11);
        /* the ray has the same turn in its face */
        struct gd__ray ray = gd__turn_ray(mesh, &point, turn);
        double back = gd__turn_in_face(mesh, &point, ray.side, ray.dx, ray.dy);
        expect_near(remainder(back - turn, gd__turn_total(mesh, &point)), 0, exact);
    }
}

static void angles_and_turns(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < COUNT(surfaces); s++) {
        struct surface surface = surface_of(surfaces[s].name, surfaces[s].values);
        struct rng rng = {s};
        for (int i = 0; i < 200; i++)
            check_point(surface.mesh,
                        test_point(surface.mesh, test_random_place(&surface.polygons, &rng)), &rng);
        surface_free(&surface);
    }
}

/* A direction that leaves the surface lies in the plane of the nearest face. */
static void off_the_surface(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){2, 2, 2, 2});
    const struct gd_point points[] = {nearest(grid.mesh, 0, 0, 0), nearest(grid.mesh, 2, 0.4, 0),
                                      nearest(grid.mesh, 0.3, 0, 0), nearest(grid.mesh, 0, 1, 0)};
    for (uint32_t i = 0; i < COUNT(points); i++) {
        struct gd_direction inward =
            along(grid.mesh, points[i], 1 - gd_point_position(grid.mesh, &points[i]).x,
                  1 - gd_point_position(grid.mesh, &points[i]).y, 0);
        double turn = gd__turn_of_angle(grid.mesh, &points[i], inward.angle);
        assert_false(gd__turn_is_closed(grid.mesh, &points[i]));
        for (int k = 0; k < 24; k++) {
            double more = M_PI * (k - 12) / 12, c = cos(more), s = sin(more);
            struct gd_direction out = gd__turn_direction(grid.mesh, &points[i], turn + more);
            expect_place(out.xyz, inward.xyz.x * c - inward.xyz.y * s,
                         inward.xyz.x * s + inward.xyz.y * c, 0, exact);
        }
    }
    surface_free(&grid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(angles_and_turns),
                                       cmocka_unit_test(off_the_surface)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
