/* On any surface and at any level, the isoline separates nearer points from farther points. */
#include "isolines.h"

#include "tests/samples/zoo.h"

/* An arc and its end point in the coordinates of its face. */
struct flat_arc {
    const struct gd_isoline_arc *arc;
    double end[2];
};

static double turn(const double o[2], const double p[2], const double q[2])
{
    return (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
}

/* Counts how often the segment a-b crosses an arc of its face. */
static uint32_t times_crossed(const struct flat_arc *flat, const double a[2], const double b[2])
{
    const struct gd_isoline_arc *arc = flat->arc;
    const double start[2] = {arc->u, arc->v};
    if (arc->radius == 0)
        return (turn(a, b, start) > 0) != (turn(a, b, flat->end) > 0) &&
               (turn(start, flat->end, a) > 0) != (turn(start, flat->end, b) > 0);
    double ax = a[0] - arc->u, ay = a[1] - arc->v, dx = b[0] - a[0], dy = b[1] - a[1];
    double qa = dx * dx + dy * dy, qb = ax * dx + ay * dy,
           qc = ax * ax + ay * ay - arc->radius * arc->radius;
    double discriminant = qb * qb - qa * qc;
    uint32_t times = 0;
    if (discriminant <= 0) return 0;
    for (int sign = -1; sign <= 1; sign += 2) {
        double s = (-qb + sign * sqrt(discriminant)) / qa;
        if (s <= 0 || s >= 1) continue;
        double angle = atan2(ay + s * dy, ax + s * dx), middle = 0.5 * (arc->from + arc->to);
        times += fabs(remainder(angle - middle, 2 * M_PI)) < 0.5 * (arc->to - arc->from);
    }
    return times;
}

/* Returns a point's coordinates in the arcs' frame of the face. */
static void lay_flat(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *point,
                     double at[2])
{
    struct gd_vec3 x, y, p = gd_point_position(mesh, point);
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){face}, corners);
    gd_isoline_arc_axes(mesh, &(struct gd_isoline_arc){.face = {face}}, &x, &y);
    struct gd_vec3 from = gd_vec3_sub(p, gd_mesh_position(mesh, corners[0]));
    at[0] = gd_vec3_dot(from, x);
    at[1] = gd_vec3_dot(from, y);
}

/* Returns a random point of a face. Sets `at` to the point's coordinates in the arcs' frame. */
static struct gd_point random_in_face(const struct gd_mesh *mesh, uint32_t face, struct rng *rng,
                                      double at[2])
{
    double weight[3] = {rng_between(rng, 0.01, 1), rng_between(rng, 0.01, 1),
                        rng_between(rng, 0.01, 1)};
    double sum = weight[0] + weight[1] + weight[2];
    for (int k = 0; k < 3; k++) weight[k] /= sum;
    struct gd_point point =
        test_point(mesh, (struct test_place){face, {weight[0], weight[1], weight[2]}});
    lay_flat(mesh, face, &point, at);
    return point;
}

/* The arcs of all lines, grouped by face. */
struct by_face {
    uint32_t *first;
    struct flat_arc *arc;
};

static struct by_face sort_arcs(const struct gd_mesh *mesh, const struct gd_isoline *isoline,
                                uint32_t faces)
{
    uint32_t total = 0;
    struct by_face sorted = {.first = calloc((size_t)faces + 2, sizeof *sorted.first)};
    for (uint32_t i = 0; i < isoline->line_count; i++)
        for (uint32_t k = 0; k < isoline->lines[i].arc_count; k++, total++)
            sorted.first[isoline->lines[i].arcs[k].face.index + 2]++;
    sorted.arc = malloc(sizeof *sorted.arc * (total + 1));
    for (uint32_t f = 0; f <= faces; f++) sorted.first[f + 1] += sorted.first[f];
    for (uint32_t i = 0; i < isoline->line_count; i++)
        for (uint32_t k = 0; k < isoline->lines[i].arc_count; k++) {
            const struct gd_isoline_line *line = &isoline->lines[i];
            uint32_t face = line->arcs[k].face.index;
            struct flat_arc *flat = &sorted.arc[sorted.first[face + 1]++];
            flat->arc = &line->arcs[k];
            lay_flat(mesh, face, &line->points[k + 1 < line->point_count ? k + 1 : 0], flat->end);
        }
    return sorted;
}

/* Counts how often the segment between two points of a face crosses the isoline. The number must be
 * odd if exactly one of the points is below the level, and even otherwise. */
