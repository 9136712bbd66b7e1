/* Flights: fields that are being built, each by one, and the jobs that wait for them. Not
 * thread-safe: the cache's lock guards them. */
#ifndef SERVER_FIELDS_PENDING_BUILDS_H
#define SERVER_FIELDS_PENDING_BUILDS_H

#include "server/fields/field_key.h"
#include "server/work/job.h"

struct server_shelf;

struct server_flight {
    struct server_shelf *shelf; /* that it lands on; its starter has the reference */
    struct server_flight *next;
    struct server_field_key key; /* owned */
    struct server_job *parked;
};

struct server_flights { /* all zero is none; as many as jobs can be queued or run at most */
    struct server_flight *first;
};

/* Of the flights to that shelf of that key, reaching no farther, the one that reaches farthest; or
 * NULL. */
struct server_flight *server_flights_find(const struct server_flights *flights,
                                          const struct server_shelf *shelf,
                                          const struct server_field_key *key);

/* A new one with nobody waiting; the key is copied. NULL without memory. */
struct server_flight *server_flights_start(struct server_flights *flights,
                                           struct server_shelf *shelf,
                                           const struct server_field_key *key);

void server_flight_park(struct server_flight *flight, struct server_job *job);

/* Takes the flight out of the list; its parked jobs and its key go with server_flight_free. */
void server_flights_end(struct server_flights *flights, struct server_flight *flight);

/* Frees a flight that has ended and returns the jobs that were parked on it. */
struct server_job *server_flight_free(struct server_flight *flight);

/* Takes the parked jobs that are late out of all flights and returns them as a list. */
struct server_job *server_flights_expire(struct server_flights *flights, uint64_t now_ns);

#endif
