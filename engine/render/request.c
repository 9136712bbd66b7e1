#include "render/request.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/lanes.h"
#include "gd/isoline.h"

enum { WIDTH = 800, HEIGHT = 600, TICKS = 6 };

/* --- the members ------------------------------------------------------------------------------ */

uint32_t gd__request_width(const struct gd_picture *picture)
{
    return picture->width ? picture->width : WIDTH;
}

uint32_t gd__request_height(const struct gd_picture *picture)
{
    return picture->height ? picture->height : HEIGHT;
}

struct gd__palette gd__request_palette(const struct gd_picture *picture)
{
    struct gd__palette palette = *gd__palette(picture->background);
    if (picture->surface_colour) palette.surface = gd__colour_of_rgb(picture->surface_colour);
    return palette;
}

struct gd__scale gd__request_scale(const struct gd_picture *picture)
{
    return gd__scale_of(gd__field_range(picture->field),
                        picture->isolines ? picture->isolines : TICKS);
}

static bool is_side(uint32_t pixels)
{
    return pixels >= GD_PICTURE_LEAST && pixels <= GD_PICTURE_MOST;
}

static bool is_text(const char *text)
{
    size_t length = text ? strlen(text) : 0;
    for (size_t i = 0; i < length; i++)
        if (text[i] < ' ' || text[i] > '~') return false;
    return length <= GD_PICTURE_LABEL;
}

/* Returns true if a position is near enough to be projected without overflow. */
static bool is_near(const struct gd_mesh *mesh, struct gd_vec3 position)
{
    return gd_vec3_length(gd_vec3_sub(position, mesh->summary.min)) <=
           GD_PICTURE_FARTHEST * mesh->unit;
}

static bool labels_are_sound(const struct gd_picture_layer *layer, uint32_t *labels)
{
    for (uint32_t i = 0; layer->labels && i < layer->count; i++) {
        if (!layer->labels[i]) continue;
        if (!is_text(layer->labels[i]) || ++*labels > GD_PICTURE_LABELS) return false;
    }
    return is_text(layer->name);
}

static bool layer_is_sound(const struct gd_picture_layer *layer, const struct gd_mesh *mesh)
{
    uint32_t points = layer->first ? layer->first[layer->count] : layer->count;
    if (!(layer->width >= 0 && layer->width <= GD_PICTURE_WIDTH)) return false;
    for (uint32_t i = 0; layer->first && i < layer->count; i++)
        if (layer->first[i] > layer->first[i + 1]) return false;
    for (uint32_t i = 0; i < points; i++)
        if (!is_near(mesh, layer->points[i])) return false;
    return true;
}

static bool layers_are_sound(const struct gd_picture *picture)
{
    uint32_t labels = 0;
    if (picture->layer_count > GD_PICTURE_LAYERS) return false;
    for (uint32_t i = 0; i < picture->layer_count; i++)
        if (!layer_is_sound(&picture->layers[i], picture->mesh) ||
            !labels_are_sound(&picture->layers[i], &labels))
            return false;
    return true;
}

static bool levels_are_sound(const struct gd_picture *picture)
{
    if (picture->isolines > GD_PICTURE_ISOLINES || picture->level_count > GD_PICTURE_ISOLINES)
        return false;
    for (uint32_t i = 0; i < picture->level_count; i++)
        if (!(picture->levels[i] >= 0 && isfinite(picture->levels[i]))) return false;
    return picture->isoline_width >= 0 && picture->isoline_width <= GD_PICTURE_WIDTH;
}

bool gd__request_is_sound(const struct gd_picture *picture)
{
    uint32_t width = gd__request_width(picture), height = gd__request_height(picture);
    struct gd_vec3 d = picture->direction;
    if (!is_side(width) || !is_side(height) || (uint64_t)width * height > GD_PICTURE_PIXELS)
        return false;
    if (!gd_vec3_is_finite(picture->up) || !gd_vec3_is_finite(d)) return false;
    if (picture->zoom != 0 && !(picture->zoom >= 1 && picture->zoom <= GD_PICTURE_ZOOM))
        return false;
    if (picture->target && !is_near(picture->mesh, *picture->target)) return false;
    if (picture->field && gd_field_mesh(picture->field) != picture->mesh) return false;
    if (picture->view == GD_VIEW_DIRECTION && d.x == 0 && d.y == 0 && d.z == 0) return false;
    return levels_are_sound(picture) && layers_are_sound(picture);
}

/* --- layers ----------------------------------------------------------------------------------- */

/* Creates the layer of the picture's path. */
static enum gd_status path_open(struct gd__layer_list *list, const struct gd_picture *picture,
                                struct gd__arena *arena)
{
    const struct gd_path *path = picture->path;
    list->path_points = gd__arena_take(arena, path->count, sizeof *list->path_points);
    if (!list->path_points) return arena->status;
    for (uint32_t i = 0; i < path->count; i++)
        list->path_points[i] = gd_point_position(picture->mesh, &path->points[i]);
    snprintf(list->path_name, sizeof list->path_name, "path length %.9g", path->length);
    list->path_first[1] = path->count;
    list->path = (struct gd_picture_layer){.points = list->path_points,
                                           .first = list->path_first,
                                           .count = 1,
                                           .name = list->path_name,
                                           .ends = GD_LINE_ENDS_MARKS};
    return GD_OK;
}