static void check_sides(const struct gd_field *field, const struct gd_isoline *isoline,
                        struct rng *rng)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    uint32_t faces = gd_mesh_summary(mesh)->face_index_count;
    struct by_face sorted = sort_arcs(mesh, isoline, faces);
    for (uint32_t f = 0; f < faces; f++) {
        for (int k = 0; k < 12; k++) {
            double a[2], b[2], da, db;
            struct gd_point p = random_in_face(mesh, f, rng, a),
                            q = random_in_face(mesh, f, rng, b);
            uint32_t times = 0;
            check_ok(gd_field_distance(field, &p, &da), NULL);
            check_ok(gd_field_distance(field, &q, &db), NULL);
            for (uint32_t i = sorted.first[f]; i < sorted.first[f + 1]; i++)
                times += times_crossed(&sorted.arc[i], a, b);
            if (times % 2 != ((da < isoline->level) != (db < isoline->level))) {
                print_error("level %.17g, face %u: from %.17g to %.17g crosses %u of %u arcs\n",
                            isoline->level, f, da, db, times,
                            sorted.first[f + 1] - sorted.first[f]);
                fail();
            }
        }
    }
    free(sorted.first);
    free(sorted.arc);
}

/* Checks that open lines end on the boundary. */
static void check_ends(const struct gd_mesh *mesh, const struct gd_isoline *isoline)
{
    for (uint32_t i = 0; i < isoline->line_count; i++) {
        const struct gd_isoline_line *line = &isoline->lines[i];
        if (line->closed) continue;
        assert_true(gd_mesh_summary(mesh)->boundaries > 0);
        assert_true(line->points[0].kind != GD_POINT_FACE &&
                    line->points[line->point_count - 1].kind != GD_POINT_FACE);
    }
}

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {{"icosphere", {3, 1}},    {"torus", {24, 12, 1, 0.4}},   {"terrain", {16, 0.3, 7}},
                {"terrain", {8, 3, 8}},   {"genus2", {3, 0.03}},         {"saddle", {1, 0.6, 5, 6}},
                {"obstacles", {5, 1, 3}}, {"cylinder", {0.1, 3, 16, 5}}, {"tetrahedron", {1, 3}},
                {"tangle", {200, 11}},    {"tangle", {200, 12}},         {"box", {1, 1, 0.001, 6}}};

static struct gd_field *field_of_points(const struct gd_mesh *mesh,
                                        const struct gd_polygons *polygons, uint32_t count,
                                        struct rng *rng)
{
    struct gd_seed seeds[3] = {0};
    for (int i = 0; i < 3; i++) seeds[i].point = test_point(mesh, test_random_place(polygons, rng));
    return test_field(mesh, seeds, count, 0);
}

/* Returns a random point in the face, on one of its edges or at a corner. */
static struct gd_point random_end(const struct gd_mesh *mesh, uint32_t face, struct rng *rng)
{
    struct test_place place = {.face = face};
    uint32_t zeros = rng_below(rng, 3), first = rng_below(rng, 3);
    double sum = 0;
    for (uint32_t k = zeros; k < 3; k++)
        sum += place.weight[(first + k) % 3] = 0.01 + rng_unit(rng);
    for (int k = 0; k < 3; k++) place.weight[k] /= sum;
    return test_point(mesh, place);
}

/* Returns the field of random segments across faces or along edges, and of their ends. */
static struct gd_field *field_of_segments(const struct gd_mesh *mesh,
                                          const struct gd_polygons *polygons, uint32_t count,
                                          struct rng *rng)
{
    struct gd_seed seeds[9];
    uint32_t filled = 0;
    while (filled < 3 * count) {
        uint32_t face = rng_below(rng, polygons->polygon_count);
        struct gd_point a = random_end(mesh, face, rng), b = random_end(mesh, face, rng);
        if (gd_point_equal(&a, &b)) continue;
        seeds[filled++] = (struct gd_seed){.point = a};
        seeds[filled++] = (struct gd_seed){.point = a, .end = b, .is_segment = true};
        seeds[filled++] = (struct gd_seed){.point = b};
    }
    return test_field(mesh, seeds, filled, 0);
}

/* Returns a corner, the middle of an edge, or a point of the face with weights 1/4, 1/4, 1/2. */
static struct gd_point lattice_end(const struct gd_mesh *mesh, uint32_t face, struct rng *rng)
{
    struct test_place place = {.face = face};
    uint32_t kind = rng_below(rng, 3), first = rng_below(rng, 3);
    for (uint32_t k = 0; k < 3; k++) place.weight[k] = kind == 2 ? 0.25 : 0;
    place.weight[first] += kind == 2 ? 0.25 : kind == 1 ? 0.5 : 1;
    if (kind == 1) place.weight[(first + 1) % 3] = 0.5;
    return test_point(mesh, place);
}

