/* Shortest paths in the plane among polygonal obstacles, by the visibility graph: O(n^3) to build,
 * Dijkstra to answer. Orientations are taken to be exact, so coordinates should be multiples of
 * some 2^-k with few bits. */
#ifndef TESTS_ORACLE_VISIBILITY_H
#define TESTS_ORACLE_VISIBILITY_H

#include <stdint.h>

/* Disjoint simple polygons, borrowed; polygon i has the corners first[i] … first[i + 1] - 1. */
struct visibility_scene {
    const double (*corners)[2];
    const uint32_t *first; /* count + 1 */
    uint32_t count;
};

struct visibility; /* the distances of all corners from one point */

/* NULL: memory is out. `scene` must stay. */
struct visibility *visibility_create(const struct visibility_scene *scene, const double source[2]);
void visibility_free(struct visibility *visibility);

/* Length of the shortest path to a point that is not inside an obstacle. O(n^2). */
double visibility_distance(const struct visibility *visibility, const double target[2]);

#endif
