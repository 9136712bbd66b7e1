/* Fuzzes the decoders of JSON queries about meshes. The first byte selects the decoder. The
 * remaining bytes are the decoder's input. A refusal has a sentence; an accepted query is freed.
 * fuzz_request.c and fuzz_set.c also answer queries about pairs and sets. */
#include <stdlib.h>
#include <string.h>

#include "proto/queries/curves.h"
#include "generated/requests.h"
#include "proto/queries/isoline.h"
#include "proto/values/spline.h"
#include "proto/queries/made_mesh.h"
#include "proto/values/vector.h"
#include "proto/json/writer.h"
#include "tests/fuzz/promise.h"

enum { MOST_FACES = 100000 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A decoder whose result has a function that frees it. */
#define DECODES(name, type)                                                                        \
    static bool decode_##name(const json_t *document, struct proto_problem *problem)               \
    {                                                                                              \
        struct proto_##type out;                                                                   \
        bool is_taken = proto_##name##_decode(document, &out, problem);                            \
        if (is_taken) proto_##type##_free(&out);                                                   \
        return is_taken;                                                                           \
    }
DECODES(curve_distance, curve_distance)
DECODES(curve_operation_request, curve_operation_request)
DECODES(cut_request, cut_request)
DECODES(isolines, isolines)
DECODES(mean_request, mean_request)
DECODES(trace_request, trace_request)

static bool decode_spline(const json_t *document, struct proto_problem *problem)
{
    struct proto_spline spline;
    bool is_taken = proto_spline_decode(document, &spline, problem);
    if (is_taken) proto_spline_free(&spline);
    return is_taken;
}

static bool decode_voronoi(const json_t *document, struct proto_problem *problem)
{
    struct proto_voronoi_request voronoi;
    bool is_taken = proto_voronoi_request_decode(document, &voronoi, problem);
    if (is_taken) proto_set_free(&voronoi.set);
    return is_taken;
}

static bool decode_exp(const json_t *document, struct proto_problem *problem)
{
    struct proto_exp wanted;
    bool is_taken = proto_exp_decode(document, &wanted, problem);
    if (is_taken) proto_vectors_free(&wanted.vectors);
    return is_taken;
}

static bool decode_log(const json_t *document, struct proto_problem *problem)
{
    struct proto_log wanted;
    bool is_taken = proto_log_decode(document, &wanted, problem);
    if (is_taken) proto_points_free(&wanted.to);
    return is_taken;
}

static bool decode_transport(const json_t *document, struct proto_problem *problem)
{
    struct proto_transport wanted;
    bool is_taken = proto_transport_decode(document, &wanted, problem);
    if (is_taken) {
        proto_points_free(&wanted.ends);
        proto_vectors_free(&wanted.vectors);
    }
    return is_taken;
}

static bool decode_nearest(const json_t *document, struct proto_problem *problem)
{
    struct proto_nearest_request wanted;
    return proto_nearest_request_decode(document, &wanted, problem);
}

static bool decode_sampling(const json_t *document, struct proto_problem *problem)
{
    struct proto_sampling_request wanted;
    bool is_taken = proto_sampling_request_decode(document, &wanted, problem);
    promise(!is_taken || wanted.count > 0);
    return is_taken;
}

static bool decode_tessellation(const json_t *document, struct proto_problem *problem)
{
    struct proto_tessellation wanted;
    bool is_taken = proto_tessellation_decode(document, MOST_FACES, &wanted, problem);
    promise(!is_taken || wanted.mesh.text[0] != '\0');
    return is_taken;
}

static bool (*const decoders[])(const json_t *document,
                                struct proto_problem *problem) = {decode_curve_distance,
                                                                  decode_curve_operation_request,
                                                                  decode_cut_request,
                                                                  decode_isolines,
                                                                  decode_mean_request,
                                                                  decode_trace_request,
                                                                  decode_spline,
                                                                  decode_voronoi,
                                                                  decode_exp,
                                                                  decode_log,
                                                                  decode_transport,
                                                                  decode_nearest,
                                                                  decode_sampling,
                                                                  decode_tessellation};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) return 0;
    char *text = malloc(size); /* allocates exactly `size` bytes, so that overruns are detected */
    promise(text != NULL);
    memcpy(text, data + 1, size - 1);
    struct proto_problem problem;
    json_t *document = proto_decode_document(text, size - 1, &problem);
    if (!document || !decoders[data[0] % (sizeof decoders / sizeof *decoders)](document, &problem))
        promise_sentence(&problem);
    json_decref(document);
    free(text);
    return 0;
}
