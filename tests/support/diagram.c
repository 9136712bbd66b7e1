#include "tests/support/diagram.h"

#include <math.h>
#include <stdlib.h>

#include "gd/query.h"
#include "mesh/topology.h"
#include "tests/support/field.h"

static const double promise = 1e-9;

/* number of sections of an edge; check_edges tests the ends of the sections */
enum { SECTIONS = 4 };

/* --- members ---------------------------------------------------------------------------------- */

static void put_seed(struct member_set *set, struct gd_seed seed, uint32_t member)
{
    set->seeds = realloc(set->seeds, sizeof *set->seeds * (set->seed_count + 1));
    set->member_of_seed =
        realloc(set->member_of_seed, sizeof *set->member_of_seed * (set->seed_count + 1));
    assert_true(set->seeds && set->member_of_seed);
    set->seeds[set->seed_count] = seed;
    set->member_of_seed[set->seed_count++] = member;
}

void member_set_put_point(struct member_set *set, struct gd_point point, double offset)
{
    put_seed(set, (struct gd_seed){.point = point, .offset = offset}, set->count++);
}

void member_set_put_curve(struct member_set *set, const struct gd_point *points, uint32_t count,
                          bool closed, double offset)
{
    for (uint32_t i = 0; i < count; i++)
        put_seed(set, (struct gd_seed){.point = points[i], .offset = offset}, set->count);
    for (uint32_t i = closed ? 0 : 1; i < count; i++) {
        const struct gd_point *from = &points[i ? i - 1 : count - 1];
        put_seed(set,
                 (struct gd_seed){
                     .point = *from, .offset = offset, .is_segment = true, .end = points[i]},
                 set->count);
    }
    set->count++;
}

void member_set_put_path(struct member_set *set, const struct gd_mesh *mesh, struct gd_point from,
                         struct gd_point to)
{
    struct gd_pair_answer answer;
    check_ok(gd_pair_solve(
                 mesh, &(struct gd_pair_request){.from = &from, .to = &to, .output = GD_PAIR_PATH},
                 NULL, &answer, NULL),
             NULL);
    member_set_put_curve(set, answer.path.points, answer.path.count, false, 0);
    gd_pair_answer_free(&answer);
}

void member_set_join(struct member_set *set)
{
    set->count--;
    for (uint32_t i = 0; i < set->seed_count; i++)
        if (set->member_of_seed[i] == set->count) set->member_of_seed[i]--;
}

void member_set_free(struct member_set *set)
{
    free(set->seeds);
    free(set->member_of_seed);
    *set = (struct member_set){0};
}

/* --- diagrams --------------------------------------------------------------------------------- */

/* Returns the field of one member, whose seeds are consecutive. */
static struct gd_field *field_of_member(const struct gd_mesh *mesh, const struct member_set *set,
                                        uint32_t member)
{
    uint32_t first = 0, count = 0;
    while (set->member_of_seed[first] != member) first++;
    while (first + count < set->seed_count && set->member_of_seed[first + count] == member) count++;
    return test_field(mesh, set->seeds + first, count, 0);
}

/* Returns the largest finite distance of a vertex. */
static double greatest_distance(const struct gd_field *field)
{
    uint32_t vertices = gd_mesh_summary(gd_field_mesh(field))->index_count;
    double *distance = malloc(sizeof *distance * vertices), greatest = 0;
    gd_field_vertex_distances(field, distance);
    for (uint32_t i = 0; i < vertices; i++)
        if (isfinite(distance[i])) greatest = fmax(greatest, distance[i]);
    free(distance);
    return greatest;
}

struct diagram diagram_of(const struct gd_mesh *mesh, const struct member_set *set,
                          double tolerance)
{
    struct diagram diagram = {
        .mesh = mesh, .set = set, .field = test_field(mesh, set->seeds, set->seed_count, 0)};
    diagram.alone = malloc(sizeof *diagram.alone * set->count);
    for (uint32_t i = 0; i < set->count; i++) {
        diagram.alone[i] = field_of_member(mesh, set, i);
        diagram.size = fmax(diagram.size, greatest_distance(diagram.alone[i]));
    }
    check_ok(
        gd_voronoi_trace(diagram.field, set->member_of_seed, tolerance, NULL, &diagram.voronoi),
        NULL);
    return diagram;
}

void diagram_free(struct diagram *diagram)
{
    gd_voronoi_free(&diagram->voronoi);
    for (uint32_t i = 0; i < diagram->set->count; i++) gd_field_release(diagram->alone[i]);
    free(diagram->alone);
    gd_field_release(diagram->field);
}

