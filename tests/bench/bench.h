/* gd_bench: measures the engine, and prints one JSON line for each measurement. This header
 * declares what the subcommands share. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/point.h"
#include "tests/samples/random.h"

enum { BENCH_USAGE = 2 }; /* exit status after misuse; the reason was printed to standard error */

/* --- the subcommands. Each has its own source file of the same name. `arguments` ends with NULL. A
 * subcommand returns its exit status. */

int bench_field(char **arguments);
int bench_pair(char **arguments);
int bench_warm(char **arguments);
int bench_locate(char **arguments);
int bench_load(char **arguments);
int bench_nurbs(char **arguments);
int bench_trace(char **arguments);
int bench_limit(char **arguments);
int bench_spline(char **arguments);
int bench_curve(char **arguments);
int bench_peer(char **arguments);
int bench_export(char **arguments);

/* --- options.c: arguments --------------------------------------------------------------------- */

/* Removes "NAME NUMBER" from the front of the arguments if it is there. Returns false, after
 * printing a sentence, if the number is wrong. */
bool bench_take_count(char ***arguments, const char *name, uint32_t *count);

/* Removes "--cpu NAME" from the front of the arguments if it is there, and selects those kernels.
 * Returns false, after printing a sentence, if they don't exist. */
bool bench_take_cpu(char ***arguments);

/* Removes the word from the front of the arguments. Returns false if the first argument is another
 * word. */
bool bench_take_word(char ***arguments, const char *word);

/* Checks that no option remains, and that a mesh remains if `wants_mesh`. Otherwise prints a
 * sentence and returns false. */
bool bench_arguments_end(char **arguments, bool wants_mesh);

/* Options of all subcommands that measure. */
struct bench_options {
    uint32_t runs; /* --runs: repetitions; set to the subcommand's default before parsing */
    bool repair;   /* --repair: separate non-manifold parts, see gd_mesh_options */
    /* --subdivide: number of times that every triangle is split at the midpoints of its edges */
    uint32_t levels;
    /* --noise: largest distance by which every vertex is then moved along its normal, in mean edge
       lengths */
    double noise;
    /* --landmarks: number of landmarks that are built before pairs are solved */
    uint32_t landmarks;
    /* --distances-only: fields that keep only the vertices' distances */
    bool distances_only;
};

/* Removes all options from the front, in any order. Pins the process (--pin PROCESSOR) and selects
 * the kernels (--cpu NAME), if these options are there. A mesh must follow the options. Returns
 * false, after printing a sentence, on misuse. */
bool bench_take_options(char ***arguments, struct bench_options *options);

/* --- input.c: meshes -------------------------------------------------------------------------- */

/* The mapped bytes of a mesh file. */
struct bench_file {
    const void *bytes;
    size_t size;
};

/* Maps a file. Returns false, after printing a sentence, if it is unreadable or empty. */
bool bench_map_file(const char *path, struct bench_file *file);
void bench_unmap_file(struct bench_file *file);

/* Returns whether the argument has the form "sample:NAME[,key=value...]". */
bool bench_is_sample(const char *argument);

/* Reads the polygons of a file of any format of gd/io.h, or of a sample, altered as `options` say.
 * The caller frees them. Returns false, after printing a sentence, on failure. */
bool bench_read(const char *argument, const struct bench_options *options, struct gd_polygons *out);

/* Like bench_read, but builds a mesh, which the caller releases. Returns NULL, after printing a
 * sentence, on failure. `options` may be NULL. */
struct gd_mesh *bench_open(const char *argument, const struct bench_options *options);

/* Returns a random point of that kind on a random face. */
struct gd_point bench_random_point(const struct gd_mesh *mesh, enum gd_point_kind kind,
                                   struct rng *rng);

/* Parses the options, with `runs` as the default of --runs, and measures each mesh of the arguments
 * in turn. Returns the exit status. */
int bench_each_mesh(char **arguments, uint32_t runs,
                    void (*measure)(const char *name, const struct gd_mesh *mesh,
                                    const struct bench_options *options));

/* --- measure.c: clocks, memory, statistics, output -------------------------------------------- */

/* Returns a control like that of a daemon's worker: it has a workspace, and the memory of released
 * fields is kept for later fields. The process has one such control, without limits. */
const struct gd_control *bench_control(void);

/* Allocates memory, or ends the program. */
void *bench_allocate(size_t bytes);

/* Prints a sentence and ends the program unless the status is GD_OK. */
void bench_require(enum gd_status status, const struct gd_detail *detail);

/* Returns the milliseconds since gd_now_ns() was `start`. */
double bench_ms_since(uint64_t start);

/* Returns the milliseconds of processor time of the calling thread. Unlike elapsed time, processor
 * time also measures the thread's work on a busy machine. */
double bench_thread_ms(void);

/* Returns the largest resident memory of the process so far, or since bench_forget_peak. */
uint64_t bench_peak_bytes(void);

/* Returns freed memory to the system and, if the system permits, resets the peak to the current
 * resident memory. */
void bench_forget_peak(void);

/* Returns the current resident memory; 0 if the system does not report it. */
uint64_t bench_resident_bytes(void);

/* Sorts the values and returns their quantile `q`, interpolated linearly. `count` must be greater
 * than 0. */
double bench_quantile(double *values, uint32_t count, double q);

static inline double bench_median(double *values, uint32_t count)
{
    return bench_quantile(values, count, 0.5);
}

/* Writes `"key":"text",` and escapes the text. */
void bench_print_text(const char *key, const char *text);

/* Opens the JSON object of a line, and writes the mesh's name and sizes and a comma. */
void bench_print_mesh(const char *name, const struct gd_mesh *mesh);

/* Writes the peak memory and closes the line's object. */
void bench_print_end(void);
