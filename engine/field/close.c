#include "field/close.h"

#include "mesh/canonical.h"

/* --- across an edge --------------------------------------------------------------------------- */

/* From a seed in the face across side k of the point's face. In the side's frame the point is above
 * and the seed below: the way's x is a difference of weights of the end that has less of both. */
static bool is_across(const struct gd_mesh *mesh, uint32_t side, const double p[3],
                      const double s[3], struct gd__close *out)
{
    const struct gd_side *near = &mesh->side[side], *far = &mesh->side[side ^ 1];
    double length = near->length, left = near->left_length * near->left_x,
           below = far->left_length * far->left_x, up = p[2] * near->left_length * near->left_y,
           down = s[2] * far->left_length * far->left_y, height = up + down;
    double x = p[1] > p[0] ? (s[1] - p[0]) * length + p[2] * (left - length) + s[2] * below
                           : (p[1] - s[0]) * length + p[2] * left - s[2] * (length - below);
    if (!(height > 0)) return false;
    double back = x * (up / height);
    out->side = side;
    out->way = (struct gd__local){x, height};
    out->t = p[1] * length + p[2] * left - back;
    out->rest = p[0] * length + p[2] * (length - left) + back;
    out->distance = gd__local_length(out->way);
    out->at.vertex = GD_NONE;
    return out->t >= 0 && out->rest >= 0;
}

/* Weights by corner of a face, those of side k's origin, destination and apex first. */
static void turn_weights(const double weight[3], int k, double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = weight[(k + i) % 3];
}

static void look_across(const struct gd_field *field, uint32_t side, const double p[3],
                        struct gd__close *best)
{
    const struct gd_mesh *mesh = field->mesh;
    uint32_t face = mesh->side_face[side ^ 1];
    if (face == GD_NONE) return;
    int k = gd__place_of_side(mesh->face_side[face], side ^ 1);
    const struct gd__face_seed *end = field->face_seeds + field->face_seed_count;
    for (const struct gd__face_seed *f = gd__field_seeds_in(field, face);
         f < end && f->face == face; f++) {
        const struct gd__seed *seed = &field->seeds[f->seed];
        if (seed->is_segment) continue;
        double weight[3], s[3];
        gd__point_weights(mesh, &seed->point, face, weight);
        turn_weights(weight, k, s);
        struct gd__close close;
        if (s[2] > GD_TOL_BESIDE_VERTEX || !is_across(mesh, side, p, s, &close)) continue;
        close.seed = f->seed;
        close.distance += seed->offset;
        if (close.distance < best->distance) *best = close;
    }
}

/* --- round a vertex --------------------------------------------------------------------------- */

/* The lesser angle from a to b round their vertex, counter-clockwise. */
static double turn_between(const struct gd_mesh *mesh, const struct gd__polar *a,
                           const struct gd__polar *b)
{
    double turn = b->angle - a->angle, total = mesh->total_angle[a->vertex];
    if (mesh->vertex_kind[a->vertex] == GD_VERTEX_BOUNDARY || fabs(turn) <= total / 2) return turn;
    return turn > 0 ? turn - total : turn + total;
}

/* Both are beside one vertex: the law of cosines, without cancellation. */
static void go_round(const struct gd_mesh *mesh, struct gd__close *close)
{
    double r = close->at.radius, q = close->to.radius, half = sin(0.5 * close->turn);
    double begin = close->at.angle - mesh->fan[close->at.entry].angle;
    struct gd__local at = gd__polar_place(&close->at, begin),
                     to = gd__polar_place(&close->to, begin + close->turn);
    close->distance = sqrt((r - q) * (r - q) + 4 * r * q * half * half);
    close->side = mesh->fan[close->at.entry].side;
    close->way = (struct gd__local){at.x - to.x, at.y - to.y};
}

