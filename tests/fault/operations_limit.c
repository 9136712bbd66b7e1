/* Subdivision surfaces: built, evaluated, discretized, traced. */
#include "tests/fault/operations.h"

#include <stdlib.h>

#include "tests/unit/subdiv/surfaces.h"

#include "gd/discretization.h"
#include "gd/limit_grid.h"
#include "gd/limit_shortest.h"

enum { PLACES = 6 };

static struct gd_control_mesh cube, prism, octahedron, sheet;
static struct gd_subdivision *on_cube, *on_octahedron, *on_sheet;
static struct gd_limit_mesh *fine;
static struct gd_limit_grid *grid;
static const struct gd_limit_point places[PLACES] = {{0, 0, 0.2, 0.3}, {1, 0, 0.7, 0.1},
                                                     {2, 0, 0.5, 0.5}, {3, 0, 0.01, 0.02},
                                                     {4, 0, 0.9, 0.8}, {5, 0, 0, 0}};
static const char tags[] = SKEW_CUBE "t crease 3/1/0 0 1 3 2.5\nt corner 1/1/0 7 3\n";

static const char prism_text[] = "v 0 0 0\nv 2 0 0\nv 1 2 0\nv 0 0 2\nv 2 0 2\nv 1 2 2\n"
                                 "f 3 2 1\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n";

static void read_control(const char *text, struct gd_control_mesh *out)
{
    struct gd_detail detail = {0};
    check_ok(gd_read_control_mesh(text, strlen(text),
                                  &(struct gd_read_options){.format = GD_FORMAT_OBJ}, out, &detail),
             &detail);
}

static void open_limits(void)
{
    read_control(tags, &cube);
    read_control(prism_text, &prism);
    read_control(OCTAHEDRON, &octahedron);
    make_sheet(4, false, &sheet);
    on_cube = surface_of(&cube, GD_SCHEME_CATMULL_CLARK);
    on_octahedron = surface_of(&octahedron, GD_SCHEME_LOOP);
    on_sheet = surface_of(&sheet, GD_SCHEME_CATMULL_CLARK);
    check_ok(gd_limit_mesh_build(on_sheet, &(struct gd_limit_mesh_options){.level = 2}, NULL, &fine,
                                 NULL),
             NULL);
    check_ok(gd_limit_grid_build(on_cube, &(struct gd_limit_mesh_options){.level = 2}, NULL, &grid,
                                 NULL),
             NULL);
}

/* --- answers ---------------------------------------------------------------------------------- */

static void digest_surface(struct digest *digest, const void *out)
{
    struct gd_limit_jet jet = {0};
    enum gd_status status =
        gd_limit_evaluate(*(struct gd_subdivision *const *)out, &places[0], &jet, NULL);
    digest_number(digest, status);
    digest_bytes(digest, &jet.position, sizeof jet.position);
}

static void discard_surface(void *out)
{
    gd_subdivision_release(*(struct gd_subdivision **)out);
}

static void digest_jets(struct digest *digest, const void *out, uint32_t count)
{
    const struct gd_limit_jet *jets = out;
    for (uint32_t i = 0; i < count; i++)
        digest_bytes(digest, &jets[i], offsetof(struct gd_limit_jet, singular));
}

static void digest_one_jet(struct digest *digest, const void *out)
{
    digest_jets(digest, out, 1);
}

static void digest_all_jets(struct digest *digest, const void *out)
{
    digest_jets(digest, *(struct gd_limit_jet *const *)out, PLACES);
}

static void discard_jets(void *out)
{
    free(*(struct gd_limit_jet **)out);
}

static void digest_foot(struct digest *digest, const void *out)
{
    digest_number(digest, ((const struct gd_limit_closest *)out)->distance);
}

static void digest_steps(struct digest *digest, const struct gd_limit_step *steps, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) digest_bytes(digest, &steps[i], sizeof steps[i]);
}

static void digest_trace(struct digest *digest, const void *out)
{
    const struct gd_limit_path *path = out;
    digest_number(digest, path->length);
    digest_steps(digest, path->steps, path->step_count);
}

static void discard_trace(void *out)
{
    gd_limit_path_free(out);
}

