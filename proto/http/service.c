#include "proto/http/service.h"

#include "gd/io.h"

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

void proto_service_encode_capabilities(struct proto_writer *writer,
                                       const struct proto_service *service)
{
    proto_write_object_begin(writer);
    encode_formats(writer);
    encode_queries(writer, service->routes, service->route_count);
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
