/* See build.h. */
#include "server/surfaces/build.h"

#include <stdio.h>

#include "server/store/kind.h"

#define NOUN 64

/* "the mesh" */
static void name_it(const struct server_record *record, char text[NOUN])
{
    snprintf(text, NOUN, "the %s", record->kind->noun);
}

enum gd_status server_build_take(const struct server_builder *builder,
                                 const struct server_record *record, size_t bytes,
                                 struct proto_problem *problem)
{
    char it[NOUN];
    if (server_budget_take(builder->budget, SERVER_BUDGET_FLIGHT, bytes)) return GD_OK;
    name_it(record, it);
    server_budget_refuse(builder->budget, it, bytes, problem);
    return GD_BUDGET;
}

enum gd_status server_build_refuse(const struct server_builder *builder,
                                   const struct server_record *record, enum gd_status status,
                                   const struct gd_detail *detail, struct proto_problem *problem)
{
    char it[NOUN];
    proto_problem_from_status(problem, status, detail);
    name_it(record, it);
    if (status == GD_TOO_LARGE) proto_problem_limit(problem, builder->max_faces);
    if (status == GD_BUDGET) server_budget_refuse(builder->budget, it, 0, problem);
    return status;
}

static bool on_progress(void *user, double fraction)
{
    const struct server_build_part *part = user;
    const struct gd_control *whole = &part->builder->control;
    return !whole->progress || whole->progress(whole->user, part->begun + part->share * fraction);
}

struct gd_control server_build_control(struct server_build_part *part, size_t budget_bytes)
{
    return (struct gd_control){.budget_bytes = budget_bytes,
                               .deadline_ns = part->builder->control.deadline_ns,
                               .progress = on_progress,
                               .user = part};
}

enum gd_status server_build_surface(const struct server_builder *builder,
                                    struct server_record *record, const void *bytes,
                                    struct server_surface **out, struct proto_problem *problem)
{
    void *object = NULL;
    size_t size = 0;
    enum gd_status status = record->kind->build(builder, record, bytes, &object, &size, problem);
    if (status) return status;
    struct server_surface *surface =
        server_surface_create(record, object, size, builder->budget, builder->cache);
    if (!surface) {
        record->kind->release(object);
        server_budget_give(builder->budget, SERVER_BUDGET_FLIGHT, size);
        return server_build_refuse(builder, record, GD_NO_MEMORY, NULL, problem);
    }
    *out = surface;
    return GD_OK;
}
