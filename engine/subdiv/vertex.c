/* Vertices of neighbourhoods: their kinds, and the limit position and tangents. */
#include "subdiv/walker.h"

#include <math.h>

#include "base/tolerance.h"
#include "subdiv/refine.h"

enum kind {
    KIND_SMOOTH,
    KIND_DART, /* the end of a crease */
    KIND_CREASE,
    KIND_CORNER,
    KIND_SPIKE,  /* a corner inside a smooth surface */
    KIND_PASSING /* a semi-sharp vertex: it has another kind after some steps of subdivision */
};

static enum kind vertex_kind_of(const struct gd__net *net, const struct gd__fan *fan)
{
    float corner = net->corner[net->origin[fan->sides[0]]];
    uint32_t sharp = 0;
    bool passing = corner > 0 && corner < INFINITY;
    for (uint32_t i = 0; i < gd__fan_spokes(fan); i++) {
        float sharpness = gd__spoke_sharpness(net, fan, i);
        passing |= sharpness > 0 && sharpness < INFINITY;
        sharp += sharpness == INFINITY;
    }
    if (passing) return KIND_PASSING;
    if (corner > 0 && fan->closed && sharp == 0) return KIND_SPIKE;
    if (corner > 0 || sharp > 2) return KIND_CORNER;
    return sharp == 2 ? KIND_CREASE : sharp == 1 ? KIND_DART : KIND_SMOOTH;
}

/* A sector: the faces between two creases at a vertex, among them the face of a given side. It
 * begins at spoke `begin`. */
struct sector {
    uint32_t begin, faces;
    uint32_t own; /* the spoke of the given side, counted from `begin` */
};

static struct sector sector_of(const struct gd__net *net, const struct gd__fan *fan, uint32_t side)
{
    uint32_t spokes = gd__fan_spokes(fan), at = 0;
    while (fan->sides[at] != side) at++;
    struct sector sector = {at, 1, 0};
    while (gd__spoke_sharpness(net, fan, sector.begin) == 0) {
        sector.begin = (sector.begin + spokes - 1) % spokes;
        sector.own++;
    }
    sector.faces += sector.own;
    while (gd__spoke_sharpness(net, fan, (sector.begin + sector.faces) % spokes) == 0)
        sector.faces++;
    return sector;
}

static bool corner_is_regular(const struct gd__net *net, uint32_t side, struct gd__fan *fan)
{
    const struct gd__scheme *rules = gd__scheme_of(net);
    gd__fan_around(net, side, fan);
    switch (vertex_kind_of(net, fan)) {
    case KIND_SMOOTH:
        return fan->count == rules->valence;
    case KIND_CREASE:
        return sector_of(net, fan, side).faces == rules->valence / 2;
    case KIND_CORNER:
        return rules->corner_patches && net->sharpness[side] > 0 &&
               net->sharpness[gd__net_previous(net, side)] > 0;
    case KIND_DART:
    case KIND_SPIKE:
    case KIND_PASSING:
        break;
    }
    return false;
}

bool gd__ring_is_regular(const struct gd__net *ring, struct gd__fan *fan)
{
    for (uint32_t k = 0; k < ring->arity; k++) {
        if (!corner_is_regular(ring, k, fan)) return false;
    }
    return true;
}

/* Returns the unit vector in the direction of v, or NAN if v has no direction. */
static struct gd_vec3 unit(struct gd_vec3 v)
{
    double length = gd_vec3_length(v);
    if (!(length > 0 && length < INFINITY)) return (struct gd_vec3){NAN, NAN, NAN};
    return gd_vec3_scale(v, 1 / length);
}

static void to_units(struct gd__vertex *vertex)
{
    vertex->normal = unit(vertex->normal);
    vertex->s = unit(vertex->s);
    vertex->t = unit(vertex->t);
}

static void smooth_limit(const struct gd__net *net, const struct gd__fan *fan, uint32_t side,
                         struct gd__vertex *out)
{
    const struct gd__scheme *rules = gd__scheme_of(net);
    uint32_t own = 0;
    while (fan->sides[own] != side) own++;
    double step = 2 * M_PI / fan->count;
    struct gd_vec3 x = rules->tangent(net, fan, 0), y = rules->tangent(net, fan, M_PI / 2);
    *out = (struct gd__vertex){.position = rules->limit(net, fan),
                               .normal = gd_vec3_cross(x, y),
                               .s = rules->tangent(net, fan, own * step),
                               .t = rules->tangent(net, fan, (own + 1) * step)};
    to_units(out);
}

/* Computes the limit of a spike. During subdivision, the ring of neighbours shrinks more slowly
 * along the spike's axis than across it. So all directions from the vertex converge to the axis,
 * and no tangent plane exists. If the ring has no component along an axis (for example if it is
 * planar), the tangents are those of a smooth vertex, which do not depend on the vertex' own
 * position. */
