#include "gd/control.h"

#include <time.h>

uint64_t gd_now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

enum gd_status gd_control_check(const struct gd_control *control, double fraction)
{
    if (!control) return GD_OK;
    if (control->deadline_ns && gd_now_ns() >= control->deadline_ns) return GD_DEADLINE;
    if (control->progress && !control->progress(control->user, fraction)) return GD_CANCELLED;
    return GD_OK;
}

enum gd_status gd_control_afford(const struct gd_control *control, size_t bytes)
{
    return control && control->budget_bytes && bytes > control->budget_bytes ? GD_BUDGET : GD_OK;
}
