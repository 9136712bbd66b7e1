#if defined(__x86_64__)
#include "wedge/lanes_avx512.h"

#define KERNEL_NAME "avx512"
#define WITH_LINEAR 0
#include "wedge/kernel_lanes.h"
#endif
