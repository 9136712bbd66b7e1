/* Fuzzes the geometry: any small soup of polygons is refused by name, or becomes a surface on which
 * distances and paths keep their laws. The bytes are vertex coordinates on a coarse lattice (so
 * that ties, flats and folds abound), faces, and what is to be mended before. */
#include <math.h>

#include "gd/query.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum {
    MOST_VERTICES = 24,
    MOST_FACES = 40,
    LEAST_VERTICES = 3,
    COUNTS = MOST_VERTICES - LEAST_VERTICES + 1
};

struct soup {
    double positions[MOST_VERTICES][3];
    uint32_t corners[4 * MOST_FACES], first[MOST_FACES + 1];
    uint32_t vertices, faces;
    struct gd_mesh_options options;
};

static uint8_t next(const uint8_t **data, size_t *size)
{
    if (*size == 0) return 0;
    --*size;
    return *(*data)++;
}

static void read_soup(const uint8_t *data, size_t size, struct soup *soup)
{
    uint8_t first = next(&data, &size), mend = first / COUNTS;
    soup->vertices = LEAST_VERTICES + first % COUNTS;
    double scale = ldexp(1, (int)(int8_t)next(&data, &size)),
           squeeze = ldexp(1, -(next(&data, &size) % 24));
    soup->options = (struct gd_mesh_options){
        .repair_split = mend & 1, .weld = mend & 2, .weld_tolerance = mend & 4 ? 0.125 * scale : 0};
    for (uint32_t v = 0; v < soup->vertices; v++)
        for (int k = 0; k < 3; k++)
            soup->positions[v][k] =
                (int8_t)next(&data, &size) * 0.125 * scale * (k == 2 ? squeeze : 1);
    soup->faces = soup->first[0] = 0;
    while (size >= 3 && soup->faces < MOST_FACES) {
        uint8_t kind = next(&data, &size);
        uint32_t corners = kind % 8 == 0 ? 4 : 3, at = soup->first[soup->faces];
        for (uint32_t k = 0; k < corners; k++)
            soup->corners[at + k] = next(&data, &size) % soup->vertices;
        soup->first[++soup->faces] = at + corners;
    }
}

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
                          &(struct gd_pair_request){.from = from, .to = to, .wish = GD_PAIR_PATH},
                          NULL, &answer, NULL) == GD_OK);
    double distance = answer.distance;
    promise(distance >= 0);
    if (isfinite(distance)) {
        struct gd_vec3 p = gd_point_position(mesh, from), q = gd_point_position(mesh, to);
        /* of points that lie this close to each other */
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
    read_soup(data, size, &soup);
    struct gd_polygons polygons = {.positions = soup.positions,
                                   .position_count = soup.vertices,
                                   .polygon_count = soup.faces,
                                   .corners = soup.corners,
                                   .first = soup.first};
    struct gd_mesh *mesh;
    struct gd_detail detail = {.text = ""};
    enum gd_status status = gd_mesh_build(&polygons, &soup.options, NULL, &mesh, &detail);
    if (status) {
        promise(detail.text[0] != '\0' && status != GD_INTERNAL);
        return 0;
    }
    promise(gd_mesh_repair(mesh)->largest_shift >= 0 &&
            isfinite(gd_mesh_repair(mesh)->largest_shift));
    uint32_t seed = 0;
    for (size_t i = 0; i < size; i++) seed = seed * 31 + data[i];
    check_laws(mesh, seed);
    gd_mesh_release(mesh);
    return 0;
}
