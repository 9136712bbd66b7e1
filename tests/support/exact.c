#include "tests/support/exact.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/samples/transform.h"

/* --- scenes ----------------------------------------------------------------------------------- */

static void require(bool condition, const char *what)
{
    if (condition) return;
    fprintf(stderr, "exact: %s\n", what);
    abort();
}

static enum gd_status make_graded(struct rng *rng, struct gd_polygons *out)
{
    struct sample_grading grading = {.patches = 1 + rng_below(rng, 2),
                                     .sectors = 5 + rng_below(rng, 3),
                                     .rings = 5 + rng_below(rng, 8)};
    grading.ratio = pow(10, rng_between(rng, log10(3), 2));
    grading.bend = rng_below(rng, 3) ? rng_between(rng, -1, 1) : 0;
    grading.noise = rng_between(rng, 0, 0.4);
    return sample_graded(&grading, rng_next(rng), out);
}

/* Uses as many rings as needed to avoid faces that the engine rejects as degenerate. */
static enum gd_status make_tube(struct rng *rng, struct gd_polygons *out)
{
    double radius = pow(10, rng_between(rng, -8.3, -6));
    return sample_cylinder(radius, 1, 3 + rng_below(rng, 3), 4 + (uint32_t)(4e-7 / radius), out);
}

static enum gd_status make_needles(struct rng *rng, struct gd_polygons *out)
{
    uint32_t cells = 4 + rng_below(rng, 4);
    double roughness = rng_between(rng, 0.1, 1.5), stretch = pow(10, rng_between(rng, 4, 5.5));
    enum gd_status status = sample_terrain(cells, roughness, rng_next(rng), out);
    for (uint32_t i = 0; !status && i < out->position_count; i++) out->positions[i][0] *= stretch;
    return status;
}

static enum gd_status make_polygons(enum exact_kind kind, struct rng *rng, struct gd_polygons *out)
{
    enum gd_status status = GD_OK;
    uint64_t seed = rng_next(rng);
    switch (kind) {
    case EXACT_TERRAIN:
        return sample_terrain(4 + rng_below(rng, 9), rng_between(rng, 0.1, 1.5), seed, out);
    case EXACT_SPHERE:
        status = sample_icosphere(1 + rng_below(rng, 2), 1, out);
        if (!status) sample_jitter(out, out->polygon_count > 80 ? 0.08 : 0.2, seed);
        return status;
    case EXACT_TORUS:
        status = sample_torus(6 + rng_below(rng, 11), 4 + rng_below(rng, 6), 1,
                              rng_between(rng, 0.2, 0.7), out);
        if (!status && rng_below(rng, 2)) sample_jitter(out, 0.03, seed);
        return status;
    case EXACT_TUBE:
        return make_tube(rng, out);
    case EXACT_NEEDLES:
        return make_needles(rng, out);
    default:
        return make_graded(rng, out);
    }
}

static void measure(struct exact_scene *scene)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(scene->mesh);
    struct gd_vec3 side = gd_vec3_sub(summary->max, summary->min);
    scene->size = fmax(side.x, fmax(side.y, side.z));
    scene->mean_edge = summary->edge_length.mean;
}

/* Returns false if noise made a face too flat for the engine. */
static bool build(struct exact_scene *scene)
{
    if (gd_mesh_build(&scene->polygons, NULL, NULL, &scene->mesh, NULL) != GD_OK) return false;
    scene->naive = naive_mesh_create((const double(*)[3])scene->polygons.positions,
                                     scene->polygons.position_count, scene->polygons.corners,
                                     scene->polygons.polygon_count);
    require(scene->naive, "out of memory");
    measure(scene);
    return true;
}

void exact_scene_open_at(enum exact_kind kind, uint64_t seed, double offset,
                         struct exact_scene *out)
{
    *out = (struct exact_scene){.kind = kind, .rng = {seed}};
    for (;;) {
        require(make_polygons(kind, &out->rng, &out->polygons) == GD_OK, "out of memory");
        for (uint32_t i = 0; i < out->polygons.position_count; i++)
            for (int k = 0; k < 3; k++) out->polygons.positions[i][k] += 2 * offset;
        if (build(out)) return;
        gd_polygons_free(&out->polygons);
    }
}

void exact_scene_open(enum exact_kind kind, uint64_t seed, struct exact_scene *out)
{
    exact_scene_open_at(kind, seed, 0, out);
}

void exact_scene_from(struct gd_polygons polygons, struct exact_scene *out)
{
    *out = (struct exact_scene){.polygons = polygons};
    require(build(out), "the engine refuses the mesh");
}

void exact_scene_close(struct exact_scene *scene)
{
    gd_mesh_release(scene->mesh);
    naive_mesh_free(scene->naive);
    gd_polygons_free(&scene->polygons);
}

/* --- points ----------------------------------------------------------------------------------- */

struct naive_point exact_point(const struct exact_scene *scene, const struct gd_point *point)
{
    struct gd_point_description description;
    gd_point_describe(scene->mesh, point, &description);
    struct naive_point out = {.face = description.face.index};
    memcpy(out.weight, description.barycentric, sizeof out.weight);
    return out;
}

