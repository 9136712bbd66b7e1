#include "field/sources.h"

#include "field/array.h"
#include "mesh/segment.h"

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

bool gd__sources_window(const struct gd_field *field, const struct gd__chunk *chunk, uint32_t i,
                        uint32_t side, struct gd__window *out)
{
    double length = field->mesh->side[side].length,
           more = gd__stored_slack(length); /* it ties with its neighbour there */
    struct gd__window w = gd__field_window(field, chunk, i, length);
    if (w.source == GD_NONE) return false;
    if (side & 1) w = gd__window_mirrored(&w, length);
    if (gd__window_is_linear(&w)) more = 0;
    w.b0 = fmax(w.b0 - more, 0);
    w.b1 = fmin(w.b1 + more, length);
    *out = w;
    return true;
}

/* The unit normal (x, y) of a line in the frame of side k, turned into the face's. A source at its
 * wedge's very end sees all that is above. */
static struct gd__local normal(const struct gd__frame *frame, int k, double x, double y)
{
    double length = sqrt(x * x + y * y);
    return length > 0 ? gd__frame_turn(frame, k, x / length, y / length)
                      : gd__frame_turn(frame, k, 0, 1);
}

/* A linear source's sigma from its distance at a place. */
static void set_gradient(struct gd__source *source, struct gd__local gradient, struct gd__local at,
                         double distance)
{
    source->linear = source->has_sector = true;
    source->gradient = gradient;
    source->sigma = distance - (gradient.x * at.x + gradient.y * at.y);
}

/* A window that looks into the face across its side k. In homogeneous coordinates (window.h) its
 * sector's normals are alike for both kinds. */
static struct gd__source source_of_window(const struct gd__frame *frame, int k,
                                          const struct gd__window *w)
{
    bool linear = gd__window_is_linear(w);
    double b0 = linear ? 0 : w->b0, b1 = linear ? 0 : w->b1;
    struct gd__local place = gd__frame_place(frame, k, w->x, -w->y);
    struct gd__source source = {
        .at = place,
        .sigma = w->sigma,
        .has_sector = true,
        .left = normal(frame, k, w->y, w->x - b0),
        .right = normal(frame, k, -w->y, b1 - w->x),
        .left_at = place,
        .right_at = place,
        .nearest = gd__window_nearest(w),
        .farthest = fmax(gd__window_distance(w, w->b0), gd__window_distance(w, w->b1)),
        .pseudo = w->source & ~GD__SOURCE_LINEAR,
    };
    if (!linear) return source;
    source.at = (struct gd__local){0, 0};
    source.left_at = gd__frame_place(frame, k, w->b0, 0);
    source.right_at = gd__frame_place(frame, k, w->b1, 0);
    set_gradient(&source, gd__frame_turn(frame, k, -w->x, w->y), frame->corner[k], w->sigma);
    return source;
}

static enum gd_status append_wedges(const struct gd_field *field, int k, double most,
                                    struct gd__sources *out)
{
    uint32_t side = field->mesh->face_side[out->face][k];
    const uint32_t across = side & 1 ? GD__WINDOW_FAR_SIDE : 0;
    for (uint32_t at = field->newest[side >> 1]; at != GD_NONE;
         at = gd__field_chunk(field, at)->previous) {
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

static enum gd_status append_point(const struct gd_field *field, uint32_t seed,
                                   struct gd__sources *out)
{
    const struct gd__seed *s = &field->seeds[seed];
    double weight[3];
    gd__point_weights(field->mesh, &s->point, out->face, weight);
    struct gd__local place =
        gd__face_local(field->mesh, field->mesh->face_side[out->face][0], weight);
    return append(out, &(struct gd__source){.at = place,
                                            .sigma = s->offset,
                                            .left_at = place,
                                            .right_at = place,
                                            .nearest = s->offset,
                                            .farthest = s->offset,
                                            .pseudo = field->mesh->vertex_count + seed});
}

/* What a segment sees on its left (`left` = 1) or on its right (-1). */
static struct gd__source source_of_chord(const struct gd__chord *chord, int left, double offset)
{
    struct gd__local u = {left * chord->along.x, left * chord->along.y};
    struct gd__local ends[2] = {chord->from, chord->to};
    struct gd__source source = {.left = u,
                                .right = {-u.x, -u.y},
                                .left_at = ends[left < 0],
                                .right_at = ends[left > 0],
                                .nearest = offset,
                                .farthest = offset};
    set_gradient(&source, (struct gd__local){-u.y, u.x}, chord->from, offset);
    return source;
}

/* A segment along an edge sees the face on one side of it only. */
static enum gd_status append_chord(const struct gd_field *field, uint32_t seed,
                                   struct gd__sources *out)
{
    const struct gd__seed *s = &field->seeds[seed];
    const struct gd__local *corner = out->frame.corner;
    struct gd__home home = {GD_NONE, GD_NONE};
    struct gd__chord chord = gd__chord(field->mesh, out->face, 0, &s->point, &s->end);
    struct gd__local middle = {(corner[0].x + corner[1].x + corner[2].x) / 3,
                               (corner[0].y + corner[1].y + corner[2].y) / 3};
    bool is_inside =
             gd__segment_home(field->mesh, &s->point, &s->end, &home) && home.edge == GD_NONE,
         has_middle_on_left = gd__chord_height(&chord, middle) > 0;
    enum gd_status status = GD_OK;
    for (int left = -1; left <= 1 && !status; left += 2) {
        if (!is_inside && has_middle_on_left != (left > 0)) continue;
        struct gd__source source = source_of_chord(&chord, left, s->offset);
        source.pseudo = field->mesh->vertex_count + seed;
        status = append(out, &source);
    }
    return status;
}

static enum gd_status append_seeds(const struct gd_field *field, double most,
                                   struct gd__sources *out)
{
    enum gd_status status = GD_OK;
    const struct gd__face_seed *end = field->face_seeds + field->face_seed_count;
    for (const struct gd__face_seed *f = gd__field_seeds_in(field, out->face);
         f < end && f->face == out->face && !status; f++) {
        const struct gd__seed *seed = &field->seeds[f->seed];
        if (seed->offset >= most) continue;
        status = seed->is_segment ? append_chord(field, f->seed, out)
                                  : append_point(field, f->seed, out);
    }
    return status;
}

static enum gd_status append_corners(const struct gd_field *field, double most,
                                     struct gd__sources *out)
{
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++) {
        uint32_t vertex = field->mesh->origin[field->mesh->face_side[out->face][k]];
        double distance = field->distance[vertex];
        struct gd__source source = {.at = out->frame.corner[k],
                                    .sigma = distance,
                                    .left_at = out->frame.corner[k],
                                    .right_at = out->frame.corner[k],
                                    .nearest = distance,
                                    .farthest = distance,
                                    .pseudo = vertex};
        if (source.nearest < most) status = append(out, &source);
    }
    return status;
}

enum gd_status gd__sources_gather(const struct gd_field *field, uint32_t face, double most,
                                  struct gd__sources *out)
{
    out->face = face;
    out->frame = gd__frame_of_face(field->mesh, face);
    out->count = 0;
    enum gd_status status = append_seeds(field, most, out);
    for (int k = 0; k < 3 && !status; k++) status = append_wedges(field, k, most, out);
    if (!status) status = append_corners(field, most, out);
    return status;
}
