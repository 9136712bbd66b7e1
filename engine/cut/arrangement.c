#include "cut/arrangement.h"

#include "mesh/segment.h"

/* Each new node and each run belongs to at least one segment, so this limits their numbers too. */
#define MOST_SEGMENTS (UINT32_C(1) << 24)

/* At most WORK_AT_LEAST segments are processed, plus WORK_A_SEGMENT for each point of the curve. */
#define WORK_A_SEGMENT 4096
#define WORK_AT_LEAST  (UINT64_C(1) << 22)

/* --- the stack of waiting segments ------------------------------------------------------------ */

static enum gd_status arrangement_push(struct gd__arrangement *arrangement, uint32_t face,
                                       uint32_t a, uint32_t b)
{
    const struct gd__segment segment = {a, b, face, arrangement->waiting};
    if (a == b) return GD_OK;
    if (arrangement->segment_count == MOST_SEGMENTS) return GD_TOO_LARGE;
    enum gd_status status = gd__arena_append(
        arrangement->nodes.arena, &arrangement->segments, &arrangement->segment_count,
        &arrangement->segment_capacity, &segment, sizeof segment);
    if (!status) arrangement->waiting = arrangement->segment_count - 1;
    return status;
}

static enum gd_status push_through(struct gd__arrangement *arrangement, struct gd__segment segment,
                                   uint32_t node)
{
    enum gd_status status = arrangement_push(arrangement, segment.face, segment.a, node);
    return status ? status : arrangement_push(arrangement, segment.face, node, segment.b);
}

/* Removes a kept segment from its face's list. `link` is the address of the number that refers to
 * the segment. */
static struct gd__segment arrangement_take(struct gd__arrangement *arrangement, uint32_t *link)
{
    struct gd__segment segment = arrangement->segments[*link];
    *link = segment.next;
    return segment;
}

/* --- segments that pass nodes ----------------------------------------------------------------- */

/* Returns the distance of a position from the segment a-b, or INFINITY if its projection onto the
 * line lies beyond the ends of the segment. */
static double distance_from(struct gd__local a, struct gd__local b, struct gd__local p)
{
    double dx = b.x - a.x, dy = b.y - a.y, px = p.x - a.x, py = p.y - a.y;
    double along = px * dx + py * dy, squared = dx * dx + dy * dy;
    if (!(along > 0 && along < squared)) return INFINITY;
    return fabs(dx * py - dy * px) / sqrt(squared);
}

static double distance_of_node(const struct gd__arrangement *arrangement,
                               const struct gd__segment *segment, uint32_t node)
{
    const struct gd__nodes *nodes = &arrangement->nodes;
    struct gd__local place[3];
    const uint32_t list[3] = {segment->a, segment->b, node};
    for (int i = 0; i < 3; i++)
        place[i] = gd__site_local(nodes->mesh, segment->face,
                                  gd__node_site(nodes, segment->face, list[i]));
    return distance_from(place[0], place[1], place[2]);
}

/* Returns the node that is nearest to the segment and within half the face's reach of it, or
 * GD_NONE if there is none. */
static uint32_t find_passed(struct gd__arrangement *arrangement, const struct gd__segment *segment)
{
    struct gd__nodes *nodes = &arrangement->nodes;
    double least = gd__nodes_reach(nodes, segment->face) / 2;
    uint32_t found = GD_NONE, node;
    struct gd__node_walk walk = {0};
    while ((node = gd__nodes_walk(nodes, segment->face, &walk)) != GD_NONE) {
        if (node == segment->a || node == segment->b) continue;
        double distance = distance_of_node(arrangement, segment, node);
        if (distance >= least) continue;
        least = distance;
        found = node;
    }
    if (found != GD_NONE) nodes->shift = fmax(nodes->shift, least);
    return found;
}

