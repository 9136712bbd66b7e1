/* Executor: runs parallel tasks on threads of the caller. The engine creates no threads. */
#ifndef GD_EXECUTOR_H
#define GD_EXECUTOR_H

#include <stdint.h>

#include "gd/language.h"

GD_EXTERN_C_BEGIN

/* `run` calls task(context, i) once for each i in [0, count), in any order, on any threads, and
 * returns after all tasks have returned. `width` is the largest number of concurrent tasks (>=
 * 1). */
struct gd_executor {
    uint32_t width;
    void (*run)(void *user, void (*task)(void *context, uint32_t index), void *context,
                uint32_t count);
    void *user;
};

/* Runs `count` tasks on `executor`. If `executor` is NULL, runs them on the calling thread, in
 * their order. Tasks report failures through `context`. */
void gd_executor_run(const struct gd_executor *executor,
                     void (*task)(void *context, uint32_t index), void *context, uint32_t count);

GD_EXTERN_C_END

#endif
