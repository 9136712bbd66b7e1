/* Scrub: looks through the stored files, one after the other, for what has become damaged since it
 * was written, before somebody asks for it and while there may be a backup that has it still.
 *
 * A thread of its own reads at --scrub-rate at most, and as good as not at all while requests are
 * at work. What it finds damaged is logged and goes into quarantine (store.h); an upload of the
 * same bytes heals it. */
#ifndef SERVER_SURFACES_SCRUB_H
#define SERVER_SURFACES_SCRUB_H

#include <stdint.h>

struct server;
struct server_scrub;

/* Starts the thread: the first round begins a minute after the start, or after --scrub-s if that is
 * sooner, the others each --scrub-s after the one before began. NULL without memory or thread. The
 * server is borrowed. */
struct server_scrub *server_scrub_create(struct server *server);

/* Stops the thread and frees. NULL is harmless. */
void server_scrub_destroy(struct server_scrub *scrub);

struct server_scrub_statistics {
    uint64_t bytes, files, rounds; /* looked through, and how often all were */
    /* files that the last whole round found damaged, missing or unreadable */
    uint64_t faults;
    int64_t ended;   /* when that did, seconds since 1970; 0: there was none */
    double progress; /* of the round under way, in [0,1]; 1 between rounds */
};
struct server_scrub_statistics server_scrub_statistics(const struct server_scrub *scrub);

#endif
