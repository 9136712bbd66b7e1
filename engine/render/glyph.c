#include <string.h>

#include "render/canvas.h"

/* The stroke font: the characters of numbers and of a legend's words. */

#define STEP 0.12  /* length of a step relative to the text's size; digits are 6 steps high */
enum { BASE = 2 }; /* the baseline in steps */

/* A glyph. `lines` are strokes separated by spaces. A stroke is a list of places of two digits
 * each: steps to the right and steps upwards. */
struct glyph {
    char letter;
    double width; /* steps, including the gap to the next glyph */
    const char *lines;
};

static const struct glyph glyphs[] = {
    {'0', 5.5, "123243473818070312"},
    {'1', 4, "072822"},
    {'2', 5.5, "07183847460242"},
    {'3', 5.5, "07183847463515 354443321203"},
    {'4', 5.5, "32380444"},
    {'5', 5.5, "480805354443321203"},
    {'6', 5.5, "473818070312324344351504"},
    {'7', 5.5, "084812"},
    {'8', 5.5, "150607183847463515 1504031232434435"},
    {'9', 5.5, "031232434738180706153546"},
    {'.', 1.8, "02"},
    {'-', 5.5, "0545"},
    {'+', 5.5, "0545 2723"},
    {'a', 4.7, "36160503122233 3632"},
    {'c', 4.3, "361605031232"},
    {'d', 4.7, "36160503122233 3832"},
    {'e', 4.6, "043435261605031232"},
    {'g', 4.7, "36160503122233 36312000"},
    {'h', 4.7, "0802 0516263532"},
    {'i', 1.8, "0602 08"},
    {'l', 1.8, "0802"},
    {'n', 4.7, "0602 0516263532"},
    {'p', 4.7, "0600 0516263533221203"},
    {'s', 4.4, "3616051424332202"},
    {'t', 4.3, "18132232 0636"},
    {' ', 3, ""},
};

static const struct glyph *glyph_find(char letter)
{
    for (size_t i = 0; i < sizeof glyphs / sizeof *glyphs; i++)
        if (glyphs[i].letter == letter) return &glyphs[i];
    return &glyphs[sizeof glyphs / sizeof *glyphs - 1];
}

static double width_of(const char *text)
{
    double width = 0;
    for (; *text; text++) width += glyph_find(*text)->width;
    return width;
}

void gd__text_strokes(const struct gd__text *text, struct gd__lines *out)
{
    double step = STEP * text->size, x = text->x;
    if (text->anchor == GD__ANCHOR_MIDDLE) x -= 0.5 * step * width_of(text->text);
    for (const char *letter = text->text; *letter; letter++) {
        const struct glyph *glyph = glyph_find(*letter);
        for (const char *c = glyph->lines; *c; c++) {
            if (*c == ' ') {
                gd__lines_end(out);
                continue;
            }
            gd__lines_add(out, x + step * (c[0] - '0'), text->y - step * (c[1] - '0' - BASE));
            c++;
        }
        gd__lines_end(out);
        x += step * glyph->width;
    }
}
