/* Fuzzes the decoders of requests, and their answers. The first byte selects the decoder. The
 * remaining bytes are the decoder's input. An accepted request is located on a mesh and answered;
 * the answer must be JSON. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/mesh.h"
#include "gd/query.h"
#include "proto/http/accept.h"
#include "proto/queries/batch.h"
#include "proto/json/decode.h"
#include "proto/queries/matrix.h"
#include "proto/values/mesh.h"
#include "proto/queries/pair.h"
#include "proto/values/point.h"
#include "proto/json/writer.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Returns a cube with triangles of two sizes. The mesh is made once and kept until the program
 * ends. */
static const struct gd_mesh *cube(void)
{
    static struct gd_mesh *mesh;
    static double positions[9][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},    {0, 0, 1},
                                     {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.4, 0.6, 1}};
    static uint32_t corners[] = {0, 3, 2, 0, 2, 1, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7,
                                 2, 7, 6, 3, 0, 4, 3, 4, 7, 4, 5, 8, 5, 6, 8, 6, 7, 8, 7, 4, 8};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 9, .polygon_count = 14, .corners = corners};
    if (!mesh) promise(gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL) == GD_OK);
    return mesh;
}

/* Answers the query for the first two stops, and frees the stops. */
static void answer(struct proto_points *stops)
{
    struct proto_located_points located;
    struct proto_problem problem;
    struct gd_pair_answer result;
    struct proto_writer writer;
    bool is_located = proto_points_locate(cube(), stops, &located, &problem);
    proto_points_free(stops);
    if (!is_located) {
        promise_sentence(&problem);
        return;
    }
    promise(gd_pair_solve(cube(),
                          &(struct gd_pair_request){.from = &located.points[0],
                                                    .to = &located.points[1],
                                                    .output = GD_PAIR_PATH},
                          NULL, &result, NULL) == GD_OK);
    promise(result.distance >= 0 && isfinite(result.distance) && result.path.count > 0);
    struct proto_options options = {.fields = ~0u};
    proto_writer_init(&writer, 1 << 20);
    proto_pair_encode(&writer, &located, &result, &options);
    json_t *back = json_loadb(writer.data, writer.size, JSON_REJECT_DUPLICATES, NULL);
    promise(back != NULL);
    json_decref(back);
    proto_writer_free(&writer);
    gd_pair_answer_free(&result);
    proto_located_points_free(&located);
}

static void fuzz_document(const char *text, size_t size)
{
    struct proto_problem problem;
    struct proto_points stops;
    json_t *document = proto_decode_document(text, size, &problem);
    if (document && proto_pair_decode(document, &stops, &problem))
        answer(&stops);
    else
        promise_sentence(&problem);
    json_decref(document);
}

/* Parses compact points, separated by semicolons. */
static void fuzz_compact_points(const char *text)
{
    struct proto_problem problem;
    struct proto_points stops = {0};
    if (proto_points_parse(&stops, text, "via", PROTO_PAIR_VIA, &problem) &&
        proto_points_parse(&stops, "v:0", "to", 1, &problem)) {
        answer(&stops);
        return;
    }
    promise_sentence(&problem);
    proto_points_free(&stops);
}

/* Each line of a batch is accepted or has a problem, and its output is JSON. */
static void fuzz_batch(const char *text, size_t size)
{
    struct proto_batch_line line = {0};
    struct proto_problem problem;
    while (proto_batch_next(text, size, &line)) {
        struct proto_batch_query query;
        promise(line.size > 0 && line.end <= size);
        if (proto_batch_decode(&line, &query, &problem))
            proto_batch_query_free(&query);
        else
            promise_sentence(&problem);
    }
}

static void fuzz_matrix(const char *text, size_t size)
{
    struct proto_problem problem;
    struct proto_matrix_request matrix;
    json_t *document = proto_decode_document(text, size, &problem);
    if (document && proto_matrix_request_decode(document, &matrix, &problem))
        proto_matrix_request_free(&matrix);
    else
        promise_sentence(&problem);
    json_decref(document);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) return 0;
    /* allocates exactly the remaining bytes and a NUL, so that overruns are detected */
    char *text = malloc(size);
    promise(text != NULL);
    memcpy(text, data + 1, size - 1);
    text[size - 1] = '\0';
    struct proto_problem problem;
    switch (data[0] % 6) {
    case 0:
        fuzz_document(text, size - 1);
        break;
    case 1:
        fuzz_compact_points(text);
        break;
    case 2:
        promise(proto_accept_quality(text, "application/json") <= 1000);
        break;
    case 3:
        if (!proto_mesh_name_check(text, size - 1, &problem)) promise_sentence(&problem);
        break;
    case 4:
        fuzz_batch(text, size - 1);
        break;
    case 5:
        fuzz_matrix(text, size - 1);
        break;
    }
    free(text);
    return 0;
}
