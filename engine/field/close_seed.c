#include "field/close_seed.h"

#include "mesh/canonical.h"

/* --- across an edge --------------------------------------------------------------------------- */

/* Computes the vector to a point from a seed in the face across `side`. In the side's frame the
 * point is above and the seed below. For accuracy, x is computed from the two weights of one end of
 * the side, as their difference. This is the end where both weights are smaller. */
static bool is_across(const struct gd_mesh *mesh, uint32_t side, const double p[3],
                      const double s[3], struct gd__close_seed *out)
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

/* Rotates a face's weights so that they belong to side k's origin, destination and apex. */
static void turn_weights(const double weight[3], int k, double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = weight[(k + i) % 3];
}

static void search_across_edge(const struct gd_field *field, uint32_t side, const double p[3],
                               struct gd__close_seed *best)
{
    const struct gd_mesh *mesh = field->mesh;
    uint32_t face = mesh->side_face[side ^ 1];
    if (face == GD_NONE) return;
    int k = gd__place_of_side(mesh->face_side[face], side ^ 1);
    for (struct gd__face_seeds f = gd__field_seeds_in(field, face); f.at < f.end; f.at++) {
        const struct gd__seed *seed = &field->seeds[f.at->seed];
        if (seed->is_segment) continue;
        double weight[3], s[3];
        gd__point_weights(mesh, &seed->point, face, weight);
        turn_weights(weight, k, s);
        struct gd__close_seed close;
        if (s[2] > GD_TOL_BESIDE_VERTEX || !is_across(mesh, side, p, s, &close)) continue;
        close.seed = f.at->seed;
        close.distance += seed->offset;
        if (close.distance < best->distance) *best = close;
    }
}

/* --- around a vertex -------------------------------------------------------------------------- */

/* Returns the smaller of the two angles from a to b around their vertex, positive if
 * counter-clockwise. */
static double turn_between(const struct gd_mesh *mesh, const struct gd__polar *a,
                           const struct gd__polar *b)
{
    double turn = b->angle - a->angle, total = mesh->total_angle[a->vertex];
    if (mesh->vertex_kind[a->vertex] == GD_VERTEX_BOUNDARY || fabs(turn) <= total / 2) return turn;
    return turn > 0 ? turn - total : turn + total;
}

/* Measures the line between a point and a seed beside the same vertex, by the law of cosines
 * without cancellation. */
static void measure_round_vertex(const struct gd_mesh *mesh, struct gd__close_seed *close)
{
    double r = close->at.radius, q = close->to.radius, half = sin(0.5 * close->turn);
    double begin = close->at.angle - mesh->fan[close->at.entry].angle;
    struct gd__local at = gd__polar_place(&close->at, begin),
                     to = gd__polar_place(&close->to, begin + close->turn);
    close->distance = sqrt((r - q) * (r - q) + 4 * r * q * half * half);
    close->side = mesh->fan[close->at.entry].side;
    close->way = (struct gd__local){at.x - to.x, at.y - to.y};
}

static void search_round_vertex(const struct gd_field *field, const struct gd__polar *at,
                                struct gd__close_seed *best)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t i = mesh->fan_first[at->vertex]; i < mesh->fan_first[at->vertex + 1]; i++) {
        uint32_t face = mesh->side_face[mesh->fan[i].side];
        for (struct gd__face_seeds f = gd__field_seeds_in(field, face); f.at < f.end; f.at++) {
            const struct gd__seed *seed = &field->seeds[f.at->seed];
            struct gd__close_seed close = {.seed = f.at->seed, .at = *at};
            if (seed->is_segment || !gd__polar_around(mesh, &seed->point, at->radius, &close.to) ||
                close.to.vertex != at->vertex)
                continue;
            close.turn = turn_between(mesh, &close.at, &close.to);
            /* the shortest path passes through the vertex */
            if (fabs(close.turn) >= M_PI) continue;
            measure_round_vertex(mesh, &close);
            close.distance += seed->offset;
            /* differences of weights are more accurate than differences of radii and angles */
            double rounding = GD_TOL_PLACE * (close.at.radius + close.to.radius);
            if (close.distance < best->distance - (best->at.vertex == GD_NONE ? rounding : 0))
                *best = close;
        }
    }
}

