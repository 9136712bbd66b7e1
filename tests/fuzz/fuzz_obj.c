#include "reader.h"

FUZZ_READER(OBJ)
