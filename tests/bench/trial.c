#include "tests/bench/trial.h"

#include <stdlib.h>

#include "field/layout.h"
#include "tests/bench/bench.h"

struct recorder {
    struct gd_field *field; /* as gd_field_build would make it, but for the methods */
    struct trial *trial;
    double start_ms;
};

/* A sink: stops the clock, counts, and keeps the wedges as a field does. */
static enum gd_status record(void *user, struct gd__wavefront *front, const struct gd_executor *executor)
{
    struct recorder *recorder = user;
    struct trial *trial = recorder->trial;
    trial->ms = bench_thread_ms() - recorder->start_ms;
    trial->produced = front->effort.windows_created;
    trial->propagated = front->effort.windows_propagated;
    for (uint32_t side = 0; side < 2 * front->mesh->edge_count; side++) trial->kept_half += front->lists[side].count;
    return gd__field_take(recorder->field, front, executor);
}

static uint64_t count_wedges(const struct gd_field *field)
{
    uint64_t count = 0;
    for (uint64_t i = 0; i < field->statistics.wedges; i++) count += field->wedges[i].source != GD_NONE; /* no gaps */
    return count;
}

struct trial trial_run(const struct gd_mesh *mesh, const struct trial_request *request)
{
    struct gd__seed seed = {.point = request->source};
    struct gd__propagation propagation = {
        .seeds = &seed, .seed_count = 1, .radius = GD__FAR, .target = request->target, .methods = request->methods};
    struct trial trial = {0};
    struct gd_field *field = bench_allocate(sizeof *field);
    *field = (struct gd_field){.mesh = gd_mesh_retain(mesh)};
    atomic_init(&field->references, 1);
    struct recorder recorder = {.field = field, .trial = &trial, .start_ms = bench_thread_ms()};
    struct gd__sink sink = {.take = record, .user = &recorder};
    bench_require(gd__wavefront_run(mesh, &propagation, &sink, NULL, NULL), NULL);
    trial.kept_merged = count_wedges(field);
    if (request->distances) gd_field_vertex_distances(field, request->distances);
    gd_field_release(field);
    return trial;
}