/* Returns the field of segments between lattice points. Half of them have the offset 0.5. */
static struct gd_field *field_on_lattice(const struct gd_mesh *mesh,
                                         const struct gd_polygons *polygons, uint32_t count,
                                         struct rng *rng)
{
    struct gd_seed seeds[18];
    uint32_t filled = 0;
    while (filled < 3 * count) {
        uint32_t face = rng_below(rng, polygons->polygon_count);
        double offset = 0.5 * rng_below(rng, 2);
        struct gd_point a = lattice_end(mesh, face, rng), b = lattice_end(mesh, face, rng);
        if (gd_point_equal(&a, &b)) continue;
        seeds[filled++] = (struct gd_seed){.point = a, .offset = offset};
        seeds[filled++] = (struct gd_seed){.point = b, .offset = offset};
        seeds[filled++] =
            (struct gd_seed){.point = a, .end = b, .is_segment = true, .offset = offset};
    }
    return test_field(mesh, seeds, filled, 0);
}

typedef struct gd_field *field_maker(const struct gd_mesh *, const struct gd_polygons *, uint32_t,
                                     struct rng *);

/* Checks fields of one and of three seeds. Levels are random, or exactly the distance of a
 * vertex. */
static void check_surface(const char *name, const struct gd_polygons *polygons, field_maker *make,
                          uint64_t seed, int rounds)
{
    struct gd_mesh *mesh = test_mesh(polygons);
    struct rng rng = {seed};
    uint32_t lines = 0, arcs = 0;
    double worst = 0, *distance = malloc(sizeof *distance * polygons->position_count);
    for (int round = 0; round < rounds; round++) {
        struct gd_field *field = make(mesh, polygons, round % 2 ? 3 : 1, &rng);
        struct gd_point farthest;
        double most;
        check_ok(gd_field_farthest(field, NULL, &farthest, &most), NULL);
        gd_field_vertex_distances(field, distance);
        for (int k = 0; k < 8; k++) {
            double level = k % 2 ? rng_between(&rng, 0.01, 1.05) * most
                                 : distance[rng_below(&rng, polygons->position_count)];
            if (!(level > 1e-3 * most && isfinite(level))) continue;
            struct gd_isoline isoline;
            check_ok(gd_isoline_trace(field, level, NULL, &isoline), NULL);
            worst = fmax(worst, check_isoline(field, &isoline));
            check_sides(field, &isoline, &rng);
            check_ends(mesh, &isoline);
            assert_true(level <= most || !isoline.line_count);
            lines += isoline.line_count;
            for (uint32_t i = 0; i < isoline.line_count; i++) arcs += isoline.lines[i].arc_count;
            gd_isoline_free(&isoline);
        }
        gd_field_release(field);
    }
    print_message("# %s: %u lines of %u arcs, distances off by %.1e at most\n", name, lines, arcs,
                  worst);
    free(distance);
    gd_mesh_release(mesh);
}

static void check_surfaces(field_maker *make)
{
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        struct gd_polygons polygons;
        check_ok(sample_find(surfaces[s].name)->generate(surfaces[s].values, &polygons), NULL);
        check_surface(surfaces[s].name, &polygons, make, s, TEST_IS_SANITIZED ? 1 : 4);
        gd_polygons_free(&polygons);
    }
}

static void check_degenerate_shapes(field_maker *make)
{
    static const struct {
        const char *name;
        zoo_maker *make;
        double values[4];
    } shapes[] = {{"cap", zoo_cap, {1e-6}},
                  {"needles", zoo_needles, {8, 5, 1e-5, 0.1}},
                  {"wheel", zoo_wheel, {64, 0.999}},
                  {"accordion", zoo_accordion, {8, 6, 1, 3}},
                  {"pillow", zoo_pillow, {1, 1, 5}},
                  {"tube", zoo_tube, {1e-3, 1, 12, 5}},
                  {"box", zoo_box, {1, 1, 1}},
                  {"plate", zoo_box, {1, 1, 1e-3}},
                  {"octahedron", zoo_octahedron, {1, 2, 1e-2}},
                  {"crumpled", zoo_crumpled, {2, 100, 10, 10}},
                  {"assembly", zoo_assembly, {3, 1e-6}},
                  {"spike", zoo_spike, {10, 1000}}};
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct zoo_shape shape;
        check_ok(shapes[s].make(shapes[s].values, &shape), NULL);
        check_surface(shapes[s].name, &shape.mesh, make, 100 + s, TEST_IS_SANITIZED ? 1 : 4);
        zoo_shape_free(&shape);
    }
}

