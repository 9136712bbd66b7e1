/* gd_bench: measurements of the engine, one JSON line each. What its subcommands share. */
#ifndef TESTS_BENCH_BENCH_H
#define TESTS_BENCH_BENCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/point.h"
#include "tests/samples/random.h"

enum { BENCH_USAGE = 2 }; /* exit status; the reason is on standard error already */

/* --- the subcommands: ablation.c, field.c, pair.c. `arguments` ends with NULL; returns the exit status. ------------------ */

int bench_ablation(char **arguments);
int bench_field(char **arguments);
int bench_pair(char **arguments);

/* --- input.c: arguments and meshes --------------------------------------------------------------------------------------- */

/* Takes "NAME NUMBER" from the front of the arguments if it is there. False, after a sentence, when the number is wrong. */
bool bench_take_count(char ***arguments, const char *name, uint32_t *count);

/* Takes the word from the front of the arguments if it is there. */
bool bench_take_word(char ***arguments, const char *word);

/* No option is left, and a mesh is if `wants_mesh`; else false, after a sentence. */
bool bench_arguments_end(char **arguments, bool wants_mesh);

/* A mesh from a file of any format of gd/io.h, or from "sample:NAME[,key=value...]"; the caller releases it. NULL, after a sentence, when
 * there is none. */
struct gd_mesh *bench_open(const char *argument);

/* A random point of that kind on a random face. */
struct gd_point bench_random_point(const struct gd_mesh *mesh, enum gd_point_kind kind, struct rng *rng);

/* --- measure.c: clocks, memory, statistics, output ----------------------------------------------------------------------- */

/* Memory or the end of the program. */
void *bench_allocate(size_t bytes);

/* Ends the program with a sentence unless the status is GD_OK. */
void bench_require(enum gd_status status, const struct gd_detail *detail);

/* Milliseconds since gd_now_ns() was `start`. */
double bench_ms_since(uint64_t start);

/* Milliseconds of processor time that the calling thread has had: on a busy machine the measure of its own work. */
double bench_thread_ms(void);

/* Most memory that the process has had resident until now. */
uint64_t bench_peak_bytes(void);

/* The value that the part `q` of the values doesn't exceed, between neighbours in proportion; sorts them. count > 0. */
double bench_quantile(double *values, uint32_t count, double q);

static inline double bench_median(double *values, uint32_t count)
{
    return bench_quantile(values, count, 0.5);
}

/* Writes `"key":"text",`, the text escaped. */
void bench_print_text(const char *key, const char *text);

#endif
