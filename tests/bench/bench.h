/* gd_bench: measurements of the engine, one JSON line each. What its subcommands share. */
#ifndef TESTS_BENCH_BENCH_H
#define TESTS_BENCH_BENCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/executor.h"
#include "gd/point.h"
#include "tests/samples/random.h"

enum { BENCH_USAGE = 2 }; /* exit status; the reason is on standard error already */

/* --- the subcommands, each in a source of its name. `arguments` ends with NULL; returns the exit
 * status.  */

int bench_ablation(char **arguments);
int bench_field(char **arguments);
int bench_pair(char **arguments);
int bench_warm(char **arguments);
int bench_locate(char **arguments);
int bench_load(char **arguments);
int bench_nurbs(char **arguments);
int bench_trace(char **arguments);
int bench_limit(char **arguments);
int bench_spline(char **arguments);
int bench_resume(char **arguments);
int bench_curve(char **arguments);
int bench_peer(char **arguments);
int bench_export(char **arguments);

/* --- options.c: arguments --------------------------------------------------------------------- */

/* Takes "NAME NUMBER" from the front of the arguments if it is there. False, after a sentence, when
 * the number is wrong. */
bool bench_take_count(char ***arguments, const char *name, uint32_t *count);

/* Takes "--cpu NAME" from the front of the arguments if it is there, and uses those kernels. False,
 * after a sentence, when there are none such. */
bool bench_take_cpu(char ***arguments);

/* Takes the word from the front of the arguments if it is there. */
bool bench_take_word(char ***arguments, const char *word);

/* No option is left, and a mesh is if `wants_mesh`; else false, after a sentence. */
bool bench_arguments_end(char **arguments, bool wants_mesh);

/* What all subcommands that measure understand. */
struct bench_options {
    uint32_t runs; /* --runs: repetitions; set to the subcommand's default before parsing */
    bool repair;   /* --repair: what is no surface is cut apart, see gd_mesh_options */
    /* --subdivide: so many times every triangle is split at the middles of its edges */
    uint32_t levels;
    /* --noise: then every vertex is moved along its normal by up to so many mean edges */
    double noise;
    uint32_t landmarks; /* --landmarks: built before pairs are solved */
    uint32_t threads;   /* --threads: of one field; 1 */
    /* --distances-only: fields of which the vertices' distances are wanted, no more */
    bool distances_only;
};

/* Takes all options from the front, in any order, pins the process (--pin PROCESSOR) and chooses
 * its kernels (--cpu NAME). A mesh must follow. False, after a sentence, on misuse. */
bool bench_take_options(char ***arguments, struct bench_options *options);

/* --- input.c: meshes -------------------------------------------------------------------------- */

/* Bytes of a mesh file, mapped. */
struct bench_file {
    const void *bytes;
    size_t size;
};

/* False, after a sentence, when it can't be read or is empty. */
bool bench_map_file(const char *path, struct bench_file *file);
void bench_unmap_file(struct bench_file *file);

/* Is it "sample:NAME[,key=value...]"? */
bool bench_is_sample(const char *argument);

/* The polygons of a file of any format of gd/io.h, or of a sample, altered as `options` say; the
 * caller frees them. False, after a sentence, when there are none. */
bool bench_read(const char *argument, const struct bench_options *options, struct gd_polygons *out);

/* The same as a mesh, which the caller releases. NULL, after a sentence, when there is none.
 * `options` may be NULL. */
struct gd_mesh *bench_open(const char *argument, const struct bench_options *options);

/* A random point of that kind on a random face. */
struct gd_point bench_random_point(const struct gd_mesh *mesh, enum gd_point_kind kind,
                                   struct rng *rng);

/* Parses the options, `runs` being the default of --runs, and measures each mesh of the arguments
 * in turn. Returns the exit status. */
int bench_each_mesh(char **arguments, uint32_t runs,
                    void (*measure)(const char *name, const struct gd_mesh *mesh,
                                    const struct bench_options *options));

/* --- measure.c: clocks, memory, statistics, output -------------------------------------------- */

/* What a worker of the daemon works with: a workspace, and memory of released fields that is kept
 * for the next. One for the process; no limits. */
const struct gd_control *bench_control(void);

/* So many threads, the calling one among them; NULL for one. The program ends, after a sentence,
 * when it can't have them. */
const struct gd_executor *bench_executor(uint32_t threads);

/* Memory or the end of the program. */
void *bench_allocate(size_t bytes);

/* Ends the program with a sentence unless the status is GD_OK. */
void bench_require(enum gd_status status, const struct gd_detail *detail);

/* Milliseconds since gd_now_ns() was `start`. */
double bench_ms_since(uint64_t start);

/* Milliseconds of processor time that the calling thread has had: on a busy machine the measure of
 * its own work. */
double bench_thread_ms(void);

/* Most memory that the process has had resident until now, or since the peak was forgotten. */
uint64_t bench_peak_bytes(void);

/* Freed memory goes back, and the peak begins anew with what is resident then, where the system
 * lets it. */
void bench_forget_peak(void);

/* Memory that the process has resident now; 0 where the system does not tell. */
uint64_t bench_resident_bytes(void);

/* The value that the part `q` of the values doesn't exceed, between neighbours in proportion; sorts
 * them. count > 0. */
double bench_quantile(double *values, uint32_t count, double q);

static inline double bench_median(double *values, uint32_t count)
{
    return bench_quantile(values, count, 0.5);
}

/* Writes `"key":"text",`, the text escaped. */
void bench_print_text(const char *key, const char *text);

/* Opens a line's object: the mesh's name and sizes, and a comma. */
void bench_print_mesh(const char *name, const struct gd_mesh *mesh);

/* Closes it: the peak memory, and the line's end. */
void bench_print_end(void);

#endif
