#include "tests/support/test.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/region.h"

#define MEGABYTE ((size_t)1 << 20)
#define LIMIT    (10 * MEGABYTE)
#define SPARES   8 /* as in region.c */

/* --- mremap, as strict as in Linux before 6.17 ------------------------------------------------ */

static int moves;

/* Returns whether one mapping holds the whole range. */
static bool is_one_mapping(const void *begin, size_t size)
{
    unsigned long from, to, at = (unsigned long)begin;
    bool found = false;
    char line[512];
    FILE *maps = fopen("/proc/self/maps", "r");
    assert_non_null(maps);
    while (fgets(line, sizeof line, maps))
        found |= sscanf(line, "%lx-%lx", &from, &to) == 2 && from <= at && at + size <= to;
    fclose(maps);
    return found;
}

/* Replaces the C library's mremap: fails unless the range is one mapping, and counts calls. */
void *mremap(void *old, size_t old_size, size_t size, int flags, ...)
{
    va_list rest;
    va_start(rest, flags);
    void *place = va_arg(rest, void *);
    va_end(rest);
    moves++;
    if (is_one_mapping(old, old_size))
        return (void *)syscall(SYS_mremap, old, old_size, size, flags, place);
    errno = EFAULT;
    return MAP_FAILED;
}

/* --- regions ---------------------------------------------------------------------------------- */

static bool is_aligned(const void *p)
{
    return (uintptr_t)p % 64 == 0;
}

/* Writes the offset of each word of [from, to) into this word. check_filled compares these
 * offsets. */
static void fill(char *base, size_t from, size_t to)
{
    for (size_t at = from; at < to; at += sizeof at) memcpy(base + at, &at, sizeof at);
}

static void check_filled(const char *base, size_t size)
{
    for (size_t at = 0; at < size; at += sizeof at) assert_memory_equal(base + at, &at, sizeof at);
}

/* Reserves and fills pieces of increasing size until the next one would exceed `size`. */
static size_t grow(struct gd__region *region, size_t size)
{
    for (size_t piece = 8; region->used + piece <= size; piece += piece / 3 & ~(size_t)7) {
        check_ok(gd__region_reserve(region, piece), NULL);
        assert_true(region->granted >= region->used + piece);
        fill(region->base, region->used, region->used + piece);
        region->used += piece;
        if (piece < 24) piece += 8;
    }
    return region->used;
}

/* A region grows in place up to its expected size. Beyond this size, each growth moves its
 * pages. */
static void grows(void **state)
{
    (void)state;
    struct gd__region region = {0};
    check_ok(gd__region_open(&region, MEGABYTE, NULL), NULL);
    assert_true(is_aligned(region.base));
    assert_int_equal(region.used, 0);
    const char *base = region.base;
    grow(&region, MEGABYTE);
    assert_ptr_equal(region.base, base);
    moves = 0;
    size_t size = grow(&region, 40 * MEGABYTE);
    assert_true(moves >= 3);
    assert_true(size > 20 * MEGABYTE && is_aligned(region.base));
    check_filled(region.base, size);
    gd__region_destroy(&region);
    assert_null(region.base);
    gd__region_destroy(&region); /* destroying it twice is harmless */
}

/* The budget includes the memory that the region's owner holds elsewhere. A refused request changes
 * nothing. */
static void respects_the_budget(void **state)
{
    (void)state;
    struct gd_control control = {.budget_bytes = 10 * MEGABYTE};
    struct gd__budget budget = {.control = &control, .held = 4 * MEGABYTE};
    struct gd__region region = {0};
    check_ok(gd__region_open(&region, MEGABYTE, &budget), NULL);
    /* this request uses exactly the rest of the budget */
    check_ok(gd__region_reserve(&region, 6 * MEGABYTE), NULL);
    region.used = 6 * MEGABYTE;
    struct gd__region before = region;
    assert_int_equal(gd__region_reserve(&region, 8), GD_BUDGET);
    assert_memory_equal(&region, &before, sizeof region);
    check_ok(gd__region_reserve(&region, 0), NULL);
    assert_int_equal(budget.held, control.budget_bytes);
    gd__region_destroy(&region);
    budget.held = 4 * MEGABYTE;
    check_ok(gd__region_open(&region, MEGABYTE, &budget), NULL);
    size_t step = 24 * 100;
    /* the region gets the whole budget, and no byte more */
    while (gd__region_reserve(&region, step) == GD_OK) region.used += step;
    assert_true(region.used + step > 6 * MEGABYTE && region.granted <= 6 * MEGABYTE);
    gd__region_destroy(&region);
}

/* A region that is opened again is empty, has another owner's budget and keeps its address. */
static void reopens_empty(void **state)
{
    (void)state;
    struct gd_control control = {.budget_bytes = 3 * MEGABYTE};
    struct gd__region region = {0};
    check_ok(gd__region_open(&region, MEGABYTE, NULL), NULL);
    grow(&region, 5 * MEGABYTE);
    const char *base = region.base;
    struct gd__budget budget = {.control = &control, .held = 2 * MEGABYTE};
    check_ok(gd__region_open(&region, MEGABYTE, &budget), NULL);
    assert_ptr_equal(region.base, base);
    assert_int_equal(region.used, 0);
    /* the request fails although the region's pages are still mapped */
    assert_int_equal(gd__region_reserve(&region, 2 * MEGABYTE), GD_BUDGET);
    check_filled(region.base, grow(&region, MEGABYTE));
    gd__region_destroy(&region);
}

static void refuses_more_than_the_maximum(void **state)
{
    (void)state;
    struct gd__region region = {0};
    check_ok(gd__region_open(&region, MEGABYTE, NULL), NULL);
    assert_int_equal(gd__region_reserve(&region, GD__REGION_MOST + 8), GD_BUDGET);
    check_filled(region.base, grow(&region, MEGABYTE)); /* smaller sizes still work */
    gd__region_destroy(&region);
}

