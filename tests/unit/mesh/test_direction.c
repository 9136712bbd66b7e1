#include "shapes.h"

#include "gd/direction.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static const double exact = 1e-14;

static struct gd_point on_edge(const struct gd_mesh *mesh, uint32_t a, uint32_t b)
{
    struct gd_point point;
    assert_int_equal(gd_point_on_edge(mesh, (struct gd_vertex[]){{a}, {b}}, 0.3, &point, NULL),
                     GD_OK);
    return point;
}

static struct gd_point in_face(const struct gd_mesh *mesh, uint32_t face)
{
    struct gd_point point;
    const double weights[3] = {0.2, 0.3, 0.5};
    assert_int_equal(gd_point_in_face(mesh, (struct gd_face){face}, weights, &point, NULL), GD_OK);
    return point;
}

static struct gd_direction at(const struct gd_mesh *mesh, struct gd_point point, double angle)
{
    struct gd_direction direction = {0};
    struct gd_detail detail = {0};
    enum gd_status status = gd_direction_at_angle(mesh, &point, angle, &direction, &detail);
    if (status) fail_msg("%.17g: %s", angle, detail.text);
    return direction;
}

static struct gd_direction along(const struct gd_mesh *mesh, struct gd_point point,
                                 struct gd_vec3 v)
{
    struct gd_direction direction = {0};
    struct gd_detail detail = {0};
    enum gd_status status = gd_direction_along(mesh, &point, v, &direction, &detail);
    if (status) fail_msg("(%.17g %.17g %.17g): %s", v.x, v.y, v.z, detail.text);
    return direction;
}

static void expect_vector(struct gd_vec3 actual, double x, double y, double z)
{
    if (gd_vec3_distance(actual, (struct gd_vec3){x, y, z}) > exact)
        fail_msg("(%.17g %.17g %.17g) instead of (%.17g %.17g %.17g)", actual.x, actual.y, actual.z,
                 x, y, z);
}

/* Checks that the angle gives the vector (x, y, z) and that this vector gives the angle. */
static void expect_both(const struct gd_mesh *mesh, struct gd_point point, double angle, double x,
                        double y, double z)
{
    struct gd_direction direction = at(mesh, point, angle);
    expect_vector(direction.xyz, x, y, z);
    expect_near(remainder(direction.angle - angle, 2 * M_PI), 0, exact);
    direction = along(mesh, point, (struct gd_vec3){1e3 * x, 1e3 * y, 1e3 * z});
    expect_near(remainder(direction.angle - angle, 2 * M_PI), 0, exact);
    expect_vector(direction.xyz, x, y, z);
}

/* --- the plane -------------------------------------------------------------------------------- */

/* A square around its centre, vertex 4. Faces 1 and 3 have the opposite orientation in the
 * input. */
static double square_positions[][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}};
static uint32_t square_corners[] = {0, 1, 4, 2, 1, 4, 2, 3, 4, 0, 3, 4};

static struct gd_mesh *new_square(void)
{
    struct gd_polygons square = TRIANGLES(square_positions, square_corners);
    struct gd_mesh *mesh = build(&square);
    assert_int_equal(gd_mesh_summary(mesh)->flipped_faces, 2);
    return mesh;
}

/* Directions in a plane are ordinary angles, measured from a zero that depends on the point. */
static void in_the_plane(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_square();
    const struct {
        struct gd_point point;
        double zero;     /* direction of the point's angle 0, as an angle in the plane */
        double from, to; /* range of the angles on the surface */
    } places[] = {
        {in_face(mesh, 0), 0, 0, 2 * M_PI},         /* 0 -> 1 */
        {in_face(mesh, 1), -M_PI_2, 0, 2 * M_PI},   /* 2 -> 1, face reversed */
        {in_face(mesh, 2), M_PI, 0, 2 * M_PI},      /* 2 -> 3 */
        {in_face(mesh, 3), M_PI_2, 0, 2 * M_PI},    /* 0 -> 3, face reversed */
        {on_edge(mesh, 4, 0), M_PI_4, 0, 2 * M_PI}, /* 0 -> 4 */
        {on_edge(mesh, 2, 4), -3 * M_PI_4, 0, 2 * M_PI},
        {on_edge(mesh, 0, 1), 0, 0, M_PI}, /* the surface is to the left */
        /* the surface is to the right of 0 -> 3 */
        {on_edge(mesh, 3, 0), M_PI_2, M_PI, 2 * M_PI},
        {test_vertex(mesh, 4), -3 * M_PI_4, 0, 2 * M_PI}, /* 4 -> 0 */
        {test_vertex(mesh, 0), 0, 0, M_PI_2},
        {test_vertex(mesh, 1), M_PI_2, 0, M_PI_2},
        {test_vertex(mesh, 2), M_PI, 0, M_PI_2},
        {test_vertex(mesh, 3), -M_PI_2, 0, M_PI_2},
    };
    for (uint32_t i = 0; i < COUNT(places); i++) {
        for (int k = 0; k <= 24; k++) {
            double angle = places[i].from + (places[i].to - places[i].from) * k / 24,
                   plane = places[i].zero + angle;
            expect_both(mesh, places[i].point, angle, cos(plane), sin(plane), 0);
            struct gd_direction lifted =
                along(mesh, places[i].point, (struct gd_vec3){cos(plane), sin(plane), k - 12.0});
            expect_near(remainder(lifted.angle - angle, 2 * M_PI), 0, 1e-13);
        }
    }
    gd_mesh_release(mesh);
}