/* --- search ----------------------------------------------------------------------------------- */

bool gd__close_seed_find(const struct gd_field *field, uint32_t face, const double weight[3],
                         double known, struct gd__close_seed *out)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__close_seed best = {.distance = known, .seed = GD_NONE, .at = {.vertex = GD_NONE}};
    for (int k = 0; k < 3; k++) {
        double p[3];
        if (weight[(k + 2) % 3] > GD_TOL_BESIDE_VERTEX) continue;
        turn_weights(weight, k, p);
        search_across_edge(field, mesh->face_side[face][k], p, &best);
    }
    struct gd_point point = {
        .kind = GD_POINT_FACE, .element = face, .weight = {weight[0], weight[1], weight[2]}};
    struct gd__polar at;
    if (gd__polar_around(mesh, &point, 0, &at)) search_round_vertex(field, &at, &best);
    *out = best;
    return best.seed != GD_NONE;
}

/* --- tracing ---------------------------------------------------------------------------------- */

/* Appends the point where the straight line crosses a side of `face`, without snapping to
 * vertices. */
static void append_crossing(struct gd__path_builder *builder, uint32_t face, uint32_t side,
                            double t, double rest)
{
    bool turned = side & 1;
    struct gd_point point = {.kind = GD_POINT_EDGE,
                             .element = side >> 1,
                             .weight = {turned ? rest : t, turned ? t : rest}};
    if (!(t > 0)) point = gd__point_of_vertex(builder->mesh->origin[side]);
    if (!(rest > 0)) point = gd__point_of_vertex(builder->mesh->origin[side ^ 1]);
    gd__path_builder_append_in_face(builder, point, face);
}

/* Appends the point where the line crosses an edge that ends at the vertex. Around the vertex, the
 * edge is `turn` radians away from the point. `face` is the builder's face. */
static void append_spoke(struct gd__path_builder *builder, const struct gd__close_seed *close,
                         uint32_t face, uint32_t side, double turn)
{
    double r = close->at.radius, q = close->to.radius, whole = fabs(close->turn);
    double part = r * q * sin(whole) / (r * sin(turn) + q * sin(whole - turn)) /
                  builder->mesh->side[side].length;
    append_crossing(builder, face, side, part, 1 - part);
}

static void trace_round(struct gd__path_builder *builder, const struct gd__close_seed *close)
{
    const struct gd_mesh *mesh = builder->mesh;
    uint32_t vertex = close->at.vertex, first = mesh->fan_first[vertex],
             end = mesh->fan_first[vertex + 1];
    uint32_t entry = close->at.entry;
    bool left = close->turn > 0;
    double turned = left ? gd__fan_end(mesh, vertex, entry) - close->at.angle
                         : close->at.angle - mesh->fan[entry].angle;
    while (entry != close->to.entry && turned < fabs(close->turn)) {
        uint32_t next =
            left ? (entry + 1 < end ? entry + 1 : first) : (entry > first ? entry : end) - 1;
        append_spoke(builder, close, mesh->side_face[mesh->fan[entry].side],
                     mesh->fan[left ? next : entry].side, turned);
        entry = next;
        turned += gd__fan_end(mesh, vertex, entry) - mesh->fan[entry].angle;
    }
    gd__path_builder_append_seed(builder, close->seed, mesh->side_face[mesh->fan[entry].side]);
}

void gd__close_seed_trace(struct gd__path_builder *builder, uint32_t face,
                          const struct gd__close_seed *close)
{
    const struct gd_mesh *mesh = builder->mesh;
    if (close->at.vertex != GD_NONE) {
        trace_round(builder, close);
        return;
    }
    double length = mesh->side[close->side].length;
    append_crossing(builder, face, close->side, close->t / length, close->rest / length);
    gd__path_builder_append_seed(builder, close->seed, mesh->side_face[close->side ^ 1]);
}
