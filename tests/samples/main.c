/* gd_sample NAME [key=value…] > file.obj: writes a sample mesh. gd_sample --list: lists the
 * samples. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/io.h"
#include "tests/samples/argument.h"

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

/* Generates the sample and writes it to standard output. On failure prints a message and returns
 * false. */
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
    sample_defaults(sample, values);
    for (char **argument = argv + 2; *argument; argument++)
        if (!sample_set("gd_sample", sample, *argument, values)) return EXIT_USAGE;
    return write_sample(sample, values) ? EXIT_SUCCESS : EXIT_FAILURE;
}
