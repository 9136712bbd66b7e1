/* The place of a surface for its landmarks: see landmarks.h. */
#ifndef SERVER_SURFACES_LANDMARK_SLOT_H
#define SERVER_SURFACES_LANDMARK_SLOT_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

struct server_job;
struct server_landmarks;
struct server_landmark_set;

struct server_landmark_slot {                 /* all zero is empty */
    _Atomic(struct server_landmarks *) owner; /* NULL: no search has asked */
    atomic_bool is_closed;
    /* under the owner's lock: */
    struct server_landmark_set *set;          /* NULL: empty */
    TAILQ_ENTRY(server_landmark_slot) by_use; /* while there is a set */
    struct server_job *waiting;               /* the job that builds the set, until it begins */
    bool is_coming;                           /* a job builds or reads a set */
    uint64_t cost_ns;                         /* of the last job */
    uint64_t not_before_ns;                   /* the earliest begin of the next one */
};

/* Empties the slot for good. May be called again. */
void server_landmark_slot_close(struct server_landmark_slot *slot);

#endif
