#include "kernel/lanes_plain.h"

#define KERNEL_NAME "baseline"
#define WITH_LINEAR 0
#include "kernel/kernel_lanes.h"