static struct gd_point in_face(const struct exact_scene *scene, uint32_t face,
                               const double weight[3])
{
    struct gd_point point = {0};
    require(gd_point_in_face(scene->mesh, (struct gd_face){face}, weight, &point, NULL) == GD_OK,
            "no such point");
    return point;
}

struct gd_point exact_random(struct exact_scene *scene)
{
    struct rng *rng = &scene->rng;
    double weight[3] = {0};
    uint32_t face = rng_below(rng, scene->polygons.polygon_count), corners = 1 + rng_below(rng, 3),
             first = rng_below(rng, 3);
    double rest = 1;
    for (uint32_t k = 0; k + 1 < corners; k++) {
        double part = rest * rng_between(rng, 0.01, 0.99);
        weight[(first + k) % 3] = part;
        rest -= part;
    }
    weight[(first + corners - 1) % 3] = rest;
    return in_face(scene, face, weight);
}

uint32_t exact_random_vertex(struct exact_scene *scene)
{
    return scene->polygons.corners[rng_below(&scene->rng, 3 * scene->polygons.polygon_count)];
}

/* Returns a random face at the vertex. Sets *corner to the vertex' corner in this face. */
static uint32_t face_around(struct exact_scene *scene, uint32_t vertex, uint32_t *corner)
{
    uint32_t slots = 3 * scene->polygons.polygon_count, slot = rng_below(&scene->rng, slots);
    while (scene->polygons.corners[slot] != vertex) slot = (slot + 1) % slots;
    *corner = slot % 3;
    return slot / 3;
}

static struct gd_point on_edge(const struct exact_scene *scene, uint32_t from, uint32_t to,
                               double t)
{
    struct gd_point point = {0};
    require(gd_point_on_edge(scene->mesh, (struct gd_vertex[]){{from}, {to}}, t, &point, NULL) ==
                GD_OK,
            "no such edge");
    return point;
}

struct gd_point exact_beside_vertex(struct exact_scene *scene, uint32_t vertex, double least,
                                    double most)
{
    struct rng *rng = &scene->rng;
    uint32_t k = 0, face = face_around(scene, vertex, &k), kind = rng_below(rng, 4);
    const uint32_t *corner = &scene->polygons.corners[3 * face];
    double apart = pow(10, rng_between(rng, least, most)), part = rng_unit(rng);
    if (kind == 0) return on_edge(scene, vertex, corner[(k + 1) % 3], apart);
    if (kind == 1) return on_edge(scene, corner[(k + 2) % 3], vertex, 1 - apart);
    if (kind == 2) part = pow(10, rng_between(rng, -6, 0)); /* also close to an edge */
    double weight[3];
    weight[(k + 1) % 3] = apart * part;
    weight[(k + 2) % 3] = apart * (1 - part);
    weight[k] = 1 - apart;
    return in_face(scene, face, weight);
}

struct gd_point exact_beside_edge(struct exact_scene *scene, double least, double most)
{
    struct rng *rng = &scene->rng;
    uint32_t k = rng_below(rng, 3), face = rng_below(rng, scene->polygons.polygon_count);
    double apart = pow(10, rng_between(rng, least, most)), t = rng_between(rng, 0.01, 0.99);
    double weight[3];
    weight[k] = apart;
    weight[(k + 1) % 3] = (1 - apart) * t;
    weight[(k + 2) % 3] = (1 - apart) * (1 - t);
    return in_face(scene, face, weight);
}

/* --- comparison ------------------------------------------------------------------------------- */

static void solve(struct exact_truth *truth, enum naive_precision precision)
{
    naive_field_free(truth->field);
    truth->is_quadruple = precision == NAIVE_QUADRUPLE;
    truth->field = naive_field_solve(truth->scene->naive, precision, truth->sources, truth->count,
                                     truth->radius);
    require(truth->field, "the solver gave up");
}

void exact_truth_open(const struct exact_scene *scene, const struct gd_seed *seeds, uint32_t count,
                      long double radius, struct exact_truth *out)
{
    *out = (struct exact_truth){.scene = scene, .count = count, .radius = radius};
    out->sources = calloc(count, sizeof *out->sources);
    require(out->sources, "out of memory");
    for (uint32_t i = 0; i < count; i++)
        out->sources[i] =
            (struct naive_source){exact_point(scene, &seeds[i].point), seeds[i].offset};
    solve(out, scene->kind == EXACT_TUBE ? NAIVE_QUADRUPLE : NAIVE_EXTENDED);
}

void exact_truth_close(struct exact_truth *truth)
{
    naive_field_free(truth->field);
    free(truth->sources);
}

double exact_distance(struct exact_truth *truth, const struct gd_point *point)
{
    struct naive_point at = exact_point(truth->scene, point);
    return (double)naive_field_distance(truth->field, &at);
}

double exact_relative(double a, double b)
{
    return a == b ? 0 : fabs(a - b) / fmax(fabs(a), fabs(b));
}

double exact_error(struct exact_truth *truth, const struct gd_point *point, double distance)
{
    double error = exact_relative(distance, exact_distance(truth, point));
    if (error <= EXACT_PROMISE || truth->is_quadruple) return error;
    solve(truth, NAIVE_QUADRUPLE);
    return exact_relative(distance, exact_distance(truth, point));
}
