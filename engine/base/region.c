#include "base/region.h"

#include <pthread.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>

#define HUGE_PAGE ((size_t)2 << 20)
#define PAGE      ((size_t)4096)
#define STEP      ((size_t)256 << 10) /* the budget is asked for at least so much at a time */
#define LEAST     ((size_t)4 << 20)
#define SPARES    8

static size_t up(size_t size, size_t unit)
{
    return (size + unit - 1) & ~(unit - 1);
}

/* --- memory of released regions --------------------------------------------------------------- */

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static struct gd__kept spare[SPARES];
static uint32_t spare_count;
static size_t spare_bytes, spare_limit;

static void unmap(const struct gd__kept *kept)
{
    munmap(kept->base, kept->reserved);
}

/* Under the lock: gives spares back, the oldest first, until they are within the limits. */
static void trim_spares(uint32_t most)
{
    while (spare_count && (spare_bytes > spare_limit || spare_count > most)) {
        unmap(&spare[0]);
        spare_bytes -= spare[0].bytes;
        spare_count--;
        for (uint32_t i = 0; i < spare_count; i++) spare[i] = spare[i + 1];
    }
}

void gd__region_keep_spare(size_t bytes)
{
    pthread_mutex_lock(&lock);
    spare_limit = bytes;
    trim_spares(SPARES);
    pthread_mutex_unlock(&lock);
}

size_t gd__region_spare(void)
{
    pthread_mutex_lock(&lock);
    size_t bytes = spare_bytes;
    pthread_mutex_unlock(&lock);
    return bytes;
}

void gd__region_release(const struct gd__kept *kept)
{
    if (!kept->base) return;
    pthread_mutex_lock(&lock);
    if (kept->bytes <= spare_limit) {
        trim_spares(SPARES - 1);
        spare[spare_count++] = *kept;
        spare_bytes += kept->bytes;
        trim_spares(SPARES);
    } else {
        unmap(kept);
    }
    pthread_mutex_unlock(&lock);
}

/* The newest spare with that much address space. */
static struct gd__kept take_spare(size_t reserved)
{
    struct gd__kept found = {0};
    pthread_mutex_lock(&lock);
    for (uint32_t i = spare_count; i-- > 0 && !found.base;) {
        if (spare[i].reserved < reserved) continue;
        found = spare[i];
        spare_bytes -= found.bytes;
        spare_count--;
        for (uint32_t k = i; k < spare_count; k++) spare[k] = spare[k + 1];
    }
    pthread_mutex_unlock(&lock);
    return found;
}

/* --- regions ---------------------------------------------------------------------------------- */

/* Address space from a huge page's border on, LEAST or more: only what is touched becomes memory.
 * The first huge page's worth and the rest are two mappings for ever: Linux before 6.17 moves no
 * range that spans several. */
static char *reserve(size_t size)
{
    char *pages = mmap(NULL, size + HUGE_PAGE, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (pages == MAP_FAILED) return NULL;
    char *base = (char *)up((uintptr_t)pages, HUGE_PAGE);
    if (base > pages) munmap(pages, (size_t)(base - pages));
    munmap(base + size, HUGE_PAGE - (size_t)(base - pages));
    madvise(base + HUGE_PAGE, size - HUGE_PAGE, MADV_HUGEPAGE); /* small arrays stay small */
    return base;
}

enum gd_status gd__region_open(struct gd__region *region, size_t most, struct gd__budget *budget)
{
    struct gd__kept have = {
        .base = region->base, .bytes = region->touched, .reserved = region->reserved};
    if (!have.base) have = take_spare(up(most, HUGE_PAGE));
    *region = (struct gd__region){
        .base = have.base, .touched = have.bytes, .reserved = have.reserved, .budget = budget};
    for (size_t size = up(most < LEAST ? LEAST : most, HUGE_PAGE); !region->base; size /= 2) {
        if (size < LEAST) return GD_NO_MEMORY;
        region->reserved = size & ~(HUGE_PAGE - 1);
        region->base = reserve(region->reserved);
    }
    return GD_OK;
}

/* Twice the address space, at another place. The second mapping's pages move along, and it grows on
 * the way, so that it stays one; what is in the first is copied. Where moving fails the kernel may
 * have unmapped the new place already: what lies there now need not be ours. */
static enum gd_status extend(struct gd__region *region, size_t need)
{
    size_t size = region->reserved;
    while (size < need) size *= 2;
    if (need > GD__REGION_MOST) return GD_BUDGET;
    if (size > GD__REGION_MOST) size = GD__REGION_MOST;
    char *base = reserve(size);
    if (!base) return GD_NO_MEMORY;
    if (mremap(region->base + HUGE_PAGE, region->reserved - HUGE_PAGE, size - HUGE_PAGE,
               MREMAP_MAYMOVE | MREMAP_FIXED, base + HUGE_PAGE) == MAP_FAILED) {
        munmap(base, HUGE_PAGE);
        return GD_NO_MEMORY;
    }
    memcpy(base, region->base, region->used < HUGE_PAGE ? region->used : HUGE_PAGE);
    munmap(region->base, HUGE_PAGE);
    region->base = base;
    region->reserved = size;
    return GD_OK;
}

enum gd_status gd__region_reserve(struct gd__region *region, size_t bytes)
{
    size_t need = region->used + bytes;
    if (need <= region->granted) return GD_OK;
    size_t granted = up(need + region->granted / 8, STEP);
    enum gd_status status = gd__budget_take(region->budget, granted - region->granted);
    if (status) status = gd__budget_take(region->budget, (granted = need) - region->granted);
    if (!status && granted > region->reserved) status = extend(region, granted);
    if (status) return status;
    region->granted = granted;
    if (granted > region->touched) region->touched = granted;
    return GD_OK;
}

/* Gives back the pages behind `used`, those of the last huge page too. */
static void trim(const struct gd__region *region, size_t used)
{
    size_t touched = up(region->touched > used ? region->touched : used, HUGE_PAGE);
    if (touched > used) madvise(region->base + used, touched - used, MADV_DONTNEED);
}

struct gd__kept gd__region_close(struct gd__region *region)
{
    size_t used = up(region->used, PAGE);
    struct gd__kept kept = {.base = region->base, .bytes = used, .reserved = region->reserved};
    if (used) {
        trim(region, used);
    } else {
        gd__region_destroy(region);
        kept.base = NULL;
    }
    *region = (struct gd__region){0};
    return kept;
}

void gd__region_destroy(struct gd__region *region)
{
    if (region->base) munmap(region->base, region->reserved);
    *region = (struct gd__region){0};
}
