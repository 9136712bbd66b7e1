#include "nurbs/taut.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/tolerance.h"
#include "nurbs/energy.h"

enum {
    ROUNDS_MOST = 80,
    CONTACTS_MOST = 512,
    ARC_SAMPLES = 8 /* number of samples of a contact that becomes part of a gap */
};

/* The two ends of a gap count as the same place if they are closer than this fraction of the
 * domain's width. */
static const double one_place = 1e-11;
/* A loop counts as straight if its geodesic curvature, times the size of the surface, is less than
 * this. */
static const double straight = 1e-9;

/* --- directions ------------------------------------------------------------------------------- */

/* Sets *out to the direction in which the path reaches contact i (side 0), or leaves it (side 1).
 * This is the direction of the gap on that side, or of the next contact there if that gap is empty.
 * Returns false at the end of the path. */
static bool direction_at(const struct gd__taut *taut, uint32_t i, uint32_t side,
                         struct gd_vec3 *out)
{
    for (;; i = side ? i + 1 : i - 1) {
        struct gd_jet x;
        struct gd__contact_place place;
        const struct gd__gap *gap = &taut->gaps[i + side];
        if (!gap->is_empty) {
            *out = gd__chain_velocity(gap->solution.chain, !side, &x);
            return true;
        }
        if (i == (side ? taut->contacts.count - 1 : 0)) return false;
        const struct gd__contact *next = &taut->contacts.items[side ? i + 1 : i - 1];
        if (!gd__contact_is_arc(next)) continue;
        gd__contact_at(taut->task->surface, next, side ? next->begin : next->end, &place);
        *out = place.tangent;
        return true;
    }
}

/* --- gaps ------------------------------------------------------------------------------------- */

static void gap_free(struct gd__gap *gap)
{
    gd__uv_polyline_free(&gap->line);
    if (gap->is_solved && !gap->is_empty) free(gap->solution.chain);
    *gap = (struct gd__gap){0};
}

/* Computes an end of a gap. Side 0 is the beginning of the gap, where the contact before it
 * ends. */
static void gap_end(const struct gd__taut *taut, uint32_t gap, int side, double at[2])
{
    const struct gd__contacts *contacts = &taut->contacts;
    bool is_path_end = side ? gap == contacts->count : gap == 0;
    if (is_path_end) {
        const struct gd__uv_polyline *line = &taut->gaps[gap].line;
        memcpy(at, line->at[side ? line->count - 1 : 0], 2 * sizeof *at);
        return;
    }
    const struct gd__contact *contact = &contacts->items[side ? gap : gap - 1];
    struct gd__contact_place place;
    gd__contact_at(taut->task->surface, contact, side ? contact->begin : contact->end, &place);
    memcpy(at, place.at, sizeof place.at);
}

static double taut_apart(const struct gd__taut *taut, const double a[2], const double b[2])
{
    const double *width = taut->task->surface->loops->width;
    return hypot((a[0] - b[0]) / width[0], (a[1] - b[1]) / width[1]);
}

static struct gd__joint gap_joint(const struct gd__taut *taut, uint32_t gap, int side,
                                  const double at[2])
{
    bool is_path_end = side ? gap == taut->contacts.count : gap == 0;
    if (is_path_end) return gd__joint_of_end(taut->ends[side], taut->s[side], at);
    return (struct gd__joint){.kind = GD__JOINT_FIXED, .place = {at[0], at[1]}};
}

