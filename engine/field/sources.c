#include "field/sources.h"

#include "field/array.h"

/* Ends of wedges are stored to 2^-32 of the edge: a source is taken to see two such units more, where it ties with its neighbour. */
#define LENGTHENED 2

static enum gd_status append(struct gd__sources *sources, const struct gd__source *source)
{
    struct gd__source *grown =
        gd__array_reserve(sources->source, &sources->capacity, sources->count + 1, sizeof *source);
    if (!grown) return GD_NO_MEMORY;
    sources->source = grown;
    sources->source[sources->count++] = *source;
    return GD_OK;
}

void gd__sources_destroy(struct gd__sources *sources)
{
    free(sources->source);
    *sources = (struct gd__sources){0};
}

bool gd__sources_window(const struct gd_field *field, const struct gd__chunk *chunk, uint32_t i, uint32_t side,
                        struct gd__window *out)
{
    double length = field->mesh->side[side].length, more = LENGTHENED * GD__WEDGE_UNIT * length;
    struct gd__window w = gd__field_window(field, chunk, i, length);
    if (w.source == GD_NONE) return false;
    if (side & 1) w = gd__window_mirrored(&w, length);
    if (gd__window_is_linear(&w)) more = 0;
    w.b0 = fmax(w.b0 - more, 0);
    w.b1 = fmin(w.b1 + more, length);
    *out = w;
    return true;
}

/* The unit normal (x, y) of a line in the frame of side k, turned into the face's. A source at its wedge's very end sees all that is above. */
static struct gd__local normal(const struct gd__frame *frame, int k, double x, double y)
{
    double length = sqrt(x * x + y * y);
    return length > 0 ? gd__frame_turn(frame, k, x / length, y / length) : gd__frame_turn(frame, k, 0, 1);
}

/* A window that looks into the face across its side k. */
static struct gd__source source_of_window(const struct gd__frame *frame, int k, const struct gd__window *w)
{
    return (struct gd__source){
        .at = gd__frame_place(frame, k, w->x, -w->y),
        .sigma = w->sigma,
        .has_sector = true,
        .left = normal(frame, k, w->y, w->x - w->b0),
        .right = normal(frame, k, -w->y, w->b1 - w->x),
        .nearest = gd__window_nearest(w),
        .farthest = fmax(gd__window_distance(w, w->b0), gd__window_distance(w, w->b1)),
        .pseudo = w->source,
    };
}

static enum gd_status append_wedges(const struct gd_field *field, int k, double most, struct gd__sources *out)
{
    uint32_t side = field->mesh->face_side[out->face][k];
    const uint32_t across = side & 1 ? GD__WINDOW_FAR_SIDE : 0;
    for (uint32_t at = field->newest[side >> 1]; at != GD_NONE; at = gd__field_chunk(field, at)->previous) {
        const struct gd__chunk *chunk = gd__field_chunk(field, at);
        for (uint32_t i = 0; i < chunk->count; i++) {
            struct gd__window w;
            if (!gd__sources_window(field, chunk, i, side, &w) || w.tags != across) continue;
            struct gd__source source = source_of_window(&out->frame, k, &w);
            if (source.nearest >= most) continue;
            enum gd_status status = append(out, &source);
            if (status) return status;
        }
    }
    return GD_OK;
}

static enum gd_status append_seeds(const struct gd_field *field, double most, struct gd__sources *out)
{
    enum gd_status status = GD_OK;
    const struct gd__face_seed *end = field->face_seeds + field->face_seed_count;
    for (const struct gd__face_seed *f = gd__field_seeds_in(field, out->face);
         f < end && f->face == out->face && !status; f++) {
        const struct gd__seed *seed = &field->seeds[f->seed];
        double weight[3];
        gd__point_weights(field->mesh, &seed->point, out->face, weight);
        struct gd__source source = {.at = gd__face_local(field->mesh, field->mesh->face_side[out->face][0], weight),
                                    .sigma = seed->offset,
                                    .nearest = seed->offset,
                                    .farthest = seed->offset,
                                    .pseudo = field->mesh->vertex_count + f->seed};
        if (source.nearest < most) status = append(out, &source);
    }
    return status;
}

static enum gd_status append_corners(const struct gd_field *field, double most, struct gd__sources *out)
{
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++) {
        uint32_t vertex = field->mesh->origin[field->mesh->face_side[out->face][k]];
        double distance = field->distance[vertex];
        struct gd__source source = {
            .at = out->frame.corner[k], .sigma = distance, .nearest = distance, .farthest = distance, .pseudo = vertex};
        if (source.nearest < most) status = append(out, &source);
    }
    return status;
}

enum gd_status gd__sources_gather(const struct gd_field *field, uint32_t face, double most, struct gd__sources *out)
{
    out->face = face;
    out->frame = gd__frame_of_face(field->mesh, face);
    out->count = 0;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++) status = append_wedges(field, k, most, out);
    if (!status) status = append_seeds(field, most, out);
    if (!status) status = append_corners(field, most, out);
    return status;
}
