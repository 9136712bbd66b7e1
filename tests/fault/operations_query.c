/* Queries: pairs of points, landmarks, sampling, curves and their distances. */
#include "tests/fault/operations.h"

#include <stdlib.h>

#include "gd/curve_distance.h"
#include "gd/query.h"
#include "gd/sampling.h"
#include "gd/workspace.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

enum { PLACES = 8, SAMPLES = 6 };

static struct gd_mesh *mesh;
static struct gd_point places[PLACES];
static struct gd_landmarks *landmarks;
static struct gd_workspace *workspace;
static struct gd_field *field, *of_curve;
static struct gd_curve first, second;
static void *image;

static struct gd_curve through(const struct gd_point *points, uint32_t count, bool closed)
{
    struct gd_curve curve;
    check_ok(gd_curve_resolve(
                 mesh,
                 &(struct gd_curve_request){
                     .kind = GD_CURVE_POINTS, .points = points, .count = count, .closed = closed},
                 NULL, &curve, NULL),
             NULL);
    return curve;
}

static struct gd_field *field_of_curve(const struct gd_curve *curve)
{
    struct gd_field *made;
    uint32_t count = gd_curve_seed_count(curve);
    struct gd_seed *seeds = malloc(count * sizeof *seeds);
    gd_curve_seeds(curve, 0, seeds);
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = count},
                            NULL, &made, NULL),
             NULL);
    free(seeds);
    return made;
}

static void open_queries(void)
{
    struct gd_polygons polygons;
    struct rng rng = {9};
    check_ok(sample_terrain(14, 0.5, 3, &polygons), NULL);
    mesh = test_mesh(&polygons);
    for (int i = 0; i < PLACES; i++)
        places[i] = test_point(mesh, test_random_place(&polygons, &rng));
    gd_polygons_free(&polygons);
    check_ok(gd_landmarks_build(mesh, 4, NULL, &landmarks), NULL);
    image = malloc(gd_landmarks_image_size(landmarks));
    gd_landmarks_write_image(landmarks, image);
    workspace = gd_workspace_create();
    check_ok(gd_field_build(mesh,
                            &(struct gd_field_request){
                                .seeds = &(struct gd_seed){.point = places[0]}, .seed_count = 1},
                            NULL, &field, NULL),
             NULL);
    first = through(places, 3, false);
    second = through(places + 5, 3, true);
    of_curve = field_of_curve(&first);
}

/* --- answers ---------------------------------------------------------------------------------- */

static void digest_pair(struct digest *digest, const void *out)
{
    const struct gd_pair_answer *answer = out;
    digest_number(digest, answer->distance);
    digest_path(digest, &answer->path);
}

static void discard_pair(void *out)
{
    gd_pair_answer_free(out);
}

static void digest_landmarks(struct digest *digest, const void *out)
{
    const struct gd_landmarks *made = *(struct gd_landmarks *const *)out;
    size_t size = gd_landmarks_image_size(made);
    void *bytes = malloc(size);
    gd_landmarks_write_image(made, bytes);
    digest_bytes(digest, bytes, size);
    free(bytes);
}

static void discard_landmarks(void *out)
{
    gd_landmarks_release(*(struct gd_landmarks **)out);
}

struct sampled {
    struct gd_point points[SAMPLES];
    double radii[SAMPLES];
};

static void digest_sampled(struct digest *digest, const void *out)
{
    const struct sampled *sampled = out;
    digest_path(digest,
                &(struct gd_path){.count = SAMPLES, .points = (struct gd_point *)sampled->points});
    digest_bytes(digest, sampled->radii, sizeof sampled->radii);
}

static void digest_line(struct digest *digest, const void *out)
{
    digest_curve(digest, out);
}

static void discard_line(void *out)
{
    gd_curve_free(out);
}

static void digest_between(struct digest *digest, const void *out)
{
    const struct gd_curve_distance *found = out;
    digest_number(digest, found->distance);
    digest_number(digest, found->a.parameter);
    digest_number(digest, found->b.parameter);
    digest_path(digest, &found->path);
}

static void discard_between(void *out)
{
    gd_curve_distance_free(out);
}