static void digest_relaxed(struct digest *digest, const void *out)
{
    const struct gd_limit_geodesic *geodesic = out;
    digest_number(digest, geodesic->converged);
    digest_trace(digest, &geodesic->path);
}

static void discard_relaxed(void *out)
{
    gd_limit_path_free(&((struct gd_limit_geodesic *)out)->path);
}

static void digest_fine(struct digest *digest, const void *out)
{
    const struct gd_discretization *made = out;
    digest_bytes(digest, made->polygons.positions,
                 made->polygons.position_count * sizeof *made->polygons.positions);
    digest_bytes(digest, made->normals, made->polygons.position_count * sizeof *made->normals);
}

static void discard_fine(void *out)
{
    gd_discretization_free(out);
}

static void digest_limit_mesh(struct digest *digest, const void *out)
{
    digest_mesh(digest, gd_limit_mesh_mesh(*(struct gd_limit_mesh *const *)out));
}

static void discard_limit_mesh(void *out)
{
    gd_limit_mesh_free(*(struct gd_limit_mesh **)out);
}

static void digest_limit_grid(struct digest *digest, const void *out)
{
    const struct gd_limit_grid *made = *(struct gd_limit_grid *const *)out;
    digest_number(digest, (double)gd_limit_grid_memsize(made));
}

static void discard_limit_grid(void *out)
{
    gd_limit_grid_free(*(struct gd_limit_grid **)out);
}

static void digest_shortest(struct digest *digest, const void *out)
{
    const struct gd_limit_shortest *shortest = out;
    digest_number(digest, shortest->distance);
    digest_number(digest, shortest->relaxed);
    digest_steps(digest, shortest->steps, shortest->step_count);
}

static void discard_shortest(void *out)
{
    gd_limit_shortest_free(out);
}

static const struct answer a_surface = {sizeof(struct gd_subdivision *), digest_surface,
                                        discard_surface};
static const struct answer a_jet = {sizeof(struct gd_limit_jet), digest_one_jet, NULL};
static const struct answer jets = {sizeof(struct gd_limit_jet *), digest_all_jets, discard_jets};
static const struct answer a_foot = {sizeof(struct gd_limit_closest), digest_foot, NULL};
static const struct answer a_trace = {sizeof(struct gd_limit_path), digest_trace, discard_trace};
static const struct answer a_geodesic = {sizeof(struct gd_limit_geodesic), digest_relaxed,
                                         discard_relaxed};
static const struct answer triangles = {sizeof(struct gd_discretization), digest_fine,
                                        discard_fine};
static const struct answer a_limit_grid = {sizeof(struct gd_limit_grid *), digest_limit_grid,
                                           discard_limit_grid};
static const struct answer a_limit_mesh = {sizeof(struct gd_limit_mesh *), digest_limit_mesh,
                                           discard_limit_mesh};
static const struct answer a_shortest = {sizeof(struct gd_limit_shortest), digest_shortest,
                                         discard_shortest};

/* --- calls ------------------------------------------------------------------------------------ */

static enum gd_status create_catmull_clark(void *out)
{
    struct gd_detail detail = {0};
    return gd_subdivision_create(&cube, GD_SCHEME_CATMULL_CLARK, NULL, out, &detail);
}

static enum gd_status create_of_polygons(void *out)
{
    return gd_subdivision_create(&prism, GD_SCHEME_CATMULL_CLARK, NULL, out, NULL);
}

static enum gd_status create_loop(void *out)
{
    return gd_subdivision_create(&octahedron, GD_SCHEME_LOOP, NULL, out, NULL);
}

static enum gd_status evaluate(void *out)
{
    return gd_limit_evaluate(on_cube, &places[3], out, NULL);
}

static enum gd_status evaluate_loop(void *out)
{
    return gd_limit_evaluate(on_octahedron, &places[3], out, NULL);
}

/* Evaluates into a separate array, because its contents are unspecified on failure. */
static enum gd_status evaluate_many(void *out)
{
    struct gd_limit_jet *array = malloc(PLACES * sizeof *array);
    enum gd_status status =
        array ? gd_limit_evaluate_many(on_cube, &(struct gd_limit_places){places, PLACES}, NULL,
                                       array, NULL)
              : GD_NO_MEMORY;
    if (status)
        free(array);
    else
        *(struct gd_limit_jet **)out = array;
    return status;
}

