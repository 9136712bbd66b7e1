/* Service: the daemon's description of itself: GET /v1, /livez, /readyz. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "generated/answers.h"
#include "proto/http/route.h"
#include "proto/json/writer.h"

/* Written by proto_service_encode (generated/answers.h). */
struct proto_service {
    const char *version; /* version of the program */
    struct {
        uint64_t max_body_bytes, max_faces, timeout_ms, memory_budget_bytes, max_answer_bytes,
            workers;
    } limits;
    const struct proto_route *routes; /* the routes whose queries are the capabilities */
    size_t route_count;
};

enum proto_health {
    PROTO_HEALTH_OK,
    PROTO_HEALTH_STARTING,
    PROTO_HEALTH_DRAINING,
    PROTO_HEALTH_READ_ONLY,
    PROTO_HEALTH_DEGRADED
};

/* Writes the state and, unless it is NULL, the reason. */
void proto_health_encode(struct proto_writer *writer, enum proto_health health, const char *reason);
