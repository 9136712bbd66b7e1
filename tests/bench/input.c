#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/io.h"
#include "tests/bench/bench.h"
#include "tests/samples/argument.h"

/* --- arguments ----------------------------------------------------------------------------------------------------------- */

bool bench_take_word(char ***arguments, const char *word)
{
    if (!**arguments || strcmp(**arguments, word) != 0) return false;
    ++*arguments;
    return true;
}

bool bench_take_count(char ***arguments, const char *name, uint32_t *count)
{
    if (!bench_take_word(arguments, name)) return true;
    const char *text = **arguments ? **arguments : "";
    char *end;
    unsigned long value = strtoul(text, &end, 10);
    if (end == text || *end || value < 1 || value > 1000000) {
        fprintf(stderr, "gd_bench: %s must be followed by a number from 1 to 1000000, not by \"%s\".\n", name, text);
        return false;
    }
    ++*arguments;
    *count = (uint32_t)value;
    return true;
}

bool bench_arguments_end(char **arguments, bool wants_mesh)
{
    if (*arguments && **arguments == '-') {
        fprintf(stderr, "gd_bench: there is no option \"%s\" here; gd_bench alone lists what there is.\n", *arguments);
        return false;
    }
    if (wants_mesh && !*arguments) {
        fputs("gd_bench: name a mesh: a file, or sample:NAME[,key=value...].\n", stderr);
        return false;
    }
    return true;
}

/* --- meshes -------------------------------------------------------------------------------------------------------------- */

/* The file's bytes, malloc'ed; NULL when it can't be read. */
static char *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    char *bytes = NULL;
    if (fseek(file, 0, SEEK_END) == 0) {
        long length = ftell(file);
        rewind(file);
        bytes = length < 0 ? NULL : malloc((size_t)length + 1);
        *size = bytes ? fread(bytes, 1, (size_t)length, file) : 0;
    }
    fclose(file);
    return bytes;
}

static bool read_polygons(const char *path, struct gd_polygons *out)
{
    size_t size = 0;
    char *bytes = read_file(path, &size);
    if (!bytes) {
        fprintf(stderr, "gd_bench: %s can't be read: %s.\n", path, strerror(errno));
        return false;
    }
    struct gd_detail detail = {0};
    enum gd_status status = gd_read_polygons(bytes, size, GD_FORMAT_ANY, NULL, out, &detail);
    free(bytes);
    if (status) fprintf(stderr, "gd_bench: %s: %s (%s)\n", path, gd_status_sentence(status), detail.text);
    return !status;
}

/* `text`, "NAME[,key=value...]", is cut up. */
static bool make_sample(char *text, struct gd_polygons *out)
{
    char *rest = NULL, *name = strtok_r(text, ",", &rest);
    const struct sample *sample = name ? sample_find(name) : NULL;
    if (!sample) {
        fprintf(stderr, "gd_bench: there is no sample \"%s\"; see gd_sample --list.\n", name ? name : "");
        return false;
    }
    double values[SAMPLE_PARAMETERS];
    sample_defaults(sample, values);
    for (char *argument; (argument = strtok_r(NULL, ",", &rest));)
        if (!sample_set("gd_bench", sample, argument, values)) return false;
    enum gd_status status = sample->generate(values, out);
    if (status) fprintf(stderr, "gd_bench: sample %s: %s.\n", name, gd_status_sentence(status));
    return !status;
}

struct gd_mesh *bench_open(const char *argument)
{
    static const char prefix[] = "sample:";
    struct gd_polygons polygons;
    bool opened;
    if (strncmp(argument, prefix, sizeof prefix - 1) == 0) {
        char *text = bench_allocate(strlen(argument) + 1);
        strcpy(text, argument + sizeof prefix - 1);
        opened = make_sample(text, &polygons);
        free(text);
    } else {
        opened = read_polygons(argument, &polygons);
    }
    if (!opened) return NULL;
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    enum gd_status status = gd_mesh_build(&polygons, NULL, NULL, &mesh, &detail);
    gd_polygons_free(&polygons);
    if (status) fprintf(stderr, "gd_bench: %s: %s (%s)\n", argument, gd_status_sentence(status), detail.text);
    return mesh;
}

struct gd_point bench_random_point(const struct gd_mesh *mesh, enum gd_point_kind kind, struct rng *rng)
{
    struct gd_face face = {rng_below(rng, gd_mesh_summary(mesh)->faces)};
    double u = rng_unit(rng), v = rng_unit(rng), w[3] = {fmin(u, v), fmax(u, v) - fmin(u, v), 1 - fmax(u, v)};
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, face, corners);
    struct gd_detail detail = {0};
    struct gd_point point = {.kind = kind};
    if (kind == GD_POINT_VERTEX)
        bench_require(gd_point_at_vertex(mesh, corners[0], &point, &detail), &detail);
    else if (kind == GD_POINT_EDGE)
        bench_require(gd_point_on_edge(mesh, corners[0], corners[1], u, &point, &detail), &detail);
    else
        bench_require(gd_point_in_face(mesh, face, w, &point, &detail), &detail);
    return point;
}
