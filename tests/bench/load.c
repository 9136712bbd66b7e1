/* gd_bench load: measures how long it takes to load a mesh from a file. Loading consists of
 * reading, parsing, and building (validation, sides, fans, the hierarchy of boxes). */
#include <stdio.h>
#include <stdlib.h>

#include "gd/io.h"
#include "tests/bench/bench.h"

enum part { READ, PARSE, BUILD, TOTAL, PARTS };
static const char *const part_names[PARTS] = {"read_ms", "parse_ms", "build_ms", "load_ms"};

/* Writes a sample or an altered mesh to a temporary file, as OBJ text. */
static bool write_temporary(const char *argument, const struct bench_options *options, char path[])
{
    struct gd_polygons polygons;
    if (!bench_read(argument, options, &polygons)) return false;
    char *text = NULL;
    size_t size = 0;
    bench_require(gd_write_polygons(&polygons, GD_FORMAT_OBJ, &text, &size), NULL);
    gd_polygons_free(&polygons);
    int descriptor = mkstemp(path);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    bool written = file && fwrite(text, 1, size, file) == size;
    if (file && fclose(file) != 0) written = false;
    if (!written) perror("gd_bench: the temporary file can't be written");
    free(text);
    return written;
}

/* Loads the file; the caller releases the mesh. Returns NULL, after printing a sentence, if it is
 * not a mesh. */
static struct gd_mesh *load(const char *path, const struct bench_options *options, double ms[PARTS],
                            size_t *size)
{
    struct bench_file file;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    uint64_t start = gd_now_ns();
    if (!bench_map_file(path, &file)) return NULL;
    ms[READ] = bench_ms_since(start);
    enum gd_status status = gd_read_polygons(file.bytes, file.size, NULL, &polygons, &detail);
    ms[PARSE] = bench_ms_since(start) - ms[READ];
    *size = file.size;
    bench_unmap_file(&file);
    if (status == GD_OK) {
        struct gd_mesh_options building = {.repair_split = options->repair};
        status = gd_mesh_build_consuming(&polygons, &building, NULL, &mesh, &detail);
        gd_polygons_free(&polygons);
    }
    ms[TOTAL] = bench_ms_since(start);
    ms[BUILD] = ms[TOTAL] - ms[READ] - ms[PARSE];
    if (status)
        fprintf(stderr, "gd_bench: %s: %s (%s)\n", path, gd_status_sentence(status), detail.text);
    return mesh;
}

static void print(const char *name, const struct gd_mesh *mesh, double *ms[PARTS], uint32_t runs,
                  size_t size)
{
    bench_print_mesh(name, mesh);
    printf("\"runs\":%u,\"file_bytes\":%zu,\"mesh_bytes\":%zu,", runs, size, gd_mesh_memsize(mesh));
    for (int part = 0; part < PARTS; part++)
        printf("\"%s\":%.3f,", part_names[part], bench_median(ms[part], runs));
    bench_print_end();
}

static bool measure(const char *name, const char *path, const struct bench_options *options)
{
    uint32_t runs = options->runs;
    double *values = bench_allocate(PARTS * sizeof *values * runs), *ms[PARTS];
    for (int part = 0; part < PARTS; part++) ms[part] = values + (size_t)part * runs;
    struct gd_mesh *mesh = NULL;
    size_t size = 0;
    for (uint32_t run = 0; run < runs && (run == 0 || mesh); run++) {
        double parts[PARTS];
        gd_mesh_release(mesh);
        mesh = load(path, options, parts, &size);
        for (int part = 0; part < PARTS && mesh; part++) ms[part][run] = parts[part];
    }
    if (mesh) print(name, mesh, ms, runs, size);
    gd_mesh_release(mesh);
    free(values);
    return mesh;
}

int bench_load(char **arguments)
{
    struct bench_options options = {.runs = 5};
    if (!bench_take_options(&arguments, &options)) return BENCH_USAGE;
    bool altered = options.levels || options.noise > 0, well = true;
    for (; *arguments && well; arguments++) {
        char path[] = P_tmpdir "/gd_bench_XXXXXX";
        bool temporary = altered || bench_is_sample(*arguments);
        well = !temporary || write_temporary(*arguments, &options, path);
        if (well) well = measure(*arguments, temporary ? path : *arguments, &options);
        if (temporary) remove(path);
    }
    return well ? EXIT_SUCCESS : EXIT_FAILURE;
}
