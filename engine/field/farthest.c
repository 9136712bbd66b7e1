#include <stdlib.h>

#include "field/array.h"
#include "field/circle.h"
#include "wedge/contest.h"

/* The farthest point. The distance has no maximum where it comes from one source only, as it grows away from it, nor inside a face where it comes
 * from two. So a maximum is a vertex, a point of a boundary edge between two sources, or a point between three. Vertices come first; then
 * only faces that may rise above the best so far are searched, and in them only the sources that do. */

enum { CHECK_INTERVAL = 64 /* faces */ };

struct candidate {
    double most; /* no point of the face is farther */
    uint32_t face;
};

struct search {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    double best;
    struct gd_point point;
    struct candidate *candidate;
    uint32_t candidate_count, candidate_capacity;
    struct gd__sources sources;
    struct gd__spans covered, spans;
    uint32_t *rising; /* sources of the face at hand that may give more than the best */
    uint32_t rising_count, rising_capacity;
};

static void close_search(struct search *search)
{
    free(search->candidate);
    gd__sources_destroy(&search->sources);
    free(search->covered.span);
    free(search->spans.span);
    free(search->rising);
}

static void take_farthest_vertex(struct search *search)
{
    search->best = -1;
    for (uint32_t v = 0; v < search->mesh->vertex_count; v++) {
        double distance = search->field->distance[v];
        if (distance >= GD__FAR || distance <= search->best) continue;
        search->best = distance;
        search->point = gd__point_of_vertex(v);
    }
}

/* A place of the face at hand: takes it if its distance, asked for like any other's, is greater than the best. */
static void offer(struct search *search, struct gd__local at)
{
    struct gd_point point = gd__frame_point(search->mesh, search->sources.face, &search->sources.frame, at);
    struct gd__way way;
    gd__field_way(search->field, &point, &way);
    if (way.kind == GD__LEG_NONE || way.distance <= search->best) return;
    search->best = way.distance;
    search->point = point;
}

/* --- which faces --------------------------------------------------------------------------------------------------------- */

/* Every point of a face is within an edge of each corner. */
static double most_in_face(const struct search *search, uint32_t face)
{
    const struct gd_mesh *mesh = search->mesh;
    const struct gd_side *s = &mesh->side[mesh->face_side[face][0]];
    double a = s->length, b = s->right_length, c = s->left_length, reach[3] = {fmax(a, c), fmax(a, b), fmax(b, c)};
    double most = GD__FAR;
    for (int k = 0; k < 3; k++)
        most = fmin(most, search->field->distance[mesh->origin[mesh->face_side[face][k]]] + reach[k]);
    return most;
}

static int by_most(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    if (x->most != y->most) return x->most > y->most ? -1 : 1;
    return (x->face > y->face) - (x->face < y->face);
}

static enum gd_status find_candidates(struct search *search)
{
    for (uint32_t face = 0; face < search->mesh->face_count; face++) {
        double most = most_in_face(search, face);
        if (most <= search->best || most >= GD__FAR) continue;
        struct candidate *grown = gd__array_reserve(search->candidate, &search->candidate_capacity,
                                                    search->candidate_count + 1, sizeof *grown);
        if (!grown) return GD_NO_MEMORY;
        search->candidate = grown;
        search->candidate[search->candidate_count++] = (struct candidate){most, face};
    }
    if (search->candidate_count) qsort(search->candidate, search->candidate_count, sizeof *search->candidate, by_most);
    return GD_OK;
}

/* --- which sources ------------------------------------------------------------------------------------------------------- */

/* A source that is nearest to a point beyond the best is so on all of the straight way back: it enters the face beyond the best, or passes it. */
static enum gd_status is_rising(struct search *search, uint32_t i, bool *out)
{
    const struct gd__source *source = &search->sources.source[i];
    *out = source->farthest >= search->best; /* a seed may be the farthest vertex so far */
    if (*out || source->nearest >= search->best) return GD_OK;
    enum gd_status status = gd__circle_arcs(&search->sources, i, search->best, &search->covered, &search->spans);
    *out = search->spans.count > 0;
    return status;
}

static enum gd_status find_rising(struct search *search, uint32_t face)
{
    enum gd_status status = gd__sources_gather(search->field, face, GD__FAR, &search->sources);
    search->rising_count = 0;
    for (uint32_t i = 0; i < search->sources.count && !status; i++) {
        bool rises;
        status = is_rising(search, i, &rises);
        if (status || !rises) continue;
        uint32_t *grown =
            gd__array_reserve(search->rising, &search->rising_capacity, search->rising_count + 1, sizeof *grown);
        if (!grown) return GD_NO_MEMORY;
        search->rising = grown;
        search->rising[search->rising_count++] = i;
    }
    return status;
}

/* --- between three ------------------------------------------------------------------------------------------------------- */

static double cross(struct gd__local a, struct gd__local b)
{
    return a.x * b.y - a.y * b.x;
}

static double dot(struct gd__local a, struct gd__local b)
{
    return a.x * b.x + a.y * b.y;
}

/* Places as far from a source as from two others. With p and r counted from the first source, and (a, k), (b, l) the others' places and sigmas from
 * there: |p| = r, |p - a| = r - k, |p - b| = r - l. Differences of squares leave a p = m + k r and b p = n + l r, so that p = u + r w is
 * linear in r, and |u + r w| = r a quadratic. Returns how many places there are. */
