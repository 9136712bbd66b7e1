#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/number.h"
#include "render/canvas.h"

/* An SVG 1.1 file: the surface as an embedded image, lines and texts as themselves. */

enum {
    /* of the gradient of colours: between two of them the colours differ from the scale's by less
       than one can see */
    STOPS = 16
};

/* --- text ------------------------------------------------------------------------------------- */

static bool reserve(struct gd__svg *svg, size_t more)
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

static void put(struct gd__svg *svg, const char *text)
{
    size_t size = strlen(text);
    if (!reserve(svg, size)) return;
    memcpy(svg->text + svg->used, text, size);
    svg->used += size;
}

/* To a hundredth of a pixel. */
static void put_number(struct gd__svg *svg, double number)
{
    if (!reserve(svg, GD_NUMBER_SIZE)) return;
    svg->used = (size_t)(gd_number_format(svg->text + svg->used, nearbyint(100 * number) / 100) -
                         svg->text);
}

/* The attribute ` name="number"`. */
static void put_length(struct gd__svg *svg, const char *name, double number)
{
    put(svg, " ");
    put(svg, name);
    put(svg, "=\"");
    put_number(svg, number);
    put(svg, "\"");
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
    put(svg, " ");
    put(svg, name);
    put(svg, "=\"");
    put(svg, text);
    put(svg, "\"");
}

static void put_base64(struct gd__svg *svg, const uint8_t *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    if (!reserve(svg, (size + 2) / 3 * 4)) return;
    char *out = svg->text + svg->used;
    for (size_t i = 0; i < size; i += 3) {
        size_t have = size - i < 3 ? size - i : 3;
        uint32_t bits = 0;
        for (size_t k = 0; k < have; k++) bits |= (uint32_t)bytes[i + k] << (16 - 8 * k);
        for (size_t k = 0; k < 4; k++) *out++ = k <= have ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    svg->used = (size_t)(out - svg->text);
}

/* --- the canvas ------------------------------------------------------------------------------- */

static void put_place(struct gd__svg *svg, char command, struct gd__place place)
{
    put(svg, (const char[2]){command, '\0'});
    put_number(svg, place.x);
    put(svg, " ");
    put_number(svg, place.y);
}

static void stroke(struct gd__canvas *canvas, const struct gd__lines *lines,
                   const struct gd__pen *pen)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    if (!lines->count) return;
    put(svg, "<path fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"");
    put_colour(svg, "stroke", pen->colour);
    put_length(svg, "stroke-width", pen->width);
    put_length(svg, "stroke-opacity", pen->opacity);
    if (pen->dash > 0) put_length(svg, "stroke-dasharray", pen->dash);
    put(svg, " d=\"");
    for (uint32_t i = 0; i < lines->count; i++) {
        uint32_t begin = gd__line_begin(lines, i);
        for (uint32_t k = begin; k < lines->ends[i]; k++)
            put_place(svg, k == begin ? 'M' : 'L', lines->places[k]);
    }
    put(svg, "\"/>\n");
}

static void disc(struct gd__canvas *canvas, struct gd__place centre, double radius,
                 struct gd__colour colour, double opacity)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    put(svg, "<circle");
    put_length(svg, "cx", centre.x);
    put_length(svg, "cy", centre.y);
    put_length(svg, "r", radius);
    put_colour(svg, "fill", colour);
    put_length(svg, "fill-opacity", opacity);
    put(svg, "/>\n");
}

static void text(struct gd__canvas *canvas, const struct gd__text *text)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    put(svg, "<text font-family=\"system-ui,sans-serif\"");
    if (text->anchor == GD__ANCHOR_MIDDLE) put(svg, " text-anchor=\"middle\"");
    put_length(svg, "x", text->x);
    put_length(svg, "y", text->y);
    put_length(svg, "font-size", text->size);
    put_colour(svg, "fill", text->colour);
    put(svg, ">");
    put(svg, text->text);
    put(svg, "</text>\n");
}

static void scale(struct gd__canvas *canvas, const struct gd__window_of_picture *box)
{
    struct gd__svg *svg = (struct gd__svg *)canvas;
    put(svg, "<linearGradient id=\"scale\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">");
    for (int i = 0; i <= STOPS; i++) {
        put(svg, "<stop");
        put_length(svg, "offset", (double)i / STOPS);
        put_colour(svg, "stop-color", gd__colour_of_part((double)i / STOPS));
        put(svg, "/>");
    }
    put(svg, "</linearGradient>\n<rect fill=\"url(#scale)\"");
    put_length(svg, "x", box->left);
    put_length(svg, "y", box->top);
    put_length(svg, "width", box->width);
    put_length(svg, "height", box->height);
    put(svg, "/>\n");
}

/* --- the file --------------------------------------------------------------------------------- */

void gd__svg_open(struct gd__svg *svg, uint32_t width, uint32_t height, const void *png,
                  size_t size, struct gd__budget *budget)
{
    *svg = (struct gd__svg){.canvas = {stroke, disc, text, scale, GD_OK}, .budget = budget};
    put(svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\"");
    put_length(svg, "width", width);
    put_length(svg, "height", height);
    put(svg, " viewBox=\"0 0 ");
    put_number(svg, width);
    put(svg, " ");
    put_number(svg, height);
    put(svg, "\">\n<image");
    put_length(svg, "width", width);
    put_length(svg, "height", height);
    put(svg, " xlink:href=\"data:image/png;base64,");
    put_base64(svg, png, size);
    put(svg, "\"/>\n");
}

enum gd_status gd__svg_close(struct gd__svg *svg, void **bytes, size_t *size)
{
    put(svg, "</svg>\n");
    if (svg->canvas.status) {
        free(svg->text);
        return svg->canvas.status;
    }
    *bytes = svg->text;
    *size = svg->used;
    return GD_OK;
}
