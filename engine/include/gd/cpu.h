/* CPU: which instructions the kernels use. All of them give the same results to the last bit; they
 * differ in speed. */
#ifndef GD_CPU_H
#define GD_CPU_H

#include "gd/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Forces kernels by name: "baseline" (any machine), "avx2", "avx512"; "auto" is the best that this
 * machine has, and the choice at start. GD_INVALID_ARGUMENT: no such name; GD_UNSUPPORTED: not on
 * this machine. For the whole process; call it before work begins. */
GD_MUST_USE enum gd_status gd_cpu_select(const char *name);

/* The name of the kernels in use. */
const char *gd_cpu_name(void);

#ifdef __cplusplus
}
#endif

#endif
