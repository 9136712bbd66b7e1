/* Exact: random surfaces for the engine and for the solver of tests/oracle/naive_windows.h, and the
 * comparison of their distances.
 *
 * Points are passed from the engine to the solver as gd_point_describe returns them. Both therefore
 * compute with the same point, even if the engine has snapped it. */
#pragma once

#include "gd/field.h"
#include "tests/oracle/naive_windows.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"

/* The largest relative error that the API permits. */
#define EXACT_PROMISE 1e-9

/* Suites use the kinds below EXACT_KINDS in turn. The thinnest tubes have a radius of 5e-9 of their
 * length. Needles are terrain, stretched 1e4 to 3e5 times along one axis. */
enum exact_kind {
    EXACT_TERRAIN,
    EXACT_SPHERE,
    EXACT_TORUS,
    EXACT_GRADED,
    EXACT_KINDS,
    EXACT_TUBE = EXACT_KINDS,
    EXACT_NEEDLES
};

struct exact_scene {
    enum exact_kind kind;
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
    struct naive_mesh *naive;
    struct rng rng;
    double size;      /* longest side of the bounding box */
    double mean_edge; /* mean length of the edges */
};

/* Makes a random surface of 30 to 320 faces, determined by kind and seed. A failure ends the
 * process. */
void exact_scene_open(enum exact_kind kind, uint64_t seed, struct exact_scene *out);

/* Makes the same surface, moved by 2 * `offset` along each axis. */
void exact_scene_open_at(enum exact_kind kind, uint64_t seed, double offset,
                         struct exact_scene *out);
/* Makes a scene of these polygons and takes ownership of them. */
void exact_scene_from(struct gd_polygons polygons, struct exact_scene *out);
void exact_scene_close(struct exact_scene *scene);

/* --- points ----------------------------------------------------------------------------------- */

struct naive_point exact_point(const struct exact_scene *scene, const struct gd_point *point);

/* Returns a vertex, a point of an edge or a point of a face, each with equal probability. */
struct gd_point exact_random(struct exact_scene *scene);

/* Returns a point in a face or on an edge of the vertex. Its distance from the vertex is 10^least
 * to 10^most edge lengths. */
struct gd_point exact_beside_vertex(struct exact_scene *scene, uint32_t vertex, double least,
                                    double most);

/* Returns a point of a face at that distance from the inner part of an edge. */
struct gd_point exact_beside_edge(struct exact_scene *scene, double least, double most);

/* Returns the index of a vertex that has a face. */
uint32_t exact_random_vertex(struct exact_scene *scene);

/* --- comparison ------------------------------------------------------------------------------- */

/* Sources and their exact distances in extended precision. The solver switches to quadruple
 * precision on tubes, and when a distance differs from the engine's. */
struct exact_truth {
    const struct exact_scene *scene;
    struct naive_source *sources;
    uint32_t count;
    long double radius; /* largest distance that is needed */
    struct naive_field *field;
    bool is_quadruple;
};

void exact_truth_open(const struct exact_scene *scene, const struct gd_seed *seeds, uint32_t count,
                      long double radius, struct exact_truth *out);
void exact_truth_close(struct exact_truth *truth);
double exact_distance(struct exact_truth *truth, const struct gd_point *point);

/* Returns the relative error of the engine's distance. Errors above EXACT_PROMISE are confirmed in
 * quadruple precision. */
double exact_error(struct exact_truth *truth, const struct gd_point *point, double distance);

/* Returns the difference of two distances relative to the larger distance, or 0 if both are
 * infinite. */
double exact_relative(double a, double b);
