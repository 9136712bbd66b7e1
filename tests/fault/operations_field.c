/* Fields: built, stored, queried. */
#include "tests/fault/operations.h"

#include <stdlib.h>
#include <string.h>

#include "gd/curve.h"
#include "gd/isoline.h"
#include "gd/voronoi.h"
#include "gd/workspace.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

enum { CELLS = 12, PLACES = 40, SEEDS = 6 };

static struct gd_mesh *mesh;
static struct gd_point places[PLACES];
static struct gd_seed seeds[SEEDS]; /* three points, and a segment with its ends */
static struct gd_field *field, *partial, *of_set;
static struct gd_workspace *workspace;
static struct gd_isoline isoline;
static void *image;
static size_t image_size;

static void choose_seeds(void)
{
    for (uint32_t i = 0; i < 3; i++)
        seeds[i] = (struct gd_seed){.point = places[i], .offset = 0.01 * i};
    struct gd_point a = test_point(mesh, (struct test_place){.face = 5, .weight = {0.2, 0.3, 0.5}}),
                    b = test_point(mesh, (struct test_place){.face = 5, .weight = {0.7, 0.2, 0.1}});
    seeds[3] = (struct gd_seed){.point = a};
    seeds[4] = (struct gd_seed){.point = b};
    seeds[5] = (struct gd_seed){.point = a, .end = b, .is_segment = true};
}

static enum gd_status build(struct gd_field_request request, const struct gd_control *control,
                            void *out)
{
    struct gd_detail detail = {0};
    return gd_field_build(mesh, &request, control, out, &detail);
}

static struct gd_field *make(struct gd_field_request request)
{
    struct gd_field *made;
    check_ok(build(request, NULL, &made), NULL);
    return made;
}

static void open_fields(void)
{
    struct gd_polygons polygons;
    struct rng rng = {4};
    check_ok(sample_terrain(CELLS, 0.4, 7, &polygons), NULL);
    mesh = test_mesh(&polygons);
    for (int i = 0; i < PLACES; i++)
        places[i] = test_point(mesh, test_random_place(&polygons, &rng));
    gd_polygons_free(&polygons);
    choose_seeds();
    field = make((struct gd_field_request){.seeds = seeds, .seed_count = 1});
    partial = make((struct gd_field_request){.seeds = seeds, .seed_count = SEEDS, .radius = 0.2});
    of_set = make((struct gd_field_request){.seeds = seeds, .seed_count = SEEDS});
    workspace = gd_workspace_create();
    check_ok(gd_isoline_trace(field, 0.4, NULL, &isoline), NULL);
    image_size = gd_field_image_size(field);
    image = aligned_alloc(64, (image_size + 63) / 64 * 64);
    gd_field_write_image(field, image);
}

/* --- answers ---------------------------------------------------------------------------------- */

static void digest_field(struct digest *digest, const void *out)
{
    const struct gd_field *made = *(struct gd_field *const *)out;
    uint32_t count = gd_mesh_summary(gd_field_mesh(made))->index_count;
    double *distances = malloc(count * sizeof *distances);
    gd_field_vertex_distances(made, distances);
    digest_bytes(digest, distances, count * sizeof *distances);
    free(distances);
    digest_number(digest, (double)gd_field_image_size(made));
    digest_number(digest, gd_field_reach(made));
}

static void discard_field(void *out)
{
    gd_field_release(*(struct gd_field **)out);
}

static void digest_way(struct digest *digest, const void *out)
{
    digest_path(digest, out);
}

static void discard_way(void *out)
{
    gd_path_free(out);
}

struct farthest {
    struct gd_point point;
    double distance;
};

static void digest_farthest(struct digest *digest, const void *out)
{
    const struct farthest *farthest = out;
    digest_path(digest, &(struct gd_path){.length = farthest->distance,
                                          .count = 1,
                                          .points = (struct gd_point *)&farthest->point});
}

struct wedges {
    struct gd_wedge *items;
    uint32_t count;
};

static void digest_wedges(struct digest *digest, const void *out)
{
    const struct wedges *wedges = out;
    for (uint32_t i = 0; i < wedges->count; i++)
        digest_bytes(digest, &wedges->items[i], 5 * sizeof(double));
}

static void discard_wedges(void *out)
{
    free(((struct wedges *)out)->items);
}

struct numbers {
    double at[(CELLS + 1) * (CELLS + 1)];
};

static void digest_vertices(struct digest *digest, const void *out)
{
    digest_bytes(digest, out, sizeof(struct numbers));
}

static void digest_places(struct digest *digest, const void *out)
{
    digest_bytes(digest, out, PLACES * sizeof(double));
}

static void digest_labels(struct digest *digest, const void *out)
{
    digest_bytes(digest, out, (CELLS + 1) * (CELLS + 1) * sizeof(uint32_t));
}

static void digest_isoline(struct digest *digest, const void *out)
{
    const struct gd_isoline *found = out;
    for (uint32_t i = 0; i < found->line_count; i++) {
        const struct gd_isoline_line *line = &found->lines[i];
        digest_number(digest, line->length);
        for (uint32_t k = 0; k < line->arc_count; k++) digest_number(digest, line->arcs[k].to);
    }
}

static void discard_isoline(void *out)
{
    gd_isoline_free(out);
}

static void digest_voronoi(struct digest *digest, const void *out)
{
    const struct gd_voronoi *found = out;
    for (uint32_t i = 0; i < found->bisector_count; i++) {
        const struct gd_bisector *line = &found->bisectors[i];
        digest_path(digest, &(struct gd_path){.length = line->length,
                                              .count = line->point_count,
                                              .points = (struct gd_point *)line->points});
    }
}

static void discard_voronoi(void *out)
{
    gd_voronoi_free(out);
}

