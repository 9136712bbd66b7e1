#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/number.h"
#include "io/base64.h"
#include "render/canvas.h"

/* Writes an SVG 1.1 file: the surface as an embedded image, lines and texts as vectors. */

enum {
    /* stops of the colour gradient: with 16, deviations from the colour map are invisible */
    STOPS = 16
};

/* --- text ------------------------------------------------------------------------------------- */

static bool svg_reserve(struct gd__svg *svg, size_t more)
{
    if (svg->canvas.status) return false;
    if (svg->used + more <= svg->capacity) return true;
    size_t capacity = 2 * svg->capacity > svg->used + more ? 2 * svg->capacity : svg->used + more;
    svg->canvas.status = gd__budget_take(svg->budget, capacity - svg->capacity);
    if (svg->canvas.status) return false;
    char *text = realloc(svg->text, capacity);
    if (!text) {
        svg->canvas.status = GD_NO_MEMORY;
        return false;
    }
    svg->text = text;
    svg->capacity = capacity;
    return true;
}

static void svg_put(struct gd__svg *svg, const char *text)
{
    size_t size = strlen(text);
    if (!svg_reserve(svg, size)) return;
    memcpy(svg->text + svg->used, text, size);
    svg->used += size;
}

/* Writes a number, rounded to a hundredth of a pixel. */
static void put_number(struct gd__svg *svg, double number)
{
    if (!svg_reserve(svg, GD_NUMBER_SIZE)) return;
    svg->used = (size_t)(gd_number_format(svg->text + svg->used, nearbyint(100 * number) / 100) -
                         svg->text);
}

/* Writes the attribute ` name="number"`. */
static void put_length(struct gd__svg *svg, const char *name, double number)
{
    svg_put(svg, " ");
    svg_put(svg, name);
    svg_put(svg, "=\"");
    put_number(svg, number);
    svg_put(svg, "\"");
}

static void put_colour(struct gd__svg *svg, const char *name, struct gd__colour colour)
{
    static const char digits[] = "0123456789abcdef";
    const float part[3] = {colour.red, colour.green, colour.blue};
    char text[8] = "#";
    for (int k = 0; k < 3; k++) {
        long byte = lround(255.0 * part[k]);
        text[1 + 2 * k] = digits[byte / 16];
        text[2 + 2 * k] = digits[byte % 16];
    }
    svg_put(svg, " ");
    svg_put(svg, name);
    svg_put(svg, "=\"");
    svg_put(svg, text);
    svg_put(svg, "\"");
}

/* Writes a text with the entities of XML. */
static void put_escaped(struct gd__svg *svg, const char *text)
{
    for (; *text; text++) switch (*text) {
        case '&':
            svg_put(svg, "&amp;");
            break;
        case '<':
            svg_put(svg, "&lt;");
            break;
        case '>':
            svg_put(svg, "&gt;");
            break;
        default:
            svg_put(svg, (const char[2]){*text, '\0'});
        }
}

static void put_base64(struct gd__svg *svg, const void *bytes, size_t size)
{
    size_t characters = gd__base64_characters(size);
    if (!svg_reserve(svg, characters)) return;
    gd__base64_write(bytes, size, svg->text + svg->used);
    svg->used += characters;
}

/* --- the canvas ------------------------------------------------------------------------------- */

static void put_place(struct gd__svg *svg, char command, struct gd__pixel_point place)
{
    svg_put(svg, (const char[2]){command, '\0'});
    put_number(svg, place.x);
    svg_put(svg, " ");
    put_number(svg, place.y);
}

static void svg_stroke(struct gd__canvas *canvas, const struct gd__lines *lines,
                       const struct gd__pen *pen)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    if (!lines->count) return;
    svg_put(svg, "<path fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"");
    put_colour(svg, "stroke", pen->colour);
    put_length(svg, "stroke-width", pen->width);
    put_length(svg, "stroke-opacity", pen->opacity);
    if (pen->dash > 0) put_length(svg, "stroke-dasharray", pen->dash);
    svg_put(svg, " d=\"");
    for (uint32_t i = 0; i < lines->count; i++) {
        uint32_t begin = gd__line_begin(lines, i);
        for (uint32_t k = begin; k < lines->ends[i]; k++)
            put_place(svg, k == begin ? 'M' : 'L', lines->places[k]);
    }
    svg_put(svg, "\"/>\n");
}

