#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/ablation.h"
#include "tests/bench/bench.h"

/* Answers must not depend on the methods, because methods only avoid work. The test uses meshes
 * with saddles, boundaries, flat parts, ties, slivers and handles, and a source of each kind. It
 * runs all sixteen combinations of methods, for the whole field and for propagation up to a
 * target. */

#define AGREEMENT 1e-12 /* largest permitted relative difference of distances */

static const char *const meshes[] = {
    "sample:grid,columns=12,rows=9",
    "sample:grid,columns=24,rows=8,width=30000",
    "sample:box,cells=6",
    "sample:icosphere,level=3",
    "sample:torus,columns=32,rows=20",
    "sample:cone",
    "sample:saddle",
    "sample:cylinder",
    "sample:terrain,cells=20",
    "sample:terrain,cells=20,amplitude=3,seed=4",
    "sample:terrain,cells=16,amplitude=30000",
    "sample:genus2,cells=4",
    "sample:tetrahedron,level=3",
    "sample:tangle,faces=300,seed=1",
    "sample:tangle,faces=300,seed=2",
    "sample:tangle,faces=300,seed=3",
    "sample:tangle,faces=300,seed=4",
    "sample:obstacles,count=6",
    "sample:eight",
    "sample:eight,contrast=0.6,passes=0",
    "sample:scan,faces=4000,noise=0.4,passes=0,roughness=0.5",
};

enum { COMBINATIONS = 16 };

static struct gd__variant combination(int bits)
{
    return (struct gd__variant){.one_list = bits & 1,
                                .no_filter = bits & 2,
                                .no_cone = bits & 4,
                                .no_coalescing = bits & 8};
}

static double difference(double a, double b)
{
    if (a == b || (isnan(a) && isnan(b))) return 0; /* also covers equal infinities */
    double relative = fabs(a - b) / fmax(fabs(a), fabs(b));
    return isnan(relative) ? HUGE_VAL : relative;
}

/* Returns the largest relative difference, over all vertices, between these distances and the
 * distances with all methods. */
static double worst_field(const struct gd_mesh *mesh, struct trial_request *request,
                          const double *expected)
{
    double worst = 0;
    trial_run(mesh, request);
    for (uint32_t i = 0; i < gd_mesh_summary(mesh)->index_count; i++)
        worst = fmax(worst, difference(request->distances[i], expected[i]));
    return worst;
}

/* Returns the difference at the target only. The propagation stops at the target. */
static double worst_target(const struct gd_mesh *mesh, struct trial_request *request,
                           uint32_t index, const double *expected)
{
    struct gd_point target;
    bench_require(gd_point_at_vertex(mesh, (struct gd_vertex){index}, &target, NULL), NULL);
    request->target = &target;
    trial_run(mesh, request);
    request->target = NULL;
    return difference(request->distances[index], expected[index]);
}

static double worst_of(const struct gd_mesh *mesh, struct rng *rng)
{
    uint32_t count = gd_mesh_summary(mesh)->index_count;
    double *expected = bench_allocate(sizeof *expected * count),
           *actual = bench_allocate(sizeof *actual * count);
    double worst = 0;
    for (enum gd_point_kind kind = GD_POINT_VERTEX; kind <= GD_POINT_FACE; kind++) {
        struct trial_request request = {.source = bench_random_point(mesh, kind, rng),
                                        .distances = expected};
        struct gd_vertex corners[3];
        gd_mesh_corners(mesh, (struct gd_face){rng_below(rng, gd_mesh_summary(mesh)->faces)},
                        corners);
        trial_run(mesh, &request);
        request.distances = actual;
        for (int bits = 0; bits < COMBINATIONS; bits++) {
            request.methods = combination(bits);
            worst = fmax(worst, worst_field(mesh, &request, expected));
            worst = fmax(worst, worst_target(mesh, &request, corners[0].index, expected));
        }
    }
    free(expected);
    free(actual);
    return worst;
}

bool ablation_agreement(void)
{
    struct rng rng = {3};
    double worst = 0;
    bool all = true;
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
        struct gd_mesh *mesh = bench_open(meshes[i], NULL);
        double here = mesh ? worst_of(mesh, &rng) : HUGE_VAL;
        printf("%s every combination of methods agrees on %s: %.1e\n",
               here <= AGREEMENT ? "ok" : "not ok", meshes[i], here);
        all = all && here <= AGREEMENT;
        worst = fmax(worst, here);
        gd_mesh_release(mesh);
    }
    printf("# largest relative difference of a distance between the %d combinations of methods: "
           "%.1e\n",
           COMBINATIONS, worst);
    return all;
}
