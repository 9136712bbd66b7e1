#include "reader.h"

FUZZ_READER(OFF)
