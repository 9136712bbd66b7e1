#include "proto/values/bulk_points.h"

#include <math.h>
#include <string.h>

#include "gd/number.h"

/* Each reader removes the part that it reads from the front of the text, or returns false. */
static void skip_space(struct proto_bulk_text *text)
{
    while (text->at < text->end &&
           (*text->at == ' ' || *text->at == '\n' || *text->at == '\r' || *text->at == '\t'))
        text->at++;
}

static bool bulk_take(struct proto_bulk_text *text, char character)
{
    skip_space(text);
    if (text->at == text->end || *text->at != character) return false;
    text->at++;
    return true;
}

static bool bulk_take_word(struct proto_bulk_text *text, const char *word)
{
    size_t length = strlen(word);
    if ((size_t)(text->end - text->at) < length || memcmp(text->at, word, length) != 0)
        return false;
    text->at += length;
    return true;
}

/* Reads a member's name and the colon. */
static bool bulk_take_name(struct proto_bulk_text *text, const char *name)
{
    struct proto_bulk_text rest = *text;
    if (!bulk_take(&rest, '"') || !bulk_take_word(&rest, name) || rest.at == rest.end ||
        *rest.at++ != '"' || !bulk_take(&rest, ':'))
        return false;
    *text = rest;
    return true;
}

/* --- numbers ---------------------------------------------------------------------------------- */

static bool is_digit(const struct proto_bulk_text *text)
{
    return text->at < text->end && *text->at >= '0' && *text->at <= '9';
}

static bool bulk_skip_digits(struct proto_bulk_text *text)
{
    const char *first = text->at;
    while (is_digit(text)) text->at++;
    return text->at > first;
}

/* Removes decimal digits without a leading zero. */
static bool bulk_skip_whole(struct proto_bulk_text *text)
{
    const char *first = text->at;
    return bulk_skip_digits(text) && (*first != '0' || text->at == first + 1);
}

static bool bulk_take_index(struct proto_bulk_text *text, uint32_t *out)
{
    uint64_t value = 0;
    skip_space(text);
    const char *first = text->at;
    if (!bulk_skip_whole(text) || text->at - first > 10) return false;
    for (const char *at = first; at < text->at; at++) value = 10 * value + (uint64_t)(*at - '0');
    *out = (uint32_t)value;
    return value < UINT32_MAX;
}

/* Reads a number by the grammar of JSON (RFC 8259, 6). */
static bool bulk_take_number(struct proto_bulk_text *text, double *out)
{
    skip_space(text);
    const char *first = text->at;
    (void)bulk_take_word(text, "-");
    if (!bulk_skip_whole(text)) return false;
    if (bulk_take_word(text, ".") && !bulk_skip_digits(text)) return false;
    if (bulk_take_word(text, "e") || bulk_take_word(text, "E")) {
        if (!bulk_take_word(text, "-")) (void)bulk_take_word(text, "+");
        if (!bulk_skip_digits(text)) return false;
    }
    return gd_number_parse(first, text->at, out) == text->at && isfinite(*out);
}

static bool bulk_take_triple(struct proto_bulk_text *text, double out[3])
{
    return bulk_take(text, '[') && bulk_take_number(text, &out[0]) && bulk_take(text, ',') &&
           bulk_take_number(text, &out[1]) && bulk_take(text, ',') &&
           bulk_take_number(text, &out[2]) && bulk_take(text, ']');
}

/* --- points ----------------------------------------------------------------------------------- */

bool proto_bulk_point(struct proto_bulk_text *points, struct proto_point *out)
{
    bool ok = false;
    out->place[0] = '\0';
    if (!bulk_take(points, '{')) return false;
    if (bulk_take_name(points, "vertex")) {
        out->form = PROTO_POINT_VERTEX;
        ok = bulk_take_index(points, &out->vertex);
    } else if (bulk_take_name(points, "face")) {
        out->form = PROTO_POINT_FACE;
        ok = bulk_take_index(points, &out->face) && bulk_take(points, ',') &&
             bulk_take_name(points, "barycentric") && bulk_take_triple(points, out->barycentric);
    } else if (bulk_take_name(points, "xyz")) {
        out->form = PROTO_POINT_XYZ;
        out->has_max_snap = false;
        ok = bulk_take_triple(points, out->xyz);
    }
    return ok && bulk_take(points, '}') && (bulk_take(points, ',') || bulk_take(points, ']'));
}

/* A point has only one closing brace, which is its end. */
uint32_t proto_bulk_split(struct proto_bulk_text *text, uint32_t most,
                          struct proto_bulk_text *points, bool *is_last)
{
    uint32_t count = 0;
    *is_last = false;
    points->at = text->at;
    while (count < most && !*is_last) {
        const char *brace = memchr(text->at, '}', (size_t)(text->end - text->at));
        if (!brace) return 0;
        text->at = brace + 1;
        *is_last = bulk_take(text, ']');
        if (!*is_last && !bulk_take(text, ',')) return 0;
        count++;
    }
    points->end = text->at;
    return count;
}

/* --- the object ------------------------------------------------------------------------------- */

int proto_bulk_open(struct proto_bulk_text *text, const char *const *names, bool is_first)
{
    int name = 0;
    if (!bulk_take(text, is_first ? '{' : ',')) return -1;
    while (names[name] && !bulk_take_name(text, names[name])) name++;
    return names[name] && bulk_take(text, '[') ? name : -1;
}

bool proto_bulk_end(struct proto_bulk_text *text)
{
    if (!bulk_take(text, '}')) return false;
    skip_space(text);
    return text->at == text->end;
}
