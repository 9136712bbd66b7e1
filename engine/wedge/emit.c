#include "wedge/wavefront.h"

/* Emission: what a pseudo-source sees at once. A seed at a vertex sees its fan; a saddle or boundary vertex only the shadow cone behind it, where a
 * path that bends there is locally shortest: at least pi on both sides of the ray that came in. */

/* --- vertices ------------------------------------------------------------------------------------------------------------ */

/* Angle of the ray from `vertex` back along its last leg, in its fan. */
static double incoming_angle(const struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    struct gd__birth birth = *gd__wavefront_birth(front, vertex);
    if (birth.side != GD_NONE) { /* between p -> origin and p -> destination of the side opposite to p = vertex */
        const struct gd_side *s = &mesh->side[birth.side];
        double px = s->left_length * s->left_x, py = s->left_length * s->left_y;
        double rx = birth.x - px, ry = -birth.y - py, ox = -px, oy = -py;
        if (birth.source != GD_NONE && gd__source_is_linear(birth.source)) rx = birth.x, ry = -birth.y;
        uint32_t entry = mesh->fan_first[vertex], first = gd__side_previous(mesh, birth.side);
        while (mesh->fan[entry].side != first) entry++;
        return mesh->fan[entry].angle + atan2(ox * ry - oy * rx, ox * rx + oy * ry);
    }
    uint32_t edge = GD_NONE;
    if (birth.source >= mesh->vertex_count) edge = front->seeds[birth.source - mesh->vertex_count].point.element;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        uint32_t side = mesh->fan[i].side;
        if (edge != GD_NONE ? side >> 1 == edge : mesh->fan[i].tip == birth.source) return mesh->fan[i].angle;
    }
    return mesh->total_angle[vertex]; /* the last boundary edge of the fan */
}

static void reach_along_edge(struct gd__wavefront *front, uint32_t from, uint32_t to, double length)
{
    struct gd__birth birth = {.side = GD_NONE, .source = from};
    gd__wavefront_reach(front, to, front->distance[from] + length, birth);
}

/* Casts a window through the face of a fan entry, the part of it between the angles from and to (both from the entry's own side). */
static void emit_through_face(struct gd__wavefront *front, uint32_t vertex, const struct gd_fan *fan, double from,
                              double to, double opening)
{
    const struct gd_mesh *mesh = front->mesh;
    const struct gd_side *s = &mesh->side[fan->side];
    double length = s->right_length, px = s->left_length * s->left_x, py = s->left_length * s->left_y;
    double ax = px - s->length, b0 = 0,
           b1 = length; /* (ax, py): destination -> apex; the window's side runs the other way */
    double x = -(px * s->right_x + py * s->right_y),
           y = py * s->length / length; /* twice the area over the edge: no cancellation */
    if (gd__window_grazes(x, y, length)) return;
    bool cap =
        y <= GD_TOL_CAP *
                 length; /* the vertex lies almost on the edge: see all of it, as its ends would not tell the angle */
    if (from > 0 && !cap) b1 = length * (1 - sin(from) * s->length / (cos(from) * py - sin(from) * ax));
    if (to < opening && !cap) b0 = length * (1 - sin(to) * s->length / (cos(to) * py - sin(to) * ax));
    if (b0 < 0) b0 = 0;
    if (b1 > length) b1 = length;
    if (b1 - b0 <= GD_TOL_WIDTH * length) return;
    struct gd__window window = {.b0 = b0, .b1 = b1, .x = x, .y = y, .sigma = front->distance[vertex], .source = vertex};
    gd__wavefront_offer(front, s->right, &window);
}

/* Emits into the directions [from, to] of the fan, 0 <= from <= to; an interior fan goes round (to may exceed the total angle). */
static void emit_cone(struct gd__wavefront *front, uint32_t vertex, double from, double to)
{
    const struct gd_mesh *mesh = front->mesh;
    uint32_t first = mesh->fan_first[vertex], end = mesh->fan_first[vertex + 1];
    double total = mesh->total_angle[vertex];
    bool interior = mesh->vertex_kind[vertex] != GD_VERTEX_BOUNDARY;
    for (int lap = 0; lap < (interior ? 2 : 1); lap++) {
        double turn = lap * total;
        for (uint32_t i = first; i < end; i++) {
            double begin = mesh->fan[i].angle + turn, stop = (i + 1 < end ? mesh->fan[i + 1].angle : total) + turn;
            if (stop < from - GD_TOL_CONE) continue;
            if (begin > to + GD_TOL_CONE) break;
            const struct gd_fan *fan = &mesh->fan[i];
            if (interior && begin >= from - GD_TOL_CONE)
                reach_along_edge(front, vertex, fan->tip, mesh->side[fan->side].length);
            if (stop <= from || begin >= to) continue;
            emit_through_face(front, vertex, fan, from - begin, to - begin, stop - begin);
        }
    }
}

/* A boundary vertex offers its distance along all of its edges: always true, and the cone's edge cases need no care. */
static void reach_all_neighbours(struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1]; i++) {
        uint32_t side = mesh->fan[i].side, last = gd__side_previous(mesh, side);
        reach_along_edge(front, vertex, mesh->fan[i].tip, mesh->side[side].length);
        if (gd__side_is_boundary(mesh, last ^ 1))
            reach_along_edge(front, vertex, mesh->origin[last], mesh->side[last].length);
    }
}

/* The vertex is a seed, and none comes nearer to it. */
static bool is_seed_vertex(const struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd__birth *birth = gd__wavefront_birth(front, vertex);
    uint32_t vertices = front->mesh->vertex_count;
    return birth->source >= vertices && birth->source != GD_NONE && birth->side == GD_NONE &&
           front->seeds[birth->source - vertices].point.kind == GD_POINT_VERTEX;
}

static void emit_vertex(struct gd__wavefront *front, uint32_t vertex)
{
    const struct gd_mesh *mesh = front->mesh;
    double total = mesh->total_angle[vertex];
    *gd__wavefront_emitted(front, vertex) = front->distance[vertex];
    front->effort.vertices_emitted++;
    bool boundary = mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY, is_seed = is_seed_vertex(front, vertex);
    if (boundary) reach_all_neighbours(front, vertex);
    if (is_seed || front->methods.no_cone) {
        emit_cone(front, vertex, 0, total);
        return;
    }
    double in = incoming_angle(front, vertex);
    if (boundary) {
        if (in + M_PI < total) emit_cone(front, vertex, in + M_PI, total);
        if (in - M_PI > 0) emit_cone(front, vertex, 0, in - M_PI);
    } else {
        double from = in + M_PI < total ? in + M_PI : in + M_PI - total;
        emit_cone(front, vertex, from, from + total - 2 * M_PI);
    }
}

/* The other wavefront of a domain emits from common vertices itself. Of the others it has to know the distance, as windows of theirs may come to it. */
void gd__emit_vertex(struct gd__wavefront *front, uint32_t vertex)
{
    struct gd__domain *domain = front->domain;
    if (!domain) {
        emit_vertex(front, vertex);
        return;
    }
    if (!gd__domain_has_vertex(domain, vertex)) return;
    domain->is_common = gd__domain_shares_vertex(domain, vertex);
    if (!domain->is_common) gd__wavefront_tell(front, vertex);
    if (!front->status) emit_vertex(front, vertex);
    domain->is_common = false;
}
