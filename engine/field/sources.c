#include "field/sources.h"

#include "base/array.h"
#include "mesh/segment.h"

/* Appends a source whose paths enter the face before `most`. */
static void append_source(struct gd__sources *sources, const struct gd__source *source, double most)
{
    if (source->nearest < most && !sources->status)
        sources->status = gd__array_append(&sources->source, &sources->count, &sources->capacity,
                                           source, sizeof *source);
}

void gd__sources_destroy(struct gd__sources *sources)
{
    free(sources->source);
    free(sources->covered.span);
    free(sources->spans.span);
    *sources = (struct gd__sources){0};
}

bool gd__edge_windows_next(struct gd__edge_windows *windows, struct gd__window *out)
{
    const struct gd_field *field = windows->field;
    double length = field->mesh->side[windows->side].length,
           more = gd__stored_slack(length); /* rounding error of the wedge's ends */
    struct gd__window w = {.source = GD_NONE};
    while (w.source == GD_NONE) {
        if (windows->chunk == GD_NONE) return false;
        const struct gd__chunk *chunk = gd__field_chunk(field, windows->chunk);
        if (windows->next < chunk->count) {
            w = gd__field_window(field, chunk, windows->next++, length);
        } else {
            windows->chunk = gd__chunk_previous(chunk);
            windows->next = 0;
        }
    }
    if (windows->side & 1) w = gd__window_mirrored(&w, length);
    if (gd__window_is_linear(&w)) more = 0;
    w.b0 = fmax(w.b0 - more, 0);
    w.b1 = fmin(w.b1 + more, length);
    *out = w;
    return true;
}

struct gd__face_seeds gd__edge_seeds(const struct gd_field *field, uint32_t edge)
{
    const uint32_t *face = &field->mesh->side_face[2 * edge];
    return gd__field_seeds_in(field, face[face[0] == GD_NONE]);
}

bool gd__edge_seed_window(const struct gd_field *field, uint32_t edge, uint32_t seed,
                          struct gd__window *out)
{
    const struct gd__seed *s = &field->seeds[seed];
    double length = field->mesh->side[2 * edge].length;
    if (s->is_segment || s->point.kind != GD_POINT_EDGE || s->point.element != edge) return false;
    *out = (struct gd__window){.b1 = length,
                               .x = s->point.weight[0] * length,
                               .sigma = s->offset,
                               .source = field->mesh->vertex_count + seed};
    return true;
}

/* Returns the normal (x, y) of a line, given in side k's frame, as a unit vector in the face's
 * frame. A source at the very end of its wedge (x = y = 0) sees everything above the side. */
static struct gd__local sector_normal(const struct gd__face_frame *frame, int k, double x, double y)
{
    double length = sqrt(x * x + y * y);
    return length > 0 ? gd__face_frame_turn(frame, k, x / length, y / length)
                      : gd__face_frame_turn(frame, k, 0, 1);
}

/* Makes a source linear. Sets sigma from the distance at the position `at`. */
static void set_gradient(struct gd__source *source, struct gd__local gradient, struct gd__local at,
                         double distance)
{
    source->linear = source->has_sector = true;
    source->gradient = gradient;
    source->sigma = distance - (gradient.x * at.x + gradient.y * at.y);
}

/* Returns the source of a window that enters the face across its side k. In homogeneous coordinates
 * (window.h) point and linear windows have the same normals. */
