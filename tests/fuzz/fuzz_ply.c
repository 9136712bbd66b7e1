#include "reader.h"

FUZZ_READER(PLY)
