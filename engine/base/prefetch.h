/* GD__ASKING: a function that does nothing but ask for memory ahead. GCC takes such a function for
 * one without effects and leaves its calls out, unless it is inlined first. */
#ifndef GD_BASE_PREFETCH_H
#define GD_BASE_PREFETCH_H

#define GD__ASKING static inline __attribute__((always_inline)) void

#endif
