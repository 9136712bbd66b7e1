#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "field/layout.h"
#include "gd/field.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"

/* Example 1 (Fig. 8) of Y.-J. Liu, "Exact geodesic metric in 2-manifold triangle meshes using
 * edge-based data structures", after propagation: wedge w1 on edge e3, and one wedge of an
 * equidistant pair on edge e2. */
static void example_1(void **state)
{
    (void)state;
    double positions[8][3] = {{0.5, 0.5, 1.5}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1},
                              {1, 1, 0},       {1, 0, 0}, {0, 0, 0}, {0.5, 0.5, -0.5}};
    uint32_t corners[24] = {0, 1, 2, 1, 6, 2, 2, 6, 5, 0, 2, 3, 2, 4, 3, 2, 5, 4, 5, 6, 7, 4, 5, 7};
    struct gd_mesh *mesh = test_mesh(&(struct gd_polygons){
        .positions = positions, .position_count = 8, .polygon_count = 8, .corners = corners});
    struct gd_field *field = test_field_from(mesh, test_vertex(mesh, 0));
    struct gd_wedge *wedges;
    uint32_t count, direct = 0;
    /* On e3, the only wedge of source v0 is w1. Unfolded, the source is at (0.5, 1 + sqrt(1/2))
     * above v6v5: the side of the cube's face is 1, and the slant height of the pyramid is
     * sqrt(1/2). */
    check_ok(gd_field_wedges(field, (struct gd_vertex){5}, (struct gd_vertex){6}, &wedges, &count),
             NULL);
    double slant = sqrt(0.5), height = 1 + slant;
    for (uint32_t i = 0; i < count; i++) {
        if (!wedges[i].at_vertex || wedges[i].source != 0) continue;
        direct++;
        check_close(wedges[i].d0, hypot(wedges[i].b0 - 0.5, height), 1e-9);
        check_close(wedges[i].d1, hypot(wedges[i].b1 - 0.5, height), 1e-9);
    }
    assert_int_equal(direct, 1);
    free(wedges);
    /* On e2, w3 and w4 have equal distances. The field keeps one of them, so that the wedges of v0
     * do not overlap. */
    check_ok(gd_field_wedges(field, (struct gd_vertex){5}, (struct gd_vertex){7}, &wedges, &count),
             NULL);
    direct = 0;
    for (uint32_t i = 0; i < count; i++) direct += wedges[i].at_vertex && wedges[i].source == 0;
    assert_int_equal(direct, 1);
    free(wedges);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* --- chunks ----------------------------------------------------------------------------------- */

/* The totals over all chunks of a field. */
struct chunks {
    uint64_t edges, chunks, wedges, gaps, bytes;
    uint32_t longest; /* longest chain */
};

/* Checks that all wedges of a chunk belong to one side, that their starts begin at 0 and ascend,
 * that sources exist, and that a gap has only a start. */
static void check_chunk(const struct gd_field *field, uint32_t at, struct chunks *sum)
{
    const struct gd__chunk *chunk = gd__field_chunk(field, at);
    struct gd__wedges w = gd__chunk_wedges(chunk);
    uint32_t before = sum->gaps, previous = gd__chunk_previous(chunk);
    assert_true(chunk->count > 0 && (previous == GD_NONE || previous < at));
    assert_int_equal(w.start[0], 0);
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t source = gd__wedge_source(&w, i);
        double x = gd__wedge_x(&w, i), y = gd__wedge_y(&w, i);
        if (i) assert_true(w.start[i] >= w.start[i - 1]);
        if (source == GD_NONE) {
            assert_true(x == 0 && y == 0);
            sum->gaps++;
            continue;
        }
        assert_true(source < field->mesh->vertex_count + field->seed_count && isfinite(x) &&
                    y >= 0);
        assert_true(gd__field_sigma(field, source) < GD__FAR);
    }
    assert_true(sum->gaps - before < chunk->count);
    sum->chunks++;
    sum->wedges += chunk->count;
    sum->bytes += gd__chunk_bytes(chunk);
}

