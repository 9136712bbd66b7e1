#include "reader.h"

FUZZ_READER(JSON)
