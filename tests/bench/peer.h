/* Peer: the protocol by which exact solvers are raced, the same for the engine, CGAL, and programs
 * built elsewhere.
 *
 *     PROGRAM mesh.obj SOURCE...        a line {"field_ms":…,"cpu_ms":…,"sum":…} for each source
 *     PROGRAM --pair mesh.obj S T ...   a line {"pair_ms":…,"cpu_ms":…,"distance":…} for each pair
 *     PROGRAM --trace mesh.obj FACE...  a line {"trace_ms":…,"cpu_ms":…,"crossings":…,"ends":…}
 *                                       for each face
 *
 * Vertices and faces are numbered from 0 in the file's order; every vertex belongs to a face, and
 * the mesh is one oriented 2-manifold of triangles (gd_bench export writes such files). Timed are:
 * the distances of all vertices from the source, with whatever the solver keeps to answer later
 * questions; or the distance of the two; or PEER_LINES straightest geodesics with their paths, from
 * the middle of the face in directions that part a whole turn equally, the first being the face's
 * first edge, PEER_LINE_EDGES mean edges long. Reading the file, building the mesh and freeing an
 * answer are not. `sum` is that of all distances, `ends` that of the three coordinates of all ends,
 * `crossings` of edges are points of the paths but for both ends: those that are right agree on
 * them. A program that does not do what is asked, or gets no arguments, ends with status 2. */
#ifndef TESTS_BENCH_PEER_H
#define TESTS_BENCH_PEER_H

#include <stdbool.h>

#include "gd/polygons.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { PEER_LINES = 64, PEER_LINE_EDGES = 300 };

/* The lines from one face. */
struct peer_lines {
    uint64_t crossings;
    double ends;
};

struct peer {
    const char *name; /* of the program, for sentences */
    /* A surface of its own; NULL: the solver does not take it. */
    void *(*create)(const struct gd_polygons *triangles);
    /* Distances of all vertices; false: the solver gave up. */
    bool (*field)(void *surface, uint32_t source, double *out);
    /* NULL: it does not do pairs. */
    bool (*pair)(void *surface, uint32_t from, uint32_t to, double *out);
    /* NULL: it does not trace. */
    bool (*trace)(void *surface, uint32_t face, double length, struct peer_lines *out);
    void (*forget)(void *surface); /* frees the last answer; may be NULL */
    void (*release)(void *surface);
};

/* Answers the arguments by the protocol; the exit status. */
int peer_run(const struct peer *peer, char **arguments);

#ifdef __cplusplus
}
#endif

#endif
