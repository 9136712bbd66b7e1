/* Example 1 (Fig. 8) of Y.-J. Liu, "Exact geodesic metric in 2-manifold triangle meshes using
 * edge-based data structures", window by window and without pruning: windows w1 and w2 on edge e3,
 * w3 and w4 on edge e2. */
#include "tests/support/test.h"

#include <string.h>

#include "window/contest.h"
#include "wavefront/wavefront.h"

static double positions[8][3] = {{0.5, 0.5, 1.5}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1},
                                 {1, 1, 0},       {1, 0, 0}, {0, 0, 0}, {0.5, 0.5, -0.5}};
static uint32_t corners[24] = {0, 1, 2, 1, 6, 2, 2, 6, 5, 0, 2, 3,
                               2, 4, 3, 2, 5, 4, 5, 6, 7, 4, 5, 7};
static const struct gd_polygons example = {
    .positions = positions, .position_count = 8, .polygon_count = 8, .corners = corners};

/* Returns the side of edge a-b whose face has the apex c. Vertex numbers are the paper's. */
static uint32_t side_towards(const struct gd_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t side = gd__side_between(mesh, mesh->vertex_of_index[a], mesh->vertex_of_index[b]);
    assert_int_not_equal(side, GD_NONE);
    if (gd__side_is_boundary(mesh, side) || gd__side_apex(mesh, side) != mesh->vertex_of_index[c])
        side ^= 1;
    assert_int_equal(gd__side_apex(mesh, side), mesh->vertex_of_index[c]);
    return side;
}

/* Returns the window of source v0 on edge a-b, which is opposite to v0 in a face. The window is in
 * the frame of the side whose face has the apex c. */
static struct gd__window from_v0(const struct gd_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t side = side_towards(mesh, a, b, c);
    const struct gd_side *behind = &mesh->side[side ^ 1];
    double px = behind->left_length * behind->left_x, py = behind->left_length * behind->left_y;
    return (struct gd__window){.b0 = 0,
                               .b1 = behind->length,
                               .x = behind->length - px,
                               .y = py,
                               .source = mesh->vertex_of_index[0]};
}

static struct gd__pool pool;
/* the children of the last cast window on the left and on the right side */
static struct gd__children children[2];

/* Casts a single window across the face of a side. Returns the distance of the apex through the
 * window. */
static double cast(const struct gd_side *side, const struct gd__window *window)
{
    struct gd__window_builder parent = {0};
    check_ok(gd__window_builder_reserve(&parent, 1), NULL);
    for (int k = 0; k < 2; k++) check_ok(gd__children_open(&children[k], &pool, 1), NULL);
    gd__windows_put(&parent.at, 0, window);
    struct gd__apex apex = {.distance = GD__FAR, .last_left = GD_NONE, .first_right = GD_NONE};
    gd__kernel_in_use()->cast(side, &parent.at, 1, true, &apex, &children[0], &children[1]);
    gd__window_builder_destroy(&parent);
    for (int k = 0; k < 2; k++)
        assert_true(children[k].count <= 1 && children[k].tangled == GD_NONE);
    return apex.distance;
}

static int open_pool(void **state)
{
    (void)state;
    gd__pool_init(&pool, GD__LIST_POOL_ITEM, NULL);
    memset(children, 0, sizeof children);
    return 0;
}

static int close_pool(void **state)
{
    (void)state;
    gd__pool_destroy(&pool);
    return 0;
}

/* Casts a window on edge (a, b) across the face with the apex c onto the edge (c, d), d = a or
 * b. */
static struct gd__window cross(const struct gd_mesh *mesh, struct gd__window w, uint32_t a,
                               uint32_t b, uint32_t c, uint32_t d)
{
    uint32_t side = side_towards(mesh, a, b, c);
    cast(&mesh->side[side], &w);
    const struct gd__children *child =
        &children[mesh->origin[side] == mesh->vertex_of_index[d] ? 0 : 1];
    assert_int_equal(child->count, 1);
    return gd__windows_get(&child->at, 0);
}

/* Returns the window in the frame that starts at vertex a, if it is on edge (a, b) of the face with
 * the apex c. */
static struct gd__window in_frame_of(const struct gd_mesh *mesh, struct gd__window w, uint32_t a,
                                     uint32_t b, uint32_t c)
{
    uint32_t side = side_towards(mesh, a, b, c);
    return mesh->origin[side] == mesh->vertex_of_index[a]
               ? w
               : gd__window_mirrored(&w, mesh->side[side].length);
}

