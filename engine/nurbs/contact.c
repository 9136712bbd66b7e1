#include "nurbs/contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/tolerance.h"

enum {
    HALVINGS = 24, /* largest number of halvings of an interval of the quadrature */
    PARTS_LEAST = 4,
    PROBES = 64 /* number of places at which the curvature of a contact is computed */
};

/* Sine of an angle. If a polyline turns by more than this angle at a loop, the obstacle is on the
 * inner side of the turn. */
static const double clear_turn = 1e-2;

static const struct gd__span *contact_span(const struct gd_parametric *surface,
                                           const struct gd__contact *contact)
{
    const struct gd__loops *loops = surface->loops;
    return &loops->spans[loops->loops[contact->loop].first_span + contact->span];
}

/* Computes place, velocity and acceleration in space of the loop, in the direction of the loop. */
static struct gd_vec3 contact_jet(const struct gd_parametric *surface,
                                  const struct gd__contact *contact, double t,
                                  struct gd__curve_jet *c, struct gd_jet *x)
{
    struct gd__span_jet jet;
    gd__span_jet(contact_span(surface, contact), t, &jet);
    memcpy(c, &jet, sizeof jet);
    gd__surface_at(surface, c->at, x);
    for (int k = 0; k < 2; k++) c->at[k] += contact->shift[k];
    return gd__velocity(x, c->first);
}

void gd__contact_at(const struct gd_parametric *surface, const struct gd__contact *contact,
                    double t, struct gd__contact_place *out)
{
    struct gd__curve_jet c;
    struct gd_jet x;
    struct gd_vec3 velocity = contact_jet(surface, contact, t, &c, &x),
                   bend = gd__acceleration(&x, &c), normal = gd_vec3_cross(x.u, x.v);
    double speed = gd_vec3_length(velocity), area = gd_vec3_length(normal);
    normal = gd_vec3_scale(normal, area > 0 ? 1 / area : 0);
    *out = (struct gd__contact_place){
        .at = {c.at[0], c.at[1]},
        .x = x.x,
        .tangent = gd_vec3_scale(velocity, speed > 0 ? contact->direction / speed : 0),
        .normal = normal,
        .speed = speed,
        .curvature = -gd_vec3_dot(normal, gd_vec3_cross(velocity, bend)) / (speed * speed * speed)};
}

double gd__contact_turn(const struct gd__contact *contact, struct gd_vec3 normal,
                        struct gd_vec3 from, struct gd_vec3 to)
{
    double left = gd_vec3_dot(normal, gd_vec3_cross(from, to));
    return -contact->direction * atan2(left, gd_vec3_dot(from, to));
}

/* --- length ----------------------------------------------------------------------------------- */

static double contact_gauss(const struct gd_parametric *surface, const struct gd__contact *contact,
                            double low, double high)
{
    const struct gd__gauss *rule = gd__gauss(GD__GAUSS_MOST);
    double sum = 0;
    for (int i = 0; i < GD__GAUSS_MOST; i++) {
        struct gd__curve_jet c;
        struct gd_jet x;
        double t = low + rule->node[i] * (high - low);
        sum += rule->weight[i] * gd_vec3_length(contact_jet(surface, contact, t, &c, &x));
    }
    return sum * (high - low);
}

/* Integrates the speed. Halves intervals until the result no longer changes, because the surface
 * may not be smooth where its lines cross the loop. */
static double integrate(const struct gd_parametric *surface, const struct gd__contact *contact,
                        double low, double high, int halvings, struct gd__pace *pace, double *error)
{
    double middle = 0.5 * (low + high), whole = contact_gauss(surface, contact, low, high);
    double a = contact_gauss(surface, contact, low, middle),
           b = contact_gauss(surface, contact, middle, high), gap = fabs(a + b - whole);
    if (!gd__pace(pace, 3 * GD__STEP)) return whole;
    if (gap <= GD_TOL_ARC * surface->size || halvings == HALVINGS) {
        *error += gap;
        return a + b;
    }
    return integrate(surface, contact, low, middle, halvings + 1, pace, error) +
           integrate(surface, contact, middle, high, halvings + 1, pace, error);
}

