#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/cpu.h"
#include "gd/locate.h"
#include "tests/samples/samples.h"

/* Selects the kernels that GEODESICD_CPU names, before any test runs. */
__attribute__((constructor)) static void select_kernels(void)
{
    const char *name = getenv("GEODESICD_CPU");
    if (!name || gd_cpu_select(name) == GD_OK) return;
    fprintf(stderr, "GEODESICD_CPU=%s: no such kernels on this machine.\n", name);
    exit(EXIT_FAILURE);
}

double test_check_close(double actual, double expected, double relative, const char *file, int line)
{
    if (actual == expected) return 0;
    double error = fabs(actual - expected) / fmax(fabs(actual), fabs(expected));
    if (!(error <= relative)) {
        print_error("%.17g is not %.17g: relative error %.3g > %.3g\n", actual, expected, error,
                    relative);
        _fail(file, line);
    }
    return error;
}

void test_check_ok(enum gd_status status, const struct gd_detail *detail, const char *file,
                   int line)
{
    if (status == GD_OK) return;
    print_error("%s: %s (%s)\n", gd_status_name(status), gd_status_sentence(status),
                detail ? detail->text : "");
    _fail(file, line);
}

struct gd_mesh *test_mesh(const struct gd_polygons *polygons)
{
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    check_ok(gd_mesh_build(polygons, NULL, NULL, &mesh, &detail), &detail);
    return mesh;
}

struct gd_mesh *test_sample(const char *name, const double *values, struct gd_polygons *polygons)
{
    struct gd_polygons own;
    check_ok(sample_find(name)->generate(values, &own), NULL);
    struct gd_mesh *mesh = test_mesh(&own);
    if (polygons)
        *polygons = own;
    else
        gd_polygons_free(&own);
    return mesh;
}

struct test_place test_random_place(const struct gd_polygons *polygons, struct rng *rng)
{
    struct test_place place = {.face = rng_below(rng, polygons->polygon_count)};
    uint32_t corners = 1 + rng_below(rng, 3), first = rng_below(rng, 3);
    double rest = 1;
    for (uint32_t k = 0; k + 1 < corners; k++) {
        double part = rest * rng_between(rng, 0.01, 0.99);
        place.weight[(first + k) % 3] = part;
        rest -= part;
    }
    place.weight[(first + corners - 1) % 3] = rest;
    return place;
}

void test_place_position(const struct gd_polygons *polygons, struct test_place place, double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = 0;
        for (uint32_t k = 0; k < 3; k++)
            out[axis] +=
                place.weight[k] * polygons->positions[polygons->corners[3 * place.face + k]][axis];
    }
}

struct gd_point test_point(const struct gd_mesh *mesh, struct test_place place)
{
    struct gd_point point = {0};
    struct gd_detail detail = {0};
    check_ok(gd_point_in_face(mesh, (struct gd_face){place.face}, place.weight, &point, &detail),
             &detail);
    return point;
}

struct gd_point test_vertex(const struct gd_mesh *mesh, uint32_t index)
{
    struct gd_point point = {0};
    struct gd_detail detail = {0};
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){index}, &point, &detail), &detail);
    return point;
}

struct gd_point test_point_near(const struct gd_mesh *mesh, double x, double y, double z)
{
    struct gd_point point = {0};
    struct gd_detail detail = {0};
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){x, y, z}, -1, &point, &detail), &detail);
    return point;
}

char *test_read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    char *bytes = NULL;
    if (fseek(file, 0, SEEK_END) == 0) {
        long length = ftell(file);
        rewind(file);
        bytes = length < 0 ? NULL : malloc((size_t)length + 1);
        *size = bytes ? fread(bytes, 1, (size_t)length, file) : 0;
        if (bytes) bytes[*size] = '\0';
    }
    fclose(file);
    return bytes;
}
