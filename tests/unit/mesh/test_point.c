#include "shapes.h"

#include "gd/point.h"
#include "mesh/topology.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static struct gd_mesh *sample_mesh(void)
{
    struct gd_polygons polygons;
    assert_int_equal(sample_torus(7, 5, 3, 1, &polygons), GD_OK);
    sample_flip_faces(&polygons, 0.4, 9);
    assert_int_equal(sample_renumber(&polygons, 2, NULL, NULL), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

static struct gd_point in_face(const struct gd_mesh *mesh, uint32_t face, double a, double b,
                               double c)
{
    struct gd_point point;
    struct gd_detail detail = {0};
    if (gd_point_in_face(mesh, (struct gd_face){face}, (double[3]){a, b, c}, &point, &detail))
        fail_msg("%s", detail.text);
    return point;
}

static struct gd_point on_edge(const struct gd_mesh *mesh, uint32_t a, uint32_t b, double t)
{
    struct gd_point point;
    struct gd_detail detail = {0};
    if (gd_point_on_edge(mesh, (struct gd_vertex[]){{a}, {b}}, t, &point, &detail))
        fail_msg("%s", detail.text);
    return point;
}

static struct gd_point at_vertex(const struct gd_mesh *mesh, uint32_t v)
{
    struct gd_point point;
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){v}, &point, NULL), GD_OK);
    return point;
}

/* Returns the face's corners in the order of the input. */
static void input_corners(const struct gd_mesh *mesh, uint32_t face, uint32_t out[3])
{
    struct gd_vertex c[3];
    gd_mesh_corners(mesh, (struct gd_face){face}, c);
    bool flipped = mesh->face_flipped[mesh->face_of_index[face]];
    out[0] = c[0].index;
    out[1] = c[flipped ? 2 : 1].index;
    out[2] = c[flipped ? 1 : 2].index;
}

static void expect_equal(struct gd_point a, struct gd_point b)
{
    if (!gd_point_equal(&a, &b))
        fail_msg("kind %d element %u weight %.17g, %d %u %.17g", a.kind, a.element, a.weight[0],
                 b.kind, b.element, b.weight[0]);
}

static void all_forms_give_the_same_point(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh();
    const double ts[] = {0.25, 0.1, 0.7, 1.0 / 3, 0.999};
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        uint32_t v[3];
        input_corners(mesh, f, v);
        for (int k = 0; k < 3; k++) {
            uint32_t a = v[k], b = v[(k + 1) % 3];
            double w[3] = {k == 0, k == 1, k == 2};
            expect_equal(in_face(mesh, f, w[0], w[1], w[2]), at_vertex(mesh, a));
            expect_equal(on_edge(mesh, a, b, 0), at_vertex(mesh, a));
            expect_equal(on_edge(mesh, a, b, 1), at_vertex(mesh, b));
            for (uint32_t i = 0; i < COUNT(ts); i++) {
                double e[3] = {0};
                e[k] = 1 - ts[i];
                e[(k + 1) % 3] = ts[i];
                struct gd_point p = on_edge(mesh, a, b, ts[i]);
                assert_int_equal(p.kind, GD_POINT_EDGE);
                assert_true((p.weight[0] == 1 - p.weight[1] || p.weight[1] == 1 - p.weight[0]) &&
                            p.weight[2] == 0);
                expect_equal(in_face(mesh, f, e[0], e[1], e[2]), p);
                expect_equal(on_edge(mesh, b, a, 1 - ts[i]), on_edge(mesh, a, b, 1 - (1 - ts[i])));
            }
        }
    }
    gd_mesh_release(mesh);
}