/* Computes the geodesic of a gap, and makes its samples the initial path of the next round. */
static enum gd_status gap_solve(struct gd__taut *taut, uint32_t number)
{
    struct gd__gap *gap = &taut->gaps[number];
    double at[2][2];
    if (gap->is_solved && !gap->is_empty) free(gap->solution.chain);
    gap->is_solved = false;
    for (int side = 0; side < 2; side++) gap_end(taut, number, side, at[side]);
    gap->is_empty = taut_apart(taut, at[0], at[1]) <= one_place;
    if (gap->is_empty) {
        gap->is_solved = true;
        return GD_OK;
    }
    struct gd__uv_polyline *line = &gap->line;
    memcpy(line->at[0], at[0], sizeof at[0]);
    memcpy(line->at[line->count - 1], at[1], sizeof at[1]);
    gd__uv_polyline_measure(taut->task->surface, line);
    const struct gd__joint from = gap_joint(taut, number, 0, at[0]),
                           to = gap_joint(taut, number, 1, at[1]);
    struct gd__solution solution = {0};
    enum gd_status status = gd__solve_coarse(taut->task, line, &from, &to, &solution);
    if (!status) status = gd__solve_fine(taut->task, &solution);
    if (status) {
        free(solution.chain);
        return status;
    }
    gap->solution = solution;
    gap->is_solved = true;
    gd__uv_polyline_free(line);
    status = gd__uv_polyline_of_chain(solution.chain, line);
    if (status) *line = (struct gd__uv_polyline){0};
    for (int side = 0; side < 2 && !status; side++) {
        const struct gd__joint *joint =
            &solution.chain->joints[side ? solution.chain->piece_count : 0];
        if (joint->curve && joint->kind == GD__JOINT_CURVE) taut->s[side] = joint->at;
    }
    return status;
}

static enum gd_status gaps_open(struct gd__taut *taut, uint32_t index, uint32_t count)
{
    enum gd_status status =
        gd__array_extend(&taut->gaps, &taut->gap_capacity, taut->gap_count + (uint64_t)count,
                         sizeof *taut->gaps, NULL);
    if (status) return status;
    memmove(taut->gaps + index + count, taut->gaps + index,
            (taut->gap_count - index) * sizeof *taut->gaps);
    memset(taut->gaps + index, 0, count * sizeof *taut->gaps);
    taut->gap_count += count;
    return GD_OK;
}

/* Removes contact i and the gap before it. */
static void remove_contact(struct gd__taut *taut, uint32_t i)
{
    gap_free(&taut->gaps[i]);
    taut->gap_count--;
    taut->contacts.count--;
    memmove(taut->gaps + i, taut->gaps + i + 1, (taut->gap_count - i) * sizeof *taut->gaps);
    memmove(taut->contacts.items + i, taut->contacts.items + i + 1,
            (taut->contacts.count - i) * sizeof *taut->contacts.items);
}

/* Inserts a contact before contact `index`. Also inserts a gap before gap `gap`, next to the new
 * contact. The gap's line joins two places of the contact's span. */
static enum gd_status insert_contact(struct gd__taut *taut, uint32_t index,
                                     const struct gd__contact *contact, uint32_t gap,
                                     const double ends[2])
{
    enum gd_status status = gaps_open(taut, gap, 1);
    if (!status) status = gd__contacts_open(&taut->contacts, index, 1);
    if (status) return status;
    taut->contacts.items[index] = *contact;
    for (int k = 0; k < 2 && !status; k++) {
        struct gd__contact_place place;
        gd__contact_at(taut->task->surface, contact, ends[k], &place);
        status = gd__uv_polyline_add(&taut->gaps[gap].line, place.at);
    }
    return status;
}

static enum gd_status gap_append(struct gd__uv_polyline *line, const struct gd__gap *gap)
{
    return gd__uv_polyline_append(line, &gap->line, 0, gap->line.count);
}

/* Removes contact i. Joins the gaps before and after it to one gap, whose initial path runs along
 * the contact. */