static struct gd__source source_of_window(const struct gd__face_frame *frame, int k,
                                          const struct gd__window *w)
{
    bool linear = gd__window_is_linear(w);
    double b0 = linear ? 0 : w->b0, b1 = linear ? 0 : w->b1;
    struct gd__local place = gd__face_frame_place(frame, k, w->x, -w->y);
    struct gd__source source = {
        .at = place,
        .sigma = w->sigma,
        .has_sector = true,
        .left = sector_normal(frame, k, w->y, w->x - b0),
        .right = sector_normal(frame, k, -w->y, b1 - w->x),
        .left_at = place,
        .right_at = place,
        .nearest = gd__window_nearest(w),
        .farthest = fmax(gd__window_distance(w, w->b0), gd__window_distance(w, w->b1)),
        .pseudo = w->source & ~GD__SOURCE_LINEAR,
    };
    if (!linear) return source;
    source.at = (struct gd__local){0, 0};
    source.left_at = gd__face_frame_place(frame, k, w->b0, 0);
    source.right_at = gd__face_frame_place(frame, k, w->b1, 0);
    set_gradient(&source, gd__face_frame_turn(frame, k, -w->x, w->y), frame->corner[k], w->sigma);
    return source;
}

static void append_wedges(const struct gd_field *field, int k, double most, struct gd__sources *out)
{
    uint32_t side = field->mesh->face_side[out->face][k];
    const uint32_t across = side & 1 ? GD__WINDOW_FAR_SIDE : 0;
    struct gd__edge_windows windows = gd__edge_windows(field, side);
    for (struct gd__window w; gd__edge_windows_next(&windows, &w);) {
        if (w.tags != across) continue;
        struct gd__source source = source_of_window(&out->frame, k, &w);
        append_source(out, &source, most);
    }
}

/* Appends a point that sees the whole face: a seed or a corner. */
static void append_point(struct gd__sources *out, struct gd__local place, double distance,
                         uint32_t pseudo, double most)
{
    const struct gd__source source = {.at = place,
                                      .sigma = distance,
                                      .left_at = place,
                                      .right_at = place,
                                      .nearest = distance,
                                      .farthest = distance,
                                      .pseudo = pseudo};
    append_source(out, &source, most);
}

/* Returns the source of a segment for its left side (`left` = 1) or its right side (`left` =
 * -1). */
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

/* Appends the sources of a seed segment. A segment along an edge has only one source in this face,
 * because the face lies on one side of the segment. */
static void append_chord(const struct gd_field *field, uint32_t seed, double most,
                         struct gd__sources *out)
{
    const struct gd__seed *s = &field->seeds[seed];
    struct gd__segment_location location = {GD_NONE, GD_NONE};
    struct gd__chord chord = gd__chord(field->mesh, out->face, 0, &s->point, &s->end);
    bool is_inside = gd__segment_locate(field->mesh, &s->point, &s->end, &location) &&
                     location.edge == GD_NONE,
         has_middle_on_left = gd__chord_height(&chord, gd__face_frame_middle(&out->frame)) > 0;
    for (int left = -1; left <= 1; left += 2) {
        if (!is_inside && has_middle_on_left != (left > 0)) continue;
        struct gd__source source = source_of_chord(&chord, left, s->offset);
        source.pseudo = field->mesh->vertex_count + seed;
        append_source(out, &source, most);
    }
}

static void append_seeds(const struct gd_field *field, double most, struct gd__sources *out)
{
    for (struct gd__face_seeds f = gd__field_seeds_in(field, out->face); f.at < f.end; f.at++) {
        const struct gd__seed *seed = &field->seeds[f.at->seed];
        if (seed->is_segment)
            append_chord(field, f.at->seed, most, out);
        else
            append_point(out, gd__point_local(field->mesh, out->face, &seed->point), seed->offset,
                         field->mesh->vertex_count + f.at->seed, most);
    }
}

enum gd_status gd__sources_gather(const struct gd_field *field, uint32_t face, double most,
                                  struct gd__sources *out)
{
    out->face = face;
    out->frame = gd__face_frame_of(field->mesh, face);
    out->count = 0;
    append_seeds(field, most, out);
    for (int k = 0; k < 3; k++) append_wedges(field, k, most, out);
    for (int k = 0; k < 3; k++) {
        uint32_t vertex = field->mesh->origin[field->mesh->face_side[face][k]];
        append_point(out, out->frame.corner[k], field->distance[vertex], vertex, most);
    }
    return out->status;
}
