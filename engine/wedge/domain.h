/* Domain: one of the two parts into which a surface is cut by a plane through the source, each with
 * a wavefront of its own.
 *
 * DESIGN
 * - A face belongs to one part, and with it its sides: their windows are propagated by that part's
 * wavefront. A vertex of faces of both parts is known to both wavefronts. The two work by turns of
 * a fixed amount of work, each on its own memory; between turns the mail is handed over, and a turn
 *   begins with reading it: windows that crossed the cut, and distances of vertices that the other
 * one has to know.
 * - What a common vertex or a seed emits, each wavefront emits into its own part.
 * - Both know the same distance of each common vertex, to the last bit, once the mail is read: the
 * lesser one.
 * - The order of everything is fixed by the surface and the source: distances are the same on any
 * number of threads, every time. They are those of one wavefront up to rounding.
 * - Mail arrives late. That costs work, not exactness: propagation corrects itself (wavefront.h).
 */
#ifndef GD_WEDGE_DOMAIN_H
#define GD_WEDGE_DOMAIN_H

#include "wedge/list.h"
#include "wedge/workspace.h"

struct gd__wavefront;
struct gd__propagation;
struct gd_executor;

/* Letters, in the order in which they were written. */
struct gd__mail {
    struct gd__vertex_letter {
        uint32_t vertex;
        bool has_emitted; /* before: windows are on their way that began with a longer distance */
        double distance;
        struct gd__birth birth;
    } * vertices;
    uint32_t vertex_count, vertex_capacity;
    struct gd__list_letter {
        uint32_t side, count; /* so many of the windows, behind those of the letter before */
    } * lists;
    uint32_t list_count, list_capacity;
    struct gd__stack windows;
};

struct gd__domain {
    /* per side: the part of its face, 0 or 1; a boundary side has that of its other side */
    const uint8_t *side_part;
    const uint8_t *vertex_parts; /* per vertex: bits 1 << part of its faces */
    uint8_t part;
    bool is_common;       /* what is emitted now, the other part's wavefront emits too */
    struct gd__mail mail; /* to the other part */
};

static inline bool gd__domain_has_side(const struct gd__domain *domain, uint32_t side)
{
    return domain->side_part[side] == domain->part;
}

static inline bool gd__domain_has_vertex(const struct gd__domain *domain, uint32_t vertex)
{
    return domain->vertex_parts[vertex] >> domain->part & 1;
}

static inline bool gd__domain_shares_vertex(const struct gd__domain *domain, uint32_t vertex)
{
    return domain->vertex_parts[vertex] == 3;
}

/* Writes to the other part. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__domain_send_vertex(struct gd__domain *domain,
                                                  const struct gd__vertex_letter *letter);
GD_MUST_USE enum gd_status gd__domain_send_windows(struct gd__domain *domain, uint32_t side,
                                                   const struct gd__children *children);

/* Whether a propagation is worth two wavefronts: a large surface, one seed, the whole of it, and
 * memory enough. */
bool gd__domain_is_worth_it(const struct gd_mesh *mesh, const struct gd__propagation *propagation,
                            const struct gd_control *monitor);

/* Propagates by two wavefronts. `front` is not open yet; in the end it holds all as if it had
 * worked alone. Errors: those of gd__wavefront_run; GD_BUDGET where one wavefront may still have
 * enough. */
GD_MUST_USE enum gd_status gd__domain_propagate(struct gd__wavefront *front,
                                                const struct gd__propagation *propagation,
                                                const struct gd_executor *executor);

#endif
