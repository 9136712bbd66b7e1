/* Slices: a paced loop over many elements, on the threads of the control's executor.
 *
 * The elements are divided into slices of GD__PACE_STEPS. The results do not depend on the threads
 * if the body of a slice writes only data of its own elements and reads no data of others. */
#pragma once

#include "base/pace.h"

/* The body of a loop over the elements from `begin` to `end` - 1. `pace` is for inner loops; one
 * step for each element is already counted. */
typedef void gd__slice(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end);

/* Runs the body for all slices of [0, count). After the pace has stopped, the remaining slices are
 * skipped. */
void gd__slices_run(struct gd__pace *pace, uint32_t count, gd__slice *run, void *context);

/* Writes a zero to each page of a new array, so that the system provides the pages in order, on
 * several threads. Otherwise the scattered writes of a single slice would cause page faults on
 * nearly all pages. And if two threads wrote to the same huge page, each of them would clear it.
 * NULL is allowed. */
void gd__slices_touch(struct gd__pace *pace, void *array, size_t bytes);
