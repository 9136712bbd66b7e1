/* Traffic: how densely requests come, for work that would be in their way. Figures: server/doc/008.
 *
 * Time is cut into slots of a tenth of a millisecond. A thread that speaks HTTP marks the slot of
 * each request; who works looks at how many of the slots since his last look were marked. So a
 * request costs one load, mostly, and nobody takes a lock. */
#ifndef SERVER_WORK_TRAFFIC_H
#define SERVER_WORK_TRAFFIC_H

#include <stdbool.h>
#include <stdint.h>

/* A request has come. By any thread. */
void server_traffic_note(uint64_t now_ns);

/* One worker's view, zero at first; not shared. */
struct server_traffic {
    uint64_t looked_slot;
    uint32_t looked_marks;
    bool is_dense;
};

/* True: of late, requests came in most of the slots. Measured anew every ten milliseconds, at the
 * most. */
bool server_traffic_is_dense(struct server_traffic *traffic, uint64_t now_ns);

#endif
