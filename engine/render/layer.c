#include "render/layer.h"

#include <stdlib.h>
#include <string.h>

#define LINE_WIDTH  3.0
#define THIN_WIDTH  1.6 /* width of a line if the layer has several */
#define MARK_RADIUS 4.2
#define HALO_LEAST  2.0  /* thinner lines have no halo */
#define HALO        1.8  /* width of a halo, relative to the line */
#define FAINT       0.4  /* opacity of hidden marks */
#define HEAD        9.0  /* length of an arrow's head, in units */
#define HEAD_SPREAD 0.38 /* half of its width, relative to its length */
#define LETTERS     13.0 /* font size of labels, in units */

enum { CHECK_INTERVAL = 64 }; /* lines */

struct gd__colour gd__layer_colour(const struct gd_picture_layer *layer, uint32_t number,
                                   const struct gd__palette *palette)
{
    /* the palette's path colour (written as 0), blue, green, orange, purple, brown, teal */
    static const uint32_t colours[] = {0,        0x1a5fb4, 0x1b7f3b, 0xd97706,
                                       0x7b2fbe, 0x7a4a21, 0x0b7a8a};
    uint32_t next = colours[number % (sizeof colours / sizeof *colours)];
    if (layer->colour) return gd__colour_of_rgb(layer->colour);
    if (!layer->first) return palette->line;
    return next ? gd__colour_of_rgb(next) : palette->path;
}

double gd__layer_width(const struct gd_picture_layer *layer, double unit)
{
    double usual = !layer->first ? MARK_RADIUS : layer->count > 1 ? THIN_WIDTH : LINE_WIDTH;
    return unit * (layer->width > 0 ? layer->width : usual);
}

/* --- projection ------------------------------------------------------------------------------- */

static struct gd__screen_point layer_project(const struct gd__stage *stage, struct gd_vec3 position)
{
    return gd__camera_project(stage->camera, gd_vec3_scale(position, 1 / stage->mesh->unit));
}

static void mark_set(struct gd__mark *mark, const struct gd__stage *stage, struct gd_vec3 position)
{
    struct gd__screen_point point = layer_project(stage, position);
    *mark = (struct gd__mark){{point.x, point.y},
                              gd__depth_buffer_visibility(stage->buffer, &point, 1) > 0};
}

static enum gd_status marks_open(struct gd__layer *layer, const struct gd__stage *stage,
                                 uint32_t count)
{
    layer->marks = gd__arena_take(stage->arena, count, sizeof *layer->marks);
    layer->mark_count = layer->marks ? count : 0;
    return stage->arena->status;
}

static bool is_near(const struct gd__stage *stage, struct gd__screen_point point)
{
    float width = (float)stage->buffer->width, height = (float)stage->buffer->height;
    return point.x >= -width && point.x <= 2 * width && point.y >= -height && point.y <= 2 * height;
}

static float cut_at(float a, float b, float bound)
{
    return (bound - a) / (b - a);
}

/* Cuts off the parts of a segment that are farther from the picture than the picture's size.
 * Returns false if no part is left. */
static bool segment_clip(const struct gd__stage *stage, struct gd__screen_point *a,
                         struct gd__screen_point *b)
{
    const float size[2] = {(float)stage->buffer->width, (float)stage->buffer->height},
                from[2] = {a->x, a->y}, to[2] = {b->x, b->y};
    float begin = 0, end = 1;
    for (int k = 0; k < 2; k++)
        for (int side = 0; side < 2; side++) {
            float bound = side ? 2 * size[k] : -size[k];
            bool is_from_out = side ? from[k] > bound : from[k] < bound,
                 is_to_out = side ? to[k] > bound : to[k] < bound;
            if (is_from_out && is_to_out) return false;
            if (is_from_out) begin = fmaxf(begin, cut_at(from[k], to[k], bound));
            if (is_to_out) end = fminf(end, cut_at(from[k], to[k], bound));
        }
    if (begin >= end) return false;
    const struct gd__screen_point p = *a, q = *b;
    const float t[2] = {begin, end};
    struct gd__screen_point *const out[2] = {a, b};
    for (int k = 0; k < 2; k++)
        *out[k] = (struct gd__screen_point){p.x + t[k] * (q.x - p.x), p.y + t[k] * (q.y - p.y),
                                            p.z + t[k] * (q.z - p.z)};
    return true;
}

