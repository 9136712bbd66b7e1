#include "tests/samples/samples.h"

#include <string.h>

static uint32_t whole(double value)
{
    return (uint32_t)value;
}

static enum gd_status make_grid(const double *v, struct gd_polygons *out)
{
    return sample_grid(whole(v[0]), whole(v[1]), v[2], v[3], out);
}

static enum gd_status make_box(const double *v, struct gd_polygons *out)
{
    const uint32_t cells[3] = {whole(v[3]), whole(v[3]), whole(v[3])};
    return sample_box(v, cells, out);
}

static enum gd_status make_icosphere(const double *v, struct gd_polygons *out)
{
    return sample_icosphere(whole(v[0]), v[1], out);
}

static enum gd_status make_torus(const double *v, struct gd_polygons *out)
{
    return sample_torus(whole(v[0]), whole(v[1]), v[2], v[3], out);
}

static enum gd_status make_cone(const double *v, struct gd_polygons *out)
{
    return sample_cone(v[0], v[1], whole(v[2]), whole(v[3]), out);
}

static enum gd_status make_saddle(const double *v, struct gd_polygons *out)
{
    return sample_saddle(v[0], v[1], 2 * whole(v[2]), whole(v[3]), out);
}

static enum gd_status make_cylinder(const double *v, struct gd_polygons *out)
{
    return sample_cylinder(v[0], v[1], whole(v[2]), whole(v[3]), out);
}

static enum gd_status make_graded(const double *v, struct gd_polygons *out)
{
    struct sample_grading grading = {.patches = whole(v[0]),
                                     .sectors = whole(v[1]),
                                     .rings = whole(v[2]),
                                     .ratio = v[3],
                                     .bend = v[4],
                                     .noise = v[5]};
    return sample_graded(&grading, (uint64_t)v[6], out);
}

static enum gd_status make_terrain(const double *v, struct gd_polygons *out)
{
    return sample_terrain(whole(v[0]), v[1], (uint64_t)v[2], out);
}

static enum gd_status make_genus2(const double *v, struct gd_polygons *out)
{
    return sample_genus2(whole(v[0]), v[1], out);
}

static enum gd_status make_tetrahedron(const double *v, struct gd_polygons *out)
{
    return sample_tetrahedron(v[0], whole(v[1]), out);
}

static enum gd_status make_tangle(const double *v, struct gd_polygons *out)
{
    return sample_tangle(whole(v[0]), (uint64_t)v[1], out);
}

static enum gd_status make_obstacles(const double *v, struct gd_polygons *out)
{
    struct sample_obstacles obstacles;
    enum gd_status status = sample_obstacles(whole(v[0]), whole(v[1]), (uint64_t)v[2], &obstacles);
    if (status != GD_OK) return status;
    *out = obstacles.mesh;
    obstacles.mesh = (struct gd_polygons){0};
    sample_obstacles_free(&obstacles);
    return GD_OK;
}

static struct remeshing remeshing_of(const double *v)
{
    return (struct remeshing){.faces = whole(v[0]),
                              .contrast = v[1],
                              .noise = v[2],
                              .passes = whole(v[3]),
                              .roughness = v[4]};
}

static enum gd_status make_eight(const double *v, struct gd_polygons *out)
{
    struct remeshing remeshing = remeshing_of(v);
    return sample_eight(&remeshing, (uint64_t)v[5], out);
}

static enum gd_status make_ball(const double *v, struct gd_polygons *out)
{
    struct remeshing remeshing = remeshing_of(v);
    return sample_ball(&remeshing, (uint64_t)v[5], out);
}

static enum gd_status make_pot(const double *v, struct gd_polygons *out)
{
    struct remeshing remeshing = remeshing_of(v);
    return sample_pot(&remeshing, (uint64_t)v[5], out);
}

static enum gd_status make_scan(const double *v, struct gd_polygons *out)
{
    struct remeshing remeshing = remeshing_of(v);
    return sample_scan(&remeshing, (uint64_t)v[5], out);
}

