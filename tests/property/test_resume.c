/* Tests that a resumed field has the distances of a field that was built in one call. Uses random
 * surfaces and real scans. Seeds are points, with and without offsets, and segments. Fields are
 * resumed from small radii and from targets, in one step and in several, by each kernel. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/cpu.h"
#include "gd/field.h"
#include "tests/samples/samples.h"
#include "tests/support/shared.h"

enum { MOST_SEEDS = 16, POINTS = 40 };

/* A surface, seeds on it, and the whole field of these seeds. */
struct scene {
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
    struct gd_seed seeds[MOST_SEEDS];
    uint32_t seed_count;
    struct gd_field *whole;
    double farthest; /* largest distance of a vertex */
    struct rng rng;
};

static struct gd_field *build(const struct scene *scene, double radius,
                              const struct gd_point *target)
{
    struct gd_field *field;
    struct gd_detail detail = {0};
    const struct gd_field_request request = {
        .seeds = scene->seeds, .seed_count = scene->seed_count, .radius = radius, .target = target};
    check_ok(gd_field_build(scene->mesh, &request, NULL, &field, &detail), &detail);
    return field;
}

/* Resumes and releases a partial field. */
static struct gd_field *resumed(struct gd_field *partial, double radius)
{
    struct gd_field *field;
    struct gd_detail detail = {0};
    check_ok(gd_field_resume(partial, radius, NULL, &field, &detail), &detail);
    gd_field_release(partial);
    return field;
}

static double farthest_vertex(const struct gd_mesh *mesh, const struct gd_field *field)
{
    uint32_t count = gd_mesh_summary(mesh)->index_count;
    double *distances = malloc(count * sizeof *distances), farthest = 0;
    gd_field_vertex_distances(field, distances);
    for (uint32_t i = 0; i < count; i++)
        if (isfinite(distances[i])) farthest = fmax(farthest, distances[i]);
    free(distances);
    return farthest;
}

/* --- scenes ----------------------------------------------------------------------------------- */

/* Adds a segment within a face, and its ends. */
static void put_segment(struct scene *scene, double offset)
{
    struct test_place a = test_random_place(&scene->polygons, &scene->rng), b = a;
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += b.weight[k] = 0.01 + rng_unit(&scene->rng);
    for (int k = 0; k < 3; k++) b.weight[k] /= sum;
    struct gd_point ends[2] = {test_point(scene->mesh, a), test_point(scene->mesh, b)};
    for (int i = 0; i < 2; i++)
        scene->seeds[scene->seed_count++] = (struct gd_seed){.point = ends[i], .offset = offset};
    if (gd_point_equal(&ends[0], &ends[1])) return;
    scene->seeds[scene->seed_count++] =
        (struct gd_seed){.point = ends[0], .end = ends[1], .is_segment = true, .offset = offset};
}

/* Adds 1 to 3 points or segments as seeds. The first one has no offset. */
static void put_seeds(struct scene *scene, double size)
{
    uint32_t members = 1 + rng_below(&scene->rng, 3);
    scene->seed_count = 0;
    for (uint32_t i = 0; i < members; i++) {
        double offset = i ? size * rng_unit(&scene->rng) : 0;
        if (rng_below(&scene->rng, 2))
            put_segment(scene, offset);
        else
            scene->seeds[scene->seed_count++] = (struct gd_seed){
                .point = test_point(scene->mesh, test_random_place(&scene->polygons, &scene->rng)),
                .offset = offset};
    }
}

/* Opens a scene and takes ownership of the polygons. */
static void open_scene(struct scene *scene, struct gd_polygons polygons, uint64_t seed)
{
    *scene = (struct scene){.polygons = polygons, .mesh = test_mesh(&polygons), .rng = {seed}};
    const struct gd_mesh_summary *summary = gd_mesh_summary(scene->mesh);
    put_seeds(scene, 4 * summary->edge_length.mean);
    scene->whole = build(scene, 0, NULL);
    scene->farthest = farthest_vertex(scene->mesh, scene->whole);
}

