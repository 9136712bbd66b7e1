/* gd_bench peer: the engine as a solver with the command line of peer.h. Each field is built
 * completely, with stored wedges; each pair is solved without cached data. */
#include <stdlib.h>

#include "gd/query.h"
#include "gd/trace.h"
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
    bench_require(gd_point_at_vertex(engine->mesh, (struct gd_vertex){vertex}, &point, &detail),
                  &detail);
    return point;
}

static bool field(void *surface, uint32_t source, double *out)
{
    struct engine *engine = surface;
    struct gd_seed seed = {.point = at_vertex(engine, source)};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    if (gd_field_build(engine->mesh, &request, bench_control(), &engine->field, NULL)) return false;
    gd_field_vertex_distances(engine->field, out);
    return true;
}

static bool pair(void *surface, uint32_t from, uint32_t to, double *out)
{
    struct engine *engine = surface;
    struct gd_point a = at_vertex(engine, from), b = at_vertex(engine, to);
    struct gd_pair_answer answer = {0};
    if (gd_pair_solve(engine->mesh, &(struct gd_pair_request){.from = &a, .to = &b},
                      bench_control(), &answer, NULL))
        return false;
    *out = answer.distance;
    gd_pair_answer_free(&answer);
    return true;
}

static bool trace_line(const struct gd_mesh *mesh, const struct gd_point *from, double angle,
                       double length, struct peer_lines *out)
{
    struct gd_direction ahead;
    struct gd_trace trace;
    if (gd_direction_at_angle(mesh, from, angle, &ahead, NULL)) return false;
    if (gd_trace_follow(
            mesh, &(struct gd_trace_request){.start = from, .ahead = &ahead, .length = length},
            NULL, &trace, NULL))
        return false;
    struct gd_vec3 end = gd_point_position(mesh, &trace.path.points[trace.path.count - 1]);
    out->crossings += trace.path.count - 2;
    out->ends += end.x + end.y + end.z;
    gd_trace_free(&trace);
    return true;
}

static bool trace(void *surface, uint32_t face, double length, struct peer_lines *out)
{
    const struct engine *engine = surface;
    struct gd_point middle;
    const double thirds[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    if (gd_point_in_face(engine->mesh, (struct gd_face){face}, thirds, &middle, NULL)) return false;
    for (int i = 0; i < PEER_LINES; i++)
        if (!trace_line(engine->mesh, &middle, 2 * M_PI * i / PEER_LINES, length, out))
            return false;
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
    static const struct peer engine = {"gd_bench peer", create, field,  pair,
                                       trace,           forget, release};
    return bench_take_cpu(&arguments) ? peer_run(&engine, arguments) : 2;
}
