#include "tests/samples/argument.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void sample_defaults(const struct sample *sample, double values[SAMPLE_PARAMETERS])
{
    for (int i = 0; sample->parameters[i].name; i++) values[i] = sample->parameters[i].value;
}

/* Returns the index of the parameter that `argument` ("key=value") sets, or -1. Sets *text to the
 * value. */
static int parameter_of(const struct sample *sample, const char *argument, const char **text)
{
    size_t length = strcspn(argument, "=");
    for (int i = 0; sample->parameters[i].name; i++) {
        const char *name = sample->parameters[i].name;
        if (strlen(name) != length || strncmp(name, argument, length) != 0 ||
            argument[length] != '=')
            continue;
        *text = argument + length + 1;
        return i;
    }
    return -1;
}

static bool parse_value(const struct sample_parameter *parameter, const char *text, double *out)
{
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= parameter->least && value <= parameter->most))
        return false;
    if (parameter->whole && value != floor(value)) return false;
    *out = value;
    return true;
}

bool sample_set(const char *program, const struct sample *sample, const char *argument,
                double values[SAMPLE_PARAMETERS])
{
    const char *text = NULL;
    int i = parameter_of(sample, argument, &text);
    if (i < 0) {
        fprintf(stderr, "%s: %s has no parameter \"%s\"; see gd_sample --list.\n", program,
                sample->name, argument);
        return false;
    }
    const struct sample_parameter *p = &sample->parameters[i];
    if (parse_value(p, text, &values[i])) return true;
    fprintf(stderr, "%s: %s must be a %snumber from %g to %g, not \"%s\".\n", program, p->name,
            p->whole ? "whole " : "", p->least, p->most, text);
    return false;
}