static enum gd_status drop_contact(struct gd__taut *taut, uint32_t i)
{
    const struct gd__contact contact = taut->contacts.items[i];
    struct gd__uv_polyline line = {0};
    enum gd_status status = gap_append(&line, &taut->gaps[i]);
    for (int k = 1; k < ARC_SAMPLES && gd__contact_is_arc(&contact) && !status; k++) {
        struct gd__contact_place place;
        gd__contact_at(taut->task->surface, &contact,
                       contact.begin + (contact.end - contact.begin) * k / ARC_SAMPLES, &place);
        status = gd__uv_polyline_add(&line, place.at);
    }
    if (!status) status = gap_append(&line, &taut->gaps[i + 1]);
    if (status) {
        gd__uv_polyline_free(&line);
        return status;
    }
    gap_free(&taut->gaps[i + 1]);
    taut->gaps[i + 1].line = line;
    remove_contact(taut, i);
    return GD_OK;
}

/* Returns true if the second contact begins before the end of the first one, or exactly there. */
static bool contacts_overlap(const struct gd__contact *a, const struct gd__contact *b)
{
    return a->loop == b->loop && a->span == b->span && a->direction == b->direction &&
           a->shift[0] == b->shift[0] && a->shift[1] == b->shift[1] &&
           (b->begin - a->end) * a->direction <= 0;
}

/* Merges neighbouring contacts that overlap. Returns true if there were any. */
static bool merge_contacts(struct gd__taut *taut)
{
    uint32_t before = taut->contacts.count;
    for (uint32_t i = 0; i + 1 < taut->contacts.count;) {
        struct gd__contact *contact = &taut->contacts.items[i];
        if (!contacts_overlap(contact, contact + 1)) {
            i++;
            continue;
        }
        if ((contact[1].end - contact->end) * contact->direction > 0) contact->end = contact[1].end;
        if ((contact[1].begin - contact->begin) * contact->direction < 0)
            contact->begin = contact[1].begin;
        remove_contact(taut, i + 1);
    }
    return taut->contacts.count < before;
}

/* --- bounds ----------------------------------------------------------------------------------- */

/* Sets bounds for the contacts on the span where the path begins or ends, so that no contact
 * extends beyond the path's end. */
static void bound_contacts(struct gd__taut *taut, int side)
{
    const struct gd_parametric *surface = taut->task->surface;
    const struct gd__uv_polyline *line = &taut->gaps[side ? taut->gap_count - 1 : 0].line;
    struct gd__loop_place place;
    double depth = gd__surface_depth(surface, line->at[side ? line->count - 1 : 0], &place);
    if (fabs(depth) > GD_TOL_TRIMMED || !taut->ends[side]->is_point) return;
    const struct gd__contact end =
        gd__contact_touch(surface, &place, 1, line->at[side ? line->count - 1 : 0]);
    for (uint32_t i = 0; i < taut->contacts.count; i++) {
        struct gd__contact *contact = &taut->contacts.items[i];
        bool is_same = contact->loop == end.loop && contact->span == end.span &&
                       contact->shift[0] == end.shift[0] && contact->shift[1] == end.shift[1];
        if (!is_same) continue;
        bool is_after = contact->begin + contact->end >= 2 * end.begin;
        if (is_after)
            contact->least = fmax(contact->least, end.begin);
        else
            contact->most = fmin(contact->most, end.begin);
        contact->begin = fmin(fmax(contact->begin, contact->least), contact->most);
        contact->end = fmin(fmax(contact->end, contact->least), contact->most);
    }
}

/* --- steps of contacts ------------------------------------------------------------------------ */

/* The values that determine whether a contact satisfies its conditions. */
struct stand {
    struct gd__contact_place begin, end;
    bool has_in, has_out;
    double in, out; /* pressing angles into the contact and out of it; 0 at an end of the path */
    /* pressing angle from the direction in which the path arrives to the direction in which it
       leaves */
    double whole;
};

