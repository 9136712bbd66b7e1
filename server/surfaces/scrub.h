/* Scrub: a thread that reads all stored files. It finds damage early, while a backup may still have
 * the file. The thread reads at most at the configured rate, and much more slowly while requests
 * run. A damaged file is logged and put into quarantine (store.h); an upload of the same bytes
 * repairs it. */
#pragma once

#include <stdint.h>

struct server_registry;
struct server_scrub;
struct server_workers;

/* Starts the thread. The first round begins after a minute, or after `period_s` if that is sooner.
 * Each later round begins `period_s` after the start of the preceding round. `rate` is the number
 * of bytes a second. The registry's store must have `verify`. Borrows its arguments. Returns NULL
 * if there is no memory or no thread. */
struct server_scrub *server_scrub_create(struct server_registry *registry,
                                         struct server_workers *workers, uint64_t period_s,
                                         uint64_t rate);

/* Stops the thread. NULL is allowed. */
void server_scrub_destroy(struct server_scrub *scrub);

struct server_scrub_statistics {
    uint64_t bytes, files, rounds; /* numbers of bytes and files read, and of complete rounds */
    uint64_t faults; /* damaged, missing or unreadable files of the last complete round */
    int64_t ended;   /* end of the last complete round, seconds since 1970; 0 means none */
    double progress; /* progress of the current round, in [0,1]; 1 between rounds */
};
struct server_scrub_statistics server_scrub_statistics(const struct server_scrub *scrub);
