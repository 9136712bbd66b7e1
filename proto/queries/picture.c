#include "proto/queries/picture.h"

#include <string.h>

#include "generated/queries.h"
#include "proto/json/number.h"
#include "proto/queries/pair.h"

#define WIDTH    800
#define HEIGHT   600
#define ISOLINES 10

void proto_picture_free(struct proto_picture *picture)
{
    proto_points_free(&picture->stops);
    proto_picture_request_free(&picture->request);
}

/* --- the view --------------------------------------------------------------------------------- */

/* Returns whether the text is three numbers separated by commas, not all zero. */
static bool read_vector(const char *text, struct gd_vec3 *out)
{
    double number[3];
    for (int k = 0; k < 3; k++) {
        size_t length = proto_number_parse(text, &number[k]);
        text += length;
        if (length == 0 || *text != (k < 2 ? ',' : '\0')) return false;
        text++;
    }
    *out = (struct gd_vec3){number[0], number[1], number[2]};
    return number[0] != 0 || number[1] != 0 || number[2] != 0;
}

static bool parse_view(const char *text, struct gd_picture *out, struct proto_problem *problem)
{
    out->view = GD_VIEW_CHOSEN;
    if (!text) return true;
    for (unsigned i = 0; proto_view_words[i]; i++)
        if (!strcmp(text, proto_view_words[i])) {
            out->view = (enum gd_view)i;
            return true;
        }
    out->view = GD_VIEW_DIRECTION;
    return read_vector(text, &out->direction) ||
           proto_problem_refuse(problem, "view",
                                "expected auto, front, back, left, right, top, bottom, iso, or the "
                                "direction from the "
                                "surface to the eye as three numbers that are not all 0: 1,0.5,2");
}

static bool parse_up(const char *text, struct gd_picture *out, struct proto_problem *problem)
{
    out->up = (struct gd_vec3){0, 1, 0};
    if (!text || !strcmp(text, "y")) return true;
    out->up = (struct gd_vec3){0, 0, 1};
    if (!strcmp(text, "z")) return true;
    return read_vector(text, &out->up) ||
           proto_problem_refuse(problem, "up",
                                "expected y, z, or the upward direction as three numbers that "
                                "are not all 0: 0,0,1");
}

static bool refuse_pixels(struct proto_problem *problem)
{
    return proto_problem_exceed(problem, "size", GD_PICTURE_PIXELS,
                                "a picture has at most %u pixels; ask for a smaller size",
                                GD_PICTURE_PIXELS);
}

static bool is_side(uint64_t pixels)
{
    return pixels >= GD_PICTURE_LEAST && pixels <= GD_PICTURE_MOST;
}

static bool parse_size(const char *text, struct gd_picture *out, struct proto_problem *problem)
{
    uint64_t width = WIDTH, height = HEIGHT;
    size_t first = text ? proto_integer_parse(text, &width) : 0,
           second =
               first && text[first] == 'x' ? proto_integer_parse(text + first + 1, &height) : 0;
    if (text && (!second || text[first + 1 + second] || !is_side(width) || !is_side(height)))
        return proto_problem_refuse(
            problem, "size", "expected width and height in pixels, each from %d to %d: 800x600",
            GD_PICTURE_LEAST, GD_PICTURE_MOST);
    if (width * height > GD_PICTURE_PIXELS) return refuse_pixels(problem);
    out->width = (uint32_t)width;
    out->height = (uint32_t)height;
    return true;
}

/* --- the content ------------------------------------------------------------------------------ */

/* Reads the content of the picture: the field or its source, and the path. */
static bool parse_content(const struct proto_get_picture_png_query *query,
                          const struct proto_parameters *parameters, struct proto_picture *out,
                          struct proto_problem *problem)
{
    out->field = query->field;
    out->has_source = query->source != NULL;
    if (query->field && query->source)
        return proto_problem_refuse(
            problem, "source",
            "send either field, the id of a field, or source, whose field is then computed");
    if (query->source && !proto_point_parse(query->source, "source", &out->source, problem))
        return false;
    return (!query->from && !query->to && !query->via) ||
           proto_pair_parse(parameters, &out->stops, problem);
}

bool proto_picture_parse(const struct proto_parameters *parameters, struct proto_picture *out,
                         struct proto_problem *problem)
{
    struct proto_picture wanted = {0};
    struct gd_picture *picture = &wanted.picture;
    struct proto_get_picture_png_query query;
    if (!proto_get_picture_png_query_parse(parameters, &query, problem) ||
        !parse_view(query.view, picture, problem) || !parse_up(query.up, picture, problem) ||
        !parse_size(query.size, picture, problem) ||
        !parse_content(&query, parameters, &wanted, problem))
        return false;
    picture->isolines = query.has_isolines            ? (uint32_t)query.isolines
                        : query.field || query.source ? ISOLINES
                                                      : 0;
    picture->background = (enum gd_background)query.background;
    picture->edges = query.edges;
    picture->legend = query.legend;
    *out = wanted;
    return true;
}

/* --- figures ---------------------------------------------------------------------------------- */

static struct gd_vec3 vector_of(const double xyz[3])
{
    return (struct gd_vec3){xyz[0], xyz[1], xyz[2]};
}

static bool is_zero(const double xyz[3])
{
    return xyz[0] == 0 && xyz[1] == 0 && xyz[2] == 0;
}

