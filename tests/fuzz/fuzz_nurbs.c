/* Fuzzes the decoders of NURBS files and of curves in their domains. The first byte selects the
 * decoder (files, or the three queries about shortest paths). The remaining bytes are the decoder's
 * input. An accepted surface has finite points everywhere in its domain, with unit normals; an
 * accepted curve lies in the domain of its surface. */
#include <math.h>

#include "proto/json/decode.h"
#include "proto/queries/geodesic_like.h"
#include "proto/queries/nurbs.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* --- files ------------------------------------------------------------------------------------ */

static void require_points(const struct gd_parametric *surface)
{
    const struct gd_axis *u = gd_parametric_axis_u(surface), *v = gd_parametric_axis_v(surface);
    for (int i = 0; i <= 4; i++) {
        for (int j = 0; j <= 4; j++) {
            struct gd_jet jet;
            double at[2] = {i == 4 ? u->high : u->low + (u->high - u->low) * i / 4,
                            j == 4 ? v->high : v->low + (v->high - v->low) * j / 4};
            promise(gd_parametric_evaluate(surface, at[0], at[1], &jet) == GD_OK);
            promise(isfinite(jet.x.x) && isfinite(jet.x.y) && isfinite(jet.x.z));
            const struct gd_curvature curvature = gd_jet_curvature(&jet);
            promise(!curvature.regular || fabs(gd_vec3_length(curvature.normal) - 1) < 1e-9);
        }
    }
}

/* A nearest point of a trimmed surface lies in its domain. Only a surface that is almost a line has
 * none, because its grid would be too large. */
static void require_domain(const struct gd_parametric *surface)
{
    struct gd_parametric_closest found;
    bool has_outer;
    if (!gd_parametric_loops(surface, &has_outer)) return;
    enum gd_status status =
        gd_parametric_nearest(surface, (struct gd_vec3){0.3, 0.2, 0.1}, NULL, &found, NULL);
    promise(status == GD_OK || status == GD_TOO_LARGE);
    promise(status != GD_OK || gd_parametric_contains(surface, found.u, found.v));
}

static void read_file(const uint8_t *data, size_t size)
{
    static const struct proto_nurbs_options options;
    struct proto_nurbs_description description = {
        .name = "n", .sha256 = "", .etag = "", .obstacle = "none"};
    struct proto_problem problem;
    struct proto_writer writer;
    struct gd_parametric *surface;
    if (!proto_nurbs_read(data, size, &options, &surface, &description.form, &problem)) {
        promise_sentence(&problem);
        return;
    }
    require_points(surface);
    require_domain(surface);
    description.surface = surface;
    description.trimming_loops = gd_parametric_loops(surface, &description.has_outer_loop);
    proto_writer_init(&writer, 65536);
    proto_nurbs_encode(&writer, &description);
    promise_json(&writer);
    gd_parametric_release(surface);
}

/* --- questions -------------------------------------------------------------------------------- */

/* Returns a surface that is straight in one direction and periodic in the other direction. The
 * surface is made once and kept until the program ends. */
static const struct gd_parametric *vase(void)
{
    static struct gd_parametric *surface;
    static const double knots[] = {0, 0, 1, 2, 3, 3},
                        points[][2] = {{1, 0}, {2, 1}, {1.5, 2}, {3, 3}};
    const struct gd_profile profile = {.degree = 1, .count = 4, .knots = knots, .points = points};
    if (!surface) promise(gd_parametric_revolution(&profile, &surface, NULL) == GD_OK);
    return surface;
}

static void require_curve(const struct proto_domain_curve *wanted)
{
    struct proto_problem problem;
    struct gd_domain_curve *curve;
    double low, high;
    if (!proto_domain_curve_locate(vase(), wanted, NULL, &curve, &problem)) {
        promise_sentence(&problem);
        return;
    }
    gd_domain_curve_range(curve, &low, &high);
    promise(low <= high);
    for (int i = 0; i <= 8; i++) {
        double uv[2];
        gd_domain_curve_at(curve, low + (high - low) * i / 8, uv);
        promise(uv[1] > -1e-9 && uv[1] < 3 + 1e-9 && isfinite(uv[0]));
    }
    gd_domain_curve_release(curve);
}

static void read_question(const uint8_t *data, size_t size, const struct proto_geodesic_form *form)
{
    struct proto_problem problem;
    struct proto_geodesic wanted;
    json_t *document = proto_decode_document(data, size, &problem);
    if (!document) {
        promise_sentence(&problem);
        return;
    }
    if (proto_geodesic_decode(document, form, &wanted, &problem)) {
        for (int k = 0; k < 2; k++) require_curve(&wanted.ends[k]);
        proto_geodesic_free(&wanted);
    } else {
        promise_sentence(&problem);
    }
    json_decref(document);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct proto_geodesic_form *const forms[] = {
        &proto_geodesic_between_points, &proto_geodesic_to_curve, &proto_geodesic_between_curves};
    if (size == 0) return 0;
    if (data[0] % 4 == 0)
        read_file(data + 1, size - 1);
    else
        read_question(data + 1, size - 1, forms[data[0] % 4 - 1]);
    return 0;
}
