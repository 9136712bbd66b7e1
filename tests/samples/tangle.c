/* Makes small random surfaces by a random walk. Each step keeps the surface a 2-manifold. A step
 * splits an edge or a face, flips an edge, or removes a face. It flips no edge if the new edge
 * exists already. It removes a face only if the other faces at each of its corners remain one
 * fan. */
#include <math.h>

#include "gd/vec.h"
#include "tests/samples/builder.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

/* Returns the face other than `but` with the edge a-b in either direction, or GD_NONE. Sets *apex
 * to its third corner. */
static uint32_t face_across(const struct gd_polygons *mesh, uint32_t but, uint32_t a, uint32_t b,
                            uint32_t *apex)
{
    for (uint32_t f = 0; f < mesh->polygon_count; f++) {
        const uint32_t *corner = &mesh->corners[3 * f];
        for (int k = 0; k < 3 && f != but; k++) {
            uint32_t c = corner[k], d = corner[(k + 1) % 3];
            *apex = corner[(k + 2) % 3];
            if ((c == a && d == b) || (c == b && d == a)) return f;
        }
    }
    return GD_NONE;
}

static void set_face(struct gd_polygons *mesh, uint32_t face, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corner = &mesh->corners[3 * face];
    corner[0] = a, corner[1] = b, corner[2] = c;
}

/* Adds a vertex at the fraction s of the line from the middle of a-b to c. */
static uint32_t add_between(struct sample_builder *builder, uint32_t a, uint32_t b, uint32_t c,
                            double s)
{
    const double *p = builder->mesh.positions[a], *q = builder->mesh.positions[b],
                 *r = builder->mesh.positions[c];
    double at[3];
    for (int k = 0; k < 3; k++) at[k] = 0.5 * (1 - s) * (p[k] + q[k]) + s * r[k];
    return sample_add_vertex(builder, at[0], at[1], at[2]);
}

static void split_face(struct sample_builder *builder, uint32_t face)
{
    const uint32_t *corner = &builder->mesh.corners[3 * face], a = corner[0], b = corner[1],
                   c = corner[2];
    uint32_t middle = add_between(builder, a, b, c, 1.0 / 3);
    if (builder->failed) return;
    set_face(&builder->mesh, face, a, b, middle);
    sample_add_triangle(builder, b, c, middle);
    sample_add_triangle(builder, c, a, middle);
}

static void split_edge(struct sample_builder *builder, uint32_t face)
{
    const uint32_t *corner = &builder->mesh.corners[3 * face], a = corner[0], b = corner[1],
                   c = corner[2];
    uint32_t d, other = face_across(&builder->mesh, face, a, b, &d),
                middle = add_between(builder, a, b, c, 0);
    if (builder->failed) return;
    set_face(&builder->mesh, face, a, middle, c);
    sample_add_triangle(builder, middle, b, c);
    if (other == GD_NONE) return;
    set_face(&builder->mesh, other, b, middle, d);
    sample_add_triangle(builder, middle, a, d);
}

static void flip_edge(struct gd_polygons *mesh, uint32_t face)
{
    const uint32_t *corner = &mesh->corners[3 * face], a = corner[0], b = corner[1], c = corner[2];
    uint32_t d, unused, other = face_across(mesh, face, a, b, &d);
    if (other == GD_NONE || face_across(mesh, GD_NONE, c, d, &unused) != GD_NONE) return;
    set_face(mesh, face, a, d, c);
    set_face(mesh, other, d, b, c);
}

/* Returns whether the vertex' faces form one fan. In one fan at most two edges of the vertex are on
 * the boundary. */
static bool is_one_fan(const struct gd_polygons *mesh, uint32_t vertex)
{
    uint32_t faces = 0, ends = 0, unused;
    for (uint32_t f = 0; f < mesh->polygon_count; f++) {
        for (int k = 0; k < 3; k++) {
            const uint32_t *corner = &mesh->corners[3 * f];
            if (corner[k] != vertex) continue;
            faces++;
            ends += face_across(mesh, f, vertex, corner[(k + 1) % 3], &unused) == GD_NONE;
            ends += face_across(mesh, f, vertex, corner[(k + 2) % 3], &unused) == GD_NONE;
        }
    }
    return faces == 0 || ends <= 2;
}

