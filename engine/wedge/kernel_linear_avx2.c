#if defined(__x86_64__)
#include "wedge/lanes_avx2.h"

#define KERNEL_NAME "avx2"
#define WITH_LINEAR 1
#include "wedge/kernel_lanes.h"
#endif
