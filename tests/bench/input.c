#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gd/io.h"
#include "tests/bench/alter.h"
#include "tests/bench/bench.h"
#include "tests/samples/argument.h"

/* --- files ------------------------------------------------------------------------------------ */

bool bench_map_file(const char *path, struct bench_file *file)
{
    struct stat state;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    void *bytes = MAP_FAILED;
    if (descriptor >= 0 && fstat(descriptor, &state) == 0)
        bytes =
            mmap(NULL, (size_t)state.st_size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, descriptor, 0);
    if (bytes == MAP_FAILED)
        fprintf(stderr, "gd_bench: %s can't be read, or is empty: %s.\n", path, strerror(errno));
    else
        *file = (struct bench_file){bytes, (size_t)state.st_size};
    if (descriptor >= 0) close(descriptor);
    return bytes != MAP_FAILED;
}

void bench_unmap_file(struct bench_file *file)
{
    munmap((void *)file->bytes, file->size);
    *file = (struct bench_file){NULL, 0};
}

static bool read_file(const char *path, struct gd_polygons *out)
{
    struct bench_file file;
    if (!bench_map_file(path, &file)) return false;
    struct gd_detail detail = {0};
    enum gd_status status = gd_read_polygons(file.bytes, file.size, NULL, out, &detail);
    bench_unmap_file(&file);
    if (status)
        fprintf(stderr, "gd_bench: %s: %s (%s)\n", path, gd_status_sentence(status), detail.text);
    return !status;
}

/* --- samples ---------------------------------------------------------------------------------- */

static const char sample_prefix[] = "sample:";

bool bench_is_sample(const char *argument)
{
    return strncmp(argument, sample_prefix, sizeof sample_prefix - 1) == 0;
}

/* Makes a sample of `text`, "NAME[,key=value...]", which is modified. */
static bool make_sample(char *text, struct gd_polygons *out)
{
    char *rest = NULL, *name = strtok_r(text, ",", &rest);
    const struct sample *sample = name ? sample_find(name) : NULL;
    if (!sample) {
        fprintf(stderr, "gd_bench: there is no sample \"%s\"; see gd_sample --list.\n",
                name ? name : "");
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

static bool read_sample(const char *argument, struct gd_polygons *out)
{
    char *text = bench_allocate(strlen(argument) + 1);
    strcpy(text, argument + sizeof sample_prefix - 1);
    bool made = make_sample(text, out);
    free(text);
    return made;
}

/* --- meshes ----------------------------------------------------------------------------------- */

bool bench_read(const char *argument, const struct bench_options *options, struct gd_polygons *out)
{
    bool is_read =
        bench_is_sample(argument) ? read_sample(argument, out) : read_file(argument, out);
    if (!is_read || (!options->levels && !options->noise)) return is_read;
    enum gd_status status = out->first ? GD_NOT_TRIANGLES : GD_OK;
    if (status == GD_OK) status = alter_subdivide(out, options->levels);
    if (status == GD_OK && options->noise > 0) status = alter_roughen(out, options->noise);
    if (status == GD_OK) return true;
    fprintf(stderr, "gd_bench: %s can't be subdivided or roughened: %s.\n", argument,
            gd_status_sentence(status));
    gd_polygons_free(out);
    return false;
}

struct gd_mesh *bench_open(const char *argument, const struct bench_options *options)
{
    struct bench_options none = {0};
    if (!options) options = &none;
    struct gd_polygons polygons;
    if (!bench_read(argument, options, &polygons)) return NULL;
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    struct gd_mesh_options building = {.repair_split = options->repair};
    enum gd_status status = gd_mesh_build(&polygons, &building, NULL, &mesh, &detail);
    gd_polygons_free(&polygons);
    if (status)
        fprintf(stderr, "gd_bench: %s: %s (%s)\n", argument, gd_status_sentence(status),
                detail.text);
    return mesh;
}

/* Returns a random face of the mesh, except those that a repair removed. */
static struct gd_face random_face(const struct gd_mesh *mesh, struct rng *rng)
{
    struct gd_face face;
    do face.index = rng_below(rng, gd_mesh_summary(mesh)->face_index_count);
    while (!gd_mesh_has_face(mesh, face));
    return face;
}

struct gd_point bench_random_point(const struct gd_mesh *mesh, enum gd_point_kind kind,
                                   struct rng *rng)
{
    struct gd_face face = random_face(mesh, rng);
    double u = rng_unit(rng), v = rng_unit(rng),
           w[3] = {fmin(u, v), fmax(u, v) - fmin(u, v), 1 - fmax(u, v)};
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, face, corners);
    struct gd_detail detail = {0};
    struct gd_point point = {.kind = kind};
    if (kind == GD_POINT_VERTEX)
        bench_require(gd_point_at_vertex(mesh, corners[0], &point, &detail), &detail);
    else if (kind == GD_POINT_EDGE)
        bench_require(gd_point_on_edge(mesh, corners, u, &point, &detail), &detail);
    else
        bench_require(gd_point_in_face(mesh, face, w, &point, &detail), &detail);
    return point;
}

int bench_each_mesh(char **arguments, uint32_t runs,
                    void (*measure)(const char *name, const struct gd_mesh *mesh,
                                    const struct bench_options *options))
{
    struct bench_options options = {.runs = runs};
    if (!bench_take_options(&arguments, &options)) return BENCH_USAGE;
    for (; *arguments; arguments++) {
        struct gd_mesh *mesh = bench_open(*arguments, &options);
        if (!mesh) return EXIT_FAILURE;
        measure(*arguments, mesh, &options);
        gd_mesh_release(mesh);
    }
    return EXIT_SUCCESS;
}
