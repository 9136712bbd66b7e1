/* gd_sample NAME [key=value…] > file.obj: writes a sample mesh. gd_sample --list: what there is. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/io.h"
#include "tests/samples/samples.h"

enum { EXIT_USAGE = 2 };

static const char usage[] = "usage: gd_sample NAME [key=value...] > file.obj\n"
                            "       gd_sample --list\n";

static int list_samples(void)
{
    for (uint32_t i = 0; i < sample_count; i++) {
        printf("%s: %s\n   ", samples[i].name, samples[i].sentence);
        for (const struct sample_parameter *p = samples[i].parameters; p->name; p++)
            printf(" %s=%g", p->name, p->value);
        printf("\n");
    }
    return EXIT_SUCCESS;
}

/* The number of the parameter that `argument` ("key=value") sets, or -1; `*text` is the value. */
static int parameter_of(const struct sample *sample, const char *argument, const char **text)
{
    size_t length = strcspn(argument, "=");
    for (int i = 0; sample->parameters[i].name; i++) {
        const char *name = sample->parameters[i].name;
        if (strlen(name) != length || strncmp(name, argument, length) != 0 || argument[length] != '=') continue;
        *text = argument + length + 1;
        return i;
    }
    return -1;
}

static bool parse_value(const struct sample_parameter *parameter, const char *text, double *out)
{
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= parameter->least && value <= parameter->most)) return false;
    if (parameter->whole && value != floor(value)) return false;
    *out = value;
    return true;
}

/* The defaults, changed by the arguments; false, after a sentence, when one of them is wrong. */
static bool parse_values(const struct sample *sample, char **arguments, double *values)
{
    for (int i = 0; sample->parameters[i].name; i++) values[i] = sample->parameters[i].value;
    for (; *arguments; arguments++) {
        const char *text = NULL;
        int i = parameter_of(sample, *arguments, &text);
        if (i < 0) {
            fprintf(stderr, "gd_sample: %s has no parameter \"%s\"; see gd_sample --list.\n", sample->name, *arguments);
            return false;
        }
        const struct sample_parameter *p = &sample->parameters[i];
        if (!parse_value(p, text, &values[i])) {
            fprintf(stderr, "gd_sample: %s must be a %snumber from %g to %g, not \"%s\".\n", p->name,
                    p->whole ? "whole " : "", p->least, p->most, text);
            return false;
        }
    }
    return true;
}

/* Generates the sample and writes it to standard output; false, after a sentence, when that fails. */
static bool write_sample(const struct sample *sample, const double *values)
{
    struct gd_polygons mesh = {0};
    char *bytes = NULL;
    size_t size = 0;
    enum gd_status status = sample->generate(values, &mesh);
    if (status == GD_OK) status = gd_write_polygons(&mesh, GD_FORMAT_OBJ, &bytes, &size);
    gd_polygons_free(&mesh);
    if (status != GD_OK) {
        fprintf(stderr, "gd_sample: %s.\n", gd_status_sentence(status));
        return false;
    }
    bool written = fwrite(bytes, 1, size, stdout) == size && fflush(stdout) == 0;
    if (!written) perror("gd_sample");
    free(bytes);
    return written;
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--list") == 0) return list_samples();
    if (argc < 2) {
        fputs(usage, stderr);
        return EXIT_USAGE;
    }
    const struct sample *sample = sample_find(argv[1]);
    if (!sample) {
        fprintf(stderr, "gd_sample: there is no sample \"%s\"; see gd_sample --list.\n", argv[1]);
        return EXIT_USAGE;
    }
    double values[SAMPLE_PARAMETERS];
    if (!parse_values(sample, argv + 2, values)) return EXIT_USAGE;
    return write_sample(sample, values) ? EXIT_SUCCESS : EXIT_FAILURE;
}
