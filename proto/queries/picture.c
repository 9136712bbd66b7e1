#include "proto/queries/picture.h"

#include <math.h>
#include <string.h>

#include "proto/json/number.h"
#include "proto/queries/pair.h"

#define WIDTH    800
#define HEIGHT   600
#define ISOLINES 10

void proto_picture_free(struct proto_picture *picture)
{
    proto_points_free(&picture->stops);
}

static const char *value_of(const struct proto_parameters *parameters, const char *name)
{
    return proto_parameters_get(parameters, name);
}

/* --- how it is seen --------------------------------------------------------------------------- */

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

static bool parse_view(const struct proto_parameters *parameters, struct gd_picture *out,
                       struct proto_problem *problem)
{
    static const char *const words[] = {
        [GD_VIEW_CHOSEN] = "auto",   [GD_VIEW_FRONT] = "front", [GD_VIEW_BACK] = "back",
        [GD_VIEW_LEFT] = "left",     [GD_VIEW_RIGHT] = "right", [GD_VIEW_TOP] = "top",
        [GD_VIEW_BOTTOM] = "bottom", [GD_VIEW_ISO] = "iso"};
    const char *text = value_of(parameters, "view");
    out->view = GD_VIEW_CHOSEN;
    if (!text) return true;
    for (unsigned i = 0; i < sizeof words / sizeof *words; i++)
        if (!strcmp(text, words[i])) {
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

static bool parse_up(const struct proto_parameters *parameters, struct gd_picture *out,
                     struct proto_problem *problem)
{
    const char *text = value_of(parameters, "up");
    out->up = (struct gd_vec3){0, 1, 0};
    if (!text || !strcmp(text, "y")) return true;
    out->up = (struct gd_vec3){0, 0, 1};
    if (!strcmp(text, "z")) return true;
    return read_vector(text, &out->up) ||
           proto_problem_refuse(problem, "up",
                                "expected y, z, or what is to point upwards as three numbers that "
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

static bool parse_size(const struct proto_parameters *parameters, struct gd_picture *out,
                       struct proto_problem *problem)
{
    const char *text = value_of(parameters, "size");
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

static bool parse_looks(const struct proto_parameters *parameters, bool has_field,
                        struct gd_picture *out, struct proto_problem *problem)
{
    uint64_t isolines = has_field ? ISOLINES : 0;
    unsigned ground = PROTO_PICTURE_BACKGROUND_WHITE;
    out->legend = true;
    if (!proto_parameters_integer(parameters, "isolines", 0, GD_PICTURE_ISOLINES, &isolines,
                                  problem))
        return false;
    if (!proto_parameters_choice(parameters, "background", proto_picture_background_words, &ground,
                                 problem))
        return false;
    out->isolines = (uint32_t)isolines;
    out->background = (enum gd_background)ground;
    return proto_parameters_flag(parameters, "edges", &out->edges, problem) &&
           proto_parameters_flag(parameters, "legend", &out->legend, problem);
}

/* --- what is seen ----------------------------------------------------------------------------- */

static bool parse_field(const struct proto_parameters *parameters, struct proto_picture *out,
                        struct proto_problem *problem)
{
    const char *source = value_of(parameters, "source");
    out->field = value_of(parameters, "field");
    out->has_source = source != NULL;
    if (out->field && source)
        return proto_problem_refuse(
            problem, "source",
            "name a field by its id, or a source to have its field: one of both");
    return !source || proto_point_parse(source, "source", &out->source, problem);
}

static bool has_path(const struct proto_parameters *parameters)
{
    return value_of(parameters, "from") || value_of(parameters, "to") ||
           value_of(parameters, "via");
}

bool proto_picture_parse(const struct proto_parameters *parameters, struct proto_picture *out,
                         struct proto_problem *problem)
{
    struct proto_picture wanted = {0};
    if (!parse_field(parameters, &wanted, problem) ||
        !parse_view(parameters, &wanted.picture, problem) ||
        !parse_up(parameters, &wanted.picture, problem) ||
        !parse_size(parameters, &wanted.picture, problem) ||
        !parse_looks(parameters, wanted.field || wanted.has_source, &wanted.picture, problem))
        return false;
    if (has_path(parameters) && !proto_pair_parse(parameters, &wanted.stops, problem)) return false;
    *out = wanted;
    return true;
}
