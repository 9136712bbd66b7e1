#include "base/region.h"

#include <pthread.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>

#include "base/large.h"

#define PAGE   ((size_t)4096)
#define STEP   ((size_t)256 << 10) /* smallest number of bytes charged to the budget at a time */
#define LEAST  ((size_t)4 << 20)
#define SPARES 8

static size_t region_up(size_t size, size_t unit)
{
    return (size + unit - 1) & ~(unit - 1);
}

/* --- memory of released regions --------------------------------------------------------------- */

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static struct gd__kept spare[SPARES];
static uint32_t spare_count;
static size_t spare_bytes, spare_limit;
static struct gd__kept latest; /* the sizes of the last closed region; `base` is NULL */

static void unmap(const struct gd__kept *kept)
{
    munmap(kept->base, kept->reserved);
}

/* Frees the oldest spares until their bytes and their number are within the limits. The lock is
 * held. */
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

/* Removes and returns the newest spare with at least `reserved` bytes of address space. */
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

/* Reserves address space of at least LEAST bytes, aligned to a huge page. Only pages that are
 * accessed take memory. The first huge page and the rest are two mappings. Each must remain one
 * mapping, because Linux before 6.17 cannot move a range of several mappings. */
static char *region_reserve(size_t size)
{
    char *pages = mmap(NULL, size + GD__HUGE_PAGE, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (pages == MAP_FAILED) return NULL;
    char *base = (char *)region_up((uintptr_t)pages, GD__HUGE_PAGE);
    if (base > pages) munmap(pages, (size_t)(base - pages));
    munmap(base + size, GD__HUGE_PAGE - (size_t)(base - pages));
    /* huge pages would waste memory for small arrays, so the first huge page is excluded */
    madvise(base + GD__HUGE_PAGE, size - GD__HUGE_PAGE, MADV_HUGEPAGE);
    return base;
}

enum gd_status gd__region_open(struct gd__region *region, size_t most, struct gd__budget *budget)
{
    struct gd__kept have = {
        .base = region->base, .bytes = region->touched, .reserved = region->reserved};
    if (!have.base) have = take_spare(region_up(most, GD__HUGE_PAGE));
    *region = (struct gd__region){
        .base = have.base, .touched = have.bytes, .reserved = have.reserved, .budget = budget};
    for (size_t size = region_up(most < LEAST ? LEAST : most, GD__HUGE_PAGE); !region->base;
         size /= 2) {
        if (size < LEAST) return GD_NO_MEMORY;
        region->reserved = size & ~(GD__HUGE_PAGE - 1);
        region->base = region_reserve(region->reserved);
    }
    return GD_OK;
}

/* Moves the region to a range of address space that is at least twice as large. The second mapping
 * moves with its pages and grows, so it stays one mapping; the first one is copied. If the move
 * fails, the kernel may have unmapped the new range, so it is not unmapped again. */
static enum gd_status extend(struct gd__region *region, size_t need)
{
    size_t size = region->reserved;
    while (size < need) size *= 2;
    if (need > GD__REGION_MOST) return GD_BUDGET;
    if (size > GD__REGION_MOST) size = GD__REGION_MOST;
    char *base = region_reserve(size);
    if (!base) return GD_NO_MEMORY;
    if (mremap(region->base + GD__HUGE_PAGE, region->reserved - GD__HUGE_PAGE, size - GD__HUGE_PAGE,
               MREMAP_MAYMOVE | MREMAP_FIXED, base + GD__HUGE_PAGE) == MAP_FAILED) {
        munmap(base, GD__HUGE_PAGE);
        return GD_NO_MEMORY;
    }
    memcpy(base, region->base, region->used < GD__HUGE_PAGE ? region->used : GD__HUGE_PAGE);
    munmap(region->base, GD__HUGE_PAGE);
    region->base = base;
    region->reserved = size;
    return GD_OK;
}

enum gd_status gd__region_reserve(struct gd__region *region, size_t bytes)
{
    size_t need = region->used + bytes;
    if (need <= region->granted) return GD_OK;
    size_t granted = region_up(need + region->granted / 8, STEP);
    enum gd_status status = gd__budget_take(region->budget, granted - region->granted);
    if (status) status = gd__budget_take(region->budget, (granted = need) - region->granted);
    if (!status && granted > region->reserved) status = extend(region, granted);
    if (status) return status;
    region->granted = granted;
    if (granted > region->touched) region->touched = granted;
    return GD_OK;
}

/* Returns the pages after the first `used` bytes to the system, even if this splits a huge page. */
static void region_trim(const struct gd__region *region, size_t used)
{
    size_t touched = region_up(region->touched > used ? region->touched : used, GD__HUGE_PAGE);
    if (touched > used) madvise(region->base + used, touched - used, MADV_DONTNEED);
}

struct gd__kept gd__region_close(struct gd__region *region)
{
    size_t used = region_up(region->used, PAGE);
    struct gd__kept kept = {.base = region->base, .bytes = used, .reserved = region->reserved};
    if (used) {
        region_trim(region, used);
        pthread_mutex_lock(&lock);
        latest = (struct gd__kept){.bytes = used, .reserved = region->reserved};
        pthread_mutex_unlock(&lock);
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

/* --- memory that is touched ahead ------------------------------------------------------------- */

/* Returns the sizes of the spare to be prepared, or zeros if no spare must be prepared. */
static struct gd__kept spare_wanted(void)
{
    struct gd__kept wanted = {0};
    pthread_mutex_lock(&lock);
    if (spare_count < SPARES && spare_bytes + latest.bytes <= spare_limit) wanted = latest;
    pthread_mutex_unlock(&lock);
    return wanted;
}

bool gd__region_prepare(void)
{
    struct gd__kept made = spare_wanted();
    made.base = made.bytes ? region_reserve(made.reserved) : NULL;
    if (!made.base) return false;
    for (size_t at = 0; at < made.bytes; at += PAGE) *(volatile char *)(made.base + at) = 0;
    gd__region_release(&made);
    return true;
}