uint32_t diagram_ends_at(const struct diagram *diagram, const struct gd_point *point)
{
    struct gd_vec3 at = gd_point_position(diagram->mesh, point);
    uint32_t ends = 0;
    for (uint32_t i = 0; i < diagram->voronoi.bisector_count; i++) {
        const struct gd_bisector *b = &diagram->voronoi.bisectors[i];
        struct gd_vec3 first = gd_point_position(diagram->mesh, &b->points[0]),
                       last = gd_point_position(diagram->mesh, &b->points[b->point_count - 1]);
        if (b->closed) continue;
        ends += gd_vec3_distance(first, at) < promise * diagram->size;
        ends += gd_vec3_distance(last, at) < promise * diagram->size;
    }
    return ends;
}

double diagram_length(const struct diagram *diagram)
{
    double length = 0;
    for (uint32_t i = 0; i < diagram->voronoi.bisector_count; i++)
        length += diagram->voronoi.bisectors[i].length;
    return length;
}

/* --- bisectors -------------------------------------------------------------------------------- */

static double distance_of(const struct gd_field *field, const struct gd_point *point)
{
    double distance;
    check_ok(gd_field_distance(field, point, &distance), NULL);
    return distance;
}

static void fail_at(const struct diagram *diagram, const struct gd_bisector *bisector,
                    const struct gd_point *point, const char *what)
{
    struct gd_vec3 at = gd_point_position(diagram->mesh, point);
    print_error("members %u %u: %s at %.17g %.17g %.17g\n", bisector->members[0],
                bisector->members[1], what, at.x, at.y, at.z);
    fail();
}

/* Checks that both members are equidistant and that no member is nearer. */
static void check_point(const struct diagram *diagram, const struct gd_bisector *bisector,
                        const struct gd_point *point)
{
    double least = distance_of(diagram->field, point);
    for (int i = 0; i < 2; i++) {
        double own = distance_of(diagram->alone[bisector->members[i]], point);
        if (fabs(own - least) <= promise * fmax(least, 0.1 * diagram->size)) continue;
        print_error("member %u is at %.17g instead of %.17g\n", bisector->members[i], own, least);
        fail_at(diagram, bisector, point, "a vertex");
    }
}

static bool is_on_boundary(const struct gd_mesh *mesh, const struct gd_point *point)
{
    if (point->kind == GD_POINT_VERTEX)
        return mesh->vertex_kind[point->element] == GD_VERTEX_BOUNDARY;
    if (point->kind == GD_POINT_FACE) return false;
    return gd__side_is_boundary(mesh, 2 * point->element) ||
           gd__side_is_boundary(mesh, 2 * point->element + 1);
}

/* Checks that an end is on the boundary or that at least three bisectors end there. */
static void check_end(const struct diagram *diagram, const struct gd_bisector *bisector, uint32_t i)
{
    const struct gd_point *point = &bisector->points[i];
    if (is_on_boundary(diagram->mesh, point) || diagram_ends_at(diagram, point) >= 3) return;
    fail_at(diagram, bisector, point, "a loose end");
}

static void check_bisector(const struct diagram *diagram, const struct gd_bisector *bisector)
{
    double length = 0;
    assert_true(bisector->point_count >= 2);
    assert_true(bisector->members[0] < bisector->members[1] &&
                bisector->members[1] < diagram->set->count);
    for (uint32_t i = 0; i < bisector->point_count; i++) {
        check_point(diagram, bisector, &bisector->points[i]);
        if (i)
            length += gd_vec3_distance(gd_point_position(diagram->mesh, &bisector->points[i - 1]),
                                       gd_point_position(diagram->mesh, &bisector->points[i]));
    }
    assert_true(fabs(bisector->length - length) <= 1e-10 * length + 1e-14 * diagram->size);
    if (bisector->closed)
        assert_true(
            gd_point_equal(&bisector->points[0], &bisector->points[bisector->point_count - 1]));
    if (bisector->closed) return;
    check_end(diagram, bisector, 0);
    check_end(diagram, bisector, bisector->point_count - 1);
}

/* --- labels ----------------------------------------------------------------------------------- */

