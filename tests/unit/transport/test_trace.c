#include "lines.h"

/* --- developable surfaces: closed forms ------------------------------------------------------- */

static void straight_in_the_plane(void **state)
{
    (void)state;
    static const double scales[] = {1e-6, 1, 1e6}, offsets[] = {0, 1e3};
    struct rng rng = {11};
    for (uint32_t s = 0; s < COUNT(scales); s++)
        for (uint32_t o = 0; o < COUNT(offsets); o++) {
            struct gd_polygons grid;
            double scale = scales[s], far = offsets[o] * scale;
            check_ok(sample_grid(23, 17, 2, 2, &grid), NULL);
            for (uint32_t i = 0; i < grid.position_count; i++)
                for (int k = 0; k < 3; k++)
                    grid.positions[i][k] = grid.positions[i][k] * scale + far;
            struct gd_mesh *mesh = test_mesh(&grid);
            for (int i = 0; i < 100; i++) {
                double angle = rng_between(&rng, 0, 2 * M_PI),
                       length = rng_between(&rng, 0.01, 0.9) * scale;
                struct gd_point start = nearest(mesh, scale + far, scale + far, far);
                struct gd_vec3 from = gd_point_position(mesh, &start);
                struct gd_trace trace = follow(
                    mesh, start, along(mesh, start, cos(angle), sin(angle), 0), length, NULL);
                struct gd_point end = end_of(&trace);
                assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
                check_close(trace.path.length, length, 1e-15);
                expect_place(gd_point_position(mesh, &end), from.x + length * cos(angle),
                             from.y + length * sin(angle), from.z,
                             exact * length + 1e-15 * fabs(far));
                expect_place(trace.direction.xyz, cos(angle), sin(angle), 0, exact);
                gd_trace_free(&trace);
            }
            gd_mesh_release(mesh);
            gd_polygons_free(&grid);
        }
}

/* Returns the point of a prism around the z axis at height z. `u` is the arc length along the
 * perimeter from the corner on the positive x axis. */
static struct gd_vec3 on_prism(uint32_t sides, double u, double z)
{
    double side = 2 * sin(M_PI / sides), k = floor(u / side), part = u / side - k;
    double a = 2 * M_PI * k / sides, b = 2 * M_PI * (k + 1) / sides;
    return (struct gd_vec3){(1 - part) * cos(a) + part * cos(b),
                            (1 - part) * sin(a) + part * sin(b), z};
}

