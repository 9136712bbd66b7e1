/* Fuzzes the geometry: any small set of polygons is refused with a specific error, or becomes a
 * surface on which distances and paths obey the laws of a metric. */
#include <math.h>

#include "gd/query.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/soup.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static struct gd_point some_point(const struct gd_mesh *mesh, uint32_t seed)
{
    uint32_t faces = gd_mesh_summary(mesh)->face_index_count, face = seed % faces;
    while (!gd_mesh_has_face(mesh, (struct gd_face){face})) face = (face + 1) % faces;
    double a = (seed >> 8) % 5 / 4.0, b = (1 - a) * ((seed >> 16) % 5 / 4.0);
    struct gd_point point;
    promise(gd_point_in_face(mesh, (struct gd_face){face}, (double[3]){a, b, 1 - a - b}, &point,
                             NULL) == GD_OK);
    return point;
}

static double ask(const struct gd_mesh *mesh, const struct gd_point *from,
                  const struct gd_point *to)
{
    struct gd_pair_answer answer;
    promise(gd_pair_solve(mesh,
                          &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH},
                          NULL, &answer, NULL) == GD_OK);
    double distance = answer.distance;
    promise(distance >= 0);
    if (isfinite(distance)) {
        struct gd_vec3 p = gd_point_position(mesh, from), q = gd_point_position(mesh, to);
        /* rounding error for points that lie this close to each other */
        double rounding = 1e-14 * gd_mesh_summary(mesh)->edge_length.max;
        promise(fabs(answer.path.length - distance) <= 1e-9 * distance + rounding);
        promise(distance >= gd_vec3_distance(p, q) * (1 - 1e-9) -
                                1e-12 * gd_mesh_summary(mesh)->edge_length.max);
    }
    gd_pair_answer_free(&answer);
    return distance;
}

static void check_laws(const struct gd_mesh *mesh, uint32_t seed)
{
    struct gd_point p = some_point(mesh, seed), q = some_point(mesh, seed * 7 + 3),
                    r = some_point(mesh, seed * 13 + 5);
    double pq = ask(mesh, &p, &q), qp = ask(mesh, &q, &p), pr = ask(mesh, &p, &r),
           rq = ask(mesh, &r, &q);
    double slack = 1e-9 * (pq + pr + rq) + 1e-12 * gd_mesh_summary(mesh)->edge_length.max;
    promise(isfinite(pq) == isfinite(qp));
    if (isfinite(pq)) promise(fabs(pq - qp) <= slack);
    if (isfinite(pr) && isfinite(rq)) promise(pq <= pr + rq + slack);
    promise(ask(mesh, &p, &p) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct soup soup;
    soup_read(data, size, &soup);
    struct gd_mesh *mesh = soup_build(&soup);
    if (!mesh) return 0;
    promise(gd_mesh_repair(mesh)->largest_shift >= 0 &&
            isfinite(gd_mesh_repair(mesh)->largest_shift));
    uint32_t seed = 0;
    for (size_t i = 0; i < size; i++) seed = seed * 31 + data[i];
    check_laws(mesh, seed);
    gd_mesh_release(mesh);
    return 0;
}