double gd__contact_length(const struct gd_parametric *surface, const struct gd__contact *contact,
                          struct gd__pace *pace, double *error)
{
    double low = fmin(contact->begin, contact->end), high = fmax(contact->begin, contact->end);
    double sum = 0;
    for (int i = 0; i < PARTS_LEAST && low < high; i++)
        sum += integrate(surface, contact, low + (high - low) * i / PARTS_LEAST,
                         low + (high - low) * (i + 1) / PARTS_LEAST, 0, pace, error);
    return sum;
}

double gd__contact_least_curvature(const struct gd_parametric *surface,
                                   const struct gd__contact *contact, double *t)
{
    double least = INFINITY;
    for (int i = 0; i <= PROBES; i++) {
        struct gd__contact_place place;
        double at = contact->begin + (contact->end - contact->begin) * i / PROBES;
        gd__contact_at(surface, contact, at, &place);
        if (!(place.curvature < least)) continue;
        least = place.curvature;
        *t = at;
    }
    return least;
}

/* --- lists ------------------------------------------------------------------------------------ */

struct gd__contact gd__contact_touch(const struct gd_parametric *surface,
                                     const struct gd__loop_place *place, int direction,
                                     const double at[2])
{
    uint32_t spans = surface->loops->loops[place->loop].span_count;
    double s = place->s >= spans ? place->s - spans : place->s, whole = floor(s);
    if (s - whole > 1 - GD_TOL_LOOP_PLACE) whole = whole + 1 < spans ? whole + 1 : 0, s = whole;
    struct gd__contact contact = {.loop = place->loop,
                                  .span = (uint32_t)whole,
                                  .direction = direction,
                                  .begin = fmax(s - whole, 0),
                                  .most = 1};
    if (contact.begin < GD_TOL_LOOP_PLACE) contact.begin = 0;
    contact.end = contact.begin;
    for (int k = 0; k < 2; k++) {
        double period = gd__axis_period(surface->axis[k]);
        if (period > 0) contact.shift[k] = round((at[k] - place->at[k]) / period) * period;
    }
    return contact;
}

enum gd_status gd__contacts_open(struct gd__contacts *contacts, uint32_t index, uint32_t count)
{
    enum gd_status status =
        gd__array_extend(&contacts->items, &contacts->capacity, contacts->count + (uint64_t)count,
                         sizeof *contacts->items, NULL);
    if (status) return status;
    memmove(contacts->items + index + count, contacts->items + index,
            (contacts->count - index) * sizeof *contacts->items);
    contacts->count += count;
    return GD_OK;
}

enum gd_status gd__contacts_insert(const struct gd_parametric *surface,
                                   struct gd__contacts *contacts, uint32_t index,
                                   const struct gd__contact *contact, uint32_t *added)
{
    bool is_corner = contact->begin == 0;
    *added = is_corner ? 2 : 1;
    enum gd_status status = gd__contacts_open(contacts, index, *added);
    if (status) return status;
    contacts->items[index] = *contact;
    if (!is_corner) return GD_OK;
    /* at a corner, there are two contacts: at the end of the span before the corner, and at the
       beginning of the span after it */
    uint32_t spans = surface->loops->loops[contact->loop].span_count;
    struct gd__contact before = *contact;
    before.span = (contact->span + spans - 1) % spans;
    before.begin = before.end = 1;
    contacts->items[index + (contact->direction < 0)] = before;
    contacts->items[index + (contact->direction > 0)] = *contact;
    return GD_OK;
}

/* --- division of a path of the mesh ----------------------------------------------------------- */

void gd__taut_parts_free(struct gd__taut_parts *parts)
{
    for (uint32_t i = 0; i < parts->gap_count; i++) gd__uv_polyline_free(&parts->gaps[i]);
    free(parts->gaps);
    free(parts->contacts.items);
    *parts = (struct gd__taut_parts){0};
}

/* Returns the unit vector of a loop's derivative, in scaled coordinates. */
static void loop_direction(const struct gd__loops *loops, const struct gd__loop_place *place,
                           bool before, double out[2])
{
    struct gd__span_jet jet;
    gd__loop_jet(loops, place->loop, place->s, before, &jet);
    for (int k = 0; k < 2; k++) out[k] = jet.first[k] / loops->width[k];
    double length = hypot(out[0], out[1]);
    for (int k = 0; k < 2; k++) out[k] /= length > 0 ? length : 1;
}

/* Returns the direction of a contact at place i of a polyline: 1 if the polyline bends to the right
 * at this place, -1 if it bends to the left. If it is straight there, the obstacle's side decides
 * at a corner of the obstacle, and the direction of the loop elsewhere. */