static void directions_off_the_surface(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_square();
    const struct gd_point points[] = {on_edge(mesh, 0, 1), test_vertex(mesh, 0),
                                      on_edge(mesh, 0, 3)};
    const double angles[] = {-0.1, -0.1, 0.1}, rounded[] = {M_PI + 1e-10, M_PI_2 + 1e-10, 1e-10},
                 ends[] = {M_PI, M_PI_2, 0};
    const struct gd_vec3 vectors[] = {{0, -1, 0}, {1, -0.5, 0}, {-1, 0, 0}};
    for (uint32_t i = 0; i < COUNT(points); i++) {
        struct gd_direction direction = {.angle = 7};
        struct gd_detail detail = {0};
        assert_int_equal(gd_direction_at_angle(mesh, &points[i], angles[i], &direction, &detail),
                         GD_NOT_ON_SURFACE);
        assert_non_null(strstr(detail.text, "boundary"));
        assert_int_equal(gd_direction_along(mesh, &points[i], vectors[i], &direction, NULL),
                         GD_NOT_ON_SURFACE);
        assert_true(direction.angle == 7);
        expect_near(remainder(at(mesh, points[i], rounded[i]).angle - ends[i], 2 * M_PI), 0, exact);
    }
    gd_mesh_release(mesh);
}

static void invalid_directions_are_refused(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_square();
    const struct gd_point points[] = {in_face(mesh, 0), on_edge(mesh, 0, 4), test_vertex(mesh, 4),
                                      test_vertex(mesh, 0)};
    const struct gd_vec3 vectors[] = {
        {0, 0, 0}, {0, 0, 1}, {0, 0, -1e300}, {NAN, 0, 0}, {INFINITY, 1, 0}};
    for (uint32_t i = 0; i < COUNT(points); i++) {
        struct gd_direction direction = {.angle = 7};
        for (uint32_t k = 0; k < COUNT(vectors); k++)
            assert_int_equal(gd_direction_along(mesh, &points[i], vectors[k], &direction, NULL),
                             GD_INVALID_ARGUMENT);
        assert_int_equal(gd_direction_at_angle(mesh, &points[i], NAN, &direction, NULL),
                         GD_INVALID_ARGUMENT);
        assert_int_equal(gd_direction_at_angle(mesh, &points[i], -INFINITY, &direction, NULL),
                         GD_INVALID_ARGUMENT);
        assert_true(direction.angle == 7);
    }
    expect_near(along(mesh, points[0], (struct gd_vec3){1e-300, 1e-300, 0}).angle, M_PI_4, exact);
    expect_near(along(mesh, points[0], (struct gd_vec3){1e300, 1e300, 1e300}).angle, M_PI_4, exact);
    gd_mesh_release(mesh);
}

static void whole_turns_change_nothing(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_square();
    const struct gd_point points[] = {in_face(mesh, 3), on_edge(mesh, 1, 4), on_edge(mesh, 0, 1),
                                      test_vertex(mesh, 4)};
    for (uint32_t i = 0; i < COUNT(points); i++) {
        struct gd_direction once = at(mesh, points[i], 1);
        assert_true(once.angle == 1);
        for (int k = -3; k < 3; k++) {
            struct gd_direction again = at(mesh, points[i], 1 + k * 2 * M_PI);
            expect_near(again.angle, 1, exact);
            expect_near(gd_vec3_distance(again.xyz, once.xyz), 0, exact);
        }
        const double nothing[] = {-1e-300, -0.0, -2 * M_PI};
        for (uint32_t k = 0; k < COUNT(nothing); k++) {
            struct gd_direction zero = at(mesh, points[i], nothing[k]);
            assert_true(zero.angle == 0 && !signbit(zero.angle));
        }
    }
    gd_mesh_release(mesh);
}

/* --- solid corners ---------------------------------------------------------------------------- */

/* At vertex 0 of a cube three right angles meet. Angles are measured from the neighbour with the
 * lowest number, which is 1, on the x axis. Seen from outside, the edges along x, z and y follow
 * each other counter-clockwise. */
