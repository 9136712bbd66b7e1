#include "tests/support/laws.h"

#include <math.h>
#include <stdlib.h>

#include "gd/query.h"

static const double promise = 1e-9;

static struct gd_pair_answer solve(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q,
                                   bool want_path)
{
    struct gd_pair_answer answer = {0};
    struct gd_detail detail = {0};
    check_ok(gd_pair_solve(mesh,
                           &(struct gd_pair_request){.from = &p, .to = &q, .output = want_path},
                           NULL, &answer, &detail),
             &detail);
    return answer;
}

double law_distance(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q)
{
    struct gd_pair_answer answer = solve(mesh, p, q, false);
    gd_pair_answer_free(&answer);
    return answer.distance;
}

double law_metric(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q,
                  struct gd_point r)
{
    double pq = law_distance(mesh, p, q), pr = law_distance(mesh, p, r),
           rq = law_distance(mesh, r, q);
    assert_true(law_distance(mesh, p, p) == 0);
    assert_true(gd_point_equal(&p, &q) || pq > 0);
    double error = check_close(law_distance(mesh, q, p), pq, promise);
    assert_true(pq <= (pr + rq) * (1 + promise));
    return error;
}

/* Returns whether the closed face contains the point. */
static bool is_in_face(const struct gd_polygons *polygons, uint32_t face,
                       const struct gd_point_description *point)
{
    if (point->kind == GD_POINT_FACE) return point->face.index == face;
    uint32_t wanted = point->kind == GD_POINT_EDGE ? 2 : 1, found = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t corner = polygons->corners[3 * face + (uint32_t)k];
        if (point->kind == GD_POINT_EDGE)
            found += corner == point->edge[0].index || corner == point->edge[1].index;
        else
            found += corner == point->vertex.index;
    }
    return found == wanted;
}

static bool share_face(const struct gd_polygons *polygons, const struct gd_point_description *a,
                       const struct gd_point_description *b)
{
    for (uint32_t f = 0; f < polygons->polygon_count; f++)
        if (is_in_face(polygons, f, a) && is_in_face(polygons, f, b)) return true;
    return false;
}

double law_path(const struct gd_mesh *mesh, const struct gd_polygons *polygons, struct gd_point p,
                struct gd_point q)
{
    struct gd_pair_answer answer = solve(mesh, p, q, true);
    const struct gd_path *path = &answer.path;
    assert_true(path->count > 0);
    assert_true(gd_point_equal(&path->points[0], &p));
    assert_true(gd_point_equal(&path->points[path->count - 1], &q));
    double length = 0;
    struct gd_point_description here, next;
    gd_point_describe(mesh, &path->points[0], &here);
    for (uint32_t i = 1; i < path->count; i++, here = next) {
        gd_point_describe(mesh, &path->points[i], &next);
        assert_true(share_face(polygons, &here, &next));
        length += gd_vec3_distance(here.xyz, next.xyz);
    }
    double error = fmax(check_close(path->length, answer.distance, promise),
                        check_close(length, answer.distance, promise));
    gd_pair_answer_free(&answer);
    return error;
}

void law_lipschitz(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                   struct gd_point p)
{
    struct gd_seed seed = {.point = p};
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                            &field, &detail),
             &detail);
    double *distance = calloc(polygons->position_count, sizeof *distance);
    assert_non_null(distance);
    gd_field_vertex_distances(field, distance);
    gd_field_release(field);
    for (uint32_t slot = 0; slot < 3 * polygons->polygon_count; slot++) {
        uint32_t a = polygons->corners[slot],
                 b = polygons->corners[slot % 3 == 2 ? slot - 2 : slot + 1];
        if (isinf(distance[a]) && isinf(distance[b])) continue;
        double length = gd_vec3_distance(gd_mesh_position(mesh, (struct gd_vertex){a}),
                                         gd_mesh_position(mesh, (struct gd_vertex){b}));
        assert_true(fabs(distance[a] - distance[b]) <= length + promise * (distance[a] + length));
    }
    free(distance);
}