/* Checks that each vertex is labelled with a nearest member. */
static void check_labels(const struct diagram *diagram)
{
    uint32_t vertices = gd_mesh_summary(diagram->mesh)->index_count,
             *labels = malloc(sizeof *labels * vertices);
    double *least = malloc(sizeof *least * vertices), *own = malloc(sizeof *own * vertices);
    check_ok(gd_voronoi_labels(diagram->field, diagram->set->member_of_seed, labels), NULL);
    gd_field_vertex_distances(diagram->field, least);
    for (uint32_t i = 0; i < vertices; i++)
        assert_int_equal(labels[i] == UINT32_MAX, !isfinite(least[i]));
    for (uint32_t k = 0; k < diagram->set->count; k++) {
        gd_field_vertex_distances(diagram->alone[k], own);
        for (uint32_t i = 0; i < vertices; i++) {
            double slack = 1e-12 * least[i] + 1e-14 * diagram->size;
            if (labels[i] == k) assert_true(own[i] <= least[i] + slack);
            if (labels[i] != UINT32_MAX) assert_true(own[i] >= least[i] - slack);
        }
    }
    free(labels);
    free(least);
    free(own);
}

/* --- edges ------------------------------------------------------------------------------------ */

/* A crossing of a bisector and an edge. */
struct crossing {
    uint32_t edge;
    double t;
};

static int by_edge(const void *a, const void *b)
{
    const struct crossing *x = a, *y = b;
    if (x->edge != y->edge) return x->edge < y->edge ? -1 : 1;
    return (x->t > y->t) - (x->t < y->t);
}

static struct crossing *crossings_of(const struct diagram *diagram, uint32_t *count)
{
    uint32_t points = 0;
    for (uint32_t i = 0; i < diagram->voronoi.bisector_count; i++)
        points += diagram->voronoi.bisectors[i].point_count;
    struct crossing *crossings = malloc(sizeof *crossings * (points + 1));
    *count = 0;
    for (uint32_t i = 0; i < points; i++) {
        const struct gd_point *point = &diagram->voronoi.points[i];
        if (point->kind == GD_POINT_EDGE)
            crossings[(*count)++] = (struct crossing){point->element, point->weight[0]};
    }
    qsort(crossings, *count, sizeof *crossings, by_edge);
    return crossings;
}

static bool is_crossed(const struct crossing *crossings, uint32_t count, uint32_t edge, double from,
                       double to)
{
    uint32_t low = 0, high = count;
    struct crossing first = {edge, from - promise};
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (by_edge(&crossings[middle], &first) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && crossings[low].edge == edge && crossings[low].t <= to + promise;
}

static struct gd_point point_of_edge(const struct gd_mesh *mesh, uint32_t edge, double t)
{
    if (t == 0)
        return (struct gd_point){.kind = GD_POINT_VERTEX, .element = mesh->origin[2 * edge]};
    if (t == 1)
        return (struct gd_point){.kind = GD_POINT_VERTEX, .element = mesh->origin[2 * edge + 1]};
    return (struct gd_point){.kind = GD_POINT_EDGE, .element = edge, .weight = {t}};
}

/* Returns the nearest member, or UINT32_MAX if there is no nearest member or if there are
 * several. */
static uint32_t owner_of(const struct diagram *diagram, const struct gd_point *point)
{
    double least;
    uint32_t seed, as_near = 0;
    check_ok(gd_field_nearest(diagram->field, point, &least, &seed), NULL);
    if (seed == UINT32_MAX) return UINT32_MAX;
    for (uint32_t i = 0; i < diagram->set->count; i++)
        as_near += distance_of(diagram->alone[i], point) <= least + promise * diagram->size;
    return as_near == 1 ? diagram->set->member_of_seed[seed] : UINT32_MAX;
}

static void check_edges(const struct diagram *diagram)
{
    uint32_t count;
    struct crossing *crossings = crossings_of(diagram, &count);
    for (uint32_t edge = 0; edge < diagram->mesh->edge_count; edge++) {
        uint32_t last = UINT32_MAX;
        double from = 0;
        for (int i = 0; i <= SECTIONS; i++) {
            double t = (double)i / SECTIONS;
            struct gd_point point = point_of_edge(diagram->mesh, edge, t);
            uint32_t owner = owner_of(diagram, &point);
            if (owner == UINT32_MAX) continue;
            struct gd_vec3 at = gd_point_position(diagram->mesh, &point);
            if (last != UINT32_MAX && owner != last &&
                !is_crossed(crossings, count, edge, from, t)) {
                print_error("no bisector of %u and %u before %g %g %g\n", last, owner, at.x, at.y,
                            at.z);
                fail();
            }
            last = owner;
            from = t;
        }
    }
    free(crossings);
}

void check_diagram(const struct diagram *diagram)
{
    for (uint32_t i = 0; i < diagram->voronoi.bisector_count; i++)
        check_bisector(diagram, &diagram->voronoi.bisectors[i]);
    check_labels(diagram);
    check_edges(diagram);
}