static struct stand stand_of(const struct gd__taut *taut, uint32_t i)
{
    const struct gd__contact *contact = &taut->contacts.items[i];
    struct stand stand = {0};
    struct gd_vec3 in, out;
    gd__contact_at(taut->task->surface, contact, contact->begin, &stand.begin);
    gd__contact_at(taut->task->surface, contact, contact->end, &stand.end);
    stand.has_in = direction_at(taut, i, 0, &in);
    stand.has_out = direction_at(taut, i, 1, &out);
    if (stand.has_in)
        stand.in = gd__contact_turn(contact, stand.begin.normal, in, stand.begin.tangent);
    if (stand.has_out)
        stand.out = gd__contact_turn(contact, stand.end.normal, stand.end.tangent, out);
    stand.whole =
        stand.has_in && stand.has_out ? gd__contact_turn(contact, stand.begin.normal, in, out) : 0;
    return stand;
}

/* Returns the parameter of one end of a contact after a step towards the place where its angle is
 * 0. `sign` is 1 for the contact's end, -1 for its beginning. */
static double moved(const struct gd__taut *taut, const struct gd__contact *contact, double t,
                    const struct gd__contact_place *place, double angle, int sign)
{
    double least = straight / taut->task->surface->size;
    double limit = sign * contact->direction > 0 ? contact->most : contact->least;
    if (place->curvature > least) {
        double step = angle / (place->curvature * place->speed);
        t += sign * contact->direction * fmin(fmax(step, -0.5), 0.5);
    } else if (angle > GD_TOL_TAUT) {
        t = place->curvature >= -least ? limit : t;
    } else if (angle < -GD_TOL_TAUT) {
        t = sign > 0 ? contact->begin : contact->end;
    }
    return fmin(fmax(t, contact->least), contact->most);
}

/* Returns the amount by which one end of a contact violates its condition: its angle, or 0 if the
 * end is at a bound and would move beyond this bound. */
static double held_angle(const struct gd__contact *contact, double t, double angle, int sign)
{
    double limit = sign * contact->direction > 0 ? contact->most : contact->least;
    return t == limit && angle > 0 ? 0 : fabs(angle);
}

/* Returns true if a contact of one place does not press against the obstacle. */
static bool is_loose(const struct stand *stand)
{
    if (stand->has_in && stand->has_out) return stand->whole < -GD_TOL_TAUT;
    return !(stand->has_in && stand->in > GD_TOL_TAUT) &&
           !(stand->has_out && stand->out > GD_TOL_TAUT);
}

/* Returns true if the path passes a contact of one place, inside its span, against the contact's
 * direction. */
static bool is_reversed(const struct gd__contact *contact, const struct stand *stand)
{
    return contact->begin > 0 && contact->begin < 1 && (stand->has_in || stand->has_out) &&
           !(stand->has_in && fabs(stand->in) <= M_PI_2) &&
           !(stand->has_out && fabs(stand->out) <= M_PI_2);
}

/* DROPPED: a contact was removed, or its direction was reversed. */
enum step { STEP_DONE, STEP_MOVED, STEP_DROPPED };

/* Moves the ends of contact i, or removes the contact. Increases *most to the largest angle. */
static enum gd_status step_contact(struct gd__taut *taut, uint32_t i, enum step *step, double *most)
{
    struct gd__contact *contact = &taut->contacts.items[i];
    const struct stand stand = stand_of(taut, i);
    bool is_arc = gd__contact_is_arc(contact);
    *step = STEP_DONE;
    if (!is_arc && is_reversed(contact, &stand)) {
        contact->direction = -contact->direction;
        *step = STEP_DROPPED;
        return GD_OK;
    }
    if (!is_arc && is_loose(&stand)) {
        *step = STEP_DROPPED;
        return drop_contact(taut, i);
    }
    double begin = contact->begin, end = contact->end;
    bool begin_moves = is_arc ? fabs(stand.in) > GD_TOL_CALM : stand.in > GD_TOL_TAUT,
         end_moves = is_arc ? fabs(stand.out) > GD_TOL_CALM : stand.out > GD_TOL_TAUT;
    if (begin_moves) {
        *most = fmax(*most, held_angle(contact, begin, stand.in, -1));
        begin = moved(taut, contact, begin, &stand.begin, stand.in, -1);
    }
    if (end_moves) {
        *most = fmax(*most, held_angle(contact, end, stand.out, 1));
        end = moved(taut, contact, end, &stand.end, stand.out, 1);
    }
    if ((end - begin) * contact->direction < 0) begin = end = 0.5 * (begin + end);
    if (begin != contact->begin || end != contact->end) *step = STEP_MOVED;
    contact->begin = begin;
    contact->end = end;
    return GD_OK;
}