static void svg_disc(struct gd__canvas *canvas, struct gd__pixel_point centre, double radius,
                     struct gd__colour colour, double opacity)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    svg_put(svg, "<circle");
    put_length(svg, "cx", centre.x);
    put_length(svg, "cy", centre.y);
    put_length(svg, "r", radius);
    put_colour(svg, "fill", colour);
    put_length(svg, "fill-opacity", opacity);
    svg_put(svg, "/>\n");
}

static void svg_text(struct gd__canvas *canvas, const struct gd__text *text)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    svg_put(svg, "<text font-family=\"system-ui,sans-serif\"");
    if (text->anchor == GD__ANCHOR_MIDDLE) svg_put(svg, " text-anchor=\"middle\"");
    put_length(svg, "x", text->x);
    put_length(svg, "y", text->y);
    put_length(svg, "font-size", text->size);
    put_colour(svg, "fill", text->colour);
    if (text->has_halo) {
        svg_put(svg, " paint-order=\"stroke\" stroke-linejoin=\"round\"");
        put_colour(svg, "stroke", text->halo);
        put_length(svg, "stroke-width", text->size / 4);
    }
    svg_put(svg, ">");
    put_escaped(svg, text->text);
    svg_put(svg, "</text>\n");
}

static void svg_begin_layer(struct gd__canvas *canvas, uint32_t number)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    svg_put(svg, "<g id=\"layer-");
    put_number(svg, number);
    svg_put(svg, "\">\n");
}

static void svg_end_layer(struct gd__canvas *canvas)
{
    svg_put((struct gd__svg *)canvas, "</g>\n");
}

static void svg_scale(struct gd__canvas *canvas, const struct gd__viewport *box)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    svg_put(svg, "<linearGradient id=\"scale\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">");
    for (int i = 0; i <= STOPS; i++) {
        svg_put(svg, "<stop");
        put_length(svg, "offset", (double)i / STOPS);
        put_colour(svg, "stop-color", gd__colour_of_part((double)i / STOPS));
        svg_put(svg, "/>");
    }
    svg_put(svg, "</linearGradient>\n<rect fill=\"url(#scale)\"");
    put_length(svg, "x", box->left);
    put_length(svg, "y", box->top);
    put_length(svg, "width", box->width);
    put_length(svg, "height", box->height);
    svg_put(svg, "/>\n");
}

/* --- the file --------------------------------------------------------------------------------- */

void gd__svg_open(struct gd__svg *svg, uint32_t width, uint32_t height, const void *png,
                  size_t size, struct gd__budget *budget)
{
    *svg = (struct gd__svg){.canvas = {svg_stroke, svg_disc, svg_text, svg_scale, svg_begin_layer,
                                       svg_end_layer, GD_OK},
                            .budget = budget};
    svg_put(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\"");
    put_length(svg, "width", width);
    put_length(svg, "height", height);
    svg_put(svg, " viewBox=\"0 0 ");
    put_number(svg, width);
    svg_put(svg, " ");
    put_number(svg, height);
    svg_put(svg, "\">\n<image");
    put_length(svg, "width", width);
    put_length(svg, "height", height);
    svg_put(svg, " xlink:href=\"data:image/png;base64,");
    put_base64(svg, png, size);
    svg_put(svg, "\"/>\n");
}

enum gd_status gd__svg_close(struct gd__svg *svg, void **bytes, size_t *size)
{
    svg_put(svg, "</svg>\n");
    if (svg->canvas.status) {
        free(svg->text);
        return svg->canvas.status;
    }
    *bytes = svg->text;
    *size = svg->used;
    return GD_OK;
}