static void look_round(const struct gd_field *field, const struct gd__polar *at,
                       struct gd__close *best)
{
    const struct gd_mesh *mesh = field->mesh;
    const struct gd__face_seed *end = field->face_seeds + field->face_seed_count;
    for (uint32_t i = mesh->fan_first[at->vertex]; i < mesh->fan_first[at->vertex + 1]; i++) {
        uint32_t face = mesh->side_face[mesh->fan[i].side];
        for (const struct gd__face_seed *f = gd__field_seeds_in(field, face);
             f < end && f->face == face; f++) {
            const struct gd__seed *seed = &field->seeds[f->seed];
            struct gd__close close = {.seed = f->seed, .at = *at};
            if (seed->is_segment || !gd__polar_beside(mesh, &seed->point, &close.to) ||
                close.to.vertex != at->vertex)
                continue;
            close.turn = turn_between(mesh, &close.at, &close.to);
            if (fabs(close.turn) >= M_PI) continue; /* through the vertex */
            go_round(mesh, &close);
            close.distance += seed->offset;
            /* differences of weights have more digits than these differences of radii and angles */
            double rounding = GD_TOL_PLACE * (close.at.radius + close.to.radius);
            if (close.distance < best->distance - (best->at.vertex == GD_NONE ? rounding : 0))
                *best = close;
        }
    }
}

/* --- all -------------------------------------------------------------------------------------- */

bool gd__close_find(const struct gd_field *field, uint32_t face, const double weight[3],
                    double known, struct gd__close *out)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__close best = {.distance = known, .seed = GD_NONE, .at = {.vertex = GD_NONE}};
    for (int k = 0; k < 3; k++) {
        double p[3];
        if (weight[(k + 2) % 3] > GD_TOL_BESIDE_VERTEX) continue;
        turn_weights(weight, k, p);
        look_across(field, mesh->face_side[face][k], p, &best);
    }
    struct gd_point point = {
        .kind = GD_POINT_FACE, .element = face, .weight = {weight[0], weight[1], weight[2]}};
    struct gd__polar at;
    if (gd__polar_beside(mesh, &point, &at)) look_round(field, &at, &best);
    *out = best;
    return best.seed != GD_NONE;
}

/* --- the way ---------------------------------------------------------------------------------- */

/* Appends where the way crosses a side of `face`, which the trail is in, however near to a
 * vertex. */
static void append_crossing(struct gd__trail *trail, uint32_t face, uint32_t side, double t,
                            double rest)
{
    bool turned = side & 1;
    struct gd_point point = {.kind = GD_POINT_EDGE,
                             .element = side >> 1,
                             .weight = {turned ? rest : t, turned ? t : rest}};
    if (!(t > 0)) point = gd__point_of_vertex(trail->mesh->origin[side]);
    if (!(rest > 0)) point = gd__point_of_vertex(trail->mesh->origin[side ^ 1]);
    gd__trail_append_in_face(trail, point, face);
}

/* Appends where the way crosses an edge of the vertex, `turn` radians from the point; the trail is
 * in `face`. */
static void append_spoke(struct gd__trail *trail, const struct gd__close *close, uint32_t face,
                         uint32_t side, double turn)
{
    double r = close->at.radius, q = close->to.radius, whole = fabs(close->turn);
    double part = r * q * sin(whole) / (r * sin(turn) + q * sin(whole - turn)) /
                  trail->mesh->side[side].length;
    append_crossing(trail, face, side, part, 1 - part);
}

static void trace_round(struct gd__trail *trail, const struct gd__close *close)
{
    const struct gd_mesh *mesh = trail->mesh;
    uint32_t vertex = close->at.vertex, first = mesh->fan_first[vertex],
             end = mesh->fan_first[vertex + 1];
    uint32_t entry = close->at.entry;
    bool left = close->turn > 0;
    double turned = left ? gd__fan_end(mesh, vertex, entry) - close->at.angle
                         : close->at.angle - mesh->fan[entry].angle;
    while (entry != close->to.entry && turned < fabs(close->turn)) {
        uint32_t next =
            left ? (entry + 1 < end ? entry + 1 : first) : (entry > first ? entry : end) - 1;
        append_spoke(trail, close, mesh->side_face[mesh->fan[entry].side],
                     mesh->fan[left ? next : entry].side, turned);
        entry = next;
        turned += gd__fan_end(mesh, vertex, entry) - mesh->fan[entry].angle;
    }
    gd__trail_append_seed(trail, close->seed, mesh->side_face[mesh->fan[entry].side]);
}

void gd__close_trace(struct gd__trail *trail, uint32_t face, const struct gd__close *close)
{
    const struct gd_mesh *mesh = trail->mesh;
    if (close->at.vertex != GD_NONE) {
        trace_round(trail, close);
        return;
    }
    double length = mesh->side[close->side].length;
    append_crossing(trail, face, close->side, close->t / length, close->rest / length);
    gd__trail_append_seed(trail, close->seed, mesh->side_face[close->side ^ 1]);
}