/* Divides a projected line. The budget is charged for the scratch memory until the division ends,
 * and for the result permanently. */
static enum gd_status line_split(struct gd__layer *layer, const struct gd__stage *stage,
                                 const struct gd__screen_point *line, uint32_t count)
{
    struct gd__lines *hidden = layer->wanted->hidden == GD_HIDDEN_FAINT ? &layer->hidden : NULL;
    size_t before = (size_t)layer->seen.place_count + layer->hidden.place_count,
           working = gd__depth_buffer_split_bytes(line, count);
    if (layer->wanted->hidden == GD_HIDDEN_SHOWN) {
        for (uint32_t i = 0; i < count; i++) gd__lines_add(&layer->seen, line[i].x, line[i].y);
        gd__lines_end(&layer->seen);
        gd__lines_simplify(&layer->seen, 0.1);
    } else {
        enum gd_status status = gd__budget_take(&stage->arena->budget, working);
        if (status) return status;
        status = gd__depth_buffer_split(stage->buffer, line, count, &layer->seen, hidden);
        stage->arena->budget.held -= working;
        if (status) return status;
    }
    size_t after = (size_t)layer->seen.place_count + layer->hidden.place_count;
    return layer->seen.status ? layer->seen.status
                              : gd__budget_take(&stage->arena->budget,
                                                2 * (after - before) * sizeof *layer->seen.places);
}

/* Projects a line with parts far outside the picture, and divides it segment by segment. */
static enum gd_status line_split_clipped(struct gd__layer *layer, const struct gd__stage *stage,
                                         const struct gd__screen_point *line, uint32_t count)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i + 1 < count && !status; i++) {
        struct gd__screen_point ends[2] = {line[i], line[i + 1]};
        if (segment_clip(stage, &ends[0], &ends[1])) status = line_split(layer, stage, ends, 2);
    }
    return status;
}

/* Adds the two strokes of an arrow's head if the line's end is visible, or if hidden parts are
 * drawn like visible ones. */
static void arrow_add(struct gd__layer *layer, const struct gd__stage *stage,
                      const struct gd__screen_point *line, uint32_t count)
{
    const struct gd__screen_point *tip = &line[count - 1];
    uint32_t from = count - 1;
    double length = HEAD * stage->unit, x = 0, y = 0;
    while (from > 0 && hypot(x, y) < length) {
        from--;
        x = (double)tip->x - line[from].x, y = (double)tip->y - line[from].y;
    }
    double whole = hypot(x, y);
    bool is_seen = layer->wanted->hidden == GD_HIDDEN_SHOWN ||
                   gd__depth_buffer_visibility(stage->buffer, tip, 1) > 0;
    if (!is_seen || !(whole > 0) || !is_near(stage, *tip)) return;
    length = fmin(length, 0.6 * whole) / whole;
    for (int side = -1; side <= 1; side += 2) {
        gd__lines_add(&layer->seen, tip->x, tip->y);
        gd__lines_add(&layer->seen, tip->x - length * (x - side * HEAD_SPREAD * y),
                      tip->y - length * (y + side * HEAD_SPREAD * x));
        gd__lines_end(&layer->seen);
    }
}

static enum gd_status line_project(struct gd__layer *layer, const struct gd__stage *stage,
                                   const struct gd_vec3 *points, uint32_t count)
{
    size_t bytes = count * sizeof(struct gd__screen_point);
    bool is_inside = true;
    enum gd_status status = gd__budget_take(&stage->arena->budget, bytes);
    if (status) return status;
    struct gd__screen_point *line = malloc(bytes);
    for (uint32_t i = 0; line && i < count; i++) {
        line[i] = layer_project(stage, points[i]);
        is_inside &= is_near(stage, line[i]);
    }
    status = !line       ? GD_NO_MEMORY
             : is_inside ? line_split(layer, stage, line, count)
                         : line_split_clipped(layer, stage, line, count);
    if (!status && layer->wanted->ends == GD_LINE_ENDS_ARROWS) arrow_add(layer, stage, line, count);
    free(line);
    stage->arena->budget.held -= bytes;
    return status ? status : layer->seen.status;
}

