/* Exact: surfaces that the engine and the solver of tests/oracle/naive_windows.h both have, and
 * their distances compared.
 *
 * Points go from the engine to the solver, as gd_point_describe has them, so that both have the
 * same point whatever the engine snaps. */
#ifndef TESTS_SUPPORT_EXACT_H
#define TESTS_SUPPORT_EXACT_H

#include "gd/field.h"
#include "tests/oracle/naive_windows.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"

/* Relative error that the interface promises. */
#define EXACT_PROMISE 1e-9

/* Up to EXACT_KINDS: what suites take in turn. Tubes are as thin as a 2e8th of their length. */
enum exact_kind {
    EXACT_TERRAIN,
    EXACT_SPHERE,
    EXACT_TORUS,
    EXACT_GRADED,
    EXACT_KINDS,
    EXACT_TUBE = EXACT_KINDS
};

struct exact_scene {
    enum exact_kind kind;
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
    struct naive_mesh *naive;
    struct rng rng;
    double size;      /* longest side of the bounding box */
    double mean_edge; /* length */
};

/* A random surface of 30 to 320 faces: the same for the same kind and seed. A failure ends the
 * process. */
void exact_scene_open(enum exact_kind kind, uint64_t seed, struct exact_scene *out);

/* The same, moved by `offset` times its size along each axis. */
void exact_scene_open_at(enum exact_kind kind, uint64_t seed, double offset,
                         struct exact_scene *out);
/* The surface of these polygons, which it takes over. */
void exact_scene_from(struct gd_polygons polygons, struct exact_scene *out);
void exact_scene_close(struct exact_scene *scene);

/* --- points ----------------------------------------------------------------------------------- */

struct naive_point exact_point(const struct exact_scene *scene, const struct gd_point *point);

/* A vertex, a point of an edge or a point of a face, each as likely. */
struct gd_point exact_random(struct exact_scene *scene);

/* A point 10^least to 10^most edge lengths away from a vertex, in one of its faces or on one of
 * its edges. */
struct gd_point exact_beside_vertex(struct exact_scene *scene, uint32_t vertex, double least,
                                    double most);

/* The same beside the inner part of an edge. */
struct gd_point exact_beside_edge(struct exact_scene *scene, double least, double most);

uint32_t exact_random_vertex(struct exact_scene *scene); /* index of one that has a face */

/* --- comparison ------------------------------------------------------------------------------- */

/* Sources and their exact distances: in extended precision, and, once these and the engine's
 * differ and on tubes, in quadruple precision. */
struct exact_truth {
    const struct exact_scene *scene;
    struct naive_source *sources;
    uint32_t count;
    long double radius; /* distances beyond are not asked for */
    struct naive_field *field;
    bool is_quadruple;
};

void exact_truth_open(const struct exact_scene *scene, const struct gd_seed *seeds, uint32_t count,
                      long double radius, struct exact_truth *out);
void exact_truth_close(struct exact_truth *truth);
double exact_distance(struct exact_truth *truth, const struct gd_point *point);

/* Relative error of the engine's distance; above EXACT_PROMISE only if quadruple precision
 * confirms it. */
double exact_error(struct exact_truth *truth, const struct gd_point *point, double distance);

/* Difference of two distances over the larger one; 0 if both are infinite. */
double exact_relative(double a, double b);

#endif
