#if defined(__x86_64__)
#include "kernel/lanes_avx2.h"

#define KERNEL_NAME "avx2"
#define WITH_LINEAR 0
#include "kernel/kernel_lanes.h"
#endif
