#include "wedge/wavefront.h"

#include <string.h>

#include "wedge/contest.h"

/* Propagation of a side's pending windows across its face. In the side's frame the apex is p = (px, py), the source (sx, sy) with sy = -y.
 * For a point (b, 0) of the edge, k(b) = (b - sx)(py - sy) + sy (px - sx) is negative when the ray through it passes left of p. */

struct apex {
    double px, py;
};

static struct apex apex_of(const struct gd_side *side)
{
    return (struct apex){side->left_length * side->left_x, side->left_length * side->left_y};
}

/* A child has no tags; narrower than the least width: there is none. */
static inline struct gd__window make_child(double b0, double b1, double x, double y, const struct gd__window *parent)
{
    return (struct gd__window){.b0 = b0, .b1 = b1, .x = x, .y = y, .sigma = parent->sigma, .source = parent->source};
}

static const struct gd__window no_child = {.b0 = 0, .b1 = -1};

static inline struct gd__window child_left(const struct gd_side *side, const struct gd__window *w, double k1)
{
    double ux = side->left_x, uy = side->left_y, length = side->left_length, sx = w->x, sy = -w->y;
    double y = uy * sx - ux * sy, x = sx * ux + sy * uy;
    if (gd__window_grazes(x, y, length)) return no_child;
    double t0 = w->b0 <= 0 ? 0 : w->b0 * sy / ((w->b0 - sx) * uy + sy * ux);
    double t1 = k1 >= 0 ? length : w->b1 * sy / ((w->b1 - sx) * uy + sy * ux);
    if (!(t0 >= 0)) t0 = 0;
    if (!(t1 <= length)) t1 = length;
    return make_child(t0, t1, x, y, w);
}

static inline struct gd__window child_right(const struct gd_side *side, const struct gd__window *w, double k0,
                                            double k1)
{
    struct apex p = apex_of(side);
    double vx = side->right_x, vy = side->right_y, length = side->right_length, sx = w->x, sy = -w->y;
    double rx = sx - p.px, ry = sy - p.py;
    double y = vy * rx - vx * ry, x = rx * vx + ry * vy;
    if (gd__window_grazes(x, y, length)) return no_child;
    double t0 = k0 <= 0 ? 0 : -k0 / ((w->b0 - sx) * vy + sy * vx);
    double t1 = w->b1 >= side->length ? length : -k1 / ((w->b1 - sx) * vy + sy * vx);
    if (!(t0 >= 0)) t0 = 0;
    if (!(t1 <= length)) t1 = length;
    return make_child(t0, t1, x, y, w);
}

static double turn(const struct gd__window *w, struct apex p, double b)
{
    return (b - w->x) * (p.py + w->y) - w->y * (p.px - w->x);
}

/* Which way the rays through the window's ends pass the apex. */
struct turns {
    double k0, k1;
};

static struct turns turns_of(const struct gd_side *side, const struct gd__window *w)
{
    struct apex p = apex_of(side);
    return (struct turns){turn(w, p, w->b0), turn(w, p, w->b1)};
}

struct gd__children gd__window_children(const struct gd_side *side, const struct gd__window *w)
{
    struct turns turns = turns_of(side, w);
    struct gd__children children = {0};
    if (turns.k0 < 0) children.left = child_left(side, w, turns.k1);
    if (turns.k1 > 0) children.right = child_right(side, w, turns.k0, turns.k1);
    children.has_left = children.left.b1 - children.left.b0 > GD_TOL_WIDTH * side->left_length;
    children.has_right = children.right.b1 - children.right.b0 > GD_TOL_WIDTH * side->right_length;
    return children;
}

/* Behind the last one, and of another source: neither a contest nor a joining of the two is called for. */
static inline bool lies_clear(const struct gd__window *last, const struct gd__window *child, double min_width)
{
    return child->b0 >= last->b1 - min_width &&
           fabs(child->x - last->x) > GD_TOL_SAME_SOURCE * (last->y + fabs(last->x));
}

