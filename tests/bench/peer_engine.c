/* gd_bench peer: the engine in the race. A field is built whole, with its compact wedges; a pair is solved from nothing. */
#include <stdlib.h>

#include "gd/query.h"
#include "tests/bench/bench.h"
#include "tests/bench/peer.h"

struct engine {
    struct gd_mesh *mesh;
    struct gd_field *field; /* the last answer */
};

static void *create(const struct gd_polygons *triangles)
{
    struct engine *engine = bench_allocate(sizeof *engine);
    *engine = (struct engine){NULL, NULL};
    if (gd_mesh_build(triangles, NULL, NULL, &engine->mesh, NULL) == GD_OK) return engine;
    free(engine);
    return NULL;
}

static struct gd_point at_vertex(const struct engine *engine, uint32_t vertex)
{
    struct gd_point point = {0};
    struct gd_detail detail = {0};
    bench_require(gd_point_at_vertex(engine->mesh, (struct gd_vertex){vertex}, &point, &detail), &detail);
    return point;
}

static bool field(void *surface, uint32_t source, double *out)
{
    struct engine *engine = surface;
    struct gd_seed seed = {.point = at_vertex(engine, source)};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    if (gd_field_build(engine->mesh, &request, bench_control(), NULL, &engine->field, NULL)) return false;
    gd_field_vertex_distances(engine->field, out);
    return true;
}

static bool pair(void *surface, uint32_t from, uint32_t to, double *out)
{
    struct engine *engine = surface;
    struct gd_point a = at_vertex(engine, from), b = at_vertex(engine, to);
    struct gd_pair_answer answer = {0};
    if (gd_pair_solve(engine->mesh, &a, &b, false, NULL, bench_control(), &answer, NULL)) return false;
    *out = answer.distance;
    gd_pair_answer_free(&answer);
    return true;
}

static void forget(void *surface)
{
    struct engine *engine = surface;
    gd_field_release(engine->field);
    engine->field = NULL;
}

static void release(void *surface)
{
    struct engine *engine = surface;
    forget(engine);
    gd_mesh_release(engine->mesh);
    free(engine);
}

int bench_peer(char **arguments)
{
    static const struct peer engine = {"gd_bench peer", create, field, pair, forget, release};
    return peer_run(&engine, arguments);
}
