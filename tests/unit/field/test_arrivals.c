/* Tests the points that several shortest paths reach (the cut locus). They are known by symmetry,
 * or found by bisection where the gradient jumps. */
#include "field/arrivals.h"

#include <math.h>

#include "gd/query.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

enum { JUMPS = 60, SEGMENTS = 400000 };

struct surface {
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
};

static struct surface surface_of(const char *name, const double *values)
{
    struct surface surface;
    check_ok(sample_find(name)->generate(values, &surface.polygons), NULL);
    surface.mesh = test_mesh(&surface.polygons);
    return surface;
}

static void surface_free(struct surface *surface)
{
    gd_mesh_release(surface->mesh);
    gd_polygons_free(&surface->polygons);
}

static struct gd_field *field_of(const struct gd_mesh *mesh, const struct gd_point *from)
{
    struct gd_seed seed = {.point = *from};
    struct gd_field *field = NULL;
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                            &field, NULL),
             NULL);
    return field;
}

static bool is_cut(const struct gd_field *field, const struct gd_point *point)
{
    bool cut;
    check_ok(gd__field_is_cut(field, point, &cut), NULL);
    return cut;
}

static bool is_cut_by_search(const struct gd_mesh *mesh, const struct gd_point *from,
                             const struct gd_point *to)
{
    struct gd_pair_answer answer = {0};
    check_ok(gd_pair_solve(
                 mesh,
                 &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH_AND_CUT},
                 NULL, &answer, NULL),
             NULL);
    gd_pair_answer_free(&answer);
    return answer.is_cut;
}

/* --- jumps ------------------------------------------------------------------------------------ */

static struct gd_point in_face(const struct gd_mesh *mesh, uint32_t face, const double *a,
                               const double *b, double t)
{
    struct gd_point point;
    double weight[3];
    for (int k = 0; k < 3; k++) weight[k] = a[k] + t * (b[k] - a[k]);
    check_ok(gd_point_in_face(mesh, (struct gd_face){face}, weight, &point, NULL), NULL);
    return point;
}

static struct gd_vec3 gradient_at(const struct gd_field *field, const struct gd_point *point)
{
    struct gd_vec3 gradient;
    check_ok(gd_field_gradient(field, point, &gradient), NULL);
    return gradient;
}

static void random_weights(struct rng *rng, double weight[3])
{
    double a = rng_between(rng, 0.05, 1), b = rng_between(rng, 0.05, 1),
           c = rng_between(rng, 0.05, 1);
    weight[0] = a / (a + b + c);
    weight[1] = b / (a + b + c);
    weight[2] = 1 - weight[0] - weight[1];
}

/* Searches a random segment of a face for a jump of the gradient, by bisection. Checks that the
 * engine reports the point of the jump as a point of the cut locus. Returns the size of the jump,
 * or 0 if none is found. */
static double check_segment(const struct gd_field *field, const struct gd_mesh *mesh,
                            const struct gd_point *from, uint32_t face, struct rng *rng)
{
    double a[3], b[3], low = 0, high = 1;
    random_weights(rng, a);
    random_weights(rng, b);
    struct gd_point point = in_face(mesh, face, a, b, 0);
    struct gd_vec3 first = gradient_at(field, &point), last;
    point = in_face(mesh, face, a, b, 1);
    last = gradient_at(field, &point);
    if (gd_vec3_distance(first, last) < 0.3) return 0;
    for (int i = 0; i < 60; i++) {
        double middle = (low + high) / 2;
        point = in_face(mesh, face, a, b, middle);
        struct gd_vec3 here = gradient_at(field, &point);
        bool is_first = gd_vec3_distance(here, first) < gd_vec3_distance(here, last);
        *(is_first ? &low : &high) = middle;
        *(is_first ? &first : &last) = here;
    }
    double jump = gd_vec3_distance(first, last);
    if (jump < 0.01) return 0;
    assert_true(is_cut_by_search(mesh, from, &point) && is_cut_by_search(mesh, &point, from));
    return jump;
}

static void gradient_jumps_are_cut(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } cases[] = {{"torus", {36, 24, 1, 0.4}},
                 {"box", {5, 4, 3, 4}},
                 {"tangle", {600}},
                 {"terrain", {24, 0.5, 5}}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct surface surface = surface_of(cases[c].name, cases[c].values);
        struct rng rng = {c + 1};
        uint32_t jumps = 0, faces = gd_mesh_summary(surface.mesh)->faces;
        double widest = 0;
        struct gd_point from = test_point(surface.mesh, test_random_place(&surface.polygons, &rng));
        struct gd_field *field = field_of(surface.mesh, &from);
        for (int i = 0; i < SEGMENTS && jumps < JUMPS; i++) {
            uint32_t face = (uint32_t)rng_below(&rng, faces);
            double jump = check_segment(field, surface.mesh, &from, face, &rng);
            jumps += jump > 0;
            widest = fmax(widest, jump);
        }
        print_message("# %s: %u jumps of the gradient found, the largest %.2f\n", cases[c].name,
                      jumps, widest);
        assert_true(jumps > 5);
        gd_field_release(field);
        surface_free(&surface);
    }
}