/* Sets *used to the number of filled bytes. */
static struct gd__kept make_kept(size_t size, size_t *used)
{
    struct gd__region region = {0};
    check_ok(gd__region_open(&region, MEGABYTE, NULL), NULL);
    *used = grow(&region, size);
    struct gd__kept kept = gd__region_close(&region);
    assert_null(region.base);
    return kept;
}

static void closing_keeps_the_content(void **state)
{
    (void)state;
    size_t used;
    struct gd__kept kept = make_kept(5 * MEGABYTE, &used);
    assert_true(kept.base && used > 2 * MEGABYTE && kept.bytes >= used);
    check_filled(kept.base, used);
    gd__region_release(&kept);
    kept = make_kept(0, &used);
    assert_null(kept.base); /* nothing was used */
    gd__region_release(&kept);
}

/* Released memory is kept up to the limit and reused. Without a limit none is kept. */
static void keeps_spare_memory(void **state)
{
    (void)state;
    struct gd__kept kept[12];
    size_t used;
    for (int i = 0; i < 12; i++) kept[i] = make_kept(MEGABYTE, &used);
    gd__region_release(&kept[0]);
    assert_int_equal(gd__region_spare(), 0);
    gd__region_keep_spare(LIMIT);
    for (int i = 1; i < 12; i++) {
        gd__region_release(&kept[i]);
        assert_true(gd__region_spare() >= kept[i].bytes && gd__region_spare() <= LIMIT);
    }
    size_t spare = gd__region_spare();
    struct gd__region region = {0};
    check_ok(gd__region_open(&region, MEGABYTE, NULL), NULL);
    /* the region gets the most recently released memory */
    assert_ptr_equal(region.base, kept[11].base);
    assert_true(region.used == 0 && gd__region_spare() < spare);
    check_filled(region.base, grow(&region, 3 * MEGABYTE));
    gd__region_destroy(&region);
    struct gd__kept large = make_kept(20 * MEGABYTE, &used); /* larger than the limit */
    spare = gd__region_spare();
    gd__region_release(&large);
    assert_true(gd__region_spare() <= spare);
    gd__region_keep_spare(0);
    assert_int_equal(gd__region_spare(), 0);
}

/* Prepared memory has the size of the last region and is backed by pages. Its size and the number
 * of its parts are limited. */
static void prepares_spare_memory(void **state)
{
    (void)state;
    size_t used;
    gd__region_keep_spare(0);
    struct gd__kept kept = make_kept(3 * MEGABYTE, &used);
    assert_false(gd__region_prepare());
    gd__region_keep_spare(LIMIT);
    assert_true(gd__region_prepare());
    assert_int_equal(gd__region_spare(), kept.bytes);
    while (gd__region_prepare()) continue;
    assert_int_equal(gd__region_spare(), LIMIT / kept.bytes * kept.bytes);
    gd__region_keep_spare(100 * MEGABYTE);
    while (gd__region_prepare()) continue;
    assert_int_equal(gd__region_spare(), SPARES * kept.bytes);
    struct gd__region region = {0};
    check_ok(gd__region_open(&region, MEGABYTE, NULL), NULL);
    unsigned char resident = 0;
    assert_int_equal(mincore(region.base, 4096, &resident), 0);
    assert_true(resident & 1);
    assert_true(region.touched == kept.bytes);
    assert_int_equal(gd__region_spare(), (SPARES - 1) * kept.bytes);
    check_filled(region.base, grow(&region, 3 * MEGABYTE));
    gd__region_destroy(&region);
    gd__region_release(&kept);
    gd__region_keep_spare(3 * MEGABYTE / 2);
    assert_false(gd__region_prepare()); /* a region of this size exceeds the limit */
    assert_int_equal(gd__region_spare(), 0);
    gd__region_keep_spare(0);
}

/* Where address space is scarce, a region is smaller and returns GD_NO_MEMORY when it is full. */
static void works_with_little_address_space(void **state)
{
    (void)state;
#if TEST_IS_SANITIZED
    print_message("# not asked under a sanitizer, which needs all address space itself\n");
#else
    struct rlimit before, scarce;
    assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
    scarce = (struct rlimit){.rlim_cur = 200 * MEGABYTE, .rlim_max = before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_AS, &scarce), 0);
    struct gd__region region = {0}, more = {0};
    enum gd_status status = gd__region_open(&region, MEGABYTE, NULL),
                   full = gd__region_reserve(&region, 300 * MEGABYTE);
    size_t size = status ? 0 : grow(&region, 20 * MEGABYTE);
    /* the limit is less than the used address space, so every further mapping fails */
    scarce.rlim_cur = MEGABYTE;
    int limited = setrlimit(RLIMIT_AS, &scarce);
    enum gd_status none = gd__region_open(&more, MEGABYTE, NULL);
    assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
    check_ok(status, NULL);
    assert_int_equal(full, GD_NO_MEMORY);
    check_filled(region.base, size);
    gd__region_destroy(&region);
    assert_int_equal(limited, 0);
    assert_int_equal(none, GD_NO_MEMORY);
    assert_null(more.base);
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grows),
        cmocka_unit_test(respects_the_budget),
        cmocka_unit_test(reopens_empty),
        cmocka_unit_test(refuses_more_than_the_maximum),
        cmocka_unit_test(closing_keeps_the_content),
        cmocka_unit_test(keeps_spare_memory),
        cmocka_unit_test(prepares_spare_memory),
        cmocka_unit_test(works_with_little_address_space),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