static void at_the_corner_of_a_cube(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_mesh *mesh = build(&polygons);
    struct gd_point corner = test_vertex(mesh, 0);
    const double third = 2 * M_PI / 3, half = sqrt(0.5);
    expect_both(mesh, corner, 0, 1, 0, 0);
    expect_both(mesh, corner, third, 0, 0, 1);
    expect_both(mesh, corner, 2 * third, 0, 1, 0);
    expect_both(mesh, corner, third / 2, half, 0, half);
    expect_both(mesh, corner, third * 1.5, 0, half, half);
    expect_both(mesh, corner, third * 2.5, half, half, 0);
    expect_both(mesh, corner, third / 3, cos(M_PI / 6), 0, sin(M_PI / 6));
    struct gd_direction x = at(mesh, corner, 0), back = gd_direction_opposite(mesh, &corner, &x);
    expect_near(back.angle, M_PI, exact);
    expect_vector(back.xyz, 0, half, half);
    /* vectors that are symmetric about the normal stay symmetric */
    struct gd_direction down = along(mesh, corner, (struct gd_vec3){-2, 1, 1});
    expect_near(down.angle, M_PI, exact);
    expect_vector(down.xyz, 0, half, half);
    expect_near(along(mesh, corner, (struct gd_vec3){3, 2, 2}).angle, 0, exact);
    gd_mesh_release(mesh);
}

/* Tests a point on the edge of a cube between its faces y = 0 and z = 0. Across an edge the surface
 * is flat. */
static void on_the_edge_of_a_cube(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_mesh *mesh = build(&polygons);
    struct gd_point point = on_edge(mesh, 1, 0);
    for (int k = 0; k < 24; k++) {
        double angle = 2 * M_PI * k / 24, x = cos(angle), y = sin(angle);
        /* the face y = 0 is to the left of x, seen from outside */
        expect_both(mesh, point, angle, x, y < 0 ? -y : 0, y < 0 ? 0 : y);
        struct gd_direction direction = at(mesh, point, angle),
                            opposite = gd_direction_opposite(mesh, &point, &direction);
        expect_near(remainder(opposite.angle - angle - M_PI, 2 * M_PI), 0, exact);
    }
    /* A vector that projects into both faces is assigned to the nearer face. A vector that projects
       into neither face is assigned to the edge. */
    expect_near(along(mesh, point, (struct gd_vec3){0, 1, 2}).angle, M_PI_2, exact);
    expect_near(along(mesh, point, (struct gd_vec3){0, 2, 1}).angle, 3 * M_PI_2, exact);
    expect_near(along(mesh, point, (struct gd_vec3){0.1, -1, -2}).angle, 0, exact);
    gd_mesh_release(mesh);
}

