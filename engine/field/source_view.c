#include "field/source_view.h"

/* A line with a unit normal towards its visible side. */
struct bound {
    struct gd__local normal, through;
};

enum { BOUNDS_MOST = 3 };

/* Collects the borders of a source's view and returns their number. A sector has two borders. A
 * linear source (a segment) has a third one: the line at the distance `nearest`. A segment across
 * the face gives two sources, one for each side; the third border keeps each on its own side. */
static int source_bounds(const struct gd_field *field, const struct gd__face_frame *frame,
                         const struct gd__source *source, struct bound bound[BOUNDS_MOST])
{
    if (!source->has_sector) return 0;
    bound[0] = (struct bound){source->left, source->left_at};
    bound[1] = (struct bound){source->right, source->right_at};
    if (!source->linear) return 2;
    double offset = gd__field_sigma(field, source->pseudo);
    for (int k = 0; k < 2; k++) {
        double more = gd__line_lengthened(frame->size,
                                          gd__source_distance(source, bound[k].through) - offset);
        bound[k].through.x -= more * bound[k].normal.x;
        bound[k].through.y -= more * bound[k].normal.y;
    }
    double ahead = source->nearest - source->sigma;
    bound[2] =
        (struct bound){source->gradient, {ahead * source->gradient.x, ahead * source->gradient.y}};
    return 3;
}

static double height_above(const struct bound *bound, struct gd__local at)
{
    return bound->normal.x * (at.x - bound->through.x) +
           bound->normal.y * (at.y - bound->through.y);
}

/* Clips a convex polygon by a line; the view has room for the new corners. */
static void clip_view(struct gd__view *view, const struct bound *bound)
{
    struct gd__view cut = {0};
    for (int k = 0; k < view->count; k++) {
        struct gd__local a = view->corner[k], b = view->corner[(k + 1) % view->count];
        double height = height_above(bound, a), next = height_above(bound, b);
        if (height >= 0) cut.corner[cut.count++] = a;
        if ((height < 0) == (next < 0)) continue;
        double t = height / (height - next);
        cut.corner[cut.count++] = (struct gd__local){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    }
    *view = cut;
}

struct gd__view gd__source_view(const struct gd_field *field, const struct gd__face_frame *frame,
                                const struct gd__source *source, double nudge)
{
    struct gd__view view = {3, {frame->corner[0], frame->corner[1], frame->corner[2]}, 0};
    struct bound bound[BOUNDS_MOST];
    int bounds = source_bounds(field, frame, source, bound);
    for (int k = 0; k < bounds; k++) clip_view(&view, &bound[k]);
    struct gd__focus focus = gd__focus_of(source);
    focus.sigma += nudge;
    for (int k = 0; k < view.count; k++)
        view.most = fmax(view.most, gd__focus_distance(&focus, view.corner[k]));
    return view;
}

bool gd__view_is_beyond(const struct gd__view *view, const struct gd__source *other)
{
    if (view->most < other->nearest) return true;
    if (!other->has_sector) return view->count == 0;
    bool is_left = true, is_right = true;
    for (int k = 0; k < view->count; k++) {
        is_left &= height_above(&(struct bound){other->left, other->left_at}, view->corner[k]) < 0;
        is_right &=
            height_above(&(struct bound){other->right, other->right_at}, view->corner[k]) < 0;
    }
    return is_left || is_right;
}

/* Reduces `turn` to the spans where the branch lies inside a border. Returns false if no span is
 * left. */
static bool narrow(const struct gd__branch *branch, const struct bound *bound,
                   struct gd__turn *turn)
{
    struct gd__turn inside = gd__branch_beyond(branch, bound->normal, bound->through);
    gd__turn_narrow(turn, &inside);
    return turn->count > 0;
}

bool gd__branch_narrow_to_view(const struct gd_field *field, const struct gd__face_frame *frame,
                               const struct gd__branch *branch, const struct gd__source *source,
                               struct gd__turn *turn)
{
    struct bound bound[BOUNDS_MOST];
    int bounds = source_bounds(field, frame, source, bound);
    bool is_left = turn->count > 0;
    for (int k = 0; k < bounds && is_left; k++) is_left = narrow(branch, &bound[k], turn);
    return is_left;
}

struct gd__turn gd__branch_domain(const struct gd_field *field, const struct gd__sources *sources,
                                  const struct gd__branch *branch, const uint32_t pair[2],
                                  double slack)
{
    const struct gd__face_frame *frame = &sources->frame;
    struct gd__turn turn = gd__branch_turn(branch);
    bool is_left = true;
    for (int i = 0; i < 2 && is_left; i++)
        is_left = gd__branch_narrow_to_view(field, frame, branch, &sources->source[pair[i]], &turn);
    for (int k = 0; k < 3 && is_left; k++) {
        struct gd__local normal = {-frame->along[k].y, frame->along[k].x}, at = frame->corner[k];
        struct bound side = {normal, {at.x - slack * normal.x, at.y - slack * normal.y}};
        is_left = narrow(branch, &side, &turn);
    }
    return turn;
}

static bool is_needless(const struct gd_field *field, const struct gd__source *source)
{
    uint32_t vertices = field->mesh->vertex_count;
    if (source->has_sector || source->pseudo >= vertices) return false;
    if (field->mesh->vertex_kind[source->pseudo] != GD_VERTEX_CONVEX) return false;
    const struct gd__predecessor *predecessor = &field->predecessor[source->pseudo];
    return predecessor->side != GD_NONE ||
           predecessor->source < vertices; /* otherwise the vertex may be a seed */
}

void gd__sources_drop_needless(const struct gd_field *field, struct gd__sources *sources)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < sources->count; i++)
        if (!is_needless(field, &sources->source[i])) sources->source[kept++] = sources->source[i];
    sources->count = kept;
}

double gd__face_farthest(const struct gd_field *field, uint32_t face)
{
    const struct gd_mesh *mesh = field->mesh;
    const struct gd_side *s = &mesh->side[mesh->face_side[face][0]];
    double most = GD__FAR, longest = fmax(s->length, fmax(s->left_length, s->right_length));
    for (int k = 0; k < 3; k++)
        most = fmin(most, field->distance[mesh->origin[mesh->face_side[face][k]]] + longest);
    return most * (1 + GD_TOL_CHECK);
}
