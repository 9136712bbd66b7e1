#include "cut/arrangement.h"

#include "cutting.h"

/* Checks the segments and nodes of a face. Segments must meet only in their ends, no node may be
 * close to the inside of a segment, and no segment may be a side of the face. Nodes must not be
 * closer to each other than the least permitted distance. */
static void check_face(const struct gd__arrangement *arrangement, uint32_t face)
{
    const struct gd__nodes *nodes = &arrangement->nodes;
    double reach = gd__nodes_reach(nodes, face);
    for (uint32_t s = arrangement->of_face[face]; s != GD_NONE; s = arrangement->segments[s].next) {
        const struct gd__segment *segment = &arrangement->segments[s];
        struct gd__site a = gd__node_site(nodes, face, segment->a),
                        b = gd__node_site(nodes, face, segment->b);
        struct gd__local p = gd__site_local(nodes->mesh, face, a),
                         q = gd__site_local(nodes->mesh, face, b);
        assert_int_equal(
            gd__node_sides(nodes, face, segment->a) & gd__node_sides(nodes, face, segment->b), 0);
        for (uint32_t o = segment->next; o != GD_NONE; o = arrangement->segments[o].next)
            assert_false(gd__sites_cross(a, b,
                                         gd__node_site(nodes, face, arrangement->segments[o].a),
                                         gd__node_site(nodes, face, arrangement->segments[o].b)));
        struct gd__node_walk walk = {0};
        uint32_t node;
        while ((node = gd__nodes_walk(nodes, face, &walk)) != GD_NONE) {
            struct gd__local r =
                gd__site_local(nodes->mesh, face, gd__node_site(nodes, face, node));
            double along = (r.x - p.x) * (q.x - p.x) + (r.y - p.y) * (q.y - p.y),
                   length = hypot(q.x - p.x, q.y - p.y);
            if (node == segment->a || node == segment->b || along <= 0 || along >= length * length)
                continue;
            double across = fabs((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / length;
            assert_true(across > reach / 2 * (1 - 1e-6));
        }
    }
    for (uint32_t n = nodes->of_face[face]; n != GD_NONE; n = gd__node(nodes, n)->next) {
        struct gd__local p = gd__site_local(nodes->mesh, face, gd__node_site(nodes, face, n));
        for (uint32_t m = gd__node(nodes, n)->next; m != GD_NONE; m = gd__node(nodes, m)->next) {
            struct gd__local q = gd__site_local(nodes->mesh, face, gd__node_site(nodes, face, m));
            assert_true(hypot(q.x - p.x, q.y - p.y) > reach * (1 - 1e-6));
        }
    }
}

/* Tests closed polylines with many corners at few positions, perturbed by tiny amounts. The
 * polylines cross, touch and overlap in every way. */
static void crowded_polylines(void **state)
{
    (void)state;
    struct rng rng = {11};
    uint32_t crossings = 0;
    for (int round = 0; round < 120; round++) {
        double cells = 1 + round % 4, jitter = pow(10, -rng_between(&rng, 2, 9));
        struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){cells, cells, 1, 1});
        struct gd_point points[24];
        for (int i = 0; i < 24; i++) {
            double x = rng_below(&rng, 5) / 4.0 + jitter * rng_between(&rng, -1, 1),
                   y = rng_below(&rng, 5) / 4.0 + jitter * rng_between(&rng, -1, 1);
            check_ok(gd_locate_nearest(mesh, (struct gd_vec3){x, y, 0}, -1, &points[i], NULL),
                     NULL);
        }
        struct gd_curve curve = curve_through(mesh, points, 24, true);
        struct gd__arena arena = {0};
        struct gd__arrangement arrangement;
        check_ok(gd__arrange(mesh, &curve, 1e-6, &arena, &arrangement, NULL), NULL);
        for (uint32_t face = 0; face < mesh->face_count; face++) check_face(&arrangement, face);
        assert_true(arrangement.nodes.shift < 2e-5);
        crossings += arrangement.nodes.count;
        gd__arena_free(&arena);
        gd_curve_free(&curve);
        gd_mesh_release(mesh);
    }
    assert_true(crossings > 5000);
}

/* A curve that runs along a side three times gives three runs and no segment. */
static void curves_along_sides_are_runs(void **state)
{
    (void)state;
    struct gd_mesh *mesh = sample_mesh("grid", (double[SAMPLE_PARAMETERS]){1, 1, 1, 1});
    struct gd_point points[] = {vertex_of(mesh, 0), point_at(mesh, 0.25, 0.25, 0),
                                point_at(mesh, 0.75, 0.75, 0)};
    struct gd__arena arena = {0};
    struct gd__arrangement arrangement;
    check_ok(
        gd__arrange(mesh, &(struct gd_curve){points, 3, true}, 1e-6, &arena, &arrangement, NULL),
        NULL);
    assert_int_equal(arrangement.run_count, 3);
    assert_int_equal(arrangement.nodes.count, 2);
    for (uint32_t face = 0; face < 2; face++) {
        assert_int_equal(arrangement.of_face[face], GD_NONE);
        assert_true(gd__is_crossed(&arrangement, face));
    }
    gd__arena_free(&arena);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crowded_polylines),
        cmocka_unit_test(curves_along_sides_are_runs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
