/* Route: the table of operations, generated from openapi.yaml (`generate.py routes`), and how a
 * request finds its row.
 *
 * The generated source defines proto_routes and proto_route_count. A row's handler is
 * server_handle_<name>, where <name> is the operation's x-handler or else its operationId. Queries
 * about meshes share the handler server_handle_query; their kind is server_query_<name>, the same
 * for the GET and POST forms of one query. Rows with literal segments stand before rows that
 * capture in the same place. */
#ifndef PROTO_ROUTE_H
#define PROTO_ROUTE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/json/problem.h"

/* the server's own; only their addresses pass through here */
struct server_exchange;
struct server_query_kind;

/* Which key an operation needs, where keys are needed. */
enum proto_access { PROTO_ACCESS_READ, PROTO_ACCESS_WRITE, PROTO_ACCESS_PUBLIC };

enum proto_method { PROTO_METHOD_GET, PROTO_METHOD_PUT, PROTO_METHOD_POST, PROTO_METHOD_DELETE };

#define PROTO_ROUTE_SEGMENTS 6
#define PROTO_ROUTE_CAPTURES 2

/* A former name of a path or of a query parameter. It works as its replacement does, and the answer
 * says so. */
struct proto_deprecation {
    const char *name, *replacement; /* of paths: templates */
    int64_t since;                  /* Unix time */
};

struct proto_route {
    enum proto_method method;
    enum proto_access access;
    bool has_body;         /* the operation takes a request body */
    bool is_async;         /* it takes the header Prefer: respond-async */
    const char *operation; /* operationId */
    const char *path;      /* template, "/v1/meshes/{name}": a label for logs and metrics */
    /* the query's name ("distance"), listed among the capabilities; NULL: no query */
    const char *query;
    const char *const *fields;                  /* of its answer; NULL: there is no projection */
    const char *const *parameters;              /* of the query string; NULL: none */
    uint32_t segment_count;                     /* "/" has none */
    const char *segments[PROTO_ROUTE_SEGMENTS]; /* literal text, or NULL: captures */
    void (*handle)(struct server_exchange *exchange);
    const struct server_query_kind *kind;                  /* of a query about a mesh; else NULL */
    const struct proto_deprecation *deprecation;           /* of this path; NULL: it is current */
    const struct proto_deprecation *deprecated_parameters; /* ends with name NULL; NULL: none */
    /* path of the page about the current operation; set if any of the two above is */
    const char *documentation;
};

extern const struct proto_route proto_routes[];
extern const size_t proto_route_count;

struct proto_route_match {
    const struct proto_route *route;
    uint32_t capture_count;
    struct proto_capture {
        const char *text; /* within the path that was given; not NUL-terminated, never empty */
        size_t length;
    } captures[PROTO_ROUTE_CAPTURES]; /* in the order of the path */
};

/* Finds the row of a request. `method` as in the request line; HEAD finds the row of GET. `path`:
 * without query string, percent-decoded, borrowed by the captures. not_found; method_not_allowed
 * with `allow` set. O(count) comparisons of short strings; thread-safe. */
bool proto_route_find(const struct proto_route *routes, size_t count, const char *method,
                      const char *path, struct proto_route_match *out,
                      struct proto_problem *problem);

#endif
