#if defined(__x86_64__)
#include "kernel/lanes_avx512.h"

#define KERNEL_NAME "avx512"
#define WITH_LINEAR 0
#include "kernel/kernel_lanes.h"
#endif
