#include "wedge/lanes_plain.h"

#define KERNEL_NAME "baseline"
#define WITH_LINEAR 0
#include "wedge/kernel_lanes.h"
