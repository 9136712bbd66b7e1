/* An executor of threads, for tests and measurements. */
#ifndef TESTS_SUPPORT_THREADS_H
#define TESTS_SUPPORT_THREADS_H

#include "gd/executor.h"

/* Runs tasks on as many threads as there are tasks, at most `width`, started for each run; the caller's is one of them. */
struct gd_executor test_threads(uint32_t width);

#endif
