#include <stdio.h>
#include <malloc.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>
#include <time.h>

#include "gd/workspace.h"
#include "tests/bench/bench.h"

/* the daemon keeps at most this many bytes of freed memory */
#define SPARE_BYTES ((size_t)256 << 20)

const struct gd_control *bench_control(void)
{
    static struct gd_control control;
    if (!control.workspace) {
        control.workspace = gd_workspace_create();
        bench_require(control.workspace ? GD_OK : GD_NO_MEMORY, NULL);
        gd_spare_memory(SPARE_BYTES);
    }
    return &control;
}

void *bench_allocate(size_t bytes)
{
    void *memory = malloc(bytes ? bytes : 1);
    if (memory) return memory;
    fputs("gd_bench: the system is out of memory.\n", stderr);
    exit(EXIT_FAILURE);
}

void bench_require(enum gd_status status, const struct gd_detail *detail)
{
    if (status == GD_OK) return;
    fprintf(stderr, "gd_bench: %s (%s)\n", gd_status_sentence(status), detail ? detail->text : "");
    exit(EXIT_FAILURE);
}

double bench_ms_since(uint64_t start)
{
    return 1e-6 * (double)(gd_now_ns() - start);
}

double bench_thread_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

uint64_t bench_peak_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024 * (uint64_t)usage.ru_maxrss : 0;
}

void bench_forget_peak(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (!file) return;
    fputs("5", file);
    fclose(file);
}

uint64_t bench_resident_bytes(void)
{
    FILE *file = fopen("/proc/self/statm", "r");
    unsigned long long pages = 0;
    if (file && fscanf(file, "%*u %llu", &pages) != 1) pages = 0;
    if (file) fclose(file);
    return pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

static int by_value(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

double bench_quantile(double *values, uint32_t count, double q)
{
    qsort(values, count, sizeof *values, by_value);
    double at = q * (count - 1);
    uint32_t low = (uint32_t)at, high = low + 1 < count ? low + 1 : low;
    return values[low] + (at - low) * (values[high] - values[low]);
}

void bench_print_text(const char *key, const char *text)
{
    printf("\"%s\":\"", key);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            printf("\\%c", *text);
        else if ((unsigned char)*text < 0x20)
            printf("\\u%04x", (unsigned char)*text);
        else
            putchar(*text);
    }
    fputs("\",", stdout);
}

void bench_print_mesh(const char *name, const struct gd_mesh *mesh)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    putchar('{');
    bench_print_text("mesh", name);
    printf("\"vertices\":%u,\"faces\":%u,\"edges\":%u,", summary->vertices, summary->faces,
           summary->edges);
}

void bench_print_end(void)
{
    printf("\"peak_bytes\":%llu}\n", (unsigned long long)bench_peak_bytes());
    fflush(stdout);
}