static enum gd_status lines_project(struct gd__layer *layer, const struct gd__stage *stage,
                                    const struct gd_control *control)
{
    const struct gd_picture_layer *wanted = layer->wanted;
    const uint32_t *first = wanted->first;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < wanted->count && !status; i++) {
        if (first[i] < first[i + 1])
            status = line_project(layer, stage, wanted->points + first[i], first[i + 1] - first[i]);
        if (!status && i % CHECK_INTERVAL == 0) status = gd_control_check(control, 0);
    }
    if (status || wanted->ends != GD_LINE_ENDS_MARKS || !first[wanted->count]) return status;
    status = marks_open(layer, stage, 2);
    if (status) return status;
    mark_set(&layer->marks[0], stage, wanted->points[first[0]]);
    mark_set(&layer->marks[1], stage, wanted->points[first[wanted->count] - 1]);
    return GD_OK;
}

enum gd_status gd__layer_project(struct gd__layer *layer, const struct gd__stage *stage,
                                 const struct gd_control *control)
{
    const struct gd_picture_layer *wanted = layer->wanted;
    if (wanted->first) return lines_project(layer, stage, control);
    enum gd_status status = marks_open(layer, stage, wanted->count);
    for (uint32_t i = 0; i < wanted->count && !status; i++)
        mark_set(&layer->marks[i], stage, wanted->points[i]);
    return status ? status : gd_control_check(control, 0);
}

void gd__layer_free(struct gd__layer *layer)
{
    gd__lines_free(&layer->seen);
    gd__lines_free(&layer->hidden);
}

/* --- drawing ---------------------------------------------------------------------------------- */

static double mark_opacity(const struct gd__layer *layer, const struct gd__mark *mark)
{
    enum gd_hidden hidden = layer->wanted->hidden;
    if (mark->is_seen || hidden == GD_HIDDEN_SHOWN) return 1;
    return hidden == GD_HIDDEN_FAINT ? FAINT : 0;
}

/* Draws an end of a line: the first end as a ring, the last end as a disc. */
static void draw_end(const struct gd__layer *layer, uint32_t i, const struct gd__stage *stage,
                     struct gd__canvas *canvas)
{
    const struct gd__mark *mark = &layer->marks[i];
    struct gd__colour halo = stage->palette->halo, outer = i ? halo : layer->colour,
                      inner = i ? layer->colour : halo;
    double opacity = mark_opacity(layer, mark), unit = stage->unit;
    if (opacity == 0) return;
    canvas->disc(canvas, mark->at, 5.5 * unit, outer, opacity);
    canvas->disc(canvas, mark->at, (i ? 4.2 : 2.8) * unit, inner, opacity);
}

static void draw_mark(const struct gd__layer *layer, const struct gd__mark *mark,
                      const struct gd__stage *stage, struct gd__canvas *canvas)
{
    double opacity = mark_opacity(layer, mark),
           radius = gd__layer_width(layer->wanted, stage->unit);
    if (opacity == 0) return;
    canvas->disc(canvas, mark->at, radius + 1.3 * stage->unit, stage->palette->halo, opacity);
    canvas->disc(canvas, mark->at, radius, layer->colour, opacity);
}

void gd__layer_draw(const struct gd__layer *layer, const struct gd__stage *stage,
                    struct gd__canvas *canvas)
{
    double width = gd__layer_width(layer->wanted, stage->unit);
    bool is_lines = layer->wanted->first, has_halo = width >= HALO_LEAST * stage->unit;
    canvas->stroke(canvas, &layer->hidden,
                   &(struct gd__pen){layer->colour, 0.6, width / 1.5, 5 * stage->unit});
    if (has_halo)
        canvas->stroke(canvas, &layer->seen,
                       &(struct gd__pen){stage->palette->halo, 0.85, HALO * width, 0});
    canvas->stroke(canvas, &layer->seen, &(struct gd__pen){layer->colour, 1, width, 0});
    for (uint32_t i = 0; i < layer->mark_count; i++)
        if (is_lines)
            draw_end(layer, i, stage, canvas);
        else
            draw_mark(layer, &layer->marks[i], stage, canvas);
}

