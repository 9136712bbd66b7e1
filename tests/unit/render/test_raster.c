#include "tests/support/test.h"

#include <stdlib.h>

#include "render/shade.h"
#include "tests/samples/samples.h"

enum { SIDE = 96, GRID = 4 };

struct scene {
    struct gd_mesh *mesh;
    struct gd__screen_point *points;
    struct gd__raster raster;
    struct gd__arena arena;
};

/* Opens a scene in which x and y are pixels and z is the depth. */
static struct scene open_scene(struct gd_polygons *polygons, uint32_t rows)
{
    struct scene scene = {.mesh = test_mesh(polygons)};
    const struct gd_mesh *mesh = scene.mesh;
    scene.points = malloc(mesh->vertex_count * sizeof *scene.points);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        struct gd_vec3 p = gd_vec3_scale(mesh->position[v], mesh->unit);
        scene.points[v] = (struct gd__screen_point){(float)p.x, (float)p.y, (float)p.z};
    }
    scene.raster = (struct gd__raster){.mesh = mesh,
                                       .points = scene.points,
                                       .width = SIDE,
                                       .height = SIDE,
                                       .grid = GRID,
                                       .rows = rows};
    check_ok(gd__raster_open(&scene.raster, &scene.arena, NULL), NULL);
    return scene;
}

static void close_scene(struct scene *scene)
{
    gd__arena_free(&scene->arena);
    free(scene->points);
    gd_mesh_release(scene->mesh);
}

/* Calls `look` for each sample of the picture. */
static void each_sample(struct scene *scene,
                        void (*look)(void *user, uint32_t face, float depth, double x, double y),
                        void *user)
{
    struct gd__raster *raster = &scene->raster;
    for (uint32_t band = 0; band < raster->bands; band++) {
        check_ok(gd__raster_fill(raster, band, NULL), NULL);
        uint32_t first = band * raster->rows * GRID, end = first + raster->rows * GRID;
        for (uint32_t row = first; row < end && row < SIDE * GRID; row++)
            for (uint32_t i = 0; i < SIDE * GRID; i++) {
                size_t at = (size_t)(row - first) * SIDE * GRID + i;
                double x = (i + 0.5 + gd__raster_shift(GRID, row)) / GRID, y = (row + 0.5) / GRID;
                look(user, raster->face[at], raster->depth[at], x, y);
            }
    }
}

/* --- against every triangle at every sample --------------------------------------------------- */

enum { FACES = 60 };

struct soup {
    const struct scene *scene;
    uint64_t samples, covered, skipped;
};

/* Returns the face's depth at a sample. Returns INFINITY outside the face, and NAN on its border up
 * to rounding. */
static double depth_at(const struct scene *scene, uint32_t face, double x, double y)
{
    uint32_t v[3];
    gd__corners(scene->mesh, face, v);
    const struct gd__screen_point *p[3] = {&scene->points[v[0]], &scene->points[v[1]],
                                           &scene->points[v[2]]};
    double weight[3], area = 0, depth = 0, least = INFINITY;
    for (int k = 0; k < 3; k++) {
        const struct gd__screen_point *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        weight[k] = ((double)b->x - a->x) * (y - a->y) - ((double)b->y - a->y) * (x - a->x);
        area += weight[k];
    }
    for (int k = 0; k < 3; k++) {
        least = fmin(least, weight[k] / area);
        depth += weight[k] / area * p[k]->z;
    }
    return fabs(least) < 1e-5 ? NAN : least < 0 ? INFINITY : depth;
}

static void compare_sample(void *user, uint32_t face, float depth, double x, double y)
{
    struct soup *soup = user;
    double nearest = INFINITY, second = INFINITY;
    uint32_t winner = GD_NONE;
    soup->samples++;
    for (uint32_t f = 0; f < soup->scene->mesh->face_count; f++) {
        double z = depth_at(soup->scene, f, x, y);
        if (isnan(z)) nearest = second = -INFINITY;
        if (z < nearest) {
            second = nearest;
            nearest = z;
            winner = f;
        } else if (z < second) {
            second = z;
        }
    }
    if (isinf(nearest) && nearest < 0) winner = GD_NONE;
    if ((isinf(nearest) && nearest < 0) || (winner != GD_NONE && second - nearest < 0.01)) {
        soup->skipped++;
        return;
    }
    assert_int_equal(face, winner);
    if (winner == GD_NONE) {
        assert_true(isinf(depth));
        return;
    }
    soup->covered++;
    assert_true(fabs(depth - nearest) < 2e-3);
}

/* Uses random triangles, some of which are partly outside the picture. */
static void nearest_face_at_every_sample(void **state)
{
    (void)state;
    struct rng rng = {5};
    for (int round = 0; round < 6; round++) {
        double positions[3 * FACES][3];
        uint32_t corners[3 * FACES];
        for (uint32_t i = 0; i < 3 * FACES; i++) {
            for (int k = 0; k < 3; k++) positions[i][k] = rng_between(&rng, -20, SIDE + 20);
            corners[i] = i;
        }
        struct gd_polygons polygons = {positions, 3 * FACES, FACES, corners, NULL};
        struct scene scene = open_scene(&polygons, round % 2 ? 16 : 7);
        struct soup soup = {.scene = &scene};
        each_sample(&scene, compare_sample, &soup);
        assert_int_equal(soup.samples, (uint64_t)SIDE * SIDE * GRID * GRID);
        assert_true(soup.covered > soup.samples / 2 && soup.skipped < soup.samples / 10);
        close_scene(&scene);
    }
}