static struct chunks check_chains(const struct gd_field *field)
{
    struct chunks sum = {.edges = field->mesh->edge_count};
    for (uint32_t e = 0; e < field->mesh->edge_count; e++) {
        uint32_t length = 0;
        for (uint32_t at = field->newest[e]; at != GD_NONE;
             at = gd__chunk_previous(gd__field_chunk(field, at)), length++)
            check_chunk(field, at, &sum);
        if (length > sum.longest) sum.longest = length;
    }
    assert_int_equal(sum.wedges, field->statistics.wedges);
    assert_int_equal(sum.bytes, field->wedge_bytes); /* each chunk belongs to one chain */
    return sum;
}

/* Checks that the merged list of an edge is sorted, disjoint and within the edge, and that adjacent
 * wedges have equal distances where they meet. */
static void check_merged(const struct gd_field *field, uint32_t edge, uint64_t *wedges,
                         uint64_t *joints)
{
    const struct gd_mesh *mesh = field->mesh;
    uint32_t a = mesh->index_of_vertex[mesh->origin[2 * edge]],
             b = mesh->index_of_vertex[mesh->origin[2 * edge + 1]], count;
    double length = mesh->side[2 * edge].length * mesh->unit;
    double ends[2] = {field->distance[mesh->origin[2 * edge + (a > b)]] * mesh->unit,
                      field->distance[mesh->origin[2 * edge + (a < b)]] * mesh->unit};
    struct gd_wedge *list;
    check_ok(gd_field_wedges(field, (struct gd_vertex){a}, (struct gd_vertex){b}, &list, &count),
             NULL);
    for (uint32_t i = 0; i < count; i++) {
        assert_true(list[i].b0 >= 0 && list[i].b0 < list[i].b1 && list[i].b1 <= length);
        if (!i) continue;
        assert_true(list[i].b0 >= list[i - 1].b1);
        if (list[i].b0 > list[i - 1].b1) continue;
        if (fmin(list[i - 1].b1 - list[i - 1].b0, list[i].b1 - list[i].b0) <=
            4 * length * GD__WEDGE_UNIT)
            continue; /* the width is not larger than the rounding of the ends */
        double before = list[i - 1].sigma + list[i - 1].d1, behind = list[i].sigma + list[i].d0;
        double round = fmin(ends[0] + list[i].b0, ends[1] + length - list[i].b0);
        if (fmin(before, behind) > round * (1 - 1e-9))
            /* a path around an end of the edge is shorter, and no wedge stores such a path */
            continue;
        check_close(before, behind, 1e-8);
        ++*joints;
    }
    *wedges += count;
    free(list);
}

/* Returns the distance at parameter t of a wedge, computed from the distances at its ends. */
static double distance_in_wedge(const struct gd_wedge *w, double t)
{
    double width = w->b1 - w->b0, part = t - w->b0;
    if (w->linear) return w->sigma + w->d0 + part / width * (w->d1 - w->d0);
    double x = (w->d0 * w->d0 - w->d1 * w->d1 + width * width) / (2 * width);
    return w->sigma + hypot(part - x, sqrt(fmax(0, w->d0 * w->d0 - x * x)));
}

