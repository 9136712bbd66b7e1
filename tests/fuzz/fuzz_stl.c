#include "reader.h"

FUZZ_READER(STL)