/* Appends a child to its list if it lies clear of the last one, as most do; else leaves it to gd__stack_push. The child stays in registers on the
 * way: built in memory and copied, it costs more than its arithmetic. */
static inline void push_child(struct gd__wavefront *front, struct gd__stack *list, struct gd__window child,
                              double length)
{
    double min_width = GD_TOL_WIDTH * length;
    if (child.b1 - child.b0 <= min_width) return;
    if (front->methods.no_coalescing) child.tags = (uint32_t)front->effort.windows_propagated * GD__WINDOW_SERIAL;
    if (list->count < list->capacity &&
        (!list->count || lies_clear(&list->windows[list->count - 1], &child, min_width))) {
        list->windows[list->count++] = child;
        return;
    }
    struct gd__window copy = child;
    enum gd_status status = gd__stack_push(list, &copy, min_width, &front->scratch);
    if (status) front->status = status;
}

/* Offers the apex a distance through the window: straight when it is visible, else round the window's nearer end, which closes gaps. */
static void reach_apex(struct gd__wavefront *front, uint32_t side, const struct gd_side *s, const struct gd__window *w,
                       struct turns turns)
{
    uint32_t vertex = front->mesh->origin[s->right];
    struct apex p = apex_of(s);
    double hx = p.px - w->x, hy = p.py + w->y, room = front->distance[vertex] - w->sigma;
    if (room <= 0 || hx * hx + hy * hy >= room * room) return; /* no path through the window is shorter */
    if (turns.k0 <= 0 && turns.k1 >= 0) {
        struct gd__birth birth = {.x = w->x, .y = w->y, .side = side, .source = w->source};
        gd__wavefront_reach(front, vertex, w->sigma + sqrt(hx * hx + hy * hy), birth);
    } else {
        double b = turns.k0 > 0 ? w->b0 : w->b1, bx = p.px - b;
        struct gd__birth birth = {.x = b, .y = 0, .side = side, .source = GD_NONE};
        gd__wavefront_reach(front, vertex, gd__window_distance(w, b) + sqrt(bx * bx + p.py * p.py), birth);
    }
}

/* Filter by the distances d0, d1 of the edge's ends (Xin and Wang 2009): where the way round an end is strictly shorter than the window, no
 * shortest path uses it. False: all of it; else [b0, b1] is trimmed. Comparisons are squared: sigma + |s b| > d + way. */
static bool filter(struct gd__window *w, double d0, double d1, double length)
{
    double y2 = w->y * w->y, e0 = w->b0 - w->x, e1 = w->b1 - w->x, r0 = e0 * e0 + y2, r1 = e1 * e1 + y2;
    double slack = GD_TOL_BETTER * (w->sigma + length + fabs(w->x) + w->y);
    double c0 = d0 - w->sigma, c1 = d1 - w->sigma;
    double way0 = c0 + w->b1 + slack, way1 = c1 + length - w->b0 + slack;
    if (way0 < 0 || r1 > way0 * way0 || way1 < 0 || r0 > way1 * way1) return false;
    way0 = c0 + w->b0 + slack;
    way1 = c1 + length - w->b1 + slack;
    if (way0 < 0 || r0 > way0 * way0) {
        double t = (w->x * w->x + y2 - c0 * c0) / (2 * (c0 + w->x));
        if (t > w->b0 && t < w->b1) w->b0 = t;
    }
    if (way1 < 0 || r1 > way1 * way1) {
        double c = c1 + length, t = (c * c - w->x * w->x - y2) / (2 * (c - w->x));
        if (t < w->b1 && t > w->b0) w->b1 = t;
    }
    return true;
}

/* Cuts the pieces out of `w` where the windows of the other side are strictly shorter, and appends what is left to `out`. `twin` is sorted
 * by its own parameter, so from high to low here; `*first` is the first that may still overlap. */