static void spike_limit(const struct gd__net *net, const struct gd__fan *fan, uint32_t side,
                        struct gd__vertex *out)
{
    const struct gd__scheme *rules = gd__scheme_of(net);
    struct gd_vec3 own = net->points[net->origin[side]], axis = rules->axis(net, fan);
    double around = 0;
    for (uint32_t i = 0; i < fan->count; i++)
        around += gd_vec3_distance(net->points[gd__side_end(net, fan->sides[i])], own);
    if (gd_vec3_length(axis) > GD_TOL_SPIKE * around)
        *out = (struct gd__vertex){.normal = {NAN, NAN, NAN}, .s = unit(axis), .t = unit(axis)};
    else
        smooth_limit(net, fan, side, out);
    out->position = own;
}

/* Returns the limit direction of a spoke. For the two spokes of the crease, it is the direction
 * along the crease. For the other spokes of a sector with three or more faces, it is the direction
 * across the crease, because during subdivision such a ring shrinks less across the crease than
 * along it. */
static struct gd_vec3 crease_direction(struct sector sector, uint32_t spoke, struct gd_vec3 along,
                                       struct gd_vec3 cross)
{
    if (spoke == 0) return along;
    return spoke == sector.faces ? gd_vec3_scale(along, -1) : cross;
}

static void crease_limit(const struct gd__net *net, const struct gd__fan *fan, uint32_t side,
                         struct gd__vertex *out)
{
    struct sector sector = sector_of(net, fan, side);
    uint32_t spokes = gd__fan_spokes(fan);
    struct gd_vec3 own = net->points[net->origin[side]];
    struct gd_vec3 a = net->points[gd__spoke_end(net, fan, sector.begin)];
    struct gd_vec3 b = net->points[gd__spoke_end(net, fan, (sector.begin + sector.faces) % spokes)];
    struct gd_vec3 along = gd_vec3_sub(a, b),
                   cross = gd__scheme_of(net)->cross(net, fan, sector.begin, sector.faces);
    *out = (struct gd__vertex){
        .position = gd_vec3_scale(gd_vec3_along(gd_vec3_add(a, b), 4, own), 1.0 / 6),
        .normal = gd_vec3_cross(along, cross),
        .s = crease_direction(sector, sector.own, along, cross),
        .t = crease_direction(sector, sector.own + 1, along, cross),
    };
    to_units(out);
}

/* Computes the limit of darts and corners, for which there are no closed-form masks. Subdivides the
 * ring of such a vertex until the shape of the ring no longer changes. */
static void shape_limit(const struct gd__net *net, const struct gd__fan *fan, uint32_t side,
                        struct gd__vertex *out)
{
    bool corner = vertex_kind_of(net, fan) == KIND_CORNER;
    struct gd_vec3 own = net->points[net->origin[side]];
    struct gd_vec3 limit = corner ? own : gd__scheme_of(net)->limit(net, fan);
    *out = (struct gd__vertex){
        .position = limit,
        .s = gd_vec3_sub(net->points[gd__side_end(net, side)], limit),
        .t = gd_vec3_sub(net->points[net->origin[gd__net_previous(net, side)]], limit),
    };
    for (uint32_t i = 0; !corner && i < fan->count; i++) {
        struct gd_vec3 a = net->points[gd__side_end(net, fan->sides[i])];
        struct gd_vec3 b = net->points[net->origin[gd__net_previous(net, fan->sides[i])]];
        out->normal =
            gd_vec3_add(out->normal, gd_vec3_cross(gd_vec3_sub(a, limit), gd_vec3_sub(b, limit)));
    }
    if (corner) out->normal = gd_vec3_cross(out->s, out->t);
    bool is_plane = gd_vec3_length(out->normal) >
                    GD_TOL_SPIKE * gd_vec3_length(out->s) * gd_vec3_length(out->t);
    if (corner && !is_plane) out->normal = (struct gd_vec3){NAN, NAN, NAN};
    to_units(out);
}

void gd__vertex_limit(struct gd__walker *walker, uint32_t at, uint32_t corner, uint32_t free,
                      struct gd_vec3 origin, struct gd__vertex *out)
{
    static void (*const limits[])(const struct gd__net *, const struct gd__fan *, uint32_t,
                                  struct gd__vertex *) = {[KIND_SMOOTH] = smooth_limit,
                                                          [KIND_CREASE] = crease_limit,
                                                          [KIND_SPIKE] = spike_limit,
                                                          [KIND_PASSING] = NULL};
    for (uint32_t depth = 0;; depth++) {
        const struct gd__net *net = &walker->stages[at].ring;
        gd__fan_around(net, corner, &walker->fan);
        enum kind kind = vertex_kind_of(net, &walker->fan);
        if (limits[kind] || depth == GD__DEPTH_MOST) {
            (limits[kind] ? limits[kind] : shape_limit)(net, &walker->fan, corner, out);
            break;
        }
        uint32_t to = free + depth % 2;
        gd__descend(walker, at, gd__child_at_corner(net, corner), to, &origin);
        at = to;
        corner = 0;
    }
    out->position = gd_vec3_add(out->position, origin);
}
