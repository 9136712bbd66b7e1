#include "proto/values/flat_strip.h"

#include <math.h>
#include <string.h>

#include "gd/number.h"

/* The page, in its own unit (pixels): the drawing fits into WIDTH x HEIGHT, with a margin around it
 * and the bar below. */
#define WIDTH  960.0
#define HEIGHT 540.0
#define MARGIN 20.0
#define FOOT   48.0

#define NUMBER_BYTES (GD_NUMBER_SIZE + 1)
#define FRAME_BYTES  4096 /* bytes of the drawing without faces and points */

struct drawing {
    struct proto_writer *writer;
    const struct gd_flat_strip *strip;
    double min[2], max[2]; /* corners of the strip's bounding box */
    double scale;          /* pixels per unit */
    double width, height;  /* size of the page */
};

size_t proto_flat_strip_bytes(const struct gd_flat_strip *strip)
{
    return FRAME_BYTES +
           NUMBER_BYTES * ((size_t)strip->face_count * 6 + (size_t)strip->point_count * 2);
}

/* --- text ------------------------------------------------------------------------------------- */

static void text(const struct drawing *drawing, const char *text)
{
    proto_append(drawing->writer, text, strlen(text));
}

static void number(const struct drawing *drawing, double value)
{
    char digits[GD_NUMBER_SIZE];
    proto_append(drawing->writer, digits, (size_t)(gd_number_format(digits, value) - digits));
}

/* Writes a number of a sentence, to six digits. */
static void rounded(const struct drawing *drawing, double value)
{
    double unit = value != 0 ? pow(10, floor(log10(fabs(value))) - 5) : 1;
    double digits = rint(value / unit);
    number(drawing, unit < 1 ? digits / rint(1 / unit) : digits * unit);
}

static void attribute(const struct drawing *drawing, const char *name, double value)
{
    text(drawing, " ");
    text(drawing, name);
    text(drawing, "=\"");
    number(drawing, value);
    text(drawing, "\"");
}

/* Writes x,y with y downwards. */
static void place(const struct drawing *drawing, const double at[2], const char *before)
{
    text(drawing, before);
    number(drawing, at[0]);
    text(drawing, ",");
    number(drawing, at[1] != 0 ? -at[1] : 0);
}

/* --- the page --------------------------------------------------------------------------------- */

static void widen(struct drawing *drawing, const double at[2])
{
    for (int axis = 0; axis < 2; axis++) {
        drawing->min[axis] = fmin(drawing->min[axis], at[axis]);
        drawing->max[axis] = fmax(drawing->max[axis], at[axis]);
    }
}

static void measure(struct drawing *drawing)
{
    const struct gd_flat_strip *strip = drawing->strip;
    for (uint32_t i = 0; i < strip->face_count; i++)
        for (int k = 0; k < 3; k++) widen(drawing, strip->faces[i].corners[k]);
    for (uint32_t i = 0; i < strip->point_count; i++) widen(drawing, strip->points[i]);
    double width = drawing->max[0] - drawing->min[0], height = drawing->max[1] - drawing->min[1];
    drawing->scale = fmin(WIDTH / width, HEIGHT / height);
    drawing->width = rint(fmax(drawing->scale * width, WIDTH / 2) + 2 * MARGIN);
    drawing->height = rint(drawing->scale * height + 2 * MARGIN + FOOT);
}

static void begin_page(const struct drawing *drawing, double length)
{
    text(drawing, "<svg xmlns=\"http://www.w3.org/2000/svg\"");
    attribute(drawing, "width", drawing->width);
    attribute(drawing, "height", drawing->height);
    proto_append_format(drawing->writer, " viewBox=\"0 0 %d %d\"", (int)drawing->width,
                        (int)drawing->height);
    text(drawing, " font-family=\"sans-serif\" font-size=\"14\">\n<title>A path of length ");
    number(drawing, length);
    text(drawing,
         ", unfolded</title>\n<desc>The faces that the path runs through, laid flat one beside the "
         "other. "
         "Coordinates within the group are lengths in the unit of the mesh.</desc>\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<g transform=\"translate(");
    number(drawing, MARGIN - drawing->scale * drawing->min[0]);
    text(drawing, ",");
    number(drawing, MARGIN + drawing->scale * drawing->max[1]);
    text(drawing, ") scale(");
    number(drawing, drawing->scale);
    text(drawing, ")\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n");
}

