/* See flights.h. */
#include "server/fields/pending_builds.h"

#include <stdlib.h>

struct server_flight *server_flights_find(const struct server_flights *flights,
                                          const struct server_shelf *shelf,
                                          const struct server_field_key *key)
{
    struct server_flight *found = NULL;
    for (struct server_flight *flight = flights->first; flight; flight = flight->next) {
        if (flight->shelf != shelf || !server_field_key_equal(&flight->key, key)) continue;
        if (!server_field_key_covers(key, &flight->key)) continue;
        if (!found || server_field_key_covers(&flight->key, &found->key)) found = flight;
    }
    return found;
}

struct server_flight *server_flights_start(struct server_flights *flights,
                                           struct server_shelf *shelf,
                                           const struct server_field_key *key)
{
    struct server_flight *flight = malloc(sizeof *flight);
    if (!flight) return NULL;
    *flight = (struct server_flight){.shelf = shelf, .next = flights->first};
    if (!server_field_key_copy(key, &flight->key)) {
        free(flight);
        return NULL;
    }
    flights->first = flight;
    return flight;
}

void server_flight_park(struct server_flight *flight, struct server_job *job)
{
    job->next = flight->parked;
    flight->parked = job;
}

void server_flights_end(struct server_flights *flights, struct server_flight *flight)
{
    struct server_flight **link = &flights->first;
    while (*link != flight) link = &(*link)->next;
    *link = flight->next;
}

struct server_job *server_flight_free(struct server_flight *flight)
{
    struct server_job *parked = flight->parked;
    server_field_key_free(&flight->key);
    free(flight);
    return parked;
}

struct server_job *server_flights_expire(struct server_flights *flights, uint64_t now_ns)
{
    struct server_job *expired = NULL, **end = &expired;
    for (struct server_flight *flight = flights->first; flight; flight = flight->next) {
        *end = server_jobs_expire(&flight->parked, now_ns);
        while (*end) end = &(*end)->next;
    }
    return expired;
}
