#include "gd/executor.h"

void gd_executor_run(const struct gd_executor *executor,
                     void (*task)(void *context, uint32_t index), void *context, uint32_t count)
{
    if (executor && executor->width > 1 && count > 1) {
        executor->run(executor->user, task, context, count);
        return;
    }
    for (uint32_t i = 0; i < count; i++) task(context, i);
}
