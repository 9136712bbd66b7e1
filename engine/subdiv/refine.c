#include "subdiv/refine.h"

/* DeRose, Kass, Truong: Subdivision surfaces in character animation (1998), section 3. If the rule
 * of a point changes from one level to the next, its position is interpolated between the results
 * of both rules. As in OpenSubdiv, the weight of the sharper rule is the mean of the sharpnesses
 * that become zero in this step. */
enum rule { RULE_SMOOTH, RULE_CREASE, RULE_CORNER };

#define NOT_PLACED (-1.0F) /* marks a point that is not placed yet */

static float decayed(float sharpness, float decay)
{
    return sharpness > decay ? sharpness - decay : 0;
}

static enum rule rule_at(const struct gd__net *net, const struct gd__fan *fan, float corner,
                         float decay)
{
    uint32_t sharp = 0;
    for (uint32_t i = 0; i < gd__fan_spokes(fan); i++)
        sharp += gd__spoke_sharpness(net, fan, i) > decay;
    return corner > decay || sharp > 2 ? RULE_CORNER : sharp == 2 ? RULE_CREASE : RULE_SMOOTH;
}

static struct gd_vec3 crease_point(const struct gd__net *net, const struct gd__fan *fan,
                                   struct gd_vec3 own, float decay)
{
    struct gd_vec3 sum = gd_vec3_scale(own, 6);
    for (uint32_t i = 0; i < gd__fan_spokes(fan); i++) {
        if (gd__spoke_sharpness(net, fan, i) > decay)
            sum = gd_vec3_add(sum, net->points[gd__spoke_end(net, fan, i)]);
    }
    return gd_vec3_scale(sum, 0.125);
}

static struct gd_vec3 point_by(enum rule rule, const struct gd__net *net, const struct gd__fan *fan,
                               const struct gd_vec3 *face_points, float decay)
{
    struct gd_vec3 own = net->points[net->origin[fan->sides[0]]];
    switch (rule) {
    case RULE_SMOOTH:
        return gd__scheme_of(net)->vertex_point(net, fan, face_points);
    case RULE_CREASE:
        return crease_point(net, fan, own, decay);
    case RULE_CORNER:
        break;
    }
    return own;
}

static void count_transition(float sharpness, uint32_t *count, double *sum)
{
    if (sharpness <= 0 || sharpness > 1) return;
    ++*count;
    *sum += sharpness;
}

/* Returns the weight of the sharper rule, for a step in which sharpnesses become zero. */
static double transition(const struct gd__net *net, const struct gd__fan *fan, float corner)
{
    uint32_t count = 0;
    double sum = 0;
    count_transition(corner, &count, &sum);
    for (uint32_t i = 0; i < gd__fan_spokes(fan); i++)
        count_transition(gd__spoke_sharpness(net, fan, i), &count, &sum);
    return count ? sum / count : 0;
}

static struct gd_vec3 vertex_point(const struct gd__net *net, const struct gd__fan *fan,
                                   const struct gd_vec3 *face_points)
{
    float corner = net->corner[net->origin[fan->sides[0]]];
    enum rule now = rule_at(net, fan, corner, 0), next = rule_at(net, fan, corner, 1);
    struct gd_vec3 point = point_by(now, net, fan, face_points, 0);
    if (now == next) return point;
    struct gd_vec3 later = point_by(next, net, fan, face_points, 1);
    return gd_vec3_along(later, transition(net, fan, corner), gd_vec3_sub(point, later));
}

static struct gd_vec3 edge_point(const struct gd__net *net, uint32_t side,
                                 const struct gd_vec3 *face_points)
{
    struct gd_vec3 a = net->points[net->origin[side]], b = net->points[gd__side_end(net, side)];
    struct gd_vec3 middle = gd_vec3_scale(gd_vec3_add(a, b), 0.5);
    double sharpness = net->sharpness[side];
    if (net->twin[side] == GD_NONE || sharpness >= 1) return middle;
    struct gd_vec3 smooth = gd__scheme_of(net)->edge_point(net, side, face_points);
    return gd_vec3_along(smooth, sharpness, gd_vec3_sub(middle, smooth));
}

static struct gd_vec3 face_point(const struct gd__net *net, uint32_t face)
{
    uint32_t first = gd__face_first(net, face), count = gd__face_first(net, face + 1) - first;
    struct gd_vec3 sum = {0};
    for (uint32_t i = 0; i < count; i++)
        sum = gd_vec3_add(sum, net->points[net->origin[first + i]]);
    return gd_vec3_scale(sum, 1.0 / count);
}

