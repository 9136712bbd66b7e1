/* Yielding: when a worker's work goes behind everybody else's (server_place_behind). Figures:
 * server/doc/008.
 *
 * Long work gets what nobody else wants. Where that is less than an eighth of its time, because the
 * machine is full, it comes back among the others for a second, then two, four: it may be slow, but
 * it never starves. Short work stays where it is: somebody waits for it. */
#ifndef SERVER_WORK_YIELDING_H
#define SERVER_WORK_YIELDING_H

#include <stdbool.h>
#include <stdint.h>

/* One worker's, not shared; begun anew with each job. */
struct server_yielding {
    bool is_behind;
    uint64_t not_before_ns;    /* it stays among the others until then */
    uint64_t return_ns;        /* for which it comes back the next time */
    uint64_t since_ns, cpu_ns; /* what its share is measured from */
};

void server_yielding_begin(struct server_yielding *yielding, uint64_t now_ns);

/* Whether it should be behind from now on; to be asked every now and then. `cpu_ns`: the processor
 * time that the thread has had so far. */
bool server_yielding_is_due(struct server_yielding *yielding, uint64_t now_ns, uint64_t cpu_ns);

#endif