static void rounded_weights_are_accepted(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh();
    uint32_t v[3];
    input_corners(mesh, 5, v);
    expect_equal(in_face(mesh, 5, -5e-17, 0.5, 0.5), on_edge(mesh, v[1], v[2], 0.5));
    expect_equal(in_face(mesh, 5, -5e-17, 1, 5e-17), at_vertex(mesh, v[1]));
    expect_equal(in_face(mesh, 5, 1e-15, 1e-15, 1 - 2e-15), at_vertex(mesh, v[2]));
    expect_equal(in_face(mesh, 5, 1 + 1e-10, -1e-10, 0), at_vertex(mesh, v[0]));
    expect_equal(in_face(mesh, 5, 0.5, 0.5 - 1e-15, 3e-15), on_edge(mesh, v[0], v[1], 0.5 - 1e-15));
    expect_equal(on_edge(mesh, v[0], v[1], -1e-10), at_vertex(mesh, v[0]));
    struct gd_point near = in_face(mesh, 5, 1e-13, 0.5, 0.5 - 1e-13);
    assert_int_equal(near.kind, GD_POINT_FACE);
    /* the weights are normalized to the sum 1 */
    struct gd_point p = in_face(mesh, 5, 0.2, 0.3, 0.5 + 9e-10);
    expect_near(p.weight[0] + p.weight[1] + p.weight[2], 1, 4e-16);
    gd_mesh_release(mesh);
}

static void invalid_points_are_refused(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {1, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 1, 4, 2};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = build(&polygons);
    struct gd_point out = {.element = 77}, before = out;
    const struct {
        double b[3];
        enum gd_status status;
    } faces[] = {
        {{0.5, 0.5, 1e-8}, GD_NOT_ON_SURFACE},   {{0.5, 0.6, -0.1}, GD_NOT_ON_SURFACE},
        {{0, 0, 0}, GD_NOT_ON_SURFACE},          {{NAN, 0.5, 0.5}, GD_INVALID_ARGUMENT},
        {{INFINITY, 0, 0}, GD_INVALID_ARGUMENT}, {{1e308, 1e308, -1e308}, GD_NOT_ON_SURFACE}};
    for (uint32_t i = 0; i < COUNT(faces); i++) {
        struct gd_detail detail = {0};
        assert_int_equal(gd_point_in_face(mesh, (struct gd_face){0}, faces[i].b, &out, &detail),
                         faces[i].status);
        assert_true(strlen(detail.text) > 0);
    }
    const double third[3] = {0.4, 0.3, 0.3};
    struct gd_vertex v0 = {0}, v1 = {1}, v3 = {3}, v4 = {4}, v9 = {9};
    assert_int_equal(gd_point_in_face(mesh, (struct gd_face){2}, third, &out, NULL),
                     GD_OUT_OF_RANGE);
    assert_int_equal(gd_point_at_vertex(mesh, v9, &out, NULL), GD_OUT_OF_RANGE);
    assert_int_equal(gd_point_at_vertex(mesh, v3, &out, NULL), GD_UNREFERENCED_VERTEX);
    assert_int_equal(gd_point_on_edge(mesh, (struct gd_vertex[]){v0, v4}, 0.5, &out, NULL),
                     GD_NO_SUCH_EDGE);
    assert_int_equal(gd_point_on_edge(mesh, (struct gd_vertex[]){v0, v0}, 0.5, &out, NULL),
                     GD_NO_SUCH_EDGE);
    assert_int_equal(gd_point_on_edge(mesh, (struct gd_vertex[]){v0, v3}, 0.5, &out, NULL),
                     GD_UNREFERENCED_VERTEX);
    assert_int_equal(gd_point_on_edge(mesh, (struct gd_vertex[]){v9, v0}, 0.5, &out, NULL),
                     GD_OUT_OF_RANGE);
    assert_int_equal(gd_point_on_edge(mesh, (struct gd_vertex[]){v0, v1}, 1.1, &out, NULL),
                     GD_NOT_ON_SURFACE);
    assert_int_equal(gd_point_on_edge(mesh, (struct gd_vertex[]){v0, v1}, NAN, &out, NULL),
                     GD_INVALID_ARGUMENT);
    expect_equal(out, before);
    gd_mesh_release(mesh);
}

static void expect_lowest_face(const struct gd_mesh *mesh, const struct gd_point_description *d)
{
    for (uint32_t f = 0; f < d->face.index; f++) {
        uint32_t v[3];
        input_corners(mesh, f, v);
        uint32_t met = 0;
        for (int k = 0; k < 3; k++) {
            met += d->kind == GD_POINT_VERTEX && v[k] == d->vertex.index;
            met +=
                d->kind == GD_POINT_EDGE && (v[k] == d->edge[0].index || v[k] == d->edge[1].index);
        }
        assert_true(met < (d->kind == GD_POINT_EDGE ? 2u : 1u));
    }
}

