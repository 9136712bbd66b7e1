#include "tests/bench/trial.h"

#include <stdlib.h>

#include "field/layout.h"
#include "tests/bench/bench.h"

struct recorder {
    /* equals the result of gd_field_build, but is computed by the trial's methods */
    struct gd_field *field;
    struct trial *trial;
    double start_ms;
};

/* Receives the final wedges of the propagation. Stops the clock, counts the wedges, and stores them
 * as a field does. */
static enum gd_status record(void *user, struct gd__wavefront *front)
{
    struct recorder *recorder = user;
    struct trial *trial = recorder->trial;
    trial->ms = bench_thread_ms() - recorder->start_ms;
    trial->produced = front->counts.windows_created;
    trial->propagated = front->counts.windows_propagated;
    return gd__field_take(recorder->field, front);
}

/* Counts the wedges of the final stage in two ways: as stored without gaps, and after merging the
 * lists of each edge into one list. */
static void count_wedges(const struct gd_field *field, struct trial *trial)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t edge = 0; edge < mesh->edge_count; edge++) {
        struct gd_vertex a = {mesh->index_of_vertex[mesh->origin[2 * edge]]},
                         b = {mesh->index_of_vertex[mesh->origin[2 * edge + 1]]};
        struct gd_wedge *wedges;
        uint32_t count;
        bench_require(gd_field_wedges(field, a, b, &wedges, &count), NULL);
        free(wedges);
        trial->kept_merged += count;
        for (uint32_t at = field->newest[edge]; at != GD_NONE;
             at = gd__chunk_previous(gd__field_chunk(field, at))) {
            const struct gd__chunk *chunk = gd__field_chunk(field, at);
            struct gd__wedges stored = gd__chunk_wedges(chunk);
            for (uint32_t i = 0; i < chunk->count; i++)
                trial->kept_half += gd__wedge_source(&stored, i) != GD_NONE;
        }
    }
}

/* Creates a field from one seed, without wedges. */
static struct gd_field *open_field(const struct gd_mesh *mesh, const struct gd_point *source)
{
    struct gd_field *field = gd__field_create(mesh);
    if (!field) bench_require(GD_NO_MEMORY, NULL);
    field->seeds = bench_allocate(sizeof *field->seeds);
    field->seeds[0] = (struct gd__seed){.point = *source};
    field->seed_count = 1;
    return field;
}

struct trial trial_run(const struct gd_mesh *mesh, const struct trial_request *request)
{
    struct trial trial = {0};
    struct gd_field *field = open_field(mesh, &request->source);
    struct gd__propagation propagation = {.seeds = field->seeds,
                                          .seed_count = field->seed_count,
                                          .radius = GD__FAR,
                                          .target = request->target,
                                          .variant = request->methods};
    struct recorder recorder = {.field = field, .trial = &trial, .start_ms = bench_thread_ms()};
    struct gd__sink sink = {.take = record, .user = &recorder};
    bench_require(gd__wavefront_run(mesh, &propagation, &sink, NULL), NULL);
    count_wedges(field, &trial);
    if (request->distances) gd_field_vertex_distances(field, request->distances);
    gd_field_release(field);
    return trial;
}
