/* Declarations that the engine's tests share: cmocka, comparison by relative error, and points of a
 * mesh in a form that the engine, the oracles and the closed forms all use. The environment
 * variable GEODESICD_CPU selects the kernels (gd/cpu.h). */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

/* gcc defines macros; clang has __has_feature */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TEST_IS_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define TEST_IS_SANITIZED 1
#endif
#endif

#ifndef TEST_IS_SANITIZED
#define TEST_IS_SANITIZED 0
#endif

/* Sanitizers slow the long tests down some ten times. With a sanitizer, these tests run one in
 * TEST_STRIDE of their repetitions. */
#define TEST_STRIDE (TEST_IS_SANITIZED ? 10 : 1)

#include "gd/point.h"
#include "tests/samples/random.h"

/* Fails the test and prints both numbers if they differ by more than `relative` times the larger
 * one. Two infinities are equal. Returns the relative error. */
#define check_close(actual, expected, relative)                                                    \
    test_check_close(actual, expected, relative, __FILE__, __LINE__)
double test_check_close(double actual, double expected, double relative, const char *file,
                        int line);

/* Fails the test with the status' name and detail unless the status is GD_OK. */
#define check_ok(status, detail) test_check_ok(status, detail, __FILE__, __LINE__)
void test_check_ok(enum gd_status status, const struct gd_detail *detail, const char *file,
                   int line);

/* Builds a mesh or fails the test. The caller releases it. */
struct gd_mesh *test_mesh(const struct gd_polygons *polygons);

/* Builds the mesh of a sample or fails the test. The caller releases it. If `polygons` is not NULL
 * it receives the sample's polygons, which the caller frees. */
struct gd_mesh *test_sample(const char *name, const double *values, struct gd_polygons *polygons);

/* A point of a triangle mesh by face and barycentric coordinates. Weights of exactly zero place it
 * on an edge or a vertex. */
struct test_place {
    uint32_t face;
    double weight[3];
};

/* Returns a vertex, a point of an edge or a point of a face, each with equal probability. */
struct test_place test_random_place(const struct gd_polygons *polygons, struct rng *rng);
void test_place_position(const struct gd_polygons *polygons, struct test_place place,
                         double out[3]);
struct gd_point test_point(const struct gd_mesh *mesh, struct test_place place);
struct gd_point test_vertex(const struct gd_mesh *mesh, uint32_t index);
struct gd_point test_point_near(const struct gd_mesh *mesh, double x, double y,
                                double z); /* returns the nearest point of the surface */

/* Returns the file's bytes, which end with a NUL and which the caller frees. Returns NULL if the
 * file can't be read. */
char *test_read_file(const char *path, size_t *size);