static int places_between(const struct gd__source *s[3], struct gd__local place[2])
{
    struct gd__local a = {s[1]->at.x - s[0]->at.x, s[1]->at.y - s[0]->at.y},
                     b = {s[2]->at.x - s[0]->at.x, s[2]->at.y - s[0]->at.y};
    double k = s[1]->sigma - s[0]->sigma, l = s[2]->sigma - s[0]->sigma, area = cross(a, b);
    double m = 0.5 * (dot(a, a) - k * k), n = 0.5 * (dot(b, b) - l * l);
    if (area == 0) return 0;
    struct gd__local u = {(m * b.y - n * a.y) / area, (n * a.x - m * b.x) / area},
                     w = {(k * b.y - l * a.y) / area, (l * a.x - k * b.x) / area};
    double q2 = dot(w, w) - 1, q1 = dot(u, w), q0 = dot(u, u), discriminant = q1 * q1 - q2 * q0;
    if (!(discriminant >= 0)) return 0;
    double z = -(q1 + copysign(sqrt(discriminant), q1)), root[2] = {q0 / z, z / q2};
    int count = 0;
    for (int i = 0; i < 2; i++) {
        double r = root[i];
        if (!(r >= 0 && r >= k && r >= l && isfinite(r))) continue;
        place[count++] = (struct gd__local){s[0]->at.x + u.x + r * w.x, s[0]->at.y + u.y + r * w.y};
    }
    return count;
}

static bool is_in_face(const struct gd__frame *frame, struct gd__local at)
{
    for (int k = 0; k < 3; k++) {
        struct gd__local from = {at.x - frame->corner[k].x, at.y - frame->corner[k].y};
        if (cross(frame->along[k], from) < -GD_TOL_CHECK * frame->size) return false;
    }
    return true;
}

static void search_between(struct search *search, uint32_t i, uint32_t k, uint32_t l)
{
    const struct gd__source *all = search->sources.source, *s[3] = {&all[i], &all[k], &all[l]};
    struct gd__local place[2];
    int count = places_between(s, place);
    for (int p = 0; p < count; p++)
        if (gd__source_distance(s[0], place[p]) > search->best && is_in_face(&search->sources.frame, place[p]))
            offer(search, place[p]);
}

static void search_inside(struct search *search)
{
    const uint32_t *rising = search->rising;
    for (uint32_t i = 0; i < search->rising_count; i++)
        for (uint32_t k = i + 1; k < search->rising_count; k++)
            for (uint32_t l = k + 1; l < search->rising_count; l++)
                search_between(search, rising[i], rising[k], rising[l]);
}

/* --- on the boundary ----------------------------------------------------------------------------------------------------- */

/* A source as a window of side k; whether it lies above or below the side makes no difference along it. */
static struct gd__window window_of(const struct gd__frame *frame, int k, const struct gd__source *source)
{
    struct gd__local from = {source->at.x - frame->corner[k].x, source->at.y - frame->corner[k].y};
    return (struct gd__window){.b1 = frame->length[k],
                               .x = dot(frame->along[k], from),
                               .y = fabs(cross(frame->along[k], from)),
                               .sigma = source->sigma};
}

static void search_along(struct search *search, int k)
{
    const struct gd__frame *frame = &search->sources.frame;
    for (uint32_t i = 0; i < search->rising_count; i++) {
        for (uint32_t j = i + 1; j < search->rising_count; j++) {
            struct gd__window a = window_of(frame, k, &search->sources.source[search->rising[i]]),
                              b = window_of(frame, k, &search->sources.source[search->rising[j]]);
            struct gd__verdict verdict = gd__contest(&a, &b, 0, frame->length[k]);
            for (int s = 0; s < verdict.switches; s++)
                if (gd__window_distance(&a, verdict.at[s]) > search->best)
                    offer(search, gd__frame_place(frame, k, verdict.at[s], 0));
        }
    }
}

static enum gd_status search_face(struct search *search, uint32_t face)
{
    enum gd_status status = find_rising(search, face);
    if (status) return status;
    for (int k = 0; k < 3; k++)
        if (gd__side_is_boundary(search->mesh, search->mesh->face_side[face][k] ^ 1)) search_along(search, k);
    search_inside(search);
    return GD_OK;
}

enum gd_status gd_field_farthest(const struct gd_field *field, const struct gd_control *control, struct gd_point *point,
                                 double *distance)
{
    if (field->reach < GD__FAR) return GD_BEYOND_REACH;
    if (field->has_segments) return GD_UNSUPPORTED;
    struct search search = {.field = field, .mesh = field->mesh};
    take_farthest_vertex(&search);
    enum gd_status status = gd_control_check(control, 0);
    if (!status) status = find_candidates(&search);
    for (uint32_t i = 0; i < search.candidate_count && !status && search.candidate[i].most > search.best; i++) {
        if (i % CHECK_INTERVAL == 0) status = gd_control_check(control, (double)i / search.candidate_count);
        if (!status) status = search_face(&search, search.candidate[i].face);
    }
    close_search(&search);
    if (status) return status;
    *point = search.point;
    *distance = search.best * field->mesh->unit;
    return GD_OK;
}
