/* Peer: the command line of all exact solvers that tests/bench/peers.py compares: the engine, CGAL,
 * and programs built elsewhere.
 *
 *     PROGRAM mesh.obj SOURCE...        a line {"field_ms":…,"cpu_ms":…,"sum":…} for each source
 *     PROGRAM --pair mesh.obj S T ...   a line {"pair_ms":…,"cpu_ms":…,"distance":…} for each pair
 *     PROGRAM --trace mesh.obj FACE...  a line {"trace_ms":…,"cpu_ms":…,"crossings":…,"ends":…}
 *                                       for each face
 *
 * Vertices and faces are numbered from 0 in the file's order. Every vertex belongs to a face, and
 * the mesh is one oriented 2-manifold of triangles (gd_bench export writes such files). The time of
 * a field covers the distances of all vertices from the source, with all data that the solver keeps
 * for later queries. The time of a pair covers its distance. The time of a trace covers PEER_LINES
 * straightest geodesics with their paths. These geodesics are PEER_LINE_EDGES mean edges long. They
 * start in the middle of the face. Their directions divide a full turn equally; the first one is
 * the direction of the face's first edge. No time includes reading the file, building the mesh or
 * freeing an answer. `sum` is the sum of all distances. `ends` is the sum of the three coordinates
 * of all ends. `crossings` is the number of points of all paths, not counting the two ends of each
 * path. Correct solvers agree on these numbers. A program that does not support a task, or gets no
 * arguments, ends with status 2. */
#pragma once

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
    const char *name; /* name of the program, for messages */
    /* Creates the solver's surface. Returns NULL if the solver rejects the mesh. */
    void *(*create)(const struct gd_polygons *triangles);
    /* Computes the distances of all vertices. Returns false if the solver failed. */
    bool (*field)(void *surface, uint32_t source, double *out);
    /* The member is NULL if the solver does not support pairs. */
    bool (*pair)(void *surface, uint32_t from, uint32_t to, double *out);
    /* The member is NULL if the solver does not support traces. */
    bool (*trace)(void *surface, uint32_t face, double length, struct peer_lines *out);
    void (*forget)(void *surface); /* frees the last answer; the member may be NULL */
    void (*release)(void *surface);
};

/* Runs the task that the arguments select, as described above. Returns the exit status. */
int peer_run(const struct peer *peer, char **arguments);

#ifdef __cplusplus
}
#endif
