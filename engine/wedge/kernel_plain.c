#include "wedge/lanes_plain.h"

#define KERNEL_NAME "baseline"
#include "wedge/kernel_lanes.h"
