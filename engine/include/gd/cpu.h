/* CPU: selects the instruction set of the vector kernels. All kernels give the same results to the
 * last bit; they differ only in speed. */
#ifndef GD_CPU_H
#define GD_CPU_H

#include "gd/status.h"

GD_EXTERN_C_BEGIN

/* Selects kernels by name: "baseline" (runs on any machine), "avx2", "avx512", or "auto" (the
 * default), which selects the best kernels that this machine supports. The selection is valid for
 * the whole process, so call this function before any other work. O(1). Errors: GD_INVALID_ARGUMENT
 * (unknown name), GD_UNSUPPORTED (this machine does not have the instructions). */
GD_MUST_USE enum gd_status gd_cpu_select(const char *name);

/* Returns the name of the kernels in use, a static string. Thread-safe. */
const char *gd_cpu_name(void);

GD_EXTERN_C_END

#endif