/* A random point is reached by one shortest path only. */
static void random_points_have_one_path(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } cases[] = {{"torus", {36, 24, 1, 0.4}},
                 {"grid", {8, 6, 4, 3}},
                 {"tangle", {600}},
                 {"terrain", {24, 0.5, 5}}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct surface surface = surface_of(cases[c].name, cases[c].values);
        struct rng rng = {c + 20};
        for (int s = 0; s < 8; s++) {
            struct gd_point from =
                test_point(surface.mesh, test_random_place(&surface.polygons, &rng));
            struct gd_field *field = field_of(surface.mesh, &from);
            for (int i = 0; i < 1000; i++) {
                struct gd_point point =
                    test_point(surface.mesh, test_random_place(&surface.polygons, &rng));
                if (point.kind == GD_POINT_FACE && is_cut(field, &point))
                    fail_msg("%s: a random point is said to be on the cut locus", cases[c].name);
            }
            assert_false(is_cut(field, &from));
            gd_field_release(field);
        }
        surface_free(&surface);
    }
}

/* Two paths count as one if one passes a flat vertex on the left, the other on the right, and
 * nothing else differs, however close the target is to the vertex. */
static void next_to_a_vertex(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){80, 60, 4, 3});
    struct rng rng = {5};
    struct gd_point from = test_point(grid.mesh, test_random_place(&grid.polygons, &rng));
    struct gd_field *field = field_of(grid.mesh, &from);
    for (uint32_t face = 0; face < gd_mesh_summary(grid.mesh)->faces; face++) {
        struct gd_point point =
            in_face(grid.mesh, face, (double[3]){1 - 2e-9, 1e-9, 1e-9}, (double[3]){0}, 0);
        if (point.kind == GD_POINT_FACE) assert_false(is_cut(field, &point));
    }
    gd_field_release(field);
    surface_free(&grid);
}

/* --- symmetry --------------------------------------------------------------------------------- */

/* On an icosphere shortest paths leave a vertex in several directions to reach its antipode. */
static void antipodes(void **state)
{
    (void)state;
    struct surface sphere = surface_of("icosphere", (double[SAMPLE_PARAMETERS]){3, 1});
    uint32_t count = gd_mesh_summary(sphere.mesh)->index_count, told = 0;
    struct gd_point from, to;
    check_ok(gd_point_at_vertex(sphere.mesh, (struct gd_vertex){0}, &from, NULL), NULL);
    struct gd_field *field = field_of(sphere.mesh, &from);
    struct gd_vec3 pole = gd_point_position(sphere.mesh, &from);
    for (uint32_t v = 0; v < count; v++) {
        check_ok(gd_point_at_vertex(sphere.mesh, (struct gd_vertex){v}, &to, NULL), NULL);
        bool is_antipode =
            gd_vec3_distance(gd_point_position(sphere.mesh, &to), gd_vec3_scale(pole, -1)) < 1e-9;
        if (!is_antipode) continue;
        assert_true(is_cut(field, &to) && is_cut_by_search(sphere.mesh, &from, &to));
        told++;
    }
    assert_int_equal(told, 1);
    gd_field_release(field);
    surface_free(&sphere);
}

/* On the lateral surface of a prism, the line opposite to the source belongs to the cut locus, also
 * at vertices and on edges. */
static void behind_a_prism(void **state)
{
    (void)state;
    struct surface prism = surface_of("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 12, 6});
    const struct gd_mesh *mesh = prism.mesh;
    uint32_t count = gd_mesh_summary(mesh)->index_count, told = 0;
    struct gd_point from, to;
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){0}, &from, NULL), NULL);
    struct gd_vec3 front = gd_point_position(mesh, &from);
    struct gd_field *field = field_of(mesh, &from);
    for (uint32_t v = 1; v < count; v++) {
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){v}, &to, NULL), NULL);
        struct gd_vec3 at = gd_point_position(mesh, &to);
        bool is_behind = fabs(at.x + front.x) + fabs(at.y + front.y) < 1e-9;
        told += is_behind;
        if (is_cut(field, &to) != is_behind) fail_msg("vertex %u", v);
    }
    assert_true(told > 2);
    gd_field_release(field);
    surface_free(&prism);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gradient_jumps_are_cut), cmocka_unit_test(random_points_have_one_path),
        cmocka_unit_test(next_to_a_vertex), cmocka_unit_test(antipodes),
        cmocka_unit_test(behind_a_prism)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