/* Returns true if contact i is one place at a corner of the loop, and if the contact `next` at the
 * same corner would not press against the obstacle. */
static bool is_next_loose(const struct gd__taut *taut, uint32_t i, const struct stand *stand,
                          const struct gd__contact *next)
{
    struct gd__contact_place place;
    struct gd_vec3 way;
    if (gd__contact_is_arc(&taut->contacts.items[i])) return false;
    if (stand->has_in && stand->has_out) return is_loose(stand);
    if (!direction_at(taut, i, stand->has_in ? 0 : 1, &way)) return true;
    gd__contact_at(taut->task->surface, next, next->begin, &place);
    double angle = stand->has_in ? gd__contact_turn(next, place.normal, way, place.tangent)
                                 : gd__contact_turn(next, place.normal, place.tangent, way);
    return !(angle > GD_TOL_TAUT);
}

/* If a contact ends at an end of its span and would move farther, adds a contact on the next span
 * and sets *added. */
static enum gd_status spill_contact(struct gd__taut *taut, uint32_t i, bool *added)
{
    const struct gd__contact contact = taut->contacts.items[i];
    const struct stand stand = stand_of(taut, i);
    const struct gd__loop *loop = &taut->task->surface->loops->loops[contact.loop];
    *added = false;
    for (int sign = -1; sign <= 1; sign += 2) {
        int way = sign * contact.direction;
        double t = sign > 0 ? contact.end : contact.begin, limit = way > 0 ? 1 : 0,
               angle = sign > 0 ? stand.out : stand.in;
        if (t != limit || !(angle > GD_TOL_TAUT)) continue;
        struct gd__contact next = contact;
        next.span =
            (contact.span + loop->span_count + (uint32_t)(way > 0 ? 1 : -1)) % loop->span_count;
        next.least = 0, next.most = 1;
        next.begin = next.end = way > 0 ? 0 : 1;
        /* the next span may already have a contact */
        uint32_t other = sign > 0 ? i + 1 : i - 1;
        if (other < taut->contacts.count && taut->contacts.items[other].loop == next.loop &&
            taut->contacts.items[other].span == next.span)
            continue;
        if (is_next_loose(taut, i, &stand, &next)) continue;
        *added = true;
        return insert_contact(taut, sign > 0 ? i + 1 : i, &next, i + 1,
                              (const double[2]){next.begin, next.begin});
    }
    return GD_OK;
}

/* Divides a contact where the loop bends away from the obstacle. */
static enum gd_status split_contact(struct gd__taut *taut, uint32_t i, bool *split)
{
    struct gd__contact *contact = &taut->contacts.items[i];
    double t;
    *split = false;
    if (!gd__contact_is_arc(contact)) return GD_OK;
    double least = gd__contact_least_curvature(taut->task->surface, contact, &t);
    if (least * taut->task->surface->size >= -GD_TOL_PRESSING) return GD_OK;
    struct gd__contact after = *contact;
    double room = 0.25 * fmin(fabs(t - contact->begin), fabs(contact->end - t));
    if (room <= one_place) {
        /* the bend is at an end of the contact: move this end instead of dividing the contact */
        double width = 0.25 * (contact->end - contact->begin);
        if (fabs(t - contact->begin) < fabs(contact->end - t))
            contact->begin += width;
        else
            contact->end -= width;
        *split = true;
        return GD_OK;
    }
    contact->end = t - contact->direction * room;
    after.begin = t + after.direction * room;
    *split = true;
    return insert_contact(taut, i + 1, &after, i + 1, (const double[2]){contact->end, after.begin});
}