static const struct answer a_field = {sizeof(struct gd_field *), digest_field, discard_field};
static const struct answer a_path = {sizeof(struct gd_path), digest_way, discard_way};
static const struct answer a_farthest = {sizeof(struct farthest), digest_farthest, NULL};
static const struct answer some_wedges = {sizeof(struct wedges), digest_wedges, discard_wedges};
static const struct answer at_vertices = {sizeof(struct numbers), digest_vertices, NULL};
static const struct answer at_places = {PLACES * sizeof(double), digest_places, NULL};
static const struct answer labels = {(CELLS + 1) * (CELLS + 1) * sizeof(uint32_t), digest_labels,
                                     NULL};
static const struct answer an_isoline = {sizeof(struct gd_isoline), digest_isoline,
                                         discard_isoline};
static const struct answer a_voronoi = {sizeof(struct gd_voronoi), digest_voronoi, discard_voronoi};

/* --- fields ----------------------------------------------------------------------------------- */

static enum gd_status build_point(void *out)
{
    return build((struct gd_field_request){.seeds = seeds, .seed_count = 1}, NULL, out);
}

static enum gd_status build_set(void *out)
{
    return build((struct gd_field_request){.seeds = seeds, .seed_count = SEEDS}, NULL, out);
}

static enum gd_status build_partial(void *out)
{
    return build((struct gd_field_request){.seeds = seeds, .seed_count = SEEDS, .radius = 0.2},
                 NULL, out);
}

static enum gd_status build_to_target(void *out)
{
    return build((struct gd_field_request){.seeds = seeds, .seed_count = 1, .target = &places[9]},
                 NULL, out);
}

static enum gd_status build_in_workspace(void *out)
{
    return build((struct gd_field_request){.seeds = seeds, .seed_count = SEEDS},
                 &(struct gd_control){.workspace = workspace}, out);
}

static enum gd_status build_from_spares(void *out)
{
    gd_spare_memory((size_t)1 << 30);
    return build_set(out);
}

static void trim(void)
{
    gd_workspace_trim(workspace);
}

static enum gd_status build_distances(void *out)
{
    return gd_field_distances_only(
        mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = SEEDS}, NULL, out, NULL);
}

static enum gd_status points_only(void *out)
{
    return gd_field_distances_only(
        mesh,
        &(struct gd_field_request){
            .seeds = seeds, .seed_count = SEEDS, .points = places, .point_count = PLACES},
        NULL, out, NULL);
}

static enum gd_status within(void *out)
{
    return gd_field_within(field, 0.3, out);
}

static enum gd_status open_image(void *out)
{
    struct gd_detail detail = {0};
    return gd_field_open_image(mesh, &(struct gd_field_image){image, image_size, NULL, NULL}, out,
                               &detail);
}

/* --- questions -------------------------------------------------------------------------------- */

static enum gd_status many_distances(void *out)
{
    return gd_field_distances(field, places, PLACES, NULL, out);
}

static enum gd_status path(void *out)
{
    return gd_field_path(field, &places[20], out);
}

static enum gd_status path_to_segment(void *out)
{
    uint32_t seed;
    return gd_field_path_to_seed(of_set, &places[30], out, &seed);
}

static enum gd_status farthest(void *out)
{
    struct farthest *found = out;
    return gd_field_farthest(of_set, NULL, &found->point, &found->distance);
}

static enum gd_status wedges(void *out)
{
    struct wedges *found = out;
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){100}, corners);
    return gd_field_wedges(of_set, corners[0], corners[1], &found->items, &found->count);
}

static enum gd_status trace_isoline(void *out)
{
    return gd_isoline_trace(of_set, 0.15, NULL, out);
}

static enum gd_status flatten_isoline(void *out)
{
    return gd_isoline_flatten(mesh, &isoline.lines[0], 1e-4, NULL, out);
}

static enum gd_status label(void *out)
{
    return gd_voronoi_labels(of_set, (const uint32_t[SEEDS]){0, 1, 2, 3, 3, 3}, out);
}

static enum gd_status trace_voronoi(void *out)
{
    return gd_voronoi_trace(of_set, (const uint32_t[SEEDS]){0, 1, 2, 3, 3, 3}, 1e-4, NULL, out);
}

static const struct operation items[] = {
    {"field of a point", &a_field, build_point, GD_OK, NULL},
    {"field of a set with a segment", &a_field, build_set, GD_OK, NULL},
    {"partial field", &a_field, build_partial, GD_OK, NULL},
    {"field to a target", &a_field, build_to_target, GD_OK, NULL},
    {"field in a workspace", &a_field, build_in_workspace, GD_OK, trim},
    {"field from spare memory", &a_field, build_from_spares, GD_OK, NULL},
    {"distances without a field", &at_vertices, build_distances, GD_OK, NULL},
    {"distances of points without a field", &at_places, points_only, GD_OK, NULL},
    {"field within a radius", &a_field, within, GD_OK, NULL},
    {"field from an image", &a_field, open_image, GD_OK, NULL},
    {"distances at points", &at_places, many_distances, GD_OK, NULL},
    {"path", &a_path, path, GD_OK, NULL},
    {"path to a segment", &a_path, path_to_segment, GD_OK, NULL},
    {"farthest point", &a_farthest, farthest, GD_OK, NULL},
    {"wedges of an edge", &some_wedges, wedges, GD_OK, NULL},
    {"isoline", &an_isoline, trace_isoline, GD_OK, NULL},
    {"isoline as a polyline", &a_path, flatten_isoline, GD_OK, NULL},
    {"Voronoi labels", &labels, label, GD_OK, NULL},
    {"Voronoi diagram", &a_voronoi, trace_voronoi, GD_OK, NULL},
};

const struct operations field_operations = {open_fields, items, COUNT(items)};
