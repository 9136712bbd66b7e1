/* GD__PREFETCH: declares a function that only prefetches memory. GCC assumes that such a function
 * has no effect and drops its calls, unless it inlines the function first. */
#pragma once

#define GD__PREFETCH static inline __attribute__((always_inline)) void
