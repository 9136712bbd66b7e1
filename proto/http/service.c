#include "proto/http/service.h"

#include "gd/io.h"

#include "proto/json/writer.h"

static void encode_limits(struct proto_writer *writer, const struct proto_service *service)
{
    proto_member_object(writer, "limits");
    proto_member_uint(writer, "max_body_bytes", service->limits.max_body_bytes);
    proto_member_uint(writer, "max_faces", service->limits.max_faces);
    proto_member_uint(writer, "timeout_ms", service->limits.timeout_ms);
    proto_member_uint(writer, "memory_budget_bytes", service->limits.memory_budget_bytes);
    proto_member_uint(writer, "max_answer_bytes", service->limits.max_answer_bytes);
    proto_member_uint(writer, "workers", service->limits.workers);
    proto_write_object_end(writer);
}

static void encode_formats(struct proto_writer *writer)
{
    proto_member_array(writer, "formats");
#define ENCODE_FORMAT(NAME, name, media) proto_write_string(writer, #name);
    GD_FORMAT_MAP(ENCODE_FORMAT)
#undef ENCODE_FORMAT
    proto_write_array_end(writer);
}

static void encode_queries(struct proto_writer *writer, const struct proto_route *routes,
                           size_t count)
{
    proto_member_array(writer, "queries");
    for (size_t i = 0; i < count; i++) {
        if (routes[i].query) proto_write_string(writer, routes[i].query);
    }
    proto_write_array_end(writer);
}

void proto_service_encode(struct proto_writer *writer, const struct proto_service *service)
{
    proto_write_object_begin(writer);
    proto_member_string(writer, "version", service->version);
    encode_limits(writer, service);
    proto_member_object(writer, "capabilities");
    encode_formats(writer);
    encode_queries(writer, service->routes, service->route_count);
    proto_write_object_end(writer);
    proto_write_object_end(writer);
}

void proto_health_encode(struct proto_writer *writer, enum proto_health health, const char *reason)
{
    static const char *const words[] = {[PROTO_HEALTH_OK] = "ok",
                                        [PROTO_HEALTH_STARTING] = "starting",
                                        [PROTO_HEALTH_DRAINING] = "draining",
                                        [PROTO_HEALTH_READ_ONLY] = "read_only",
                                        [PROTO_HEALTH_DEGRADED] = "degraded"};
    proto_write_object_begin(writer);
    proto_member_string(writer, "status", words[health]);
    if (reason) proto_member_string(writer, "reason", reason);
    proto_write_object_end(writer);
}