/* --- gaps that leave the domain --------------------------------------------------------------- */

/* Adds a contact to gap `number`, which leaves the domain. */
static enum gd_status add_leaving(struct gd__taut *taut, uint32_t number,
                                  const struct gd__leaving *leaving)
{
    const struct gd_parametric *surface = taut->task->surface;
    const struct gd__contact touch = gd__passing_contact(taut, number, leaving);
    struct gd__contact_place place;
    uint32_t added;
    gd__contact_at(surface, &touch, touch.begin, &place);
    enum gd_status status = gd__contacts_insert(surface, &taut->contacts, number, &touch, &added);
    if (status) return status;
    status = gaps_open(taut, number + 1, added);
    if (status) return status;
    struct gd__gap *gap = &taut->gaps[number];
    gap_free(gap);
    status = gd__uv_polyline_append(&gap->line, &leaving->samples, 0, leaving->sample + 1);
    if (!status) status = gd__uv_polyline_add(&gap->line, place.at);
    for (uint32_t k = 1; k <= added && !status; k++) {
        status = gd__uv_polyline_add(&gap[k].line, place.at);
        if (!status && k < added) status = gd__uv_polyline_add(&gap[k].line, place.at);
    }
    if (!status)
        status = gd__uv_polyline_append(&gap[added].line, &leaving->samples, leaving->sample + 1,
                                        leaving->samples.count);
    return status;
}

/* Finds the first gap that leaves the domain, and adds a contact to it. */
static enum gd_status check_gaps(struct gd__taut *taut, bool *inside)
{
    enum gd_status status = GD_OK;
    *inside = true;
    for (uint32_t i = 0; i < taut->gap_count && !status && *inside; i++) {
        struct gd__leaving leaving;
        if (taut->gaps[i].is_empty) continue;
        status = gd__gap_check(taut->gaps[i].solution.chain, inside, &leaving);
        if (status || *inside) continue;
        status = add_leaving(taut, i, &leaving);
        gd__uv_polyline_free(&leaving.samples);
    }
    return status;
}

/* --- the path --------------------------------------------------------------------------------- */

/* Performs one round: solves the gaps, then moves or removes contacts. Sets *changed if the path
 * has changed. */
static enum gd_status taut_round(struct gd__taut *taut, bool *changed)
{
    enum gd_status status = GD_OK;
    double most = 0;
    *changed = false;
    for (uint32_t i = 0; i < taut->gap_count && !status; i++) status = gap_solve(taut, i);
    if (status) return status;
    for (uint32_t i = 0; i < taut->contacts.count && !status; i++) {
        bool split, added;
        status = split_contact(taut, i, &split);
        if (!status && split) {
            *changed = true;
            return GD_OK;
        }
        if (!status) status = spill_contact(taut, i, &added);
        if (!status && added) {
            *changed = true;
            return GD_OK;
        }
    }
    for (uint32_t i = 0; i < taut->contacts.count && !status; i++) {
        enum step step;
        status = step_contact(taut, i, &step, &most);
        if (step == STEP_DROPPED) {
            *changed = true;
            return status;
        }
    }
    *changed = most > GD_TOL_TAUT;
    taut->residual = most;
    return status;
}

static enum gd_status taut_iterate(struct gd__taut *taut)
{
    enum gd_status status = GD_OK;
    bool changed = true, inside = false;
    for (int round = 0; round < ROUNDS_MOST && !status && !inside; round++) {
        if (taut->contacts.count > CONTACTS_MOST) return GD_OK;
        (void)merge_contacts(taut);
        bound_contacts(taut, 0);
        bound_contacts(taut, 1);
        status = taut_round(taut, &changed);
        if (status || changed || merge_contacts(taut)) continue;
        /* the last step has moved contacts a little, so the gaps are solved again between the final
           places */
        for (uint32_t i = 0; i < taut->gap_count && !status; i++) status = gap_solve(taut, i);
        if (!status) status = check_gaps(taut, &inside);
    }
    taut->is_taut = !status && inside;
    return status;
}