static enum gd_status nearest(void *out)
{
    return gd_limit_nearest(on_cube, (struct gd_vec3){1, 2, 0.3}, NULL, out, NULL);
}

static enum gd_status trace(void *out)
{
    return gd_limit_trace(
        on_cube, &(struct gd_limit_trace_request){places[0], (struct gd_vec3){1, 0.4, 0.1}, 2},
        NULL, out, NULL);
}

static enum gd_status trace_loop(void *out)
{
    return gd_limit_trace(
        on_octahedron,
        &(struct gd_limit_trace_request){places[0], (struct gd_vec3){1, 0.4, 0.1}, 1}, NULL, out,
        NULL);
}

static enum gd_status relax(void *out)
{
    static const struct gd_limit_point way[] = {{5, 0, 0.2, 0.3}, {5, 0, 1, 0.4}, {9, 0, 0.6, 0.6}};
    return gd_limit_relax(on_sheet, &(struct gd_limit_places){way, 3}, NULL, out, NULL);
}

static enum gd_status discretize_level(void *out)
{
    return gd_discretize(on_cube, &(struct gd_discretize_options){.level = 2}, NULL, out, NULL);
}

static enum gd_status discretize_loop(void *out)
{
    return gd_discretize(on_octahedron, &(struct gd_discretize_options){.level = 2}, NULL, out,
                         NULL);
}

static enum gd_status discretize_near(void *out)
{
    return gd_discretize(on_cube, &(struct gd_discretize_options){.tolerance = 0.05}, NULL, out,
                         NULL);
}

static enum gd_status build_mesh(void *out)
{
    return gd_limit_mesh_build(on_cube, &(struct gd_limit_mesh_options){.level = 2}, NULL, out,
                               NULL);
}

static enum gd_status build_grid(void *out)
{
    return gd_limit_grid_build(on_cube, &(struct gd_limit_mesh_options){.level = 2}, NULL, out,
                               NULL);
}

/* Starts at a vertex, whose neighbourhood is a small mesh. */
static enum gd_status trace_grid(void *out)
{
    enum gd_status status =
        gd_limit_grid_trace(grid,
                            &(struct gd_limit_grid_request){
                                .start = places[2], .direction = {1, 0.4, 0.1}, .length = 2},
                            NULL, out, NULL);
    return status || ((struct gd_limit_path *)out)->step_count ? status : GD_INTERNAL;
}

static enum gd_status find_shortest(void *out)
{
    return gd_limit_shortest_find(
        fine, (struct gd_limit_point[]){{5, 0, 0.25, 0.5}, {10, 0, 0.5, 0.125}}, NULL, out, NULL);
}

static const struct operation items[] = {
    {"Catmull-Clark surface", &a_surface, create_catmull_clark, GD_OK, NULL},
    {"Catmull-Clark surface of polygons", &a_surface, create_of_polygons, GD_OK, NULL},
    {"Loop surface", &a_surface, create_loop, GD_OK, NULL},
    {"limit point", &a_jet, evaluate, GD_OK, NULL},
    {"limit point, Loop", &a_jet, evaluate_loop, GD_OK, NULL},
    {"limit points", &jets, evaluate_many, GD_OK, NULL},
    {"nearest limit point", &a_foot, nearest, GD_OK, NULL},
    {"trace on a limit surface", &a_trace, trace, GD_OK, NULL},
    {"trace on a limit surface, Loop", &a_trace, trace_loop, GD_OK, NULL},
    {"relaxed path", &a_geodesic, relax, GD_OK, NULL},
    {"discretization", &triangles, discretize_level, GD_OK, NULL},
    {"discretization, Loop", &triangles, discretize_loop, GD_OK, NULL},
    {"discretization to a tolerance", &triangles, discretize_near, GD_OK, NULL},
    {"limit mesh", &a_limit_mesh, build_mesh, GD_OK, NULL},
    {"limit grid", &a_limit_grid, build_grid, GD_OK, NULL},
    {"trace on a limit grid", &a_trace, trace_grid, GD_OK, NULL},
    {"shortest path on a limit surface", &a_shortest, find_shortest, GD_OK, NULL},
};

const struct operations limit_operations = {open_limits, items, COUNT(items)};