/* Checks that the merged list covers the edge from end to end and has the field's distances. */
static void check_cover(const struct gd_field *field, uint32_t edge, struct rng *rng)
{
    const struct gd_mesh *mesh = field->mesh;
    uint32_t a = mesh->index_of_vertex[mesh->origin[2 * edge]],
             b = mesh->index_of_vertex[mesh->origin[2 * edge + 1]], count;
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    double length = mesh->side[2 * edge].length * mesh->unit;
    struct gd_wedge *list;
    check_ok(
        gd_field_wedges(field, (struct gd_vertex){low}, (struct gd_vertex){high}, &list, &count),
        NULL);
    assert_true(count > 0);
    assert_true(list[0].b0 <= 1e-15 * length);
    check_close(list[count - 1].b1, length, 1e-14);
    for (uint32_t i = 1; i < count; i++)
        assert_true(fabs(list[i].b0 - list[i - 1].b1) <= 1e-15 * length);
    for (int k = 0; k < 3; k++) {
        double t = rng_between(rng, 0.01, 0.99) * length, distance;
        uint32_t i = 0;
        while (i + 1 < count && list[i].b1 < t) i++;
        if (list[i].b1 - list[i].b0 < 1e-6 * length) continue;
        struct gd_point point;
        check_ok(
            gd_point_on_edge(mesh, (struct gd_vertex[]){{low}, {high}}, t / length, &point, NULL),
            NULL);
        check_ok(gd_field_distance(field, &point, &distance), NULL);
        check_close(distance_in_wedge(&list[i], t), distance, 1e-12);
    }
    free(list);
}

/* Checks that gd_field_all_wedges returns the same as gd_field_wedges for each edge. */
static void check_all_wedges(const struct gd_field *field)
{
    struct gd_all_wedges all;
    check_ok(gd_field_all_wedges(field, NULL, &all), NULL);
    assert_int_equal(all.edge_count, field->mesh->edge_count);
    for (uint32_t e = 0; e < all.edge_count; e++) {
        struct gd_wedge *list;
        uint32_t count;
        assert_true(all.edges[e][0].index < all.edges[e][1].index);
        check_ok(gd_field_wedges(field, all.edges[e][0], all.edges[e][1], &list, &count), NULL);
        assert_int_equal(all.first[e + 1] - all.first[e], count);
        for (uint32_t i = 0; i < count; i++) {
            const struct gd_wedge *w = &all.wedges[all.first[e] + i];
            assert_true(w->b0 == list[i].b0 && w->b1 == list[i].b1 && w->d0 == list[i].d0 &&
                        w->d1 == list[i].d1 && w->sigma == list[i].sigma);
            assert_true(w->tau == list[i].tau && w->linear == list[i].linear &&
                        w->at_vertex == list[i].at_vertex && w->source == list[i].source);
        }
        free(list);
    }
    assert_true(gd_all_wedges_memsize(&all) >= all.first[all.edge_count] * sizeof *all.wedges);
    gd_all_wedges_free(&all);
}

static void check_wedges_of(const char *name, struct gd_polygons *polygons, uint64_t seed)
{
    struct rng rng = {seed};
    struct gd_mesh *mesh = test_mesh(polygons);
    uint64_t merged = 0, joints = 0;
    struct chunks sum = {0};
    for (int i = 0; i < 3; i++) {
        struct gd_field *field =
            test_field_from(mesh, test_point(mesh, test_random_place(polygons, &rng)));
        sum = check_chains(field);
        merged = joints = 0;
        for (uint32_t e = 0; e < mesh->edge_count; e++) check_merged(field, e, &merged, &joints);
        for (uint32_t e = 0; e < mesh->edge_count; e++) check_cover(field, e, &rng);
        check_all_wedges(field);
        assert_true(joints > 0 && merged <= sum.wedges + 2 * mesh->edge_count);
        gd_field_release(field);
    }
    print_message("# %s: %u edges, %llu chunks (longest chain %u), %llu wedges, %llu of them gaps; "
                  "merged %llu, %llu joints\n",
                  name, mesh->edge_count, (unsigned long long)sum.chunks, sum.longest,
                  (unsigned long long)sum.wedges, (unsigned long long)sum.gaps,
                  (unsigned long long)merged, (unsigned long long)joints);
    gd_mesh_release(mesh);
    gd_polygons_free(polygons);
}

