/* Arguments of samples, as people type them: "key=value". */
#ifndef TESTS_SAMPLES_ARGUMENT_H
#define TESTS_SAMPLES_ARGUMENT_H

#include "tests/samples/samples.h"

void sample_defaults(const struct sample *sample, double values[SAMPLE_PARAMETERS]);

/* Sets the value that the argument names. False, and a sentence on standard error that begins with
 * `program`, when it is wrong. */
bool sample_set(const char *program, const struct sample *sample, const char *argument,
                double values[SAMPLE_PARAMETERS]);

#endif