enum gd_status gd__layer_list_open(struct gd__layer_list *list, const struct gd_picture *picture,
                                   const struct gd__palette *palette, struct gd__arena *arena)
{
    uint32_t has_path = picture->path != NULL, count = has_path + picture->layer_count;
    enum gd_status status = has_path ? path_open(list, picture, arena) : GD_OK;
    list->items = gd__arena_zeroed(arena, count, sizeof *list->items);
    if (status || !list->items) return status ? status : arena->status;
    list->count = count;
    for (uint32_t i = 0, number = 0; i < count; i++) {
        struct gd__layer *layer = &list->items[i];
        layer->wanted = i < has_path ? &list->path : &picture->layers[i - has_path];
        layer->colour = gd__layer_colour(layer->wanted, number, palette);
        number += layer->wanted->first && !layer->wanted->colour;
    }
    return GD_OK;
}

/* --- isolines --------------------------------------------------------------------------------- */

uint32_t gd__isoline_count(const struct gd_picture *picture, const struct gd__scale *scale)
{
    if (!picture->field) return 0;
    return picture->level_count ? picture->level_count : picture->isolines ? scale->count : 0;
}

enum { TRACES = 2 /* number of isolines that exist at a time */ };

/* Isolines that are traced at the same time. */
struct round {
    const struct gd__isoline_request *request;
    const struct gd_isoline_index *index;
    uint32_t first; /* the isoline of the first trace */
    struct trace {
        struct gd_path *lines; /* the polylines of an isoline, or NULL */
        uint32_t count;
    } traces[TRACES];
};

static void trace_free(struct trace *trace)
{
    for (uint32_t i = 0; i < trace->count; i++) gd_path_free(&trace->lines[i]);
    free(trace->lines);
    *trace = (struct trace){0};
}

static enum gd_status trace_flatten(struct trace *trace, const struct gd__isoline_request *request,
                                    const struct gd_isoline *isoline,
                                    const struct gd_control *control)
{
    size_t bytes = isoline->bytes + (isoline->line_count + (size_t)1) * sizeof *trace->lines;
    enum gd_status status = gd_control_afford(control, bytes);
    if (status) return status;
    trace->lines = malloc((isoline->line_count + (size_t)1) * sizeof *trace->lines);
    if (!trace->lines) return GD_NO_MEMORY;
    while (trace->count < isoline->line_count && !status) {
        struct gd_path *flat = &trace->lines[trace->count];
        status = gd_isoline_flatten(request->picture->mesh, &isoline->lines[trace->count],
                                    request->tolerance, control, flat);
        if (status) break;
        trace->count++;
        bytes += flat->count * sizeof *flat->points;
        status = gd_control_afford(control, bytes);
    }
    if (status) trace_free(trace);
    return status;
}

static double level_at(const struct gd__isoline_request *request, uint32_t i)
{
    const struct gd_picture *picture = request->picture;
    return picture->level_count ? picture->levels[i] : (i + UINT64_C(1)) * request->scale->step;
}

static enum gd_status trace_make(void *context, uint32_t lane, uint32_t i,
                                 const struct gd_control *control)
{
    struct round *round = context;
    struct gd_isoline isoline;
    (void)lane;
    if (round->traces[i].lines) return GD_OK;
    double level = level_at(round->request, round->first + i);
    enum gd_status status = gd_isoline_trace_indexed(round->index, level, control, &isoline);
    if (status) return status;
    status = trace_flatten(&round->traces[i], round->request, &isoline, control);
    gd_isoline_free(&isoline);
    return status;
}

/* Traces the isolines of a round, and calls `take` in the order of their levels. */
static enum gd_status round_run(struct round *round, uint32_t count)
{
    const struct gd__isoline_request *request = round->request;
    struct gd_control control = gd__share_control(request->share, request->budget->held);
    const struct gd__lanes lanes = {.executor = control.executor,
                                    .control = &control,
                                    .share = request->share,
                                    .count = count,
                                    .make = trace_make,
                                    .context = round};
    enum gd_status status = gd__lanes_run(&lanes);
    for (uint32_t i = 0; i < count; i++) {
        struct trace *trace = &round->traces[i];
        for (uint32_t k = 0; k < trace->count && !status; k++)
            status = request->take(request->own, &trace->lines[k]);
        trace_free(trace);
    }
    return status;
}

static enum gd_status isolines_trace(const struct gd__isoline_request *request,
                                     const struct gd_isoline_index *index)
{
    uint32_t count = gd__isoline_count(request->picture, request->scale);
    enum gd_status status = GD_OK;
    for (uint32_t k = 0; k < count && !status; k += TRACES) {
        struct round round = {.request = request, .index = index, .first = k};
        status = round_run(&round, count - k < TRACES ? count - k : TRACES);
    }
    return status;
}

enum gd_status gd__isolines_flatten(const struct gd__isoline_request *request)
{
    const struct gd_picture *picture = request->picture;
    struct gd_isoline_index *index;
    if (!gd__isoline_count(picture, request->scale)) return GD_OK;
    struct gd_control control = gd__share_control(request->share, request->budget->held);
    enum gd_status status = gd__budget_take(request->budget, gd_isoline_index_bytes(picture->mesh));
    if (!status) status = gd_isoline_index_create(picture->field, &control, &index);
    request->share->done++;
    if (status) return status;
    status = isolines_trace(request, index);
    gd_isoline_index_destroy(index);
    return status;
}