static bool take_camera(const struct proto_picture_camera *camera, struct proto_picture *out,
                        struct proto_problem *problem)
{
    struct gd_picture *picture = &out->picture;
    picture->view = (enum gd_view)camera->view;
    picture->zoom = camera->zoom;
    picture->up = camera->has_up ? vector_of(camera->up) : (struct gd_vec3){0, 1, 0};
    if (camera->has_up && is_zero(camera->up))
        return proto_problem_refuse(problem, "/camera/up", "the upward direction must not be 0");
    if (camera->has_direction) {
        if (is_zero(camera->direction))
            return proto_problem_refuse(problem, "/camera/direction",
                                        "the direction must not be 0");
        picture->view = GD_VIEW_DIRECTION;
        picture->direction = vector_of(camera->direction);
    }
    out->target = vector_of(camera->target);
    if (camera->has_target) picture->target = &out->target;
    return true;
}

static bool refuse_layer(const struct proto_picture_layer *layer, const char *why,
                         struct proto_problem *problem)
{
    return proto_problem_refuse_member(problem, layer->place,
                                       proto_picture_layer_forms[layer->form], "%s", why);
}

static void take_surface(const struct proto_picture_layer *layer, struct gd_picture *picture)
{
    picture->edges = layer->surface.edges;
    if (layer->has_color) picture->surface_colour = layer->color;
}

static void take_isolines(const struct proto_picture_layer *layer, struct gd_picture *picture)
{
    picture->isolines = layer->isolines.count;
    picture->levels = layer->isolines.levels.items;
    picture->level_count = layer->isolines.levels.count;
    if (layer->has_color) picture->isoline_colour = layer->color;
    if (layer->has_width) picture->isoline_width = layer->width;
}

/* Checks the isolines' levels against the reach of the field. */
static bool check_isolines(const struct proto_picture_layer *layer,
                           const struct proto_picture_layer *field, struct proto_problem *problem)
{
    if (!field)
        return refuse_layer(layer, "isolines need a layer \"field\", whose distance they show",
                            problem);
    for (uint32_t i = 0; i < layer->isolines.levels.count; i++)
        if (field->has_max_distance && layer->isolines.levels.items[i] > field->max_distance)
            return refuse_layer(layer, "a level exceeds the max_distance of the field", problem);
    return true;
}

static bool is_single(unsigned form)
{
    return form <= PROTO_PICTURE_LAYER_ISOLINES || form == PROTO_PICTURE_LAYER_CUT;
}

/* Reads the layers that belong to the surface itself. A figure has at most one layer of each of
 * these kinds. */
static bool take_layers(struct proto_picture *out, struct proto_problem *problem)
{
    const struct proto_picture_layer *found[PROTO_PICTURE_LAYER_CUT + 1] = {NULL};
    struct proto_picture_layer_list *layers = &out->request.layers;
    for (uint32_t i = 0; i < layers->count; i++) {
        struct proto_picture_layer *layer = &layers->items[i];
        if (!is_single(layer->form)) continue;
        if (found[layer->form])
            return refuse_layer(layer, "a figure has at most one layer of this kind", problem);
        found[layer->form] = layer;
        if (layer->form == PROTO_PICTURE_LAYER_SURFACE) take_surface(layer, &out->picture);
        if (layer->form == PROTO_PICTURE_LAYER_ISOLINES) take_isolines(layer, &out->picture);
    }
    const struct proto_picture_layer *isolines = found[PROTO_PICTURE_LAYER_ISOLINES],
                                     *field = found[PROTO_PICTURE_LAYER_FIELD];
    if (field && found[PROTO_PICTURE_LAYER_CUT])
        return refuse_layer(field,
                            "a figure with a layer \"cut\" has no field, because the field "
                            "belongs to the surface that is not cut; leave one of them out",
                            problem);
    return !isolines || check_isolines(isolines, field, problem);
}

bool proto_picture_places_decode(const json_t *document, const struct gd_parametric *surface,
                                 struct proto_uvs *out, struct proto_problem *problem)
{
    struct proto_picture_places_request request;
    if (!proto_picture_places_request_decode(document, &request, problem)) return false;
    *out = request.points;
    for (uint32_t i = 0; i < out->count; i++) {
        char place[PROTO_PLACE];
        proto_place_of_element(place, "/points", i);
        if (!proto_uv_check(surface, out->items[i], place, problem)) return false;
    }
    return true;
}

bool proto_picture_limit_places_decode(const json_t *document, const struct gd_subdivision *surface,
                                       struct proto_limit_places *out,
                                       struct proto_problem *problem)
{
    struct proto_picture_limit_places_request request;
    if (!proto_picture_limit_places_request_decode(document, &request, problem)) return false;
    bool ok = proto_limit_places_locate(surface, &request.points, out, problem);
    proto_picture_limit_places_request_free(&request);
    return ok;
}

bool proto_picture_decode(const json_t *document, struct proto_picture *out,
                          struct proto_problem *problem)
{
    struct proto_picture_request *request = &out->request;
    struct gd_picture *picture = &out->picture;
    *out = (struct proto_picture){0};
    if (!proto_picture_request_decode(document, request, problem)) return false;
    picture->width = request->width;
    picture->height = request->height;
    picture->background = (enum gd_background)request->background;
    picture->legend = request->legend;
    if ((uint64_t)request->width * request->height > GD_PICTURE_PIXELS)
        return proto_problem_exceed(problem, "/width", GD_PICTURE_PIXELS,
                                    "a figure has at most %u pixels; ask for a smaller one",
                                    GD_PICTURE_PIXELS);
    return take_camera(&request->camera, out, problem) && take_layers(out, problem);
}
