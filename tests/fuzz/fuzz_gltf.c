#include "tests/fuzz/reader.h"

FUZZ_READER(GLTF)
