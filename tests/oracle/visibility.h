/* Computes shortest paths in a plane among polygonal obstacles. Builds the visibility graph in
 * O(n^3), and then runs Dijkstra's algorithm. The orientation of any three points must be exact in
 * double precision. Coordinates should therefore be multiples of some 2^-k with few bits. */
#pragma once

#include <stdint.h>

/* Disjoint simple polygons, borrowed. Polygon i has the corners first[i] … first[i + 1] - 1. */
struct visibility_scene {
    const double (*corners)[2];
    const uint32_t *first; /* count + 1 elements */
    uint32_t count;
};

struct visibility; /* distances of all corners from one source */

/* Computes the corners' distances. `scene` must outlive the result. Returns NULL if out of
 * memory. */
struct visibility *visibility_create(const struct visibility_scene *scene, const double source[2]);
void visibility_free(struct visibility *visibility);

/* Returns the length of the shortest path to a point outside all obstacles. O(n^2). */
double visibility_distance(const struct visibility *visibility, const double target[2]);