static const struct answer a_pair = {sizeof(struct gd_pair_answer), digest_pair, discard_pair};
static const struct answer some_landmarks = {sizeof(struct gd_landmarks *), digest_landmarks,
                                             discard_landmarks};
static const struct answer a_sample = {sizeof(struct sampled), digest_sampled, NULL};
static const struct answer a_curve = {sizeof(struct gd_curve), digest_line, discard_line};
static const struct answer between = {sizeof(struct gd_curve_distance), digest_between,
                                      discard_between};

/* --- calls ------------------------------------------------------------------------------------ */

static enum gd_status search(const struct gd_landmarks *with, const struct gd_control *control,
                             void *out)
{
    struct gd_detail detail = {0};
    return gd_pair_solve(
        mesh,
        &(struct gd_pair_request){
            .from = &places[1], .to = &places[6], .output = GD_PAIR_PATH, .landmarks = with},
        control, out, &detail);
}

static enum gd_status search_pair(void *out)
{
    return search(NULL, NULL, out);
}

static enum gd_status search_by_landmarks(void *out)
{
    return search(landmarks, NULL, out);
}

static enum gd_status search_in_workspace(void *out)
{
    return search(landmarks, &(struct gd_control){.workspace = workspace}, out);
}

static void trim(void)
{
    gd_workspace_trim(workspace);
}

static enum gd_status ask_field(void *out)
{
    return gd_pair_from_field(field, &places[0], &places[4], true, out);
}

static enum gd_status build_landmarks(void *out)
{
    return gd_landmarks_build(mesh, 3, NULL, out);
}

static enum gd_status open_image(void *out)
{
    return gd_landmarks_open_image(mesh, image, gd_landmarks_image_size(landmarks), out);
}

static enum gd_status sample(void *out)
{
    struct sampled *sampled = out;
    return gd_sampling_farthest(
        mesh, NULL, NULL, &(struct gd_sampling){SAMPLES, sampled->points, sampled->radii}, NULL);
}

static enum gd_status resolve(const struct gd_curve_request *request, void *out)
{
    struct gd_detail detail = {0};
    struct gd_curve_request own = *request;
    own.landmarks = landmarks;
    return gd_curve_resolve(mesh, &own, NULL, out, &detail);
}

static enum gd_status resolve_points(void *out)
{
    return resolve(
        &(struct gd_curve_request){
            .kind = GD_CURVE_POINTS, .points = places, .count = PLACES, .closed = true},
        out);
}

static enum gd_status resolve_vertices(void *out)
{
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){50}, corners);
    return resolve(
        &(struct gd_curve_request){
            .kind = GD_CURVE_VERTICES, .vertices = corners, .count = 3, .closed = true},
        out);
}

static enum gd_status resolve_boundary(void *out)
{
    return resolve(&(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY}, out);
}

static enum gd_status nearest_of_curves(void *out)
{
    return gd_curve_distance(of_curve, &first, &second, NULL, out);
}

static enum gd_status farthest_of_curves(void *out)
{
    return gd_curve_farthest(of_curve, &first, &second, NULL, out);
}

static const struct operation items[] = {
    {"search of a pair", &a_pair, search_pair, GD_OK, NULL},
    {"search of a pair by landmarks", &a_pair, search_by_landmarks, GD_OK, NULL},
    {"search of a pair in a workspace", &a_pair, search_in_workspace, GD_OK, trim},
    {"pair from a field", &a_pair, ask_field, GD_OK, NULL},
    {"landmarks", &some_landmarks, build_landmarks, GD_OK, NULL},
    {"landmarks from an image", &some_landmarks, open_image, GD_OK, NULL},
    {"farthest-point sampling", &a_sample, sample, GD_OK, NULL},
    {"curve through points", &a_curve, resolve_points, GD_OK, NULL},
    {"curve along edges", &a_curve, resolve_vertices, GD_OK, NULL},
    {"curve along a boundary", &a_curve, resolve_boundary, GD_OK, NULL},
    {"distance of two curves", &between, nearest_of_curves, GD_OK, NULL},
    {"Hausdorff distance of two curves", &between, farthest_of_curves, GD_OK, NULL},
};

const struct operations query_operations = {open_queries, items, COUNT(items)};