static void wedges_partition_their_edge(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_genus2(6, 0.05, &polygons), NULL);
    check_wedges_of("genus2", &polygons, 17);
    check_ok(sample_terrain(20, 3, 4, &polygons), NULL);
    check_wedges_of("steep terrain", &polygons, 18);
    check_ok(sample_tangle(400, 5, &polygons), NULL);
    check_wedges_of("tangle", &polygons, 19);
    check_ok(sample_box((const double[3]){1, 1, 1}, (const uint32_t[3]){6, 6, 6}, &polygons), NULL);
    check_wedges_of("box", &polygons, 20);
    check_ok(sample_icosphere(3, 1, &polygons), NULL);
    check_wedges_of("sphere", &polygons, 21);
    check_ok(sample_torus(24, 16, 2, 0.7, &polygons), NULL);
    check_wedges_of("torus", &polygons, 22);
}

/* Tests that a seed on an edge also creates wedges that cover this edge. The seed is a vertex, a
 * point of the edge, or a segment along the edge. */
static void seeds_on_an_edge_cover_it(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_box((const double[3]){1, 1, 1}, (const uint32_t[3]){4, 4, 4}, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct rng rng = {23};
    struct gd_point a = {.kind = GD_POINT_EDGE, .element = 5, .weight = {0.2, 0.8}},
                    b = {.kind = GD_POINT_EDGE, .element = 5, .weight = {0.7, 0.3}},
                    c = {.kind = GD_POINT_VERTEX, .element = 3};
    struct gd_seed seeds[] = {
        {.point = a}, {.point = b}, {.point = c}, {.point = a, .end = b, .is_segment = true}};
    for (uint32_t first = 0; first < 3; first++) {
        struct gd_field *field;
        check_ok(gd_field_build(mesh,
                                &(struct gd_field_request){.seeds = seeds + (first == 1 ? 2 : 0),
                                                           .seed_count = first == 0   ? 4
                                                                         : first == 1 ? 1
                                                                                      : 2},
                                NULL, &field, NULL),
                 NULL);
        for (uint32_t e = 0; e < mesh->edge_count; e++) check_cover(field, e, &rng);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Property 7: two correct wedges do not cross. The last segments of two paths into a face do not
 * intersect if they are from different wedges. */
static void correct_wedges_do_not_cross(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_terrain(24, 0.3, 7, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_field *field = test_field_from(mesh, test_vertex(mesh, 40));
    struct rng rng = {9};
    uint32_t pairs = 0;
    /* draws two points of one face whose shortest paths enter the face through the same edge */
    for (int i = 0; i < 200000; i++) {
        uint32_t face = rng_below(&rng, mesh->face_count);
        struct gd__leg leg[2];
        struct gd__local at[2];
        for (int k = 0; k < 2; k++) {
            double a = rng_unit(&rng), b = rng_unit(&rng) * (1 - a);
            struct gd_point point = {
                .kind = GD_POINT_FACE, .element = face, .weight = {a, b, 1 - a - b}};
            leg[k] = gd__field_leg(field, &point);
            int s = leg[k].kind == GD__LEG_WEDGE && mesh->face_side[face][1] == leg[k].side   ? 1
                    : leg[k].kind == GD__LEG_WEDGE && mesh->face_side[face][2] == leg[k].side ? 2
                                                                                              : 0;
            at[k] = gd__face_local(
                mesh, mesh->face_side[face][s],
                (double[3]){point.weight[s], point.weight[(s + 1) % 3], point.weight[(s + 2) % 3]});
        }
        if (leg[0].kind != GD__LEG_WEDGE || leg[1].kind != GD__LEG_WEDGE ||
            leg[0].side != leg[1].side)
            continue;
        if (leg[0].source == leg[1].source && fabs(leg[0].x - leg[1].x) < 1e-9 &&
            fabs(leg[0].y - leg[1].y) < 1e-9)
            continue;
        pairs++;
        /* Two segments, each from a crossing to its point, intersect if the ends of each segment
         * lie on opposite sides of the other segment. */
        double c0 = leg[0].parameter, c1 = leg[1].parameter;
        double left1 = (at[0].x - c0) * at[1].y - at[0].y * (at[1].x - c0),
               left2 = (at[0].x - c0) * 0 - at[0].y * (c1 - c0);
        double left3 = (at[1].x - c1) * at[0].y - at[1].y * (at[0].x - c1),
               left4 = (at[1].x - c1) * 0 - at[1].y * (c0 - c1);
        double tiny = 1e-9;
        assert_false(left1 * left2 < -tiny && left3 * left4 < -tiny);
    }
    print_message("# Property 7: %u pairs of legs of different wedges compared\n", pairs);
    assert_true(pairs > 1000);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* If the source moves from a vertex or an edge by 1e-16 … 1e-6 in any direction, no distance
 * changes by more than the length of this move. */
static void sources_close_to_a_vertex_or_an_edge(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(2, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    uint32_t count = mesh->summary.index_count;
    double *exact = malloc(sizeof *exact * count), *near = malloc(sizeof *near * count), worst = 0;
    for (uint32_t face = 0; face < 12; face++) {
        struct gd_vertex corner[3];
        gd_mesh_corners(mesh, (struct gd_face){face}, corner);
        for (int exponent = -16; exponent <= -6; exponent++) {
            double delta = pow(10, exponent), split = (face % 4) / 4.0;
            for (int on_edge = 0; on_edge < 2; on_edge++) {
                struct gd_point base, moved;
                double at[3] = {on_edge ? 0.6 : 1, on_edge ? 0.4 : 0, 0},
                       off[3] = {at[0] - delta, at[1] + split * delta, (1 - split) * delta};
                check_ok(gd_point_in_face(mesh, (struct gd_face){face}, at, &base, NULL), NULL);
                check_ok(gd_point_in_face(mesh, (struct gd_face){face}, off, &moved, NULL), NULL);
                struct gd_field *a = test_field_from(mesh, base), *b = test_field_from(mesh, moved);
                gd_field_vertex_distances(a, exact);
                gd_field_vertex_distances(b, near);
                for (uint32_t v = 0; v < count; v++) {
                    double excess =
                        fabs(exact[v] - near[v]) - 2 * delta * mesh->summary.edge_length.max;
                    if (excess > worst) worst = excess;
                }
                gd_field_release(a);
                gd_field_release(b);
            }
        }
    }
    print_message("# sources close to a vertex or an edge: worst excess %.1e\n", worst);
    assert_true(worst < 1e-12);
    free(exact);
    free(near);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Partial fields return final distances, or GD_BEYOND_REACH. */
static void partial_fields_answer_only_what_is_final(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_terrain(24, 0.3, 7, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct rng rng = {21};
    for (int i = 0; i < 20; i++) {
        struct gd_point source = test_point(mesh, test_random_place(&polygons, &rng));
        struct gd_point target = test_point(mesh, test_random_place(&polygons, &rng));
        struct gd_field *whole = test_field_from(mesh, source), *partial;
        struct gd_seed seed = {.point = source};
        struct gd_field_request request = {.seeds = &seed,
                                           .seed_count = 1,
                                           .target = i % 2 ? &target : NULL,
                                           .radius = i % 2 ? 0 : 0.3};
        check_ok(gd_field_build(mesh, &request, NULL, &partial, NULL), NULL);
        double expected, actual;
        if (i % 2) {
            check_ok(gd_field_distance(whole, &target, &expected), NULL);
            check_ok(gd_field_distance(partial, &target, &actual), NULL);
            check_close(actual, expected, 1e-13);
            assert_true(gd_field_reach(partial) >= expected && isfinite(gd_field_reach(partial)));
        }
        uint32_t beyond = 0;
        for (int k = 0; k < 300; k++) {
            struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
            check_ok(gd_field_distance(whole, &point, &expected), NULL);
            enum gd_status status = gd_field_distance(partial, &point, &actual);
            if (status) {
                assert_int_equal(status, GD_BEYOND_REACH);
                assert_true(expected > gd_field_reach(partial) * (1 - 1e-12));
                beyond++;
            } else {
                check_close(actual, expected, 1e-13);
            }
        }
        if (!(i % 2)) assert_true(beyond > 0);
        assert_true(gd_field_statistics(partial)->windows_propagated <=
                    gd_field_statistics(whole)->windows_propagated);
        gd_field_release(whole);
        gd_field_release(partial);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static bool stop_at_once(void *user, double fraction)
{
    (void)fraction;
    ++*(int *)user;
    return false;
}

static void budget_deadline_and_cancel(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_torus(60, 30, 2, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_vertex(mesh, 0)};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    struct gd_field *field = NULL;
    struct gd_detail detail;
    int calls = 0;
    struct gd_control budget = {.budget_bytes = 100000}, late = {.deadline_ns = 1},
                      cancel = {.progress = stop_at_once, .user = &calls};
    assert_int_equal(gd_field_build(mesh, &request, &budget, &field, &detail), GD_BUDGET);
    assert_int_equal(gd_field_build(mesh, &request, &late, &field, &detail), GD_DEADLINE);
    assert_int_equal(gd_field_build(mesh, &request, &cancel, &field, &detail), GD_CANCELLED);
    assert_int_equal(calls, 1);
    request.seed_count = 0;
    assert_int_equal(gd_field_build(mesh, &request, NULL, &field, &detail), GD_INVALID_ARGUMENT);
    request.seed_count = 1;
    seed.offset = -1;
    assert_int_equal(gd_field_build(mesh, &request, NULL, &field, &detail), GD_INVALID_ARGUMENT);
    assert_null(field);
    seed.offset = 0;
    check_ok(gd_field_build(mesh, &request, NULL, &field, &detail), &detail);
    struct gd_all_wedges all;
    calls = 0;
    assert_int_equal(gd_field_all_wedges(field, &budget, &all), GD_BUDGET);
    assert_null(all.wedges);
    assert_int_equal(gd_field_all_wedges(field, &late, &all), GD_DEADLINE);
    assert_int_equal(gd_field_all_wedges(field, &cancel, &all), GD_CANCELLED);
    assert_null(all.first);
    assert_int_equal(calls, 1);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* With several seeds and offsets the distance is the minimum, over the seeds, of offset plus
 * distance. The path ends in a seed. */
static void several_seeds(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_genus2(6, 0.05, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct rng rng = {33};
    enum { SEEDS = 5 };
    struct gd_seed seeds[SEEDS];
    struct gd_field *single[SEEDS], *all;
    for (int i = 0; i < SEEDS; i++) {
        seeds[i] = (struct gd_seed){.point = test_point(mesh, test_random_place(&polygons, &rng)),
                                    .offset = 0.1 * i};
        single[i] = test_field_from(mesh, seeds[i].point);
    }
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = SEEDS},
                            NULL, &all, NULL),
             NULL);
    for (int k = 0; k < 2000; k++) {
        struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
        double least = INFINITY, actual, one;
        for (int i = 0; i < SEEDS; i++) {
            check_ok(gd_field_distance(single[i], &point, &one), NULL);
            least = fmin(least, one + seeds[i].offset);
        }
        check_ok(gd_field_distance(all, &point, &actual), NULL);
        check_close(actual, least, 1e-12);
        struct gd_path path;
        check_ok(gd_field_path(all, &point, &path), NULL);
        bool at_seed = false;
        for (int i = 0; i < SEEDS; i++)
            at_seed |= gd_point_equal(&path.points[path.count - 1], &seeds[i].point);
        assert_true(at_seed);
        gd_path_free(&path);
    }
    for (int i = 0; i < SEEDS; i++) gd_field_release(single[i]);
    gd_field_release(all);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* A call that computes only distances, and stores no wedges, gives the distances of a field.
 * Radius, unreferenced vertices and errors have the same effects as for a field. */
static void distances_only(void **state)
{
    (void)state;
    double positions[5][3] = {{0, 0, 0}, {9, 9, 9}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    uint32_t corners[6] = {0, 2, 3, 0, 3, 4};
    struct gd_mesh *mesh = test_mesh(&(struct gd_polygons){
        .positions = positions, .position_count = 5, .polygon_count = 2, .corners = corners});
    struct gd_seed seed = {.point = test_vertex(mesh, 2), .offset = 0.5};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1, .radius = 1.75};
    double out[5];
    check_ok(gd_field_distances_only(mesh, &request, NULL, out, NULL), NULL);
    assert_true(isnan(out[1]) && out[2] == 0.5 && isinf(out[4]));
    check_close(out[3], 1.5, 1e-15);
    seed.offset = -1;
    assert_int_equal(gd_field_distances_only(mesh, &request, NULL, out, NULL), GD_INVALID_ARGUMENT);
    assert_true(out[2] == 0.5);
    gd_mesh_release(mesh);
}

/* The distances of vertices and points of edges and faces equal those of a field to the last bit,
 * with one seed or several, and with a radius. */
static void distances_of_points_equal_those_of_a_field(void **state)
{
    (void)state;
    enum { POINTS = 300, SEEDS = 3 };
    struct gd_polygons polygons;
    check_ok(sample_terrain(48, 0.3, 7, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct rng rng = {31};
    struct gd_point points[POINTS];
    struct gd_seed seeds[SEEDS];
    double kept[POINTS], only[POINTS];
    for (int i = 0; i < POINTS; i++)
        points[i] = test_point(mesh, test_random_place(&polygons, &rng));
    for (int i = 0; i < SEEDS; i++)
        seeds[i] = (struct gd_seed){.point = points[i], .offset = 0.01 * i};
    for (int i = 0; i < 4; i++) {
        const struct gd_field_request request = {.seeds = seeds,
                                                 .seed_count = i < 2 ? 1 : SEEDS,
                                                 .radius = i % 2 ? 0.3 : 0,
                                                 .points = points,
                                                 .point_count = POINTS};
        struct gd_field *field;
        check_ok(gd_field_build(mesh, &request, NULL, &field, NULL), NULL);
        check_ok(gd_field_distances(field, points, POINTS, NULL, kept), NULL);
        check_ok(gd_field_distances_only(mesh, &request, NULL, only, NULL), NULL);
        assert_memory_equal(kept, only, sizeof kept);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void distances_only_equal_those_of_a_field(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_terrain(48, 0.3, 7, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_vertex(mesh, 1111)};
    struct gd_field *field = test_field_from(mesh, seed.point);
    uint32_t count = gd_mesh_summary(mesh)->index_count;
    double *kept = malloc(sizeof *kept * count), *only = malloc(sizeof *only * count);
    gd_field_vertex_distances(field, kept);
    check_ok(gd_field_distances_only(mesh,
                                     &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                                     NULL, only, NULL),
             NULL);
    for (uint32_t i = 0; i < count; i++) check_close(only[i], kept[i], 1e-14);
    free(kept);
    free(only);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(example_1),
        cmocka_unit_test(wedges_partition_their_edge),
        cmocka_unit_test(seeds_on_an_edge_cover_it),
        cmocka_unit_test(correct_wedges_do_not_cross),
        cmocka_unit_test(sources_close_to_a_vertex_or_an_edge),
        cmocka_unit_test(partial_fields_answer_only_what_is_final),
        cmocka_unit_test(budget_deadline_and_cancel),
        cmocka_unit_test(several_seeds),
        cmocka_unit_test(distances_only),
        cmocka_unit_test(distances_only_equal_those_of_a_field),
        cmocka_unit_test(distances_of_points_equal_those_of_a_field),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