/* On a pyramid without base, angles at the apex are scaled to a total of 2 pi. */
static void on_a_cone(void **state)
{
    (void)state;
    enum { SECTORS = 7 };
    struct gd_polygons polygons;
    assert_int_equal(sample_cone(1, 2, SECTORS, 3, &polygons), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    uint32_t last = polygons.position_count - 1, lowest = UINT32_MAX;
    struct gd_point apex = test_vertex(mesh, last);
    struct gd_vec3 tip = gd_mesh_position(mesh, (struct gd_vertex){last});
    for (uint32_t f = 0; f < polygons.polygon_count; f++)
        for (int k = 0; k < 3; k++)
            if (polygons.corners[3 * f + k] == last)
                for (int j = 0; j < 3; j++)
                    if (polygons.corners[3 * f + j] < lowest) lowest = polygons.corners[3 * f + j];
    struct gd_vec3 down = gd_vec3_sub(gd_mesh_position(mesh, (struct gd_vertex){lowest}), tip);
    down = gd_vec3_scale(down, 1 / gd_vec3_length(down));
    double start = atan2(down.y, down.x), flat = hypot(down.x, down.y);
    for (int k = 0; k < SECTORS; k++) {
        double turn = 2 * M_PI * k / SECTORS, next = turn + M_PI / SECTORS;
        expect_both(mesh, apex, turn, flat * cos(start + turn), flat * sin(start + turn), down.z);
        struct gd_vec3 middle = {flat * cos(M_PI / SECTORS) * cos(start + next),
                                 flat * cos(M_PI / SECTORS) * sin(start + next), down.z};
        middle = gd_vec3_scale(middle, 1 / gd_vec3_length(middle));
        expect_both(mesh, apex, next, middle.x, middle.y, middle.z);
        struct gd_direction ridge = at(mesh, apex, turn),
                            ahead = gd_direction_opposite(mesh, &apex, &ridge);
        /* the middle of a sector is opposite an edge of the pyramid, because the number of sectors
         * is odd */
        double reach = -hypot(middle.x, middle.y);
        expect_vector(ahead.xyz, reach * cos(start + turn), reach * sin(start + turn), middle.z);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- at the boundary -------------------------------------------------------------------------- */

/* A planar mesh covers three quarters of a turn around boundary vertex 0. The opposite of a
 * direction is always half a turn away. */
static void straight_on_at_a_boundary_vertex(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    uint32_t corners[] = {0, 1, 2, 0, 2, 3, 0, 3, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = build(&polygons);
    struct gd_point corner = test_vertex(mesh, 0);
    expect_both(mesh, corner, 0, 1, 0, 0);
    expect_both(mesh, corner, 1.5 * M_PI, 0, -1, 0);
    expect_both(mesh, corner, 1.25 * M_PI, -sqrt(0.5), -sqrt(0.5), 0);
    const double back[] = {0, M_PI_4, M_PI_2, 3 * M_PI_4, M_PI, 1.5 * M_PI},
                 ahead[] = {M_PI, 1.25 * M_PI, 1.5 * M_PI, 1.75 * M_PI, 0, M_PI_2};
    for (uint32_t i = 0; i < COUNT(back); i++) {
        struct gd_direction here = at(mesh, corner, back[i]),
                            there = gd_direction_opposite(mesh, &corner, &here);
        expect_near(there.angle, ahead[i], exact);
        expect_vector(there.xyz, -here.xyz.x, -here.xyz.y, 0);
    }
    struct gd_point rim = on_edge(mesh, 1, 2);
    struct gd_direction inward = at(mesh, rim, M_PI_2),
                        outward = gd_direction_opposite(mesh, &rim, &inward);
    expect_near(outward.angle, 1.5 * M_PI, exact);
    expect_vector(outward.xyz, sqrt(0.5), sqrt(0.5), 0);
    assert_int_equal(outward.face.index, 0);
    gd_mesh_release(mesh);
}

/* --- any surface ------------------------------------------------------------------------------ */

/* Checks that an angle's vector gives the angle again, and that vectors are unit vectors in their
 * face's plane. Returns the largest error. */
static double check_round_trips(const struct gd_mesh *mesh, struct gd_point point, struct rng *rng)
{
    double worst = 0;
    for (int k = 0; k < 8; k++) {
        double angle = rng_between(rng, 0, 2 * M_PI);
        struct gd_direction direction, again;
        if (gd_direction_at_angle(mesh, &point, angle, &direction, NULL)) continue;
        again = along(mesh, point, direction.xyz);
        worst = fmax(worst, fabs(remainder(again.angle - direction.angle, 2 * M_PI)));
        struct gd_vec3 x, y;
        gd_direction_axes(mesh, direction.face, &x, &y);
        expect_near(gd_vec3_dot(gd_vec3_cross(x, y), direction.xyz), 0, 1e-12);
        expect_near(gd_vec3_length(direction.xyz), 1, exact);
    }
    return worst;
}

static void angles_and_vectors_convert_into_each_other(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"terrain", {10, 1, 3}}, {"saddle", {1, 2, 8, 4}},     {"genus2", {3, 0.03}},
                    {"box", {1, 1, 1, 2}},   {"cylinder", {0.1, 3, 9, 5}}, {"icosphere", {2, 1}}};
    for (size_t s = 0; s < COUNT(surfaces); s++) {
        struct gd_polygons polygons;
        assert_int_equal(sample_find(surfaces[s].name)->generate(surfaces[s].values, &polygons),
                         GD_OK);
        struct gd_mesh *mesh = build(&polygons);
        struct rng rng = {s};
        double worst = 0;
        for (uint32_t f = 0; f < polygons.polygon_count; f++) {
            const uint32_t *c = &polygons.corners[3 * f];
            worst = fmax(worst, check_round_trips(mesh, in_face(mesh, f), &rng));
            worst = fmax(worst, check_round_trips(mesh, on_edge(mesh, c[0], c[1]), &rng));
            worst = fmax(worst, check_round_trips(mesh, test_vertex(mesh, c[2]), &rng));
        }
        print_message("# %s: angles off by %.1e at most\n", surfaces[s].name, worst);
        assert_true(worst < 1e-12);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_the_plane),
        cmocka_unit_test(directions_off_the_surface),
        cmocka_unit_test(invalid_directions_are_refused),
        cmocka_unit_test(whole_turns_change_nothing),
        cmocka_unit_test(at_the_corner_of_a_cube),
        cmocka_unit_test(on_the_edge_of_a_cube),
        cmocka_unit_test(on_a_cone),
        cmocka_unit_test(straight_on_at_a_boundary_vertex),
        cmocka_unit_test(angles_and_vectors_convert_into_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
