/* Build: the bytes of a file become a surface, within the byte budget. Memory is taken from it step
 * by step, each time before it is used. What the steps are is for the surface's kind to know
 * (kind.h). */
#ifndef SERVER_SURFACES_BUILD_H
#define SERVER_SURFACES_BUILD_H

#include "server/work/budget.h"
#include "server/surfaces/surface.h"

struct server_builder { /* all borrowed */
    struct server_budget *budget;
    struct server_cache *cache;
    uint32_t max_faces;
    /* who ends the build early and hears of its progress; it has no budget of its own */
    struct gd_control control;
};

/* The surface of a record from its record->size bytes, without its attachment, or a problem. GD_OK;
 * GD_BUDGET (over the budget; the problem tells the numbers); else what the engine says. The caller
 * has one reference. */
GD_MUST_USE enum gd_status server_build_surface(const struct server_builder *builder,
                                                struct server_record *record, const void *bytes,
                                                struct server_surface **out,
                                                struct proto_problem *problem);

/* --- for kinds -------------------------------------------------------------------------------- */

/* Takes bytes for the record's surface from SERVER_BUDGET_FLIGHT. GD_BUDGET with the problem. */
GD_MUST_USE enum gd_status server_build_take(const struct server_builder *builder,
                                             const struct server_record *record, size_t bytes,
                                             struct proto_problem *problem);

/* What the engine says, told as a problem, with the limit that was passed; returns the status. */
enum gd_status server_build_refuse(const struct server_builder *builder,
                                   const struct server_record *record, enum gd_status status,
                                   const struct gd_detail *detail, struct proto_problem *problem);

/* A part of the whole work: its control, which has a budget of its own, lives as long as the part
 * stays where it is. */
struct server_build_part {
    const struct server_builder *builder;
    double begun, share; /* the part [begun, begun + share] of the work */
};
struct gd_control server_build_control(struct server_build_part *part, size_t budget_bytes);

#endif