static int touch_direction(const struct gd_parametric *surface,
                           const struct gd__uv_polyline *polyline, uint32_t i,
                           const struct gd__loop_place *place)
{
    const double *a = polyline->at[i - 1], *b = polyline->at[i], *c = polyline->at[i + 1];
    const double *width = surface->loops->width;
    double turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
    double most = hypot(b[0] - a[0], b[1] - a[1]) * hypot(c[0] - b[0], c[1] - b[1]);
    if (fabs(turn) > clear_turn * most) return turn < 0 ? 1 : -1;
    double way[2] = {(c[0] - a[0]) / width[0], (c[1] - a[1]) / width[1]}, before[2], after[2];
    loop_direction(surface->loops, place, true, before);
    loop_direction(surface->loops, place, false, after);
    if (before[0] * after[1] - before[1] * after[0] < -clear_turn) {
        double inward[2] = {after[0] - before[0], after[1] - before[1]};
        return way[0] * inward[1] - way[1] * inward[0] < 0 ? 1 : -1;
    }
    return way[0] * (before[0] + after[0]) + way[1] * (before[1] + after[1]) >= 0 ? 1 : -1;
}

/* Returns the change of s from one place of a loop to another, along the shorter way around the
 * loop. */
static double loop_step(const struct gd__loops *loops, const struct gd__loop_place *from,
                        const struct gd__loop_place *to)
{
    double spans = loops->loops[from->loop].span_count, step = to->s - from->s;
    return step - round(step / spans) * spans;
}

struct division {
    const struct gd_parametric *surface;
    const struct gd__uv_polyline *polyline;
    struct gd__taut_parts *parts;
    /* for each place of the polyline, the nearest place of the loops; its distance is INFINITY if
       the polyline is not on a loop */
    struct gd__loop_place *places;
};

static enum gd_status open_gap(struct gd__taut_parts *parts, const double at[2])
{
    const struct gd__uv_polyline none = {0};
    enum gd_status status =
        gd__array_append(&parts->gaps, &parts->gap_count, &parts->gap_capacity, &none, sizeof none);
    return status ? status : gd__uv_polyline_add(&parts->gaps[parts->gap_count - 1], at);
}

/* Ends the current gap at a contact, and begins the next one there. */
static enum gd_status add_contact(struct division *d, const struct gd__contact *contact)
{
    struct gd__taut_parts *parts = d->parts;
    struct gd__contact_place place;
    uint32_t added = 0;
    gd__contact_at(d->surface, contact, contact->begin, &place);
    enum gd_status status = gd__uv_polyline_add(&parts->gaps[parts->gap_count - 1], place.at);
    gd__contact_at(d->surface, contact, contact->end, &place);
    if (!status)
        status = gd__contacts_insert(d->surface, &parts->contacts, parts->contacts.count, contact,
                                     &added);
    for (uint32_t i = 0; i < added && !status; i++) {
        status = open_gap(parts, place.at);
        if (!status && i + 1 < added)
            status = gd__uv_polyline_add(&parts->gaps[parts->gap_count - 1], place.at);
    }
    return status;
}

/* Adds the contacts of the part of a loop that the polyline follows. The part begins at place i of
 * the polyline, and s changes by `run` along it. Each span of the loop has a contact of its own. */
static enum gd_status add_arc(struct division *d, uint32_t i, double run)
{
    const struct gd__loops *loops = d->surface->loops;
    struct gd__loop_place place = d->places[i];
    int direction = run > 0 ? 1 : -1;
    double s = place.s, to = place.s + run, spans = loops->loops[place.loop].span_count;
    enum gd_status status = GD_OK;
    for (uint32_t n = 0; n <= 2 * (uint32_t)spans + 2 && !status; n++) {
        double base =
                   direction > 0 ? floor(s + GD_TOL_LOOP_PLACE) : ceil(s - GD_TOL_LOOP_PLACE) - 1,
               end = direction > 0 ? fmin(base + 1, to) : fmax(base, to);
        struct gd__contact contact =
            gd__contact_touch(d->surface, &place, direction, d->polyline->at[i]);
        contact.span = (uint32_t)(base - floor(base / spans) * spans);
        contact.begin = fmin(fmax(s - base, 0), 1);
        contact.end = fmin(fmax(end - base, 0), 1);
        struct gd__taut_parts *parts = d->parts;
        struct gd__contact_place at;
        gd__contact_at(d->surface, &contact, contact.begin, &at);
        status = gd__uv_polyline_add(&parts->gaps[parts->gap_count - 1], at.at);
        if (!status) status = gd__contacts_open(&parts->contacts, parts->contacts.count, 1);
        if (!status) parts->contacts.items[parts->contacts.count - 1] = contact;
        gd__contact_at(d->surface, &contact, contact.end, &at);
        if (!status) status = open_gap(parts, at.at);
        s = end;
        if ((to - s) * direction <= GD_TOL_LOOP_PLACE) break;
    }
    return status;
}

