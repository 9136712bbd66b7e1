/* Helpers of the tests of engine/transport. */
#pragma once

#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/io.h"
#include "gd/locate.h"
#include "gd/vector.h"
#include "tests/samples/samples.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const double exact = 1e-12, promise = 1e-9;

/* A mesh and the polygons from which it was built. */
struct surface {
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
};

static inline struct surface surface_of(const char *name, const double *values)
{
    struct surface surface;
    check_ok(sample_find(name)->generate(values, &surface.polygons), NULL);
    surface.mesh = test_mesh(&surface.polygons);
    return surface;
}

static inline void surface_free(struct surface *surface)
{
    gd_mesh_release(surface->mesh);
    gd_polygons_free(&surface->polygons);
}

/* Reads a mesh of ../shared/meshes. Returns false if the file does not exist. */
static inline bool surface_read(const char *name, struct surface *out)
{
    char path[128];
    size_t size;
    struct gd_detail detail = {0};
    snprintf(path, sizeof path, "../shared/meshes/%s.obj", name);
    char *bytes = test_read_file(path, &size);
    if (!bytes) return false;
    check_ok(gd_read_polygons(bytes, size, &(struct gd_read_options){.format = GD_FORMAT_OBJ},
                              &out->polygons, &detail),
             &detail);
    check_ok(gd_mesh_build(&out->polygons, &(struct gd_mesh_options){.repair_split = true}, NULL,
                           &out->mesh, &detail),
             &detail);
    free(bytes);
    return true;
}

static inline struct gd_point vertex(const struct gd_mesh *mesh, uint32_t index)
{
    struct gd_point point;
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){index}, &point, NULL), NULL);
    return point;
}

static inline struct gd_point nearest(const struct gd_mesh *mesh, double x, double y, double z)
{
    struct gd_point point;
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){x, y, z}, -1, &point, NULL), NULL);
    return point;
}

static inline struct gd_direction along(const struct gd_mesh *mesh, struct gd_point point, double x,
                                        double y, double z)
{
    struct gd_direction direction;
    struct gd_detail detail = {0};
    check_ok(gd_direction_along(mesh, &point, (struct gd_vec3){x, y, z}, &direction, &detail),
             &detail);
    return direction;
}

static inline struct gd_trace follow(const struct gd_mesh *mesh, struct gd_point start,
                                     struct gd_direction ahead, double length,
                                     const struct gd_trace_options *options)
{
    struct gd_trace trace;
    struct gd_detail detail = {0};
    check_ok(
        gd_trace_follow(mesh,
                        &(struct gd_trace_request){
                            .start = &start, .ahead = &ahead, .length = length, .options = options},
                        NULL, &trace, &detail),
        &detail);
    return trace;
}

static inline struct gd_point end_of(const struct gd_trace *trace)
{
    return trace->path.points[trace->path.count - 1];
}

static inline void expect_place(struct gd_vec3 actual, double x, double y, double z,
                                double tolerance)
{
    if (!(gd_vec3_distance(actual, (struct gd_vec3){x, y, z}) <= tolerance))
        fail_msg("(%.17g %.17g %.17g) instead of (%.17g %.17g %.17g)", actual.x, actual.y, actual.z,
                 x, y, z);
}

static inline void expect_near(double actual, double expected, double tolerance)
{
    if (!(fabs(actual - expected) <= tolerance))
        fail_msg("%.17g instead of %.17g", actual, expected);
}

/* Returns a random direction that does not lead off the surface. */
static inline struct gd_direction random_direction(const struct gd_mesh *mesh,
                                                   struct gd_point point, struct rng *rng)
{
    struct gd_direction direction;
    while (gd_direction_at_angle(mesh, &point, rng_between(rng, 0, 2 * M_PI), &direction, NULL)) {
    }
    return direction;
}