/* On the ridge between two parallel segments the distance equals the level, inside faces (x = 2.75)
 * and along edges. */
static void along_a_ridge(void **state)
{
    (void)state;
    static const double at[2][2][4] = {{{2, 1, 2, 0.5}, {3, 1, 3, 0}},
                                       {{1, 2, 1, 1}, {3, 1.5, 3, 1}}};
    static const double offsets[2] = {0.5, 0}, levels[2] = {0.75, 1};
    struct rng rng = {41};
    struct gd_polygons polygons;
    check_ok(sample_grid(6, 3, 6, 3, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int i = 0; i < 2; i++) {
        struct gd_seed seeds[6];
        for (int k = 0; k < 2; k++) {
            const double *p = at[i][k];
            struct gd_point a = test_point_near(mesh, p[0], p[1], 0),
                            b = test_point_near(mesh, p[2], p[3], 0);
            double offset = k ? offsets[i] : 0;
            seeds[3 * k] = (struct gd_seed){.point = a, .offset = offset};
            seeds[3 * k + 1] = (struct gd_seed){.point = b, .offset = offset};
            seeds[3 * k + 2] =
                (struct gd_seed){.point = a, .end = b, .is_segment = true, .offset = offset};
        }
        struct gd_field *field = test_field(mesh, seeds, 6, 0);
        struct gd_isoline isoline = trace(field, levels[i]);
        check_sides(field, &isoline, &rng);
        check_ends(mesh, &isoline);
        gd_isoline_free(&isoline);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Two circles touch inside a face, and a third circle passes through the same point. */
static void circles_that_touch(void **state)
{
    (void)state;
    struct rng rng = {5};
    struct gd_polygons polygons;
    check_ok(sample_grid(4, 4, 4, 4, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seeds[3] = {{.point = test_point_near(mesh, 1, 0.5, 0), .offset = 0.5},
                               {.point = test_point_near(mesh, 2, 3, 0)},
                               {.point = test_point_near(mesh, 3, 2, 0), .offset = 0.5}};
    for (int order = 0; order < 6; order++) {
        struct gd_seed swapped = seeds[order % 2];
        seeds[order % 2] = seeds[order % 2 + 1];
        seeds[order % 2 + 1] = swapped;
        struct gd_field *field = test_field(mesh, seeds, 3, 0);
        struct gd_isoline isoline = trace(field, 1.75); /* all three pass through (2, 1.25) */
        check_sides(field, &isoline, &rng);
        check_ends(mesh, &isoline);
        gd_isoline_free(&isoline);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Tests lines along edges, through vertices, along ridges, and combinations of these. */
static void levels_that_tie(void **state)
{
    (void)state;
    struct rng rng = {31};
    uint32_t lines = 0;
    for (int round = 0; round < 500; round += TEST_STRIDE) {
        uint32_t columns = 2 + rng_below(&rng, 6), rows = 2 + rng_below(&rng, 6);
        struct gd_polygons polygons;
        check_ok(sample_grid(columns, rows, columns, rows, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_field *field = field_on_lattice(mesh, &polygons, 1 + rng_below(&rng, 6), &rng);
        for (int k = 1; k <= 12; k++) {
            struct gd_isoline isoline = trace(field, 0.25 * k);
            check_sides(field, &isoline, &rng);
            check_ends(mesh, &isoline);
            lines += isoline.line_count;
            gd_isoline_free(&isoline);
        }
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    print_message("# lattices: %u lines\n", lines);
}

static void lines_of_points_on_any_surface(void **state)
{
    (void)state;
    check_surfaces(field_of_points);
}

static void lines_of_segments_on_any_surface(void **state)
{
    (void)state;
    check_surfaces(field_of_segments);
}

static void lines_of_points_on_degenerate_shapes(void **state)
{
    (void)state;
    check_degenerate_shapes(field_of_points);
}

static void lines_of_segments_on_degenerate_shapes(void **state)
{
    (void)state;
    check_degenerate_shapes(field_of_segments);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(along_a_ridge),
        cmocka_unit_test(circles_that_touch),
        cmocka_unit_test(levels_that_tie),
        cmocka_unit_test(lines_of_points_on_any_surface),
        cmocka_unit_test(lines_of_segments_on_any_surface),
        cmocka_unit_test(lines_of_points_on_degenerate_shapes),
        cmocka_unit_test(lines_of_segments_on_degenerate_shapes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