uint32_t gd__number_edges(struct gd__net *net)
{
    uint32_t edges = 0;
    for (uint32_t side = 0; side < net->side_count; side++) {
        uint32_t twin = net->twin[side];
        /* a side without twin also gets a new number, because GD_NONE is the largest number */
        net->edge[side] = twin < side ? net->edge[twin] : edges++;
    }
    return edges;
}

static void place_points(const struct gd__net *net, uint32_t edges, uint32_t settled,
                         struct gd__fan *fan, struct gd__net *out)
{
    bool face_points = gd__scheme_of(net)->face_points;
    struct gd_vec3 *of_edges = out->points + net->point_count,
                   *of_faces = face_points ? of_edges + edges : NULL;
    for (uint32_t face = 0; face_points && face < net->face_count; face++)
        of_faces[face] = face_point(net, face);
    for (uint32_t side = 0; side < net->side_count; side++) {
        if (net->twin[side] >= side) of_edges[net->edge[side]] = edge_point(net, side, of_faces);
    }
    out->point_count = net->point_count + edges + (face_points ? net->face_count : 0);
    for (uint32_t i = 0; i < out->point_count; i++)
        out->corner[i] = i < net->point_count ? decayed(net->corner[i], 1) : 0;
    for (uint32_t i = 0; i < net->point_count; i++) out->points[i] = net->points[i];
    /* Places each point once, when the loop reaches the side where the point's fan begins. Points
       without faces have no such side. */
    for (uint32_t i = 0; i < settled; i++) out->corner[i] = NOT_PLACED;
    for (uint32_t side = 0; side < net->side_count; side++) {
        uint32_t point = net->origin[side];
        if (point >= settled || out->corner[point] != NOT_PLACED) continue;
        gd__fan_around(net, side, fan);
        out->points[point] = vertex_point(net, fan, of_faces);
        out->corner[point] = decayed(net->corner[point], 1);
    }
    for (uint32_t i = 0; i < settled; i++) out->corner[i] = fmaxf(out->corner[i], 0);
}

/* Creates the child face at the origin of `side`. Its corners are the origin, the edge point of
 * `side`, the face point (only with Catmull-Clark), and the edge point of the previous side. */
static void join_corner(const struct gd__net *net, uint32_t side, struct gd__net *out)
{
    uint32_t arity = net->arity, first = arity * gd__child_at_corner(net, side),
             last = first + arity - 1;
    uint32_t before = gd__net_previous(net, side), twin = net->twin[side],
             twin_before = net->twin[before];
    uint32_t edges = net->point_count;
    out->origin[first] = net->origin[side];
    out->origin[first + 1] = edges + net->edge[side];
    out->origin[last] = edges + net->edge[before];
    out->sharpness[first] = decayed(net->sharpness[side], 1);
    out->sharpness[last] = decayed(net->sharpness[before], 1);
    out->twin[first] = twin == GD_NONE
                           ? GD_NONE
                           : arity * gd__child_at_corner(net, gd__net_next(net, twin)) + arity - 1;
    out->twin[last] =
        twin_before == GD_NONE ? GD_NONE : arity * gd__child_at_corner(net, twin_before);
    for (uint32_t i = first + 1; i < last; i++) out->sharpness[i] = 0;
}

static void join_quads(const struct gd__net *net, uint32_t edges, struct gd__net *out)
{
    out->face_count = net->side_count;
    for (uint32_t side = 0; side < net->side_count; side++) {
        join_corner(net, side, out);
        out->origin[4 * side + 2] = net->point_count + edges + gd__face_of(net, side);
        out->twin[4 * side + 1] = 4 * gd__net_next(net, side) + 2;
        out->twin[4 * side + 2] = 4 * gd__net_previous(net, side) + 1;
    }
}

/* Creates the children of triangles. The corners of a middle child are the edge points, in the
 * order of the edges. */
static void join_triangles(const struct gd__net *net, struct gd__net *out)
{
    out->face_count = 4 * net->face_count;
    for (uint32_t side = 0; side < net->side_count; side++) {
        join_corner(net, side, out);
        uint32_t child = 3 * gd__child_at_corner(net, side), middle = 3 * (4 * (side / 3) + 3);
        uint32_t own = middle + side % 3, before = middle + (side + 2) % 3;
        out->origin[own] = net->point_count + net->edge[side];
        out->sharpness[own] = 0;
        out->twin[child + 1] = before;
        out->twin[before] = child + 1;
    }
}

void gd__net_refine(struct gd__net *net, uint32_t settled, struct gd__fan *fan, struct gd__net *out)
{
    uint32_t edges = gd__number_edges(net);
    place_points(net, edges, settled, fan, out);
    if (net->arity == 4)
        join_quads(net, edges, out);
    else
        join_triangles(net, out);
    out->side_count = out->arity * out->face_count;
}