/* Returns the length of a chain by quadrature. The square root of twice its energy is larger where
 * the speed is uneven, for example along a border of the domain. */
static double chain_length(const struct gd__chain *chain)
{
    double sum = 0;
    for (uint32_t i = 0; i < chain->piece_count; i++)
        for (uint32_t span = 0; span < chain->pieces[i].spans; span++)
            sum += gd__energy_length(chain, &chain->pieces[i], span, gd__chain_gauss(chain), 1);
    return sum;
}

/* Returns true if a solved gap is proven to be a local minimum. */
static bool is_gap_proven(const struct gd__task *task, const struct gd__solution *solution)
{
    return solution->converged && solution->report.converged && solution->report.positive &&
           !gd__solution_is_bent(task, solution);
}

static enum gd_status taut_measure(struct gd__taut *taut)
{
    const struct gd__task *task = taut->task;
    for (uint32_t i = 0; i < taut->gap_count; i++) {
        const struct gd__solution *solution = &taut->gaps[i].solution;
        if (taut->gaps[i].is_empty || !taut->gaps[i].is_solved) continue;
        taut->length += chain_length(solution->chain);
        taut->error += solution->error;
    }
    for (uint32_t i = 0; i < taut->contacts.count; i++)
        taut->length +=
            gd__contact_length(task->surface, &taut->contacts.items[i], task->pace, &taut->error);
    for (uint32_t i = 0; i < taut->gap_count && taut->is_taut; i++) {
        struct gd__gap *gap = &taut->gaps[i];
        if (gap->is_empty) continue;
        /* A gap that is much shorter than the path may miss the tolerance relative to its own
         * length, so its error is compared with the path. */
        if (gap->is_solved && gap->solution.error <= taut->task->tolerance * taut->length)
            gap->solution.converged = true;
        /* the last round may have changed a gap, which is then not solved */
        taut->is_taut = gap->is_solved && is_gap_proven(taut->task, &gap->solution);
    }
    /* the error of the length is of third order in the angles at the ends of contacts */
    taut->error += taut->residual * taut->residual * taut->length;
    return task->pace->status;
}

void gd__taut_free(struct gd__taut *taut)
{
    for (uint32_t i = 0; i < taut->gap_count; i++) gap_free(&taut->gaps[i]);
    free(taut->gaps);
    free(taut->contacts.items);
    taut->gaps = NULL;
    taut->contacts = (struct gd__contacts){0};
    taut->gap_count = 0;
}

/* Moves the contacts and gaps of a divided path into `taut`. */
static enum gd_status take_parts(struct gd__taut *taut, struct gd__taut_parts *parts)
{
    enum gd_status status = gaps_open(taut, 0, parts->gap_count);
    if (status) return status;
    for (uint32_t i = 0; i < parts->gap_count; i++) taut->gaps[i].line = parts->gaps[i];
    taut->contacts = parts->contacts;
    parts->contacts = (struct gd__contacts){0};
    parts->gap_count = 0;
    return GD_OK;
}

enum gd_status gd__taut_solve(const struct gd__task *task,
                              const struct gd_domain_curve *const ends[2],
                              const struct gd__path_seed *seed, bool is_free, struct gd__taut *out)
{
    struct gd__taut taut = {
        .task = task, .ends = ends, .seed = seed, .s = {seed->s[0], seed->s[1]}};
    struct gd__taut_parts parts;
    enum gd_status status =
        is_free ? gd__taut_join(&seed->polyline, &parts)
                : gd__taut_divide(task->surface, &seed->polyline, task->pace, &parts);
    if (status) return status;
    status = take_parts(&taut, &parts);
    gd__taut_parts_free(&parts);
    if (!status) status = taut_iterate(&taut);
    if (!status) status = taut_measure(&taut);
    if (status)
        gd__taut_free(&taut);
    else
        *out = taut;
    return status;
}