/* Returns the last place up to which the polyline follows the loop from place i on, and sets *run
 * to the change of s. */
static uint32_t follow_loop(const struct division *d, uint32_t i, double *run)
{
    const struct gd__loops *loops = d->surface->loops;
    uint32_t k = i;
    *run = 0;
    while (k + 1 < d->polyline->count && d->places[k + 1].distance < INFINITY &&
           d->places[k + 1].loop == d->places[i].loop) {
        const double *a = d->polyline->at[k], *b = d->polyline->at[k + 1];
        double middle[2] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])};
        struct gd__loop_place place;
        if (fabs(gd__surface_depth(d->surface, middle, &place)) > 2 * GD__LOOPS_SAG ||
            place.loop != d->places[i].loop)
            break;
        double step = loop_step(loops, &d->places[k], &d->places[k + 1]);
        /* near the path's ends two places may differ by rounding only */
        if (*run * step < 0 && fmin(fabs(*run), fabs(step)) > GD_TOL_LOOP_PLACE) break;
        *run += step;
        k++;
    }
    return k;
}

static enum gd_status divide(struct division *d, struct gd__pace *pace)
{
    const struct gd__uv_polyline *polyline = d->polyline;
    enum gd_status status = open_gap(d->parts, polyline->at[0]);
    for (uint32_t i = 0; i < polyline->count && gd__pace(pace, GD__STEP); i++) {
        double depth = gd__surface_depth(d->surface, polyline->at[i], &d->places[i]);
        d->places[i].distance = fabs(depth) <= GD_TOL_TRIMMED ? 0 : INFINITY;
    }
    if (!status) status = pace->status;
    for (uint32_t i = 0; i < polyline->count && !status; i++) {
        bool is_inner = i > 0 && i + 1 < polyline->count;
        double run = 0;
        uint32_t k = d->places[i].distance < INFINITY ? follow_loop(d, i, &run) : i;
        if (k > i && fabs(run) > GD_TOL_LOOP_PLACE) {
            status = add_arc(d, i, run);
            i = k;
        } else if (is_inner && d->places[i].distance < INFINITY) {
            struct gd__contact touch = gd__contact_touch(
                d->surface, &d->places[i], touch_direction(d->surface, polyline, i, &d->places[i]),
                polyline->at[i]);
            status = add_contact(d, &touch);
        } else if (i) {
            status = gd__uv_polyline_add(&d->parts->gaps[d->parts->gap_count - 1], polyline->at[i]);
        }
    }
    /* the last gap ends at the end of the path */
    if (!status)
        status = gd__uv_polyline_add(&d->parts->gaps[d->parts->gap_count - 1],
                                     polyline->at[polyline->count - 1]);
    return status;
}

enum gd_status gd__taut_join(const struct gd__uv_polyline *polyline, struct gd__taut_parts *out)
{
    struct gd__taut_parts parts = {0};
    enum gd_status status = open_gap(&parts, polyline->at[0]);
    if (!status) status = gd__uv_polyline_append(&parts.gaps[0], polyline, 1, polyline->count);
    if (status)
        gd__taut_parts_free(&parts);
    else
        *out = parts;
    return status;
}

enum gd_status gd__taut_divide(const struct gd_parametric *surface,
                               const struct gd__uv_polyline *polyline, struct gd__pace *pace,
                               struct gd__taut_parts *out)
{
    struct gd__taut_parts parts = {0};
    struct division division = {surface, polyline, &parts,
                                malloc(polyline->count * sizeof *division.places)};
    enum gd_status status = division.places ? divide(&division, pace) : GD_NO_MEMORY;
    free(division.places);
    if (status)
        gd__taut_parts_free(&parts);
    else
        *out = parts;
    return status;
}