static void cut_by_twin(const struct gd__window *w, const struct gd__list *twin, double length, double min_width,
                        uint32_t *first, struct gd__stack *out)
{
    while (*first > 0 && length - twin->windows[*first - 1].b0 <= w->b0) --*first;
    double start = w->b0;
    for (uint32_t j = *first; j > 0; j--) {
        struct gd__window other = gd__window_mirrored(&twin->windows[j - 1], length);
        if (other.b0 >= w->b1 - min_width) break;
        double lo = other.b0 > w->b0 ? other.b0 : w->b0, hi = other.b1 < w->b1 ? other.b1 : w->b1;
        if (hi - lo <= min_width) continue;
        struct gd__verdict verdict = gd__contest(&other, w, lo, hi);
        bool other_wins = verdict.challenger_first;
        double from = lo;
        for (int i = 0; i <= verdict.switches; i++) {
            double to = i < verdict.switches ? verdict.at[i] : hi;
            if (other_wins) {
                if (from - start > min_width) {
                    out->windows[out->count] = *w;
                    out->windows[out->count].b0 = start;
                    out->windows[out->count++].b1 = from;
                }
                start = to;
            }
            other_wins = !other_wins;
            from = to;
        }
    }
    if (w->b1 - start <= min_width) return;
    out->windows[out->count] = *w;
    out->windows[out->count++].b0 = start;
}

/* Trims the pending windows of a side where the list of the other side of the same edge is strictly better (the paper's merged list of an
 * edge, Property 3). One-sided: the other side is left alone, so a tie keeps both. */
static enum gd_status prune_by_twin(struct gd__wavefront *front, uint32_t side)
{
    struct gd__list *list = &front->lists[side];
    const struct gd__list *twin = &front->lists[side ^ 1];
    if (!twin->count || front->methods.separate_sides) return GD_OK;
    struct gd__stack *out = &front->scratch;
    enum gd_status status = gd__stack_reserve(out, gd__merged_bound(list->count, twin->count));
    if (status) return status;
    double length = front->mesh->side[side].length, min_width = GD_TOL_WIDTH * length;
    uint32_t first = twin->count;
    out->count = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        if (list->windows[i].tags & GD__WINDOW_PROPAGATED)
            out->windows[out->count++] = list->windows[i];
        else
            cut_by_twin(&list->windows[i], twin, length, min_width, &first, out);
    }
    return gd__list_assign(list, &front->pool, out->windows, out->count);
}

/* Propagates one pending window; false when the filter or the bound leaves nothing of it to keep. */
static bool propagate_window(struct gd__wavefront *front, uint32_t side, const struct gd_side *s, struct gd__window *w)
{
    const struct gd_mesh *mesh = front->mesh;
    double d0 = front->distance[mesh->origin[side]], d1 = front->distance[mesh->origin[side ^ 1]];
    if (!front->methods.no_filter && !filter(w, d0, d1, s->length)) return false;
    w->tags |= GD__WINDOW_PROPAGATED;
    if (front->bound < GD__FAR && gd__window_nearest(w) > front->bound) return true;
    front->effort.windows_propagated++;
    struct turns turns = turns_of(s, w);
    reach_apex(front, side, s, w, turns);
    if (turns.k0 < 0) push_child(front, &front->left, child_left(s, w, turns.k1), s->left_length);
    if (turns.k1 > 0) push_child(front, &front->right, child_right(s, w, turns.k0, turns.k1), s->right_length);
    return true;
}

void gd__propagate_side(struct gd__wavefront *front, uint32_t side)
{
    struct gd__list *list = &front->lists[side];
    const struct gd_side *s = &front->mesh->side[side];
    list->pending = false;
    if (s->left == GD_NONE) return;
    front->status = prune_by_twin(front, side);
    if (front->status) return;
    front->effort.sides_propagated++;
    front->left.count = front->right.count = 0;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        struct gd__window *w = &list->windows[i];
        if (!(w->tags & GD__WINDOW_PROPAGATED) && !propagate_window(front, side, s, w)) continue;
        if (kept != i) list->windows[kept] = *w;
        kept++;
    }
    list->count = kept;
    gd__wavefront_deliver(front, s->left, &front->left);
    gd__wavefront_deliver(front, s->right, &front->right);
}