static void close_scene(struct scene *scene)
{
    gd_field_release(scene->whole);
    gd_mesh_release(scene->mesh);
    gd_polygons_free(&scene->polygons);
}

/* --- the comparison --------------------------------------------------------------------------- */

static double check_point(const struct scene *scene, const struct gd_field *field,
                          const struct gd_point *point)
{
    double expected, distance;
    check_ok(gd_field_distance(scene->whole, point, &expected), NULL);
    enum gd_status status = gd_field_distance(field, point, &distance);
    if (status == GD_BEYOND_REACH) {
        assert_true(expected > gd_field_reach(field) * (1 - 1e-12));
        return 0;
    }
    check_ok(status, NULL);
    /* there is no path, or its length exceeds the reach of the field */
    if (isinf(expected) || isinf(distance)) {
        assert_true(isinf(expected) && isinf(distance));
        return 0;
    }
    return check_close(distance, expected, 1e-12);
}

/* Checks the distances of all vertices and some random points, and that paths to these points
 * exist. */
static double check_field(struct scene *scene, const struct gd_field *field)
{
    double worst = 0, radius = gd_field_reach(field);
    uint32_t count = gd_mesh_summary(scene->mesh)->index_count;
    double *a = malloc(count * sizeof *a), *b = malloc(count * sizeof *b);
    gd_field_vertex_distances(scene->whole, a);
    gd_field_vertex_distances(field, b);
    for (uint32_t i = 0; i < count; i++)
        if (a[i] <= radius * (1 - 1e-12) && a[i] < INFINITY)
            worst = fmax(worst, check_close(b[i], a[i], 1e-12));
    free(a);
    free(b);
    for (int i = 0; i < POINTS; i++) {
        struct gd_point point =
            test_point(scene->mesh, test_random_place(&scene->polygons, &scene->rng));
        worst = fmax(worst, check_point(scene, field, &point));
        struct gd_path path;
        enum gd_status status = gd_field_path(field, &point, &path);
        if (status != GD_BEYOND_REACH && status != GD_NOT_ON_SURFACE) {
            check_ok(status, NULL);
            gd_path_free(&path);
        }
    }
    return worst;
}

/* --- tests ------------------------------------------------------------------------------------ */

/* Resumes a field to twice its radius, to the whole mesh, and in several steps. */
static double check_scene(struct scene *scene)
{
    static const double parts[] = {0.001, 0.03, 0.15, 0.4, 0.7, 0.97};
    double worst = 0;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        double radius = parts[i] * scene->farthest;
        struct gd_field *field = resumed(build(scene, radius, NULL), 2 * radius);
        worst = fmax(worst, check_field(scene, field));
        field = resumed(field, 0);
        worst = fmax(worst, check_field(scene, field));
        gd_field_release(field);
        field = resumed(build(scene, radius, NULL), 0);
        worst = fmax(worst, check_field(scene, field));
        gd_field_release(field);
    }
    struct gd_field *field = build(scene, 0.02 * scene->farthest, NULL);
    for (int step = 2; step <= 10; step++) {
        field = resumed(field, 0.1 * step * scene->farthest);
        worst = fmax(worst, check_field(scene, field));
    }
    gd_field_release(field);
    return worst;
}

/* Tests a field with a target. The propagation of such a field ends at a bound that decreases
 * meanwhile. */
static double check_targets(struct scene *scene)
{
    double worst = 0;
    for (int i = 0; i < 4; i++) {
        struct gd_point target =
            test_point(scene->mesh, test_random_place(&scene->polygons, &scene->rng));
        struct gd_field *field = build(scene, 0, &target);
        /* the target is on another component, so the field is complete */
        if (isinf(gd_field_reach(field))) {
            gd_field_release(field);
            continue;
        }
        if (gd_field_reach(field) > 0) { /* the target is not a seed */
            field = resumed(field, 1.5 * gd_field_reach(field));
            worst = fmax(worst, check_field(scene, field));
        }
        field = resumed(field, 0);
        worst = fmax(worst, check_field(scene, field));
        gd_field_release(field);
    }
    return worst;
}

