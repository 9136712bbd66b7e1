/* Fuzzes the decoders of sets and of queries about them. The first byte selects the decoder (field
 * requests, or distances to a set). The remaining bytes are the decoder's input. The fuzzer locates
 * an accepted set on a mesh, builds its field and evaluates it. The distance to a set must be the
 * least distance to its members. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "generated/requests.h"
#include "proto/queries/evaluation.h"
#include "proto/queries/field.h"
#include "tests/fuzz/promise.h"

/* only sets within these limits are answered, because each member needs its own field */
enum { MOST_MEMBERS = 24, MOST_POINTS = 24 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Returns an open box with a roof ridge. The mesh is made once and kept until the program ends. */
static const struct gd_mesh *house(void)
{
    static struct gd_mesh *mesh;
    static double positions[10][3] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0},   {0, 0, 1},
                                      {2, 0, 1}, {2, 1, 1}, {0, 1, 1}, {0, 0.5, 2}, {2, 0.5, 2}};
    static uint32_t corners[] = {0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 5, 6, 9,
                                 3, 0, 4, 3, 4, 7, 4, 8, 7, 4, 5, 9, 4, 9, 8, 6, 7, 8, 6, 8, 9};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 10, .polygon_count = 14, .corners = corners};
    if (!mesh) promise(gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL) == GD_OK);
    return mesh;
}

/* Builds a field. Returns NULL if the engine refuses because of rounding. */
static struct gd_field *build(const struct gd_seed *seeds, uint32_t count, double radius)
{
    const struct gd_field_request request = {.seeds = seeds, .seed_count = count, .radius = radius};
    struct gd_field *field;
    enum gd_status status = gd_field_build(house(), &request, NULL, &field, NULL);
    promise(status == GD_OK || status == GD_INTERNAL);
    return status ? NULL : field;
}

static void check_least(const struct proto_located_set *set,
                        const struct proto_located_points *points, const double *distances)
{
    double least[MOST_POINTS], alone[MOST_POINTS];
    for (uint32_t i = 0; i < points->count; i++) least[i] = INFINITY;
    for (uint32_t k = 0; k < set->seed_count; k++) {
        struct gd_field *field = build(&set->seeds[k], 1, 0);
        if (!field) return;
        promise(gd_field_distances(field, points->points, points->count, NULL, alone) == GD_OK);
        for (uint32_t i = 0; i < points->count; i++) least[i] = fmin(least[i], alone[i]);
        gd_field_release(field);
    }
    for (uint32_t i = 0; i < points->count; i++)
        promise(fabs(least[i] - distances[i]) <= 1e-9 * (1 + least[i]));
}

static void encode(const struct gd_field *field, const struct proto_located_set *set,
                   const struct proto_located_points *points, const double *distances)
{
    struct proto_writer writer;
    proto_writer_init(&writer, 1 << 20);
    proto_write_array_begin(&writer);
    for (uint32_t i = 0; i < points->count; i++) {
        struct proto_result result = {.distance = distances[i]};
        struct gd_path path = {0};
        double distance;
        uint32_t seed;
        promise(gd_field_nearest(field, &points->points[i], &distance, &seed) == GD_OK);
        promise(seed < set->seed_count && distance == distances[i]);
        promise(gd_field_path_to_seed(field, &points->points[i], &path, &seed) == GD_OK);
        promise(seed < set->seed_count && set->members[seed] < set->count);
        result.member = set->members[seed];
        result.nearest = path.points[path.count - 1];
        result.path = &path;
        proto_result_encode(&writer, house(), set, &result, UINT32_MAX, PROTO_GEOMETRY_FULL);
        gd_path_free(&path);
    }
    proto_write_array_end(&writer);
    promise_json(&writer);
}

static void answer(const struct proto_located_set *set, const struct proto_located_points *points)
{
    double distances[MOST_POINTS];
    if (set->seed_count > MOST_MEMBERS || points->count > MOST_POINTS) return;
    struct gd_field *field = build(set->seeds, set->seed_count, 0);
    if (!field) return;
    promise(gd_field_distances(field, points->points, points->count, NULL, distances) == GD_OK);
    check_least(set, points, distances);
    encode(field, set, points, distances);
    gd_field_release(field);
}

static bool fuzz_distance_to_set(const json_t *document, struct proto_problem *problem)
{
    struct proto_set_distance_request wanted;
    struct proto_located_points points = {0};
    if (!proto_set_distance_request_decode(document, &wanted, problem)) return false;
    struct proto_located_set *located = NULL;
    bool ok = !proto_set_locate(house(), &wanted.set, NULL, &located, problem) &&
              proto_points_locate(house(), &wanted.points, &points, problem);
    if (ok) answer(located, &points);
    proto_located_points_free(&points);
    proto_set_distance_request_free(&wanted);
    free(located);
    return ok;
}

static bool fuzz_field(const json_t *document, struct proto_problem *problem)
{
    struct proto_field_request wanted;
    if (!proto_field_request_decode(document, &wanted, problem)) return false;
    struct proto_located_set *located = NULL;
    bool ok = !proto_set_locate(house(), &wanted.set, NULL, &located, problem);
    struct gd_field *field = NULL;
    if (ok && located->seed_count <= MOST_MEMBERS)
        field = build(located->seeds, located->seed_count, wanted.max_distance);
    gd_field_release(field);
    proto_set_free(&wanted.set);
    free(located);
    return ok;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct proto_problem problem;
    if (size == 0) return 0;
    char *text = malloc(size); /* allocates no additional byte, so that overruns are detected */
    promise(text != NULL);
    memcpy(text, data + 1, size - 1);
    json_t *document = proto_decode_document(text, size - 1, &problem);
    free(text);
    bool ok = document && (data[0] & 1 ? fuzz_field(document, &problem)
                                       : fuzz_distance_to_set(document, &problem));
    json_decref(document);
    if (!ok) promise_sentence(&problem);
    return 0;
}
