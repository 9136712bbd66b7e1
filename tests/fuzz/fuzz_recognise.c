#include "reader.h"

FUZZ_READER(ANY)