static void random_surfaces(void **state)
{
    (void)state;
    double worst = 0;
    for (uint32_t i = 0; i < 150; i++) {
        struct scene scene;
        struct gd_polygons polygons;
        check_ok(sample_tangle(20 + 3 * i, i, &polygons), NULL);
        open_scene(&scene, polygons, 100 + i);
        worst = fmax(worst, check_scene(&scene));
        worst = fmax(worst, check_targets(&scene));
        close_scene(&scene);
    }
    print_message("# worst relative error %.1e\n", worst);
}

static void terrains(void **state)
{
    (void)state;
    double worst = 0;
    for (uint32_t i = 0; i < 6; i++) {
        struct scene scene;
        struct gd_polygons polygons;
        check_ok(sample_terrain(24, 0.1 + 0.3 * i, i, &polygons), NULL);
        open_scene(&scene, polygons, 7 + i);
        worst = fmax(worst, check_scene(&scene));
        worst = fmax(worst, check_targets(&scene));
        close_scene(&scene);
    }
    print_message("# worst relative error %.1e\n", worst);
}

/* Tests flat faces with many ties, slivers, and very small and very large meshes. */
static void boxes_and_slivers(void **state)
{
    (void)state;
    struct gd_polygons polygons[3];
    check_ok(sample_box((double[3]){1e-6, 2e-6, 3e-6}, (uint32_t[3]){4, 5, 6}, &polygons[0]), NULL);
    check_ok(sample_grid(200, 3, 1, 40, &polygons[1]), NULL);
    check_ok(sample_cylinder(1e3, 1e6, 12, 8, &polygons[2]), NULL);
    double worst = 0;
    for (uint32_t i = 0; i < 3; i++) {
        struct scene scene;
        open_scene(&scene, polygons[i], 70 + i);
        worst = fmax(worst, check_scene(&scene));
        worst = fmax(worst, check_targets(&scene));
        close_scene(&scene);
    }
    print_message("# worst relative error %.1e\n", worst);
}

/* Tests that all kernels compute the same distances bit for bit. */
static void kernels_agree(void **state)
{
    (void)state;
    static const char *const kernels[] = {"baseline", "avx2", "avx512"};
    struct scene scene;
    struct gd_polygons polygons;
    check_ok(sample_terrain(40, 0.3, 3, &polygons), NULL);
    open_scene(&scene, polygons, 5);
    uint32_t count = gd_mesh_summary(scene.mesh)->index_count;
    double *first = malloc(count * sizeof *first), *distances = malloc(count * sizeof *distances);
    int compared = 0;
    for (int k = 0; k < 3; k++) {
        if (gd_cpu_select(kernels[k])) continue;
        struct gd_field *field = resumed(build(&scene, 0.4 * scene.farthest, NULL), 0);
        gd_field_vertex_distances(field, compared ? distances : first);
        if (compared++) assert_memory_equal(distances, first, count * sizeof *first);
        gd_field_release(field);
    }
    check_ok(gd_cpu_select("auto"), NULL);
    print_message("# %d kernels compared\n", compared);
    free(first);
    free(distances);
    close_scene(&scene);
}

static void shared_meshes(void **state)
{
    (void)state;
    static const char *const names[] = {"spot", "fandisk", "rocker-arm", "stanford-bunny"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        struct scene scene;
        open_scene(&scene, test_shared_polygons(names[n]), n);
        struct gd_field *field =
            resumed(build(&scene, 0.3 * scene.farthest, NULL), 0.6 * scene.farthest);
        double worst = check_field(&scene, field);
        field = resumed(field, 0);
        worst = fmax(worst, check_field(&scene, field));
        print_message("# %s: worst relative error %.1e, wedges %llu against %llu\n", names[n],
                      worst, (unsigned long long)gd_field_statistics(field)->wedges,
                      (unsigned long long)gd_field_statistics(scene.whole)->wedges);
        gd_field_release(field);
        worst = fmax(worst, check_targets(&scene));
        close_scene(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_surfaces), cmocka_unit_test(terrains),
        cmocka_unit_test(boxes_and_slivers), cmocka_unit_test(kernels_agree),
        cmocka_unit_test(shared_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
