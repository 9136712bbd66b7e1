/* gd_bench locate: measures how fast the engine finds nearest surface points, for points on and
 * around the surface, and first hits of rays. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/locate.h"
#include "tests/bench/bench.h"

enum { QUESTIONS = 20000 };

struct question {
    /* a point on the surface, and a point in the bounding box, which is enlarged by half of its
     * size */
    struct gd_vec3 on, around;
};

static struct gd_vec3 random_around(const struct gd_mesh *mesh, struct rng *rng)
{
    struct gd_vec3 min = gd_mesh_summary(mesh)->min, max = gd_mesh_summary(mesh)->max;
    struct gd_vec3 middle = gd_vec3_scale(gd_vec3_add(min, max), 0.5),
                   half = gd_vec3_sub(max, middle);
    return (struct gd_vec3){middle.x + rng_between(rng, -1.5, 1.5) * half.x,
                            middle.y + rng_between(rng, -1.5, 1.5) * half.y,
                            middle.z + rng_between(rng, -1.5, 1.5) * half.z};
}

static double nearest_rate(const struct gd_mesh *mesh, const struct question *questions, bool on)
{
    struct gd_detail detail = {0};
    struct gd_point point;
    uint64_t start = gd_now_ns();
    for (uint32_t i = 0; i < QUESTIONS; i++)
        bench_require(gd_locate_nearest(mesh, on ? questions[i].on : questions[i].around, -1,
                                        &point, &detail),
                      &detail);
    return 1e3 * QUESTIONS / bench_ms_since(start);
}

/* Shoots rays from `around` to `on`. Each ray hits the surface at `on` or before it, but a ray
 * within the plane of a flat mesh may miss. */
static double ray_rate(const struct gd_mesh *mesh, const struct question *questions)
{
    struct gd_detail detail = {0};
    struct gd_point point;
    uint64_t start = gd_now_ns();
    for (uint32_t i = 0; i < QUESTIONS; i++) {
        struct gd_vec3 from = questions[i].around, towards = gd_vec3_sub(questions[i].on, from);
        enum gd_status status = gd_locate_first_hit(mesh, from, towards, &point, &detail);
        if (status != GD_NOT_ON_SURFACE) bench_require(status, &detail);
    }
    return 1e3 * QUESTIONS / bench_ms_since(start);
}

static void measure(const char *name, const struct gd_mesh *mesh,
                    const struct bench_options *options)
{
    uint32_t runs = options->runs;
    double *on = bench_allocate(3 * sizeof *on * runs), *around = on + runs, *rays = around + runs;
    struct question *questions = bench_allocate(sizeof *questions * QUESTIONS);
    struct rng rng = {7};
    for (uint32_t run = 0; run < runs; run++) {
        for (uint32_t i = 0; i < QUESTIONS; i++) {
            struct gd_point point = bench_random_point(mesh, GD_POINT_FACE, &rng);
            questions[i] =
                (struct question){gd_point_position(mesh, &point), random_around(mesh, &rng)};
        }
        on[run] = nearest_rate(mesh, questions, true);
        around[run] = nearest_rate(mesh, questions, false);
        rays[run] = ray_rate(mesh, questions);
    }
    bench_print_mesh(name, mesh);
    printf("\"runs\":%u,\"questions\":%d,\"nearest_on_surface_per_s\":%.0f,\"nearest_per_s\":%.0f,"
           "\"rays_per_s\":%.0f,",
           runs, QUESTIONS, bench_median(on, runs), bench_median(around, runs),
           bench_median(rays, runs));
    bench_print_end();
    free(questions);
    free(on);
}

int bench_locate(char **arguments)
{
    return bench_each_mesh(arguments, 5, measure);
}