/* --- the content ------------------------------------------------------------------------------ */

static void draw_faces(const struct drawing *drawing)
{
    text(drawing,
         "<path fill=\"#dbe2ea\" fill-opacity=\"0.8\" stroke=\"#7a8794\" stroke-width=\"1\" "
         "vector-effect=\"non-scaling-stroke\" d=\"");
    for (uint32_t i = 0; i < drawing->strip->face_count; i++) {
        const struct gd_flat_face *face = &drawing->strip->faces[i];
        for (int k = 0; k < 3; k++) place(drawing, face->corners[k], k ? " " : i ? " M" : "M");
        text(drawing, "Z");
    }
    text(drawing, "\"/>\n");
}

static void draw_path(const struct drawing *drawing)
{
    text(drawing, "<polyline fill=\"none\" stroke=\"#c8102e\" stroke-width=\"2.5\" "
                  "vector-effect=\"non-scaling-stroke\" points=\"");
    for (uint32_t i = 0; i < drawing->strip->point_count; i++)
        place(drawing, drawing->strip->points[i], i ? " " : "");
    text(drawing, "\"/>\n");
}

static void draw_end(const struct drawing *drawing, const double at[2], const char *fill)
{
    text(drawing, "<circle");
    attribute(drawing, "cx", at[0]);
    attribute(drawing, "cy", at[1] != 0 ? -at[1] : 0);
    attribute(drawing, "r", 5 / drawing->scale);
    text(drawing,
         " stroke=\"#c8102e\" stroke-width=\"2\" vector-effect=\"non-scaling-stroke\" fill=\"");
    text(drawing, fill);
    text(drawing, "\"/>\n");
}

/* Returns 1, 2 or 5 times a power of ten, at most `most`. */
static double round_length(double most)
{
    double power = pow(10, floor(log10(most)));
    return most >= 5 * power ? 5 * power : most >= 2 * power ? 2 * power : power;
}

/* Draws a bar below the drawing, labelled with its length, and writes the path's length beside
 * it. */
static void draw_foot(const struct drawing *drawing, double length)
{
    double bar = round_length(0.25 * WIDTH / drawing->scale), y = drawing->height - FOOT + 8;
    text(drawing, "</g>\n<path fill=\"none\" stroke=\"#222\" stroke-width=\"2\" d=\"M");
    proto_append_format(drawing->writer, "%d,%d v6 h", (int)MARGIN, (int)y);
    number(drawing, bar * drawing->scale);
    text(drawing, " v-6\"/>\n<text fill=\"#222\"");
    attribute(drawing, "x", MARGIN);
    attribute(drawing, "y", y + 26);
    text(drawing, ">");
    rounded(drawing, bar);
    text(drawing, " (unit of the mesh)</text>\n<text fill=\"#c8102e\" text-anchor=\"end\"");
    attribute(drawing, "x", drawing->width - MARGIN);
    attribute(drawing, "y", y + 26);
    text(drawing, ">length ");
    rounded(drawing, length);
    text(drawing, "</text>\n</svg>\n");
}

void proto_flat_strip_svg(struct proto_writer *writer, const struct gd_flat_strip *strip,
                          double length)
{
    struct drawing drawing = {.writer = writer,
                              .strip = strip,
                              .min = {INFINITY, INFINITY},
                              .max = {-INFINITY, -INFINITY}};
    measure(&drawing);
    begin_page(&drawing, length);
    draw_faces(&drawing);
    draw_path(&drawing);
    draw_end(&drawing, strip->points[0], "#fff");
    draw_end(&drawing, strip->points[strip->point_count - 1], "#c8102e");
    draw_foot(&drawing, length);
}
