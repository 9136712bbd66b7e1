/* Helpers of the tests of edit, and checks of the properties of every edit. */
#pragma once

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gd/edit.h"
#include "gd/locate.h"
#include "tests/samples/samples.h"
#include "tests/support/shared.h"
#include "tests/support/test.h"
#include "tests/support/watch.h"

static inline uint64_t thread_time_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static inline double box_diagonal(const struct gd_mesh *mesh)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    return gd_vec3_distance(summary->min, summary->max);
}

static inline struct gd_vec3 position_at(const struct gd_polygons *polygons, uint32_t index)
{
    const double *p = polygons->positions[index];
    return (struct gd_vec3){p[0], p[1], p[2]};
}

/* Checks that the origins are points of the mesh. Returns the largest distance of a vertex from its
 * origin. */
static inline double farthest_origin(const struct gd_mesh *mesh, const struct gd_edited *edited)
{
    double farthest = 0;
    for (uint32_t i = 0; i < edited->polygons.position_count; i++) {
        const struct gd_origin *origin = &edited->origins[i];
        struct gd_point point;
        check_ok(gd_point_in_face(mesh, (struct gd_face){origin->face}, origin->barycentric, &point,
                                  NULL),
                 NULL);
        farthest =
            fmax(farthest, gd_locate_distance(mesh, position_at(&edited->polygons, i), &point));
    }
    return farthest;
}

/* Returns the largest distance of a vertex of the mesh from the edited mesh. Searches the nearest
 * point for each vertex. */
static inline double farthest_vertex(const struct gd_mesh *mesh, const struct gd_mesh *edited)
{
    double farthest = 0;
    for (uint32_t i = 0; i < gd_mesh_summary(mesh)->index_count; i++) {
        struct gd_vec3 p = gd_mesh_position(mesh, (struct gd_vertex){i});
        struct gd_point nearest;
        check_ok(gd_locate_nearest(edited, p, -1, &nearest, NULL), NULL);
        farthest = fmax(farthest, gd_locate_distance(edited, p, &nearest));
    }
    return farthest;
}

/* Returns disjoint spheres of these radii as one mesh, 80 faces each. */
static inline struct gd_mesh *separate_spheres(const double *radii, uint32_t count)
{
    struct gd_polygons sphere, all = {0};
    gd_mesh_release(test_sample("icosphere", (double[SAMPLE_PARAMETERS]){1, 1}, &sphere));
    uint32_t vertices = sphere.position_count, corners = 3 * sphere.polygon_count;
    all.positions = malloc(count * vertices * sizeof *all.positions);
    all.corners = malloc(count * corners * sizeof *all.corners);
    assert_true(all.positions && all.corners);
    all.position_count = count * vertices;
    all.polygon_count = count * sphere.polygon_count;
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t v = 0; v < vertices; v++) {
            for (int k = 0; k < 3; k++)
                all.positions[i * vertices + v][k] =
                    sphere.positions[v][k] * radii[i] + (k == 0 ? 10.0 * i : 0);
        }
        for (uint32_t c = 0; c < corners; c++)
            all.corners[i * corners + c] = sphere.corners[c] + i * vertices;
    }
    struct gd_mesh *mesh = test_mesh(&all);
    gd_polygons_free(&sphere);
    gd_polygons_free(&all);
    return mesh;
}

/* Records the longest CPU time of the thread between two checks of the control. */
struct looks {
    uint64_t last, longest;
};

static inline bool look(void *user, double fraction)
{
    struct looks *looks = user;
    uint64_t now = thread_time_ns();
    (void)fraction;
    if (looks->last && now - looks->last > looks->longest) looks->longest = now - looks->last;
    looks->last = now;
    return true;
}

static inline bool edited_equal(const struct gd_edited *a, const struct gd_edited *b)
{
    const struct gd_polygons *p = &a->polygons, *q = &b->polygons;
    return p->position_count == q->position_count && p->polygon_count == q->polygon_count &&
           a->largest_distance == b->largest_distance &&
           memcmp(p->positions, q->positions, p->position_count * sizeof *p->positions) == 0 &&
           memcmp(p->corners, q->corners, 3 * p->polygon_count * sizeof *p->corners) == 0;
}
