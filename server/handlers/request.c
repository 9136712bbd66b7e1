/* See request.h. */
#include "server/handlers/request.h"

#include <string.h>
#include <strings.h>

#include "server/reply.h"
#include "server/server.h"

bool server_request_name(struct server_exchange *exchange, char name[PROTO_MESH_NAME + 1])
{
    const struct proto_capture *capture = &exchange->match.captures[0];
    struct proto_problem problem;
    if (!proto_mesh_name_check(capture->text, capture->length, &problem)) {
        server_reply_problem(exchange, &problem);
        return false;
    }
    memcpy(name, capture->text, capture->length);
    name[capture->length] = '\0';
    return true;
}

bool server_request_is_plain(struct server_exchange *exchange)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    struct proto_problem problem;
    if (proto_parameters_check(&parameters, NULL, &problem)) return true;
    server_reply_problem(exchange, &problem);
    return false;
}

/* The same for every name, so that it tells nothing of names that exist for others. */
static void reply_absent(struct server_exchange *exchange)
{
    server_reply_refusal(exchange, PROTO_PROBLEM_NOT_FOUND,
                         "there is no mesh of this name; GET /v1/meshes lists those that there are");
}

struct server_surface *server_request_surface(struct server_exchange *exchange)
{
    struct server_store *store = exchange->server->store;
    char name[PROTO_MESH_NAME + 1];
    if (!server_request_name(exchange, name)) return NULL;
    struct server_surface *surface = store->get(store, name);
    if (!surface) reply_absent(exchange);
    return surface;
}

static bool is_json(const char *content_type)
{
    static const char json[] = "application/json";
    if (!content_type) return true;
    size_t size = strcspn(content_type, "; \t");
    return size == strlen(json) && strncasecmp(content_type, json, size) == 0;
}

json_t *server_request_document(const struct server_exchange *exchange, struct proto_problem *problem)
{
    if (is_json(server_exchange_header(exchange, "Content-Type")))
        return proto_decode_document(exchange->body.bytes, exchange->body.size, problem);
    proto_problem_set(problem, PROTO_PROBLEM_UNSUPPORTED_MEDIA_TYPE,
                      "a query is JSON: send it with the header Content-Type: application/json");
    return NULL;
}

struct server_precondition server_request_precondition(const struct server_exchange *exchange)
{
    return (struct server_precondition){.if_match = server_exchange_header(exchange, "If-Match"),
                                        .if_none_match = server_exchange_header(exchange, "If-None-Match")};
}

void server_request_fail(struct server_exchange *exchange, enum server_store_outcome outcome)
{
    switch (outcome) {
    case SERVER_STORE_ABSENT:
        reply_absent(exchange);
        break;
    case SERVER_STORE_PRECONDITION:
        server_reply_refusal(
            exchange, PROTO_PROBLEM_PRECONDITION_FAILED,
            "the mesh is not in the state that If-Match or If-None-Match asks for; get its ETag and try again");
        break;
    case SERVER_STORE_NO_MEMORY:
        server_reply_refusal(exchange, PROTO_PROBLEM_INSUFFICIENT_MEMORY, "the system is out of memory");
        break;
    case SERVER_STORE_CREATED:
    case SERVER_STORE_REPLACED:
    case SERVER_STORE_REMOVED:
        break;
    }
}
