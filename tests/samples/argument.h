/* Command-line arguments of samples: "key=value". */
#pragma once

#include "tests/samples/samples.h"

void sample_defaults(const struct sample *sample, double values[SAMPLE_PARAMETERS]);

/* Sets the value that the argument names. If the argument is wrong, prints a message that begins
 * with `program` to standard error and returns false. */
bool sample_set(const char *program, const struct sample *sample, const char *argument,
                double values[SAMPLE_PARAMETERS]);