static void helix_on_a_prism(void **state)
{
    (void)state;
    enum { SIDES = 11 };
    struct gd_polygons polygons;
    struct rng rng = {2};
    double side = 2 * sin(M_PI / SIDES);
    check_ok(sample_cylinder(1, 40, SIDES, 60, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int i = 0; i < 60; i++) {
        double u = side * (i % SIDES + 0.5), z = 20, slope = rng_between(&rng, -0.4, 0.4),
               length = rng_between(&rng, 1, 40);
        struct gd_vec3 from = on_prism(SIDES, u, z),
                       ahead = gd_vec3_sub(on_prism(SIDES, u + side / 8, z), from);
        struct gd_point start = nearest(mesh, from.x, from.y, from.z);
        ahead = gd_vec3_scale(ahead, cos(slope) / gd_vec3_length(ahead));
        struct gd_trace trace =
            follow(mesh, start, along(mesh, start, ahead.x, ahead.y, sin(slope)), length, NULL);
        struct gd_point end = end_of(&trace);
        struct gd_vec3 to = on_prism(SIDES, u + length * cos(slope), z + length * sin(slope));
        expect_place(gd_point_position(mesh, &end), to.x, to.y, to.z, exact * length);
        gd_trace_free(&trace);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* The four walls of a box unroll into a strip. Any number of cells gives the same line. */
static void around_a_box(void **state)
{
    (void)state;
    for (uint32_t cells = 1; cells < 6; cells++) {
        struct surface box = surface_of("box", (double[SAMPLE_PARAMETERS]){2, 2, 50, cells});
        struct gd_point start = nearest(box.mesh, 2, 0.3, 1);
        double slope = 0.3, length = 41.7, u = 0.3 + length * cos(slope),
               z = 1 + length * sin(slope);
        struct gd_trace trace = follow(
            box.mesh, start, along(box.mesh, start, 0, cos(slope), sin(slope)), length, NULL);
        struct gd_point end = end_of(&trace);
        double v = fmod(u, 8), part = fmod(v, 2);
        const struct gd_vec3 walls[] = {
            {2, part, z}, {2 - part, 2, z}, {0, 2 - part, z}, {part, 0, z}};
        struct gd_vec3 to = walls[(int)(v / 2)];
        expect_place(gd_point_position(box.mesh, &end), to.x, to.y, to.z, exact * length);
        gd_trace_free(&trace);
        surface_free(&box);
    }
}

enum { SECTORS = 7 };

/* Returns the angle at the cone's apex between neighbouring ridges. */
static double sector_angle(double height)
{
    double ridge = hypot(1, height);
    return 2 * asin(sin(M_PI / SECTORS) / ridge);
}

/* Computes the polar coordinates on the unrolled cone: distance from the apex, and angle from the
 * ridge in the xz plane. */
static void develop(double height, struct gd_vec3 at, double *r, double *turned)
{
    double step = 2 * M_PI / SECTORS, around = atan2(at.y, at.x);
    if (around < 0) around += 2 * M_PI;
    double k = fmin(floor(around / step), SECTORS - 1), ridge = hypot(1, height);
    struct gd_vec3 apex = {0, 0, height}, v = gd_vec3_sub(at, apex),
                   a = {cos(k * step), sin(k * step), -height},
                   b = {cos((k + 1) * step), sin((k + 1) * step), -height};
    struct gd_vec3 across = gd_vec3_along(b, -gd_vec3_dot(a, b) / (ridge * ridge), a);
    *r = gd_vec3_length(v);
    *turned = k * sector_angle(height) +
              atan2(gd_vec3_dot(v, across) / gd_vec3_length(across), gd_vec3_dot(v, a) / ridge);
}

/* On a cone a line is straight in the unrolled surface. */
static void straight_on_a_cone(void **state)
{
    (void)state;
    const double height = 3;
    struct gd_polygons polygons;
    struct rng rng = {3};
    check_ok(sample_cone(1, height, SECTORS, 9, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    double total = SECTORS * sector_angle(height);
    for (int i = 0; i < 60; i++) {
        double r, turned, q, back;
        struct gd_point start = nearest(mesh, 0.4 * cos(i), 0.4 * sin(i), 1.8);
        develop(height, gd_point_position(mesh, &start), &r, &turned);
        struct gd_vec3 down =
            gd_vec3_sub(gd_point_position(mesh, &start), (struct gd_vec3){0, 0, height});
        struct gd_direction outward = along(mesh, start, down.x, down.y, down.z), ahead;
        double bend = rng_between(&rng, 1.7, 2.9), length = rng_between(&rng, 0.1, 2);
        check_ok(gd_direction_at_angle(mesh, &start, outward.angle + bend, &ahead, NULL), NULL);
        struct gd_trace trace = follow(mesh, start, ahead, length, NULL);
        struct gd_point end = end_of(&trace);
        develop(height, gd_point_position(mesh, &end), &q, &back);
        double x = r + length * cos(bend), y = length * sin(bend);
        expect_near(q, hypot(x, y), exact * 3);
        expect_near(remainder(back - turned - atan2(y, x), total), 0, exact * 10);
        gd_trace_free(&trace);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- smooth surfaces: errors decrease with the mesh ------------------------------------------ */

static double off_great_circle(uint32_t level, enum gd_vertex_rule rule)
{
    struct gd_polygons polygons;
    double worst = 0;
    check_ok(sample_icosphere(level, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int i = 0; i < 20; i++) {
        struct gd_point start = nearest(mesh, sin(i), cos(2 * i), sin(3 * i + 1));
        struct rng rng = {(uint64_t)i};
        struct gd_direction ahead = random_direction(mesh, start, &rng);
        struct gd_vec3 pole = gd_vec3_cross(gd_point_position(mesh, &start), ahead.xyz);
        const struct gd_trace_options options = {.vertex_rule = rule};
        struct gd_trace trace = follow(mesh, start, ahead, M_PI, &options);
        for (uint32_t k = 0; k < trace.path.count; k++)
            worst = fmax(worst,
                         fabs(gd_vec3_dot(gd_point_position(mesh, &trace.path.points[k]), pole)));
        gd_trace_free(&trace);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    return worst;
}

static void great_circles(void **state)
{
    (void)state;
    for (int rule = GD_VERTEX_RULE_BISECT; rule <= GD_VERTEX_RULE_NORMAL; rule++) {
        double coarse = off_great_circle(2, (enum gd_vertex_rule)rule),
               middle = off_great_circle(4, (enum gd_vertex_rule)rule),
               fine = off_great_circle(6, (enum gd_vertex_rule)rule);
        print_message("off the great circle: %g %g %g\n", coarse, middle, fine);
        assert_true(middle < 0.5 * coarse && fine < 0.5 * middle && fine < 0.01);
    }
}

/* Returns the largest change of Clairaut's constant: the distance from the axis times the sine of
 * the angle with the meridian. */
static double off_clairaut(uint32_t columns)
{
    struct gd_polygons polygons;
    double worst = 0;
    check_ok(sample_torus(columns, columns / 2, 2, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int i = 0; i < 10; i++) {
        struct gd_point start = nearest(mesh, 3 * cos(i), 3 * sin(i), 0.1 * i);
        struct rng rng = {(uint64_t)i + 5};
        struct gd_trace trace = follow(mesh, start, random_direction(mesh, start, &rng), 10, NULL);
        double first = NAN;
        for (uint32_t k = 0; k + 1 < trace.path.count; k++) {
            struct gd_vec3 p = gd_point_position(mesh, &trace.path.points[k]),
                           q = gd_point_position(mesh, &trace.path.points[k + 1]),
                           d = gd_vec3_sub(q, p);
            if (gd_vec3_length(d) < 1e-3) continue;
            double constant = (p.x * d.y - p.y * d.x) / gd_vec3_length(d);
            if (isnan(first)) first = constant;
            worst = fmax(worst, fabs(constant - first));
        }
        gd_trace_free(&trace);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    return worst;
}

static void clairaut_on_a_torus(void **state)
{
    (void)state;
    double coarse = off_clairaut(40), middle = off_clairaut(160), fine = off_clairaut(640);
    print_message("off Clairaut's constant: %g %g %g\n", coarse, middle, fine);
    assert_true(middle < 0.5 * coarse && fine < 0.5 * middle && fine < 0.03);
}

/* --- any surface ------------------------------------------------------------------------------ */

/* Checks that a line traced back from its end returns to its start, and that the length of the line
 * is the sum of the lengths of its segments. */
static void check_return(const struct gd_mesh *mesh, struct gd_point start,
                         struct gd_direction ahead, double length)
{
    struct gd_trace there = follow(mesh, start, ahead, length, NULL);
    struct gd_point end = end_of(&there);
    double sum = 0, edge = gd_mesh_summary(mesh)->edge_length.max;
    for (uint32_t i = 0; i + 1 < there.path.count; i++)
        sum += gd_vec3_distance(gd_point_position(mesh, &there.path.points[i]),
                                gd_point_position(mesh, &there.path.points[i + 1]));
    expect_near(there.path.length, sum, exact * (length + edge));
    if (there.path.length > 0) {
        struct gd_direction back = gd_direction_opposite(mesh, &end, &there.direction);
        struct gd_trace again = follow(mesh, end, back, there.path.length, NULL);
        struct gd_point home = end_of(&again);
        struct gd_vec3 from = gd_point_position(mesh, &start);
        expect_place(gd_point_position(mesh, &home), from.x, from.y, from.z,
                     promise * there.path.length);
        gd_trace_free(&again);
    }
    gd_trace_free(&there);
}

static void check_returns(const struct surface *surface, int count)
{
    struct rng rng = {17};
    double edge = gd_mesh_summary(surface->mesh)->edge_length.mean;
    uint32_t faces = gd_mesh_summary(surface->mesh)->face_index_count;
    for (int i = 0; i < count; i++) {
        struct gd_face face;
        do face.index = (uint32_t)(rng_next(&rng) % faces);
        while (!gd_mesh_has_face(surface->mesh, face));
        double a = rng_between(&rng, 0.1, 0.4),
               b = i % 3 == 0 ? 1 - a : rng_between(&rng, 0.1, 0.4);
        struct gd_point start;
        check_ok(gd_point_in_face(surface->mesh, face, (double[3]){a, b, 1 - a - b}, &start, NULL),
                 NULL);
        check_return(surface->mesh, start, random_direction(surface->mesh, start, &rng),
                     edge * rng_between(&rng, 0.1, 60));
    }
}

static void there_and_back(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } samples_tried[] = {{"terrain", {20, 0.8, 3}},
                         {"torus", {30, 15, 2, 0.7}},
                         {"genus2", {6, 0.1}},
                         {"box", {1, 2, 3, 3}}};
    for (uint32_t s = 0; s < COUNT(samples_tried); s++) {
        struct surface surface = surface_of(samples_tried[s].name, samples_tried[s].values);
        check_returns(&surface, 300);
        surface_free(&surface);
    }
    static const char *const names[] = {"spot", "cow", "suzanne", "fandisk"};
    for (uint32_t i = 0; i < COUNT(names); i++) {
        struct surface surface;
        if (!surface_read(names[i], &surface)) continue;
        check_returns(&surface, 300);
        surface_free(&surface);
    }
}

/* Checks that the length is the sum of the distances between consecutive points. Checks that it is
 * the requested length unless the line ended early. */
static void check_path(const struct gd_mesh *mesh, const struct gd_trace *trace, double length)
{
    double sum = 0, edge = gd_mesh_summary(mesh)->edge_length.max;
    for (uint32_t i = 0; i + 1 < trace->path.count; i++)
        sum += gd_vec3_distance(gd_point_position(mesh, &trace->path.points[i]),
                                gd_point_position(mesh, &trace->path.points[i + 1]));
    expect_near(trace->path.length, sum,
                exact * (length + edge) + 1e-15 * trace->path.count * edge);
    if (trace->end == GD_TRACE_END_LENGTH) check_close(trace->path.length, length, exact);
    assert_true(trace->path.length <= length * (1 + exact));
    expect_near(gd_vec3_length(trace->direction.xyz), 1, 1e-9);
}

/* Uses surfaces with slivers, saddles and boundaries. Lines start at points of all kinds, sometimes
 * along edges. */
static void all_rules_on_any_surface(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 24; seed++) {
        struct surface surface =
            surface_of("tangle", (double[SAMPLE_PARAMETERS]){20 + 10 * seed, seed});
        struct rng rng = {seed};
        double edge = gd_mesh_summary(surface.mesh)->edge_length.mean;
        for (uint32_t i = 0; i < 160; i++) {
            struct gd_point start =
                test_point(surface.mesh, test_random_place(&surface.polygons, &rng));
            struct gd_direction ahead = random_direction(surface.mesh, start, &rng);
            const struct gd_trace_options options = {.vertex_rule = (enum gd_vertex_rule)(i & 1),
                                                     .boundary_rule =
                                                         (enum gd_boundary_rule)(i >> 1 & 1),
                                                     .stop_at_self_intersection = i >> 2 & 1,
                                                     .step_limit = i >> 3 & 1 ? 7 : 0};
            struct gd_direction zero;
            if (i % 5 == 0 && !gd_direction_at_angle(surface.mesh, &start, 0, &zero, NULL))
                ahead = zero;
            double length = edge * rng_between(&rng, 0, i % 3 ? 30 : 1);
            struct gd_trace trace = follow(surface.mesh, start, ahead, length, &options);
            check_path(surface.mesh, &trace, length);
            gd_trace_free(&trace);
        }
        surface_free(&surface);
    }
}

/* --- vertices --------------------------------------------------------------------------------- */

/* A line that is aimed at a vertex, and lines that pass the vertex within rounding on either side,
 * continue in the same direction. This direction has half of the vertex' total angle on each
 * side. */
static void hits_from_both_sides_agree(void **state)
{
    (void)state;
    struct surface box = surface_of("box", (double[SAMPLE_PARAMETERS]){1, 1, 1, 1});
    struct rng rng = {4};
    for (int i = 0; i < 200; i++) {
        double x = rng_between(&rng, 0.2, 0.8), y = rng_between(&rng, 0.2, 0.8),
               length = hypot(1 - x, 1 - y) + 0.15;
        struct gd_point start = nearest(box.mesh, x, y, 1), ends[3];
        struct gd_direction aim = along(box.mesh, start, 1 - x, 1 - y, 0);
        for (int k = 0; k < 3; k++) {
            struct gd_direction ahead;
            check_ok(
                gd_direction_at_angle(box.mesh, &start, aim.angle + (k - 1) * 4e-14, &ahead, NULL),
                NULL);
            struct gd_trace trace = follow(box.mesh, start, ahead, length, NULL);
            ends[k] = end_of(&trace);
            assert_int_equal(trace.path.points[trace.path.count - 2].kind, GD_POINT_VERTEX);
            gd_trace_free(&trace);
        }
        struct gd_vec3 middle = gd_point_position(box.mesh, &ends[1]);
        /* the corner's angle is 3/2 pi; the continued line makes an angle of 3/4 pi with the
           incoming line, and crosses one edge or the other */
        double in = atan2(1 - y, 1 - x), by_x = 3 * M_PI_4 - in, by_y = M_PI_4 + in;
        if (by_y < M_PI_2)
            expect_place(middle, 1, 1 - 0.15 * cos(by_y), 1 - 0.15 * sin(by_y), exact);
        else
            expect_place(middle, 1 - 0.15 * cos(by_x), 1, 1 - 0.15 * sin(by_x), exact);
        for (int k = 0; k < 3; k++)
            expect_place(gd_point_position(box.mesh, &ends[k]), middle.x, middle.y, middle.z,
                         1e-12);
    }
    surface_free(&box);
}

static void bisects_at_an_apex(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_cone(1, 1, 8, 5, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point apex = vertex(mesh, polygons.position_count - 1);
    for (int i = 0; i < 16; i++) {
        double around = M_PI * i / 8 + 0.1;
        struct gd_direction out = along(mesh, apex, cos(around), sin(around), -1);
        struct gd_trace down = follow(mesh, apex, out, 0.5, NULL);
        struct gd_point start = end_of(&down);
        struct gd_direction up = gd_direction_opposite(mesh, &start, &down.direction);
        struct gd_trace over = follow(mesh, start, up, 1, NULL);
        struct gd_point end = end_of(&over);
        struct gd_vec3 from = gd_point_position(mesh, &start);
        expect_place(gd_point_position(mesh, &end), -from.x, -from.y, from.z, 1e-12);
        gd_trace_free(&down);
        gd_trace_free(&over);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* A line in a mirror plane of an icosphere passes through vertices. Both vertex rules keep it in
 * this plane. The rule by normals uses the normals of the request, if the request has any. */
static void normals_keep_a_mirror_plane(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(3, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_vec3 *normals = calloc(polygons.position_count, sizeof *normals);
    for (uint32_t i = 0; i < polygons.position_count; i++)
        normals[i] = gd_mesh_position(mesh, (struct gd_vertex){i});
    const struct gd_trace_options options[] = {
        {.vertex_rule = GD_VERTEX_RULE_BISECT},
        {.vertex_rule = GD_VERTEX_RULE_NORMAL},
        {.vertex_rule = GD_VERTEX_RULE_NORMAL, .normals = normals}};
    struct gd_vec3 a = gd_mesh_position(mesh, (struct gd_vertex){0});
    for (uint32_t i = 1; i < 12; i++) {
        struct gd_vec3 b = gd_mesh_position(mesh, (struct gd_vertex){i}),
                       pole = gd_vec3_cross(a, b);
        /* these vertices are not neighbours in the icosahedron */
        if (gd_vec3_dot(a, b) < 0.1) continue;
        for (uint32_t k = 0; k < COUNT(options); k++) {
            struct gd_point start = vertex(mesh, 0);
            struct gd_vec3 d = gd_vec3_sub(b, a);
            struct gd_trace trace =
                follow(mesh, start, along(mesh, start, d.x, d.y, d.z), 6, &options[k]);
            uint32_t hits = 0;
            for (uint32_t p = 0; p < trace.path.count; p++) {
                expect_near(gd_vec3_dot(gd_point_position(mesh, &trace.path.points[p]), pole), 0,
                            1e-11);
                hits += trace.path.points[p].kind == GD_POINT_VERTEX;
            }
            assert_true(hits > 8);
            gd_trace_free(&trace);
        }
    }
    /* with tilted normals the line leaves the plane */
    for (uint32_t i = 0; i < polygons.position_count; i++) normals[i].z += 0.5;
    struct gd_point start = vertex(mesh, 0);
    struct gd_vec3 d = gd_vec3_sub(gd_mesh_position(mesh, (struct gd_vertex){1}), a);
    struct gd_trace straight =
                        follow(mesh, start, along(mesh, start, d.x, d.y, d.z), 6, &options[1]),
                    turned = follow(mesh, start, along(mesh, start, d.x, d.y, d.z), 6, &options[2]);
    struct gd_point p = end_of(&straight), q = end_of(&turned);
    assert_true(gd_vec3_distance(gd_point_position(mesh, &p), gd_point_position(mesh, &q)) > 1e-3);
    gd_trace_free(&straight);
    gd_trace_free(&turned);
    free(normals);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- self-intersections ----------------------------------------------------------------------- */

/* On a cone with a total angle below pi, a line that runs towards the apex turns around the apex
 * and crosses itself. */
static void crosses_itself_on_a_cone(void **state)
{
    (void)state;
    const double height = 3;
    const struct gd_trace_options options = {.stop_at_self_intersection = true};
    struct gd_polygons polygons;
    check_ok(sample_cone(1, height, SECTORS, 9, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    double total = SECTORS * sector_angle(height), r, turned;
    assert_true(total < M_PI);
    struct gd_point start = nearest(mesh, 0.75, 0.1, 0.6);
    struct gd_vec3 down =
        gd_vec3_sub(gd_point_position(mesh, &start), (struct gd_vec3){0, 0, height});
    develop(height, gd_point_position(mesh, &start), &r, &turned);
    struct gd_direction outward = along(mesh, start, down.x, down.y, down.z), ahead;
    for (int i = 0; i < 10; i++) {
        /* distance of the line from the apex */
        double bend = M_PI - 0.15 - 0.02 * i, foot = r * sin(bend);
        check_ok(gd_direction_at_angle(mesh, &start, outward.angle + bend, &ahead, NULL), NULL);
        struct gd_trace trace = follow(mesh, start, ahead, 5, &options);
        struct gd_point end = end_of(&trace);
        assert_int_equal(trace.end, GD_TRACE_END_SELF_INTERSECTION);
        check_close(gd_vec3_distance(gd_point_position(mesh, &end), (struct gd_vec3){0, 0, height}),
                    foot / cos(total / 2), 1e-11);
        check_close(trace.path.length, -r * cos(bend) + foot * tan(total / 2), 1e-11);
        gd_trace_free(&trace);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* A closed line that starts at a vertex ends in that vertex. */
static void closed_line_ends_in_its_vertex(void **state)
{
    (void)state;
    const struct gd_trace_options options = {.stop_at_self_intersection = true};
    struct gd_polygons polygons;
    check_ok(sample_icosphere(2, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    uint32_t next = 1;
    struct gd_vec3 a = gd_mesh_position(mesh, (struct gd_vertex){0}), b;
    while (gd_vec3_dot(a, b = gd_mesh_position(mesh, (struct gd_vertex){next})) < 0.1) next++;
    struct gd_point start = vertex(mesh, 0);
    struct gd_vec3 d = gd_vec3_sub(b, a);
    struct gd_trace trace = follow(mesh, start, along(mesh, start, d.x, d.y, d.z), 30, &options);
    struct gd_point end = end_of(&trace);
    assert_int_equal(trace.end, GD_TRACE_END_SELF_INTERSECTION);
    assert_true(gd_point_equal(&end, &start));
    check_close(trace.path.length, 2 * M_PI, 0.02);
    gd_trace_free(&trace);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* A closed line ends where it began. A helix never meets itself. */
static void closed_line_ends_where_it_began(void **state)
{
    (void)state;
    const struct gd_trace_options options = {.stop_at_self_intersection = true};
    struct surface box = surface_of("box", (double[SAMPLE_PARAMETERS]){2, 3, 4, 3});
    struct gd_point start = nearest(box.mesh, 0.7, 0.4, 4);
    struct gd_trace trace = follow(box.mesh, start, along(box.mesh, start, 1, 0, 0), 30, &options);
    struct gd_point end = end_of(&trace);
    assert_int_equal(trace.end, GD_TRACE_END_SELF_INTERSECTION);
    check_close(trace.path.length, 12, exact);
    expect_place(gd_point_position(box.mesh, &end), 0.7, 0.4, 4, exact);
    gd_trace_free(&trace);
    surface_free(&box);
    struct gd_polygons polygons;
    check_ok(sample_cylinder(1, 40, 9, 20, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    start = nearest(mesh, 0.9, 0.1, 2);
    trace = follow(mesh, start, along(mesh, start, 0, 1, 0.3), 60, &options);
    assert_int_equal(trace.end, GD_TRACE_END_LENGTH);
    gd_trace_free(&trace);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(straight_in_the_plane),
                                       cmocka_unit_test(helix_on_a_prism),
                                       cmocka_unit_test(around_a_box),
                                       cmocka_unit_test(straight_on_a_cone),
                                       cmocka_unit_test(great_circles),
                                       cmocka_unit_test(clairaut_on_a_torus),
                                       cmocka_unit_test(there_and_back),
                                       cmocka_unit_test(all_rules_on_any_surface),
                                       cmocka_unit_test(hits_from_both_sides_agree),
                                       cmocka_unit_test(bisects_at_an_apex),
                                       cmocka_unit_test(normals_keep_a_mirror_plane),
                                       cmocka_unit_test(crosses_itself_on_a_cone),
                                       cmocka_unit_test(closed_line_ends_in_its_vertex),
                                       cmocka_unit_test(closed_line_ends_where_it_began)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
