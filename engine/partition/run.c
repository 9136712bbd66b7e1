#include "partition/run.h"

#include "partition/partition.h"

static enum gd_status propagate_alone(struct gd__wavefront *front,
                                      const struct gd__propagation *propagation)
{
    enum gd_status status = gd__wavefront_open(front, propagation);
    if (status) return status;
    if (propagation->partial)
        gd__resume(front, propagation->partial);
    else
        gd__emit_seeds(front);
    gd__wavefront_advance(front, GD_NONE, UINT64_MAX);
    return front->status;
}

/* Propagates by two wavefronts, or by one if the memory does not suffice for two. */
static enum gd_status propagate_together(struct gd__wavefront *front,
                                         const struct gd__propagation *propagation,
                                         const struct gd_executor *executor)
{
    struct gd__wavefront fresh = *front;
    enum gd_status status = gd__partition_propagate(front, propagation, executor);
    if (status != GD_BUDGET) return status;
    gd__workspace_clean(front->work);
    *front = fresh;
    return propagate_alone(front, propagation);
}

static enum gd_status run_in(struct gd_workspace *work, const struct gd_mesh *mesh,
                             const struct gd__propagation *propagation, const struct gd__sink *sink,
                             const struct gd_control *monitor, const struct gd_executor *executor)
{
    struct gd__wavefront front = {.mesh = mesh,
                                  .work = work,
                                  .seeds = propagation->seeds,
                                  .seed_count = propagation->seed_count,
                                  .variant = propagation->variant,
                                  .guide = propagation->guide,
                                  .monitor = monitor};
    bool together = executor && executor->width > 1 && !propagation->partial &&
                    gd__partition_is_worth_it(mesh, propagation, monitor);
    enum gd_status status = together ? propagate_together(&front, propagation, executor)
                                     : propagate_alone(&front, propagation);
    if (!status) status = sink->take(sink->user, &front, executor);
    return status;
}

enum gd_status gd__wavefront_run(const struct gd_mesh *mesh,
                                 const struct gd__propagation *propagation,
                                 const struct gd__sink *sink, const struct gd_control *monitor,
                                 const struct gd_executor *executor)
{
    struct gd_workspace own = {0},
                        *work = monitor && monitor->workspace ? monitor->workspace : &own;
    enum gd_status status = run_in(work, mesh, propagation, sink, monitor, executor);
    if (work == &own)
        gd_workspace_trim(work);
    else
        gd__workspace_clean(work);
    return status;
}
