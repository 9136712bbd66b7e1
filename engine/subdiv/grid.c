#include "subdiv/grid.h"

#include <math.h>

#include "subdiv/refine.h"

/* Layout of a part of the face in the arrays: the part's place (i,j) is at index origin + i step_s
 * + j step_t. */
struct part {
    uint32_t level;
    ptrdiff_t origin, step_s, step_t;
};

struct canvas {
    struct gd__walker *walker;
    struct gd_vec3 *positions, *normals;
    struct gd__pace *pace;
};

static struct part part_of_child(const struct part *part, const struct gd__child *child)
{
    ptrdiff_t half = (ptrdiff_t)1 << (part->level - 1), s = part->step_s, t = part->step_t;
    return (struct part){part->level - 1,
                         part->origin + half * (child->origin[0] * s + child->origin[1] * t),
                         child->s[0] * s + child->s[1] * t, child->t[0] * s + child->t[1] * t};
}

/* Completes a row: adds the origin of the coordinates to the positions, and scales normals to unit
 * length. */
static void settle_row(const struct gd__grid_rows *rows, uint32_t i, uint32_t last,
                       struct gd_vec3 origin)
{
    for (uint32_t j = 0; j <= last; j++) {
        ptrdiff_t at = rows->origin + (ptrdiff_t)i * rows->step_s + (ptrdiff_t)j * rows->step_t;
        double square = gd_vec3_dot(rows->normals[at], rows->normals[at]);
        bool known = square > 0 && square < INFINITY;
        rows->positions[at] = gd_vec3_add(rows->positions[at], origin);
        rows->normals[at] =
            known ? gd_vec3_scale(rows->normals[at], 1 / sqrt(square)) : (struct gd_vec3){0};
    }
}

static void paint_patch(const struct canvas *canvas, const struct gd__net *ring,
                        const struct part *part, struct gd_vec3 origin)
{
    const struct gd__scheme *rules = gd__scheme_of(ring);
    const struct gd__grid_rows rows = {1u << part->level, part->origin,      part->step_s,
                                       part->step_t,      canvas->positions, canvas->normals};
    struct gd__patch patch;
    rules->patch(ring, &canvas->walker->fan, &patch);
    for (uint32_t i = 0; i <= rows.cells && gd__pace(canvas->pace, rows.cells + 1); i++) {
        rules->row(&patch, i, &rows);
        settle_row(&rows, i, rules->arity == 3 ? rows.cells - i : rows.cells, origin);
    }
}

static void paint_corners(const struct canvas *canvas, uint32_t stage, const struct part *part,
                          struct gd_vec3 origin)
{
    static const int place[2][4][2] = {{{0, 0}, {1, 0}, {0, 1}}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    uint32_t arity = canvas->walker->surface->rules->arity;
    for (uint32_t k = 0; k < arity; k++) {
        struct gd__vertex vertex;
        const int *at = place[arity == 4][k];
        ptrdiff_t index = part->origin + at[0] * part->step_s + at[1] * part->step_t;
        gd__vertex_limit(canvas->walker, stage, k, stage + 1, origin, &vertex);
        canvas->positions[index] = vertex.position;
        canvas->normals[index] = isnan(vertex.normal.x) ? (struct gd_vec3){0} : vertex.normal;
    }
}

/* Fills the grid of a part, recursively. The depth of recursion is at most the level. */
static void paint(const struct canvas *canvas, uint32_t stage, const struct part *part,
                  struct gd_vec3 origin)
{
    struct gd__walker *walker = canvas->walker;
    struct gd__stage *here = &walker->stages[stage];
    if (gd__ring_is_regular(&here->ring, &walker->fan)) {
        paint_patch(canvas, &here->ring, part, origin);
        return;
    }
    if (part->level == 0) {
        paint_corners(canvas, stage, part, origin);
        return;
    }
    gd__net_refine(&here->ring, here->ring.arity, &walker->fan, &here->refined);
    for (uint32_t child = 0; child < GD__CHILDREN && !canvas->pace->status; child++) {
        struct part quarter = part_of_child(part, &walker->surface->rules->children[child]);
        struct gd_vec3 child_origin = origin;
        gd__neighbourhood_extract(walker, &here->refined, child, &walker->stages[stage + 1].ring,
                                  &child_origin);
        paint(canvas, stage + 1, &quarter, child_origin);
    }
}

enum gd_status gd__grid(struct gd__walker *walker, uint32_t face, uint32_t level,
                        const struct gd__grid_room *room, struct gd__pace *pace)
{
    struct gd__pace none = {0};
    struct canvas canvas = {walker, room->positions, room->normals, pace ? pace : &none};
    struct part whole = {level, 0, ((ptrdiff_t)1 << level) + 1, 1};
    struct gd_vec3 origin = {0};
    gd__neighbourhood_extract(walker, &walker->surface->base, face, &walker->stages[0].ring,
                              &origin);
    paint(&canvas, 0, &whole, origin);
    return canvas.pace->status;
}