/* --- labels ----------------------------------------------------------------------------------- */

struct label_box {
    double left, top, right, bottom;
};

static bool boxes_meet(const struct label_box *a, const struct label_box *b)
{
    return a->left < b->right && b->left < a->right && a->top < b->bottom && b->top < a->bottom;
}

struct labels {
    const struct gd__stage *stage;
    const struct gd__layer *layers;
    uint32_t layer_count, count; /* count: labels placed so far */
    struct label_box placed[GD_PICTURE_LABELS];
};

/* Returns a measure of what the box covers: other labels, marks, and space outside the picture. 0
 * means that it covers none of these. */
static double box_cost(const struct labels *labels, const struct label_box *box)
{
    const struct gd__depth_buffer *buffer = labels->stage->buffer;
    double cost = 0;
    if (box->left < 0 || box->top < 0 || box->right > buffer->width || box->bottom > buffer->height)
        cost += 100;
    for (uint32_t i = 0; i < labels->count; i++) cost += 10 * boxes_meet(box, &labels->placed[i]);
    for (uint32_t i = 0; i < labels->layer_count; i++) {
        const struct gd__layer *layer = &labels->layers[i];
        if (!layer->wanted->labels) continue;
        double radius = gd__layer_width(layer->wanted, labels->stage->unit);
        for (uint32_t k = 0; k < layer->mark_count; k++) {
            struct gd__pixel_point at = layer->marks[k].at;
            cost += boxes_meet(box, &(struct label_box){at.x - radius, at.y - radius, at.x + radius,
                                                        at.y + radius});
        }
    }
    return cost;
}

/* Tries eight positions of a label around its mark: right, left, above, below, and the corners.
 * Returns the position with the least box_cost. */
static struct label_box label_place(const struct labels *labels, struct gd__pixel_point at,
                                    double width, double height, double away)
{
    static const double sides[][2] = {{1, 0},  {-1, 0}, {0, -1},  {0, 1},
                                      {1, -1}, {1, 1},  {-1, -1}, {-1, 1}};
    struct label_box best = {0};
    double least = INFINITY;
    for (size_t i = 0; i < sizeof sides / sizeof *sides && least > 0; i++) {
        bool is_corner = sides[i][0] != 0 && sides[i][1] != 0;
        double gap = is_corner ? 0.7 * away : away, x = at.x + sides[i][0] * (gap + width / 2),
               y = at.y + sides[i][1] * (gap + height / 2);
        struct label_box box = {x - width / 2, y - height / 2, x + width / 2, y + height / 2};
        double cost = box_cost(labels, &box);
        if (cost >= least) continue;
        least = cost;
        best = box;
    }
    return best;
}

static void label_draw(struct labels *labels, const struct gd__layer *layer, uint32_t i,
                       struct gd__canvas *canvas)
{
    const struct gd__stage *stage = labels->stage;
    static const struct gd__colour faint = {0.42F, 0.43F, 0.46F};
    const char *text = layer->wanted->labels[i];
    double size = LETTERS * stage->unit, opacity = mark_opacity(layer, &layer->marks[i]);
    if (!text || opacity == 0 || labels->count >= GD_PICTURE_LABELS) return;
    struct label_box box =
        label_place(labels, layer->marks[i].at, gd__text_width(text, size), 0.9 * size,
                    gd__layer_width(layer->wanted, stage->unit) + 4 * stage->unit);
    labels->placed[labels->count++] = box;
    canvas->text(canvas, &(struct gd__text){.text = text,
                                            .x = 0.5 * (box.left + box.right),
                                            .y = box.bottom - 0.09 * size,
                                            .size = size,
                                            .anchor = GD__ANCHOR_MIDDLE,
                                            .colour = opacity < 1 ? faint : stage->palette->line,
                                            .has_halo = true,
                                            .halo = stage->palette->halo});
}

void gd__labels_draw(const struct gd__layer *layers, uint32_t count, const struct gd__stage *stage,
                     struct gd__canvas *canvas)
{
    struct labels labels = {.stage = stage, .layers = layers, .layer_count = count};
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; layers[i].wanted->labels && k < layers[i].wanted->count; k++)
            label_draw(&labels, &layers[i], k, canvas);
}
