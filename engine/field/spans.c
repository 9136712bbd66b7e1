#include "field/spans.h"

#include <stdlib.h>

#include "base/array.h"

struct gd__turn gd__turn_around(double phi, double q)
{
    if (q <= -1) return gd__turn_all;
    if (!(q < 1)) return (struct gd__turn){0};
    double half = acos(q), from = phi - half, to = phi + half;
    if (from < -M_PI)
        return (struct gd__turn){2, {{-M_PI, to, 0, 0}, {from + 2 * M_PI, M_PI, 0, 0}}};
    if (to > M_PI) return (struct gd__turn){2, {{-M_PI, to - 2 * M_PI, 0, 0}, {from, M_PI, 0, 0}}};
    return (struct gd__turn){1, {{from, to, 0, 0}}};
}

struct gd__turn gd__turn_both(const struct gd__turn *a, const struct gd__turn *b)
{
    struct gd__turn common; /* other spans stay uninitialised, because calls are very frequent */
    common.count = 0;
    for (int i = 0; i < a->count; i++) {
        for (int k = 0; k < b->count; k++) {
            double from = fmax(a->part[i].from, b->part[k].from),
                   to = fmin(a->part[i].to, b->part[k].to);
            if (from < to && common.count < GD__TURN_PARTS)
                common.part[common.count++] = (struct gd__span){.from = from, .to = to};
        }
    }
    return common;
}

static void append_span(struct gd__spans *spans, struct gd__span span)
{
    if (!spans->status)
        spans->status =
            gd__array_append(&spans->span, &spans->count, &spans->capacity, &span, sizeof span);
}

void gd__spans_put(struct gd__spans *spans, const struct gd__turn *turn, uint32_t by)
{
    for (int i = 0; i < turn->count; i++)
        append_span(spans, (struct gd__span){turn->part[i].from, turn->part[i].to, by, by});
}

static int by_start(const void *a, const void *b)
{
    const struct gd__span *x = a, *y = b;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    return (x->from_by > y->from_by) - (x->from_by < y->from_by);
}

/* Sorts spans by insertion if there are few, as usual. */
static void sort_by_start(struct gd__spans *spans)
{
    if (spans->count > 2 * GD__SPANS_FEW) {
        qsort(spans->span, spans->count, sizeof *spans->span, by_start);
        return;
    }
    for (uint32_t i = 1; i < spans->count; i++) {
        struct gd__span span = spans->span[i];
        uint32_t place = i;
        for (; place > 0 && spans->span[place - 1].from > span.from; place--)
            spans->span[place] = spans->span[place - 1];
        spans->span[place] = span;
    }
}

bool gd__spans_unite(struct gd__spans *covered, double least, uint32_t *limit)
{
    struct gd__span *span = covered->span;
    uint32_t joined = 0; /* the last span of the joined ones */
    sort_by_start(covered);
    bool has_gap = span[0].from + M_PI > least;
    for (uint32_t i = 1; i < covered->count; i++) {
        struct gd__span *last = &span[joined], next = span[i];
        has_gap |= next.from - last->to > least;
        if (next.from > last->to) {
            span[++joined] = next;
        } else if (next.to > last->to) {
            last->to = next.to;
            last->to_by = next.to_by;
        }
    }
    has_gap |= M_PI - span[joined].to > least;
    covered->count = joined + 1;
    *limit = 2 * covered->count > GD__SPANS_FEW ? 2 * covered->count : GD__SPANS_FEW;
    return !has_gap;
}

void gd__spans_invert(struct gd__spans *covered, double least, struct gd__spans *out)
{
    /* `free` begins at the end of the spans covered so far */
    struct gd__span free = {.from = -M_PI, .from_by = GD__SPAN_OPEN};
    append_span(covered, (struct gd__span){M_PI, M_PI, GD__SPAN_OPEN, GD__SPAN_OPEN});
    sort_by_start(covered);
    out->count = 0;
    if (covered->status) out->status = covered->status;
    for (uint32_t i = 0; i < covered->count && !out->status; i++) {
        struct gd__span next = covered->span[i];
        free.to = next.from;
        free.to_by = next.from_by;
        if (free.to - free.from > least) append_span(out, free);
        if (next.to <= free.from) continue;
        free.from = next.to;
        free.from_by = next.to_by;
    }
}

void gd__spans_cover_outside(const struct gd__turn *turn, struct gd__spans *covered,
                             struct gd__spans *scratch)
{
    scratch->count = 0;
    gd__spans_put(scratch, turn, GD__SPAN_OPEN);
    gd__spans_invert(scratch, 0, covered);
}

void gd__spans_join(struct gd__spans *spans)
{
    if (spans->count < 2) return;
    struct gd__span *first = &spans->span[0], *last = &spans->span[spans->count - 1];
    if (first->from > -M_PI || last->to < M_PI) return;
    last->to = first->to + 2 * M_PI;
    last->to_by = first->to_by;
    spans->count--;
    for (uint32_t i = 0; i < spans->count; i++) spans->span[i] = spans->span[i + 1];
}