static void tear_face(struct gd_polygons *mesh, uint32_t face)
{
    uint32_t last = --mesh->polygon_count, *corner = &mesh->corners[3 * face],
             *moved = &mesh->corners[3 * last];
    for (int k = 0; k < 3; k++) {
        uint32_t torn = corner[k];
        corner[k] = moved[k];
        moved[k] = torn;
    }
    if (mesh->polygon_count > 0 && is_one_fan(mesh, moved[0]) && is_one_fan(mesh, moved[1]) &&
        is_one_fan(mesh, moved[2]))
        return;
    mesh->polygon_count++; /* the face stays and is the last face */
}

static enum gd_status make_start(struct rng *rng, struct gd_polygons *out)
{
    switch (rng_below(rng, 5)) {
    case 0:
        return sample_tetrahedron(1.5, 0, out);
    case 1:
        return sample_torus(3, 3, 1, 0.5, out);
    case 2:
        return sample_cylinder(0.7, 1, 3, 1, out);
    case 3:
        return sample_saddle(1, 0.8, 6, 1, out);
    default:
        return sample_grid(2, 2, 1.5, 1.5, out);
    }
}

static void mutate(struct sample_builder *builder, struct rng *rng)
{
    uint32_t face = rng_below(rng, builder->mesh.polygon_count), choice = rng_below(rng, 16);
    if (choice < 4)
        split_face(builder, face);
    else if (choice < 8)
        split_edge(builder, face);
    else if (choice < 15)
        flip_edge(&builder->mesh, face);
    else
        tear_face(&builder->mesh, face);
}

static double rounded(double x, double step)
{
    return step * round(x / step);
}

/* Returns whether no two vertices coincide after rounding of their coordinates. */
static bool stay_apart(const struct gd_polygons *mesh, double step)
{
    for (uint32_t i = 0; i < mesh->position_count; i++) {
        for (uint32_t j = 0; j < i; j++) {
            const double *p = mesh->positions[i], *q = mesh->positions[j];
            int same = 0;
            for (int k = 0; k < 3; k++) same += rounded(p[k], step) == rounded(q[k], step);
            if (same == 3) return false;
        }
    }
    return true;
}

/* Returns whether every face keeps an area after rounding of the coordinates. Exact on a
 * lattice. */
static bool stay_open(const struct gd_polygons *mesh, double step)
{
    for (uint32_t f = 0; f < mesh->polygon_count; f++) {
        struct gd_vec3 p[3];
        for (int k = 0; k < 3; k++) {
            const double *q = mesh->positions[mesh->corners[3 * f + (uint32_t)k]];
            p[k] = (struct gd_vec3){rounded(q[0], step), rounded(q[1], step), rounded(q[2], step)};
        }
        struct gd_vec3 normal = gd_vec3_cross(gd_vec3_sub(p[1], p[0]), gd_vec3_sub(p[2], p[0]));
        if (normal.x == 0 && normal.y == 0 && normal.z == 0) return false;
    }
    return true;
}

/* Moves the vertices to a coarse lattice, which gives many ties and flat vertices. */
static void snap(struct gd_polygons *mesh)
{
    double step = 0.5;
    while (step > 1e-6 && !(stay_apart(mesh, step) && stay_open(mesh, step))) step /= 2;
    for (uint32_t i = 0; i < mesh->position_count; i++)
        for (int k = 0; k < 3; k++) mesh->positions[i][k] = rounded(mesh->positions[i][k], step);
}

enum gd_status sample_tangle(uint32_t faces, uint64_t seed, struct gd_polygons *out)
{
    struct rng rng = {seed};
    struct sample_builder builder = {0};
    enum gd_status status = make_start(&rng, &builder.mesh);
    if (status != GD_OK) return status;
    builder.position_capacity = builder.mesh.position_count;
    builder.triangle_capacity = builder.mesh.polygon_count;
    for (uint32_t step = 0;
         step < 8 * faces && builder.mesh.polygon_count + 1 < faces && !builder.failed; step++)
        mutate(&builder, &rng);
    sample_jitter(&builder.mesh, rng_between(&rng, 0.01, 1.0), rng_next(&rng));
    switch (rng_below(&rng, 4)) {
    case 0:
        sample_scale(&builder.mesh, 1, 1, pow(10, -rng_between(&rng, 0, 4)));
        break;
    case 1:
        snap(&builder.mesh);
        break;
    default:
        break;
    }
    return sample_finish(&builder, out);
}