/* A point's description gives the same point again, and the numbers of the description give the
 * same position. */
static void a_description_gives_the_point_again(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh();
    struct rng rng = {4};
    for (int i = 0; i < 3000; i++) {
        double a = rng_unit(&rng), b = rng_unit(&rng) * (1 - a), w[3] = {a, b, 1 - a - b};
        uint32_t f = rng_below(&rng, mesh->face_count);
        if (i % 3 == 1) w[2] = 0, w[0] = 1 - w[1];
        if (i % 3 == 2) w[0] = 0, w[1] = 1, w[2] = 0;
        struct gd_point p = in_face(mesh, f, w[0], w[1], w[2]);
        struct gd_point_description d;
        gd_point_describe(mesh, &p, &d);
        assert_int_equal(d.kind, p.kind);
        expect_equal(
            in_face(mesh, d.face.index, d.barycentric[0], d.barycentric[1], d.barycentric[2]), p);
        expect_lowest_face(mesh, &d);
        uint32_t v[3];
        input_corners(mesh, d.face.index, v);
        struct gd_vec3 at = {0, 0, 0};
        for (int k = 0; k < 3; k++)
            at = gd_vec3_along(at, d.barycentric[k],
                               gd_mesh_position(mesh, (struct gd_vertex){v[k]}));
        expect_near(gd_vec3_distance(at, d.xyz), 0, 1e-14);
        if (d.kind == GD_POINT_EDGE) {
            assert_true(d.edge[0].index < d.edge[1].index);
            struct gd_point again = on_edge(mesh, d.edge[0].index, d.edge[1].index, d.t);
            assert_true(again.kind == p.kind && again.element == p.element);
            expect_near(again.weight[0], p.weight[0], 2e-16);
        }
        if (d.kind == GD_POINT_VERTEX) {
            struct gd_vec3 exact = gd_mesh_position(mesh, d.vertex);
            assert_memory_equal(&exact, &d.xyz, sizeof exact);
        }
    }
    gd_mesh_release(mesh);
}

/* Uses two triangles without a common vertex. */
static void finds_the_component_of_a_point(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 4, 5};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = build(&polygons);
    for (uint32_t f = 0; f < 2; f++) {
        struct gd_point points[] = {at_vertex(mesh, 3 * f), at_vertex(mesh, 3 * f + 2),
                                    on_edge(mesh, 3 * f + 1, 3 * f + 2, 0.25),
                                    in_face(mesh, f, 0.2, 0.3, 0.5)};
        for (uint32_t i = 0; i < COUNT(points); i++)
            assert_int_equal(gd_point_component(mesh, &points[i]), f);
    }
    gd_mesh_release(mesh);
}

/* The positions of several points in one call equal the positions from single calls, bit for
 * bit. */
static void a_batch_equals_single_calls(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh();
    const struct gd_point points[] = {at_vertex(mesh, 3), in_face(mesh, 5, 0.2, 0.3, 0.5),
                                      on_edge(mesh, 0, 1, 0.375), in_face(mesh, 0, 0.6, 0.3, 0.1),
                                      at_vertex(mesh, 0)};
    enum { COUNT = sizeof points / sizeof points[0] };
    double xyz[COUNT][3];
    gd_points_positions(mesh, points, COUNT, xyz);
    for (int i = 0; i < COUNT; i++) {
        struct gd_vec3 position = gd_point_position(mesh, &points[i]);
        assert_memory_equal(xyz[i], ((double[]){position.x, position.y, position.z}),
                            sizeof xyz[i]);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_forms_give_the_same_point),
        cmocka_unit_test(rounded_weights_are_accepted),
        cmocka_unit_test(invalid_points_are_refused),
        cmocka_unit_test(a_description_gives_the_point_again),
        cmocka_unit_test(finds_the_component_of_a_point),
        cmocka_unit_test(a_batch_equals_single_calls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