/* --- neighbours ------------------------------------------------------------------------------- */

static void count_covered(void *user, uint32_t face, float depth, double x, double y)
{
    uint64_t *count = user;
    bool is_inside = x > 3.3 && x < 90.3 && y > 3.3 && y < 90.3;
    (void)depth;
    assert_int_equal(face != GD_NONE, is_inside);
    *count += face != GD_NONE;
}

/* Tests a sheet of many triangles with displaced inner vertices. Samples inside the sheet are
 * covered; other samples are not. */
static void no_gaps_between_neighbours(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct rng rng = {9};
    uint64_t covered = 0;
    check_ok(sample_grid(60, 60, 87, 87, &polygons), NULL);
    for (uint32_t i = 0; i < polygons.position_count; i++) {
        double *p = polygons.positions[i];
        for (int k = 0; k < 2; k++)
            if (p[k] > 1 && p[k] < 86) p[k] += rng_between(&rng, -0.5, 0.5);
        for (int k = 0; k < 2; k++) p[k] += 3.3;
    }
    struct scene scene = open_scene(&polygons, 16);
    each_sample(&scene, count_covered, &covered);
    assert_true(covered > 0);
    close_scene(&scene);
    gd_polygons_free(&polygons);
}

/* --- control ---------------------------------------------------------------------------------- */

static bool refuse(void *user, double fraction)
{
    (void)user;
    (void)fraction;
    return false;
}

static void work_within_a_band_can_be_cancelled(void **state)
{
    (void)state;
    double positions[3 * FACES][3];
    uint32_t corners[3 * FACES];
    for (uint32_t i = 0; i < 3 * FACES; i++) {
        positions[i][0] = i % 3 == 1 ? 3 * SIDE : 0;
        positions[i][1] = i % 3 == 2 ? 3 * SIDE : 0;
        positions[i][2] = i / 3;
        corners[i] = i;
    }
    struct gd_polygons polygons = {positions, 3 * FACES, FACES, corners, NULL};
    struct scene scene = open_scene(&polygons, SIDE);
    const struct gd_control control = {.progress = refuse};
    assert_int_equal(gd__raster_fill(&scene.raster, 0, &control), GD_CANCELLED);
    close_scene(&scene);
}

static bool count_down(void *user, double fraction)
{
    uint32_t *checks = user;
    (void)fraction;
    return (*checks)-- > 0;
}

static enum gd_status colour_band(struct scene *scene, struct gd__shade *shade, uint32_t band,
                                  uint32_t checks, struct gd__image *image)
{
    const struct gd_control control = {.progress = count_down, .user = &checks};
    check_ok(gd__raster_fill(&scene->raster, band, NULL), NULL);
    return gd__shade_band(shade, band, &control, image);
}

/* Fragments of a band that was cancelled are not coloured in the next band. */
static void a_cancelled_band_leaves_no_fragments(void **state)
{
    (void)state;
    static uint8_t pixels[2][SIDE * SIDE][4];
    struct gd__image images[2] = {{SIDE, SIDE, true, pixels[0]}, {SIDE, SIDE, true, pixels[1]}};
    struct gd_polygons polygons;
    struct rng rng = {5};
    check_ok(sample_grid(40, 40, SIDE, SIDE, &polygons), NULL);
    for (uint32_t i = 0; i < polygons.position_count; i++)
        polygons.positions[i][2] = rng_between(&rng, -2, 2);
    struct scene scene = open_scene(&polygons, SIDE / 2);
    struct gd__camera camera =
        gd__camera_aim(scene.mesh, (struct gd_vec3){0, 0, 1}, (struct gd_vec3){0, 1, 0});
    struct gd__shade shade = {.raster = &scene.raster,
                              .camera = &camera,
                              .palette = gd__palette(GD_BACKGROUND_WHITE),
                              .range = 1};
    check_ok(gd__shade_open(&shade, &scene.arena, NULL), NULL);
    check_ok(colour_band(&scene, &shade, 1, UINT32_MAX, &images[0]), NULL);
    assert_int_equal(colour_band(&scene, &shade, 0, 5, &images[1]), GD_CANCELLED);
    check_ok(colour_band(&scene, &shade, 1, UINT32_MAX, &images[1]), NULL);
    assert_memory_equal(pixels[0], pixels[1], sizeof pixels[0]);
    close_scene(&scene);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(nearest_face_at_every_sample),
                                       cmocka_unit_test(no_gaps_between_neighbours),
                                       cmocka_unit_test(work_within_a_band_can_be_cancelled),
                                       cmocka_unit_test(a_cancelled_band_leaves_no_fragments)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