/* The content of a parameter's braces. */
#define COUNT(name, value, least, most) name, value, least, most, true
#define LENGTH(name, value)             name, value, 1e-100, 1e100, false
#define SEED                            COUNT("seed", 1, 0, 1e15)
#define REMESHED(faces)                                                                            \
    {COUNT("faces", faces, 200, 1e6)}, {"contrast", 0, 0, 2, false}, {"noise", 0, 0, 2, false},    \
        {COUNT("passes", 30, 0, 1000)}, {"roughness", 0, 0, 1, false},                             \
    {                                                                                              \
        SEED                                                                                       \
    }

const struct sample samples[] = {
    {"grid",
     "a flat rectangle",
     {{COUNT("columns", 32, 1, 4096)},
      {COUNT("rows", 32, 1, 4096)},
      {LENGTH("width", 1)},
      {LENGTH("height", 1)}},
     make_grid},
    {"box",
     "a closed box",
     {{LENGTH("a", 1)}, {LENGTH("b", 1)}, {LENGTH("c", 1)}, {COUNT("cells", 8, 1, 600)}},
     make_box},
    {"icosphere",
     "a subdivided icosahedron on a sphere",
     {{COUNT("level", 4, 0, 10)}, {LENGTH("radius", 1)}},
     make_icosphere},
    {"torus",
     "a torus",
     {{COUNT("columns", 64, 3, 4096)},
      {COUNT("rows", 32, 3, 4096)},
      {LENGTH("major", 1)},
      {LENGTH("minor", 0.4)}},
     make_torus},
    {"cone",
     "the mantle of a pyramid",
     {{LENGTH("radius", 1)},
      {LENGTH("height", 1)},
      {COUNT("sectors", 32, 3, 4096)},
      {COUNT("rings", 16, 1, 4096)}},
     make_cone},
    {"saddle",
     "a fan of congruent sectors, up and down in turn, round a saddle vertex",
     {{LENGTH("radius", 1)},
      {LENGTH("amplitude", 0.5)},
      {COUNT("pairs", 8, 2, 2048)},
      {COUNT("rings", 16, 1, 4096)}},
     make_saddle},
    {"cylinder",
     "the mantle of a prism, open at both ends",
     {{LENGTH("radius", 1)},
      {LENGTH("height", 2)},
      {COUNT("sides", 32, 3, 131072)},
      {COUNT("rings", 16, 1, 4096)}},
     make_cylinder},
    {"graded",
     "rings around an apex, each a ratio smaller than the one outside it",
     {{COUNT("patches", 1, 1, 2)},
      {COUNT("sectors", 6, 3, 4096)},
      {COUNT("rings", 8, 1, 100)},
      {"ratio", 10, 1.5, 1e6, false},
      {"bend", 0.5, -10, 10, false},
      {"noise", 0, 0, 0.9, false},
      {SEED}},
     make_graded},
    {"terrain",
     "fractal heights over the unit square",
     {{COUNT("cells", 64, 1, 2048)}, {LENGTH("amplitude", 0.2)}, {SEED}},
     make_terrain},
    {"genus2",
     "a smoothed, bumpy slab with two holes",
     {{COUNT("cells", 8, 1, 128)}, {"bump", 0.02, 0, 0.05, false}},
     make_genus2},
    {"tetrahedron",
     "a regular tetrahedron",
     {{LENGTH("edge", 1)}, {COUNT("level", 0, 0, 11)}},
     make_tetrahedron},
    {"tangle",
     "a small random surface with saddles, slivers and holes",
     {{COUNT("faces", 40, 4, 1000)}, {SEED}},
     make_tangle},
    {"obstacles",
     "high prisms on a rectangle, whose geodesics are shortest planar paths",
     {{COUNT("count", 20, 1, 200)}, {COUNT("level", 1, 0, 6)}, {SEED}},
     make_obstacles},
    {"eight", "a slab with two holes, remeshed", {REMESHED(2022)}, make_eight},
    {"ball", "a sphere, remeshed", {REMESHED(4074)}, make_ball},
    {"pot", "a pot with a handle, remeshed", {REMESHED(11666)}, make_pot},
    {"scan", "a ball with lumps and folds, remeshed", {REMESHED(10000)}, make_scan},
};
const uint32_t sample_count = sizeof samples / sizeof *samples;

const struct sample *sample_find(const char *name)
{
    for (uint32_t i = 0; i < sample_count; i++)
        if (strcmp(samples[i].name, name) == 0) return &samples[i];
    return NULL;
}
