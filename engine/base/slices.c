#include "base/slices.h"

#include <pthread.h>
#include <stdatomic.h>

#include "base/large.h"

struct slices {
    struct gd__pace *pace; /* used by the calling thread only */
    pthread_t caller;
    struct gd_control others; /* control of the other threads */
    atomic_int status;        /* first status that stopped a slice */
    uint32_t count;
    gd__slice *run;
    void *context;
};

/* Receives the progress of the other threads, which must not call the caller's function. */
static bool slices_go_on(void *user, double fraction)
{
    const struct slices *slices = user;
    (void)fraction;
    return atomic_load_explicit(&slices->status, memory_order_relaxed) == GD_OK;
}

static void run_slice(void *context, uint32_t index)
{
    struct slices *slices = context;
    uint32_t begin = index * GD__PACE_STEPS, rest = slices->count - begin;
    uint32_t end = begin + (rest < GD__PACE_STEPS ? rest : GD__PACE_STEPS);
    struct gd__pace other = {.control = &slices->others};
    bool is_caller = pthread_equal(pthread_self(), slices->caller);
    struct gd__pace *pace = is_caller ? slices->pace : &other;
    if (!slices_go_on(slices, 0)) return;
    if (gd__pace(pace, end - begin)) slices->run(slices->context, pace, begin, end);
    int none = GD_OK;
    if (pace->status)
        (void)atomic_compare_exchange_strong(&slices->status, &none, (int)pace->status);
}

void gd__slices_run(struct gd__pace *pace, uint32_t count, gd__slice *run, void *context)
{
    const struct gd_control *control = pace->control;
    struct slices slices = {
        .pace = pace, .caller = pthread_self(), .count = count, .run = run, .context = context};
    slices.others = (struct gd_control){.deadline_ns = control ? control->deadline_ns : 0,
                                        .progress = slices_go_on,
                                        .user = &slices};
    atomic_init(&slices.status, (int)pace->status);
    gd_executor_run(control ? control->executor : NULL, run_slice, &slices,
                    count / GD__PACE_STEPS + (count % GD__PACE_STEPS > 0));
    if (!pace->status) pace->status = (enum gd_status)atomic_load(&slices.status);
}

/* --- pages ------------------------------------------------------------------------------------ */

#define PAGE_BYTES  ((size_t)4096)
#define TOUCH_BYTES (GD__HUGE_PAGE / GD__PACE_STEPS) /* so that a slice is a huge page */

static void touch_slice(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    volatile char *bytes = context;
    (void)pace;
    for (size_t at = begin * TOUCH_BYTES; at < end * TOUCH_BYTES; at += PAGE_BYTES) bytes[at] = 0;
}

void gd__slices_touch(struct gd__pace *pace, void *array, size_t bytes)
{
    if (array) gd__slices_run(pace, (uint32_t)(bytes / TOUCH_BYTES), touch_slice, array);
}
