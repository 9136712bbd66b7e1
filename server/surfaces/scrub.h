/* Scrub: a thread that reads all stored files, at the configured rate at most and hardly at all
 * while requests are at work, to find damage while a backup may still have the file. A damaged file
 * is logged and goes into quarantine (store.h); an upload of the same bytes repairs it. */
#ifndef SERVER_SURFACES_SCRUB_H
#define SERVER_SURFACES_SCRUB_H

#include <stdint.h>

struct server_registry;
struct server_scrub;
struct server_workers;

/* Starts the thread. The first round begins a minute after the start or after `period_s`, whichever
 * is sooner, each later one `period_s` after the begin of the last. `rate`: bytes a second. The
 * registry's store can verify. All is borrowed. NULL without memory or thread. */
struct server_scrub *server_scrub_create(struct server_registry *registry,
                                         struct server_workers *workers, uint64_t period_s,
                                         uint64_t rate);

/* Stops the thread. NULL is harmless. */
void server_scrub_destroy(struct server_scrub *scrub);

struct server_scrub_statistics {
    uint64_t bytes, files, rounds; /* read, and whole rounds */
    uint64_t faults; /* damaged, missing or unreadable files of the last whole round */
    int64_t ended;   /* the last whole round, seconds since 1970; 0: there was none */
    double progress; /* of the round under way, in [0,1]; 1 between rounds */
};
struct server_scrub_statistics server_scrub_statistics(const struct server_scrub *scrub);

#endif