/* Moves the kept segments of a face that pass near a new node back to the stack. */
static enum gd_status revisit_face(struct gd__arrangement *arrangement, uint32_t face,
                                   uint32_t node)
{
    double reach = gd__nodes_reach(&arrangement->nodes, face) / 2;
    enum gd_status status = GD_OK;
    for (uint32_t *link = &arrangement->of_face[face]; *link != GD_NONE && !status;) {
        if (distance_of_node(arrangement, &arrangement->segments[*link], node) < reach) {
            struct gd__segment segment = arrangement_take(arrangement, link);
            status = arrangement_push(arrangement, face, segment.a, segment.b);
            /* restarts, because the push may have changed the list of segments */
            link = &arrangement->of_face[face];
        } else {
            link = &arrangement->segments[*link].next;
        }
    }
    return status;
}

static enum gd_status revisit(struct gd__arrangement *arrangement, uint32_t node)
{
    const struct gd__nodes *nodes = &arrangement->nodes;
    const struct gd_point point = gd__node_point(nodes, node);
    if (point.kind == GD_POINT_FACE) return revisit_face(arrangement, point.element, node);
    enum gd_status status = GD_OK;
    for (uint32_t h = 2 * point.element; h < 2 * point.element + 2 && !status; h++) {
        uint32_t face = nodes->mesh->side_face[h];
        if (face != GD_NONE) status = revisit_face(arrangement, face, node);
    }
    return status;
}

/* --- crossings -------------------------------------------------------------------------------- */

/* Returns the address of the number of a kept segment that `segment` crosses, or NULL if there is
 * none. */
static uint32_t *find_crossed(struct gd__arrangement *arrangement,
                              const struct gd__segment *segment)
{
    const struct gd__nodes *nodes = &arrangement->nodes;
    uint32_t face = segment->face;
    struct gd__site a = gd__node_site(nodes, face, segment->a),
                    b = gd__node_site(nodes, face, segment->b);
    for (uint32_t *link = &arrangement->of_face[face]; *link != GD_NONE;
         link = &arrangement->segments[*link].next) {
        const struct gd__segment *kept = &arrangement->segments[*link];
        if (gd__sites_cross(a, b, gd__node_site(nodes, face, kept->a),
                            gd__node_site(nodes, face, kept->b)))
            return link;
    }
    return NULL;
}

static enum gd_status node_of_crossing(struct gd__arrangement *arrangement,
                                       const struct gd__segment *segment,
                                       const struct gd__segment *other, uint32_t *out)
{
    const struct gd__nodes *nodes = &arrangement->nodes;
    uint32_t face = segment->face;
    struct gd__site a = gd__node_site(nodes, face, segment->a),
                    b = gd__node_site(nodes, face, segment->b),
                    c = gd__node_site(nodes, face, other->a),
                    d = gd__node_site(nodes, face, other->b);
    double before = (double)gd__site_area(c, d, a), behind = (double)gd__site_area(c, d, b);
    double t = before / (before - behind);
    double u = gd__from_lattice(a.u) + t * gd__from_lattice(b.u - a.u),
           v = gd__from_lattice(a.v) + t * gd__from_lattice(b.v - a.v);
    uint32_t known = nodes->count;
    enum gd_status status = gd__node_in_face(&arrangement->nodes, face, u, v, out);
    return status || nodes->count == known ? status : revisit(arrangement, *out);
}

static enum gd_status arrangement_split(struct gd__arrangement *arrangement,
                                        struct gd__segment segment, uint32_t *link)
{
    struct gd__segment other = arrangement_take(arrangement, link);
    uint32_t node = GD_NONE;
    enum gd_status status = node_of_crossing(arrangement, &segment, &other, &node);
    if (!status) status = push_through(arrangement, other, node);
    return status ? status : push_through(arrangement, segment, node);
}

/* --- settling --------------------------------------------------------------------------------- */

static enum gd_status add_run(struct gd__arrangement *arrangement,
                              const struct gd__segment *segment, uint32_t sides)
{
    uint32_t k = sides & 1 ? 0 : sides & 2 ? 1 : 2;
    const struct gd__run run = {arrangement->nodes.mesh->face_side[segment->face][k] / 2,
                                segment->a, segment->b};
    return gd__arena_append(arrangement->nodes.arena, &arrangement->runs, &arrangement->run_count,
                            &arrangement->run_capacity, &run, sizeof run);
}

