/* See yielding.h. */
#include "server/work/yielding.h"

#define LONG_NS     UINT64_C(50000000)   /* what takes longer is long work */
#define MEASURE_NS  UINT64_C(100000000)  /* over which its share is measured */
#define LEAST_SHARE 8                    /* one part in so many */
#define RETURN_NS   UINT64_C(1000000000) /* for which it comes back, the first time */

void server_yielding_begin(struct server_yielding *yielding, uint64_t now_ns)
{
    *yielding = (struct server_yielding){.not_before_ns = now_ns + LONG_NS, .return_ns = RETURN_NS};
}

static void measure_from(struct server_yielding *yielding, uint64_t now_ns, uint64_t cpu_ns)
{
    yielding->since_ns = now_ns;
    yielding->cpu_ns = cpu_ns;
}

static bool is_starved(const struct server_yielding *yielding, uint64_t now_ns, uint64_t cpu_ns)
{
    return (cpu_ns - yielding->cpu_ns) * LEAST_SHARE < now_ns - yielding->since_ns;
}

bool server_yielding_is_due(struct server_yielding *yielding, uint64_t now_ns, uint64_t cpu_ns)
{
    bool was_behind = yielding->is_behind;
    yielding->is_behind = now_ns >= yielding->not_before_ns;
    if (!yielding->is_behind) return false;
    if (!was_behind) {
        measure_from(yielding, now_ns, cpu_ns);
    } else if (now_ns - yielding->since_ns >= MEASURE_NS) {
        if (is_starved(yielding, now_ns, cpu_ns)) {
            yielding->is_behind = false;
            yielding->not_before_ns = now_ns + yielding->return_ns;
            yielding->return_ns *= 2;
        }
        measure_from(yielding, now_ns, cpu_ns);
    }
    return yielding->is_behind;
}
