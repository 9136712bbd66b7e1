/* Executor: how the engine does work in parallel without owning a thread. The caller brings the
 * threads. */
#ifndef GD_EXECUTOR_H
#define GD_EXECUTOR_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* `run` calls task(context, i) once for each i in [0, count), in any order, on any threads, and
 * returns when all have returned. `width` is how many may run at a time (>= 1). A NULL executor
 * means: one after the other on the calling thread. */
struct gd_executor {
    uint32_t width;
    void (*run)(void *user, void (*task)(void *context, uint32_t index), void *context,
                uint32_t count);
    void *user;
};

/* Runs `count` tasks on `executor`, or on the calling thread when it is NULL. Task functions report
 * failure through `context`. */
void gd_executor_run(const struct gd_executor *executor,
                     void (*task)(void *context, uint32_t index), void *context, uint32_t count);

#ifdef __cplusplus
}
#endif

#endif
