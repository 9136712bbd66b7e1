#include "gd/cpu.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "kernel/kernel.h"

/* The kernels, in the order of their numbers of lanes. */
static const struct gd__kernel *const kernels[] = {
    &gd__kernel_plain,
#if defined(__x86_64__)
    &gd__kernel_avx2,
    &gd__kernel_avx512,
#endif
};
enum { KERNELS = sizeof kernels / sizeof *kernels };

static _Atomic(const struct gd__kernel *) in_use;

static bool is_supported(const struct gd__kernel *kernel)
{
#if defined(__x86_64__)
    if (kernel == &gd__kernel_avx2) return __builtin_cpu_supports("avx2");
    if (kernel == &gd__kernel_avx512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
               __builtin_cpu_supports("avx512dq");
#endif
    return kernel == &gd__kernel_plain;
}

enum gd_status gd_cpu_select(const char *name)
{
    bool best = strcmp(name, "auto") == 0;
    enum gd_status status = GD_INVALID_ARGUMENT;
    for (int i = 0; i < KERNELS; i++) {
        if (!best && strcmp(name, kernels[i]->name) != 0) continue;
        bool supported = is_supported(kernels[i]);
        if (supported) atomic_store(&in_use, kernels[i]);
        if (!best || supported) status = supported ? GD_OK : GD_UNSUPPORTED;
    }
    return status;
}

const struct gd__kernel *gd__kernel_in_use(void)
{
    const struct gd__kernel *kernel = atomic_load_explicit(&in_use, memory_order_relaxed);
    if (kernel) return kernel;
    return gd_cpu_select("auto") ? &gd__kernel_plain : atomic_load(&in_use);
}

const char *gd_cpu_name(void)
{
    return gd__kernel_in_use()->name;
}