static bool is_kept(const struct gd__arrangement *arrangement, const struct gd__segment *segment)
{
    for (uint32_t i = arrangement->of_face[segment->face]; i != GD_NONE;
         i = arrangement->segments[i].next) {
        const struct gd__segment *kept = &arrangement->segments[i];
        if ((kept->a == segment->a && kept->b == segment->b) ||
            (kept->a == segment->b && kept->b == segment->a))
            return true;
    }
    return false;
}

/* Processes the segment at the top of the stack. */
static enum gd_status arrangement_settle(struct gd__arrangement *arrangement)
{
    const struct gd__nodes *nodes = &arrangement->nodes;
    uint32_t top = arrangement->waiting;
    struct gd__segment segment = arrangement->segments[top];
    arrangement->waiting = segment.next;
    uint32_t sides = gd__node_sides(nodes, segment.face, segment.a) &
                     gd__node_sides(nodes, segment.face, segment.b);
    if (sides) return add_run(arrangement, &segment, sides);
    if (is_kept(arrangement, &segment)) return GD_OK;
    uint32_t passed = find_passed(arrangement, &segment);
    if (passed != GD_NONE) return push_through(arrangement, segment, passed);
    uint32_t *crossed = find_crossed(arrangement, &segment);
    if (crossed) return arrangement_split(arrangement, segment, crossed);
    arrangement->segments[top].next = arrangement->of_face[segment.face];
    arrangement->of_face[segment.face] = top;
    return GD_OK;
}

static enum gd_status settle_all(struct gd__arrangement *arrangement, uint32_t points)
{
    uint64_t most = WORK_AT_LEAST + (uint64_t)points * WORK_A_SEGMENT;
    enum gd_status status = GD_OK;
    while (arrangement->waiting != GD_NONE && !status) {
        status = arrangement_settle(arrangement);
        if (!status && ++arrangement->work > most) status = GD_RUNAWAY;
        if (!status) status = gd_control_check(arrangement->nodes.arena->budget.control, 0);
    }
    return status;
}

/* --- segments of the curve -------------------------------------------------------------------- */

static enum gd_status push_segment(struct gd__arrangement *arrangement,
                                   const struct gd_curve *curve, uint32_t i,
                                   struct gd_detail *detail)
{
    uint32_t j = (i + 1) % curve->count, a = GD_NONE, b = GD_NONE;
    const struct gd_point *p = &curve->points[i], *q = &curve->points[j];
    uint32_t face = gd__common_face(arrangement->nodes.mesh, p, q);
    if (face == GD_NONE)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "points %u and %u of the curve do not lie within one face", i, j);
    enum gd_status status = gd__node_of_point(&arrangement->nodes, p, &a);
    if (!status) status = gd__node_of_point(&arrangement->nodes, q, &b);
    return status ? status : arrangement_push(arrangement, face, a, b);
}

enum gd_status gd__arrange(const struct gd_mesh *mesh, const struct gd_curve *curve, double snap,
                           struct gd__arena *arena, struct gd__arrangement *out,
                           struct gd_detail *detail)
{
    *out = (struct gd__arrangement){.nodes = {.mesh = mesh,
                                              .arena = arena,
                                              .snap = snap,
                                              .of_edge = gd__cut_numbers(arena, mesh->edge_count),
                                              .of_face = gd__cut_numbers(arena, mesh->face_count)},
                                    .of_face = gd__cut_numbers(arena, mesh->face_count),
                                    .waiting = GD_NONE};
    enum gd_status status = arena->status;
    uint32_t segments = curve->closed ? curve->count : curve->count - 1;
    for (uint32_t i = 0; i < segments && !status; i++) status = push_segment(out, curve, i, detail);
    return status ? status : settle_all(out, curve->count);
}

bool gd__is_crossed(const struct gd__arrangement *arrangement, uint32_t face)
{
    const struct gd__nodes *nodes = &arrangement->nodes;
    if (arrangement->of_face[face] != GD_NONE || nodes->of_face[face] != GD_NONE) return true;
    for (uint32_t k = 0; k < 3; k++)
        if (nodes->of_edge[nodes->mesh->face_side[face][k] / 2] != GD_NONE) return true;
    return false;
}
