/* Preloaded library that makes allocations of a whole process fail (its own, its libraries' and
 * libc's). alloc.py gives the orders in the file ALLOC_CONTROL. The file has a struct control,
 * which both the process and alloc.py map. */
#include "stacks.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>

enum order { ORDER_FINE, ORDER_FRESH, ORDER_LASTING };

struct control {
    /* FRESH makes the first call fail whose call path has not failed yet; LASTING also makes all
     * later calls fail */
    _Atomic uint32_t order;
    _Atomic uint32_t failures; /* number of failures since alloc.py set this to 0 */
    _Atomic int64_t blocks;    /* number of held blocks */
    _Atomic uint32_t step;     /* as in allocator.h, for FRESH and LASTING */
    struct stacks stacks;      /* call paths that have failed */
    struct stacks sites;       /* the return addresses of calls that have failed */
};

static struct control *control;
/* true during this file's own calls, which don't fail */
static __thread bool is_inside __attribute__((tls_model("initial-exec")));

__attribute__((constructor)) static void open_control(void)
{
    const char *path = getenv("ALLOC_CONTROL");
    int file = path ? open(path, O_RDWR | O_CLOEXEC) : -1;
    if (file < 0) return;
    stacks_here(); /* the first call loads the libraries that stacks_here needs */
    void *pages = mmap(NULL, sizeof *control, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (pages != MAP_FAILED) control = pages;
}

/* Adds the call path to the call paths that have failed. Returns whether the call fails. */
static bool is_chosen(uint64_t stack, const void *site)
{
    if (!stacks_add(&control->stacks, stack)) return false;
    return control->step < 2 || control->stacks.count % control->step == 0 ||
           !stacks_has(&control->sites, (uintptr_t)site);
}

static __attribute__((noinline)) bool fails(const void *site)
{
    if (!control || is_inside || control->order == ORDER_FINE) return false;
    is_inside = true;
    bool failed =
        control->failures ? control->order == ORDER_LASTING : is_chosen(stacks_here(), site);
    if (failed) {
        stacks_add(&control->sites, (uintptr_t)site);
        control->failures++;
        errno = ENOMEM;
    }
    is_inside = false;
    return failed;
}

#define FAILS() fails(__builtin_return_address(0))

static void *held(void *block)
{
    if (block && control) control->blocks++;
    return block;
}

/* glibc's own functions, which need no dlsym. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *block);

void *malloc(size_t size)
{
    return FAILS() ? NULL : held(__libc_malloc(size));
}

void *calloc(size_t count, size_t size)
{
    return FAILS() ? NULL : held(__libc_calloc(count, size));
}

void *realloc(void *block, size_t size)
{
    if (FAILS()) return NULL;
    void *moved = __libc_realloc(block, size);
    return block ? moved : held(moved);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return FAILS() ? NULL : held(__libc_memalign(alignment, size));
}

void *memalign(size_t alignment, size_t size)
{
    return FAILS() ? NULL : held(__libc_memalign(alignment, size));
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    if (FAILS()) return ENOMEM;
    void *block = held(__libc_memalign(alignment, size));
    if (block) *out = block;
    return block ? 0 : ENOMEM;
}

void free(void *block)
{
    if (block && control) control->blocks--;
    __libc_free(block);
}

void *mmap(void *at, size_t size, int protection, int flags, int file, off_t offset)
{
    static void *(*real)(void *, size_t, int, int, int, off_t);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "mmap");
    return FAILS() ? MAP_FAILED : real(at, size, protection, flags, file, offset);
}
