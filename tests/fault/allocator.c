#include "tests/fault/allocator.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/types.h>

static struct allocator_book *book;
static struct allocator_order order;
static _Atomic bool armed;
static _Atomic unsigned long calls, failures;
static _Atomic long blocks, mapped;

void allocator_open(struct allocator_book *shared)
{
    book = shared;
    stacks_here(); /* the first call loads the libraries that stacks_here needs */
}

void allocator_arm(struct allocator_order what)
{
    order = what;
    calls = failures = 0;
    armed = true;
}

unsigned long allocator_disarm(void)
{
    armed = false;
    return failures;
}

struct allocator_live allocator_live(void)
{
    return (struct allocator_live){blocks, mapped};
}

/* Adds the call path to the call paths that have failed. Returns whether the call fails. */
static bool is_chosen(uint64_t stack, const void *site)
{
    if (!stacks_add(&book->stacks, stack)) return false;
    return order.step < 2 || book->stacks.count % order.step == 0 ||
           !stacks_has(&book->sites, (uintptr_t)site);
}

/* Returns whether the call from `site` must fail. */
static __attribute__((noinline)) bool fails(const void *site)
{
    if (!armed) return false;
    unsigned long number = ++calls;
    bool failed = order.lasting && failures;
    if (order.nth && number == order.nth) failed = true;
    if (order.fresh && !failures) failed = is_chosen(stacks_here(), site);
    if (!failed) return false;
    stacks_add(&book->sites, (uintptr_t)site);
    failures++;
    errno = ENOMEM;
    return true;
}

#define FAILS() fails(__builtin_return_address(0))

/* Counts the block as held and returns it. */
static void *held(void *block)
{
    if (block) blocks++;
    return block;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
int __real_posix_memalign(void **out, size_t alignment, size_t size);
void __real_free(void *block);
void *__real_mmap(void *at, size_t size, int protection, int flags, int file, off_t offset);
int __real_munmap(void *at, size_t size);
void *__real_mremap(void *at, size_t size, size_t wanted, int flags, ...);

void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
int __wrap_posix_memalign(void **out, size_t alignment, size_t size);
void __wrap_free(void *block);
void *__wrap_mmap(void *at, size_t size, int protection, int flags, int file, off_t offset);
int __wrap_munmap(void *at, size_t size);
void *__wrap_mremap(void *at, size_t size, size_t wanted, int flags, ...);

void *__wrap_malloc(size_t size)
{
    return FAILS() ? NULL : held(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return FAILS() ? NULL : held(__real_calloc(count, size));
}

void *__wrap_realloc(void *block, size_t size)
{
    if (FAILS()) return NULL;
    void *moved = __real_realloc(block, size);
    return block ? moved : held(moved);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return FAILS() ? NULL : held(__real_aligned_alloc(alignment, size));
}

int __wrap_posix_memalign(void **out, size_t alignment, size_t size)
{
    if (FAILS()) return ENOMEM;
    int error = __real_posix_memalign(out, alignment, size);
    if (!error) blocks++;
    return error;
}

void __wrap_free(void *block)
{
    if (block) blocks--;
    __real_free(block);
}

void *__wrap_mmap(void *at, size_t size, int protection, int flags, int file, off_t offset)
{
    if (FAILS()) return MAP_FAILED;
    void *pages = __real_mmap(at, size, protection, flags, file, offset);
    if (pages != MAP_FAILED) mapped += (long)size;
    return pages;
}

int __wrap_munmap(void *at, size_t size)
{
    mapped -= (long)size;
    return __real_munmap(at, size);
}

/* Handles mremap to a target that is already mapped. As on Linux, a failed call has already
 * unmapped the target. */
void *__wrap_mremap(void *at, size_t size, size_t wanted, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    void *to = va_arg(arguments, void *);
    va_end(arguments);
    if (FAILS()) {
        __wrap_munmap(to, wanted);
        return MAP_FAILED;
    }
    void *pages = __real_mremap(at, size, wanted, flags, to);
    if (pages != MAP_FAILED) mapped -= (long)size;
    return pages;
}