static void example_1(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_mesh(&example);
    /* w1 on e3 = (v5, v6): through faces v0v1v2, v1v6v2, v2v6v5 */
    struct gd__window on_26 = cross(mesh, from_v0(mesh, 1, 2, 6), 1, 2, 6, 2);
    struct gd__window w1 = cross(mesh, on_26, 2, 6, 5, 6);
    /* w2: through faces v0v2v3, v2v4v3, v2v5v4, v2v6v5 */
    struct gd__window on_24 = cross(mesh, from_v0(mesh, 2, 3, 4), 2, 3, 4, 2);
    struct gd__window on_25 = cross(mesh, on_24, 2, 4, 5, 2);
    struct gd__window w2 = cross(mesh, on_25, 2, 5, 6, 5);
    double lo = fmax(w1.b0, w2.b0), hi = fmin(w1.b1, w2.b1);
    assert_true(hi > lo);
    struct gd__contest_result verdict =
        gd__contest(&w2, &w1, lo, hi); /* C1: no solution, w1 wins everywhere */
    assert_int_equal(verdict.switches, 0);
    assert_false(verdict.challenger_first);
    assert_true(gd__window_distance(&w2, (lo + hi) / 2) >
                gd__window_distance(&w1, (lo + hi) / 2) + 1e-3);
    /* w3 on e2 = (v5, v7): w1 across v5v6v7; w4: across edge v4v5 and face v4v5v7 */
    struct gd__window w3 = in_frame_of(mesh, cross(mesh, w1, 5, 6, 7, 5), 5, 7, 4);
    struct gd__window w4 =
        in_frame_of(mesh, cross(mesh, cross(mesh, on_24, 2, 4, 5, 4), 4, 5, 7, 5), 5, 7, 6);
    lo = fmax(w3.b0, w4.b0);
    hi = fmin(w3.b1, w4.b1);
    assert_true(hi - lo > 0.1 / mesh->unit);
    for (int k = 0; k <= 10; k++) { /* C2: infinitely many solutions */
        double t = lo + (hi - lo) * k / 10;
        check_close(gd__window_distance(&w3, t), gd__window_distance(&w4, t), 1e-15);
    }
    assert_false(gd__contest(&w3, &w4, lo, hi).challenger_first);
    assert_false(gd__contest(&w4, &w3, lo, hi).challenger_first);
    assert_int_equal(gd__contest(&w3, &w4, lo, hi).switches, 0);
    gd_mesh_release(mesh);
}

/* Computes a point of a child's edge in the frame of the parent's side. */
static void place_on_child(const struct gd_side *s, int k, double t, double at[2])
{
    at[0] = k ? s->left_length * s->left_x + t * s->right_x : t * s->left_x;
    at[1] = k ? s->left_length * s->left_y + t * s->right_y : t * s->left_y;
}

/* A child is a window that was cast from its parent. The distances through a child are the lengths
 * of the parent's rays. These rays cross the parent's interval. */
static void children_continue_the_rays(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_mesh(&example);
    struct rng rng = {5};
    int checked = 0, seen = 0;
    for (int i = 0; i < 20000; i++) {
        uint32_t side = rng_below(&rng, 2 * mesh->edge_count);
        if (gd__side_is_boundary(mesh, side)) continue;
        const struct gd_side *s = &mesh->side[side];
        double a = rng_between(&rng, 0, s->length), b = rng_between(&rng, 0, s->length);
        struct gd__window w = {.b0 = fmin(a, b),
                               .b1 = fmax(a, b),
                               .x = rng_between(&rng, -3, 3),
                               .y = rng_between(&rng, 0.01, 3),
                               .sigma = 1};
        double apex = cast(s, &w);
        for (int k = 0; k < 2; k++) {
            if (!children[k].count) continue;
            struct gd__window child = gd__windows_get(&children[k].at, 0);
            double t = (child.b0 + child.b1) / 2, at[2];
            place_on_child(s, k, t, at);
            check_close(gd__window_distance(&child, t), 1 + hypot(at[0] - w.x, at[1] + w.y), 1e-13);
            double crossing = w.x + (at[0] - w.x) * w.y / (at[1] + w.y);
            assert_true(crossing >= w.b0 - 1e-9 && crossing <= w.b1 + 1e-9);
            checked++;
        }
        assert_true(children[0].count + children[1].count > 0);
        /* if the window has children on both sides, it reaches the apex */
        if (children[0].count && children[1].count) {
            double px = s->left_length * s->left_x, py = s->left_length * s->left_y;
            check_close(apex, 1 + hypot(px - w.x, py + w.y), 1e-13);
            seen++;
        }
    }
    assert_true(checked > 10000 && seen > 1000);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(example_1, open_pool, close_pool),
        cmocka_unit_test_setup_teardown(children_continue_the_rays, open_pool, close_pool),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
