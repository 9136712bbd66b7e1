/* Route: the table of operations, generated from openapi.yaml (`generate.py sources`), and the
 * search for a request's row.
 *
 * The generated source defines proto_routes and proto_route_count. A row's handler is
 * server_handle_<name>, where <name> is the operation's x-handler or else its operationId. Queries
 * about meshes share the handler server_handle_query; their kind is server_query_<name>, which the
 * GET and POST forms of a query share. Rows with a literal segment precede rows that capture the
 * same segment. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/json/problem.h"

/* The server defines these structs; this folder only passes their addresses. */
struct server_exchange;
struct server_query_kind;

/* The key that an operation needs, if the daemon has keys. */
enum proto_access { PROTO_ACCESS_READ, PROTO_ACCESS_WRITE, PROTO_ACCESS_PUBLIC };

enum proto_method {
    PROTO_METHOD_GET,
    PROTO_METHOD_PUT,
    PROTO_METHOD_POST,
    PROTO_METHOD_PATCH,
    PROTO_METHOD_DELETE
};

#define PROTO_ROUTE_METHODS "GET, HEAD, PUT, POST, PATCH, DELETE" /* all, as in Allow */

#define PROTO_ROUTE_SEGMENTS 6
#define PROTO_ROUTE_CAPTURES 2

/* A former name of a path or of a query parameter. A request may use the former name instead of its
 * replacement; the answer then has the header Deprecation. */
struct proto_deprecation {
    const char *name, *replacement; /* for a path, its template */
    int64_t since;                  /* Unix time */
};

struct proto_route {
    enum proto_method method;
    enum proto_access access;
    bool is_follow_up;     /* true if the operation only reads or ends jobs or batches */
    bool has_body;         /* true if the operation accepts a request body */
    bool is_async;         /* true if the operation accepts the header Prefer: respond-async */
    const char *operation; /* operationId */
    const char *path;      /* template, "/v1/meshes/{name}": a label for logs and metrics */
    /* the query's name ("distance"), listed among the capabilities; NULL if not a query */
    const char *query;
    const char *const *fields;     /* fields of the query's answer; NULL means no projection */
    const char *const *parameters; /* parameters of the query string; may be NULL */
    /* true if the answer has lines, whose points `geometry` selects */
    bool has_lines;
    uint32_t segment_count; /* "/" has none */
    /* literal text; NULL means that the segment is captured */
    const char *segments[PROTO_ROUTE_SEGMENTS];
    void (*handle)(struct server_exchange *exchange);
    const struct server_query_kind *kind; /* NULL unless it is a query about a mesh */
    /* deprecation of this path; NULL means that the path is current */
    const struct proto_deprecation *deprecation;
    const struct proto_deprecation *deprecated_parameters; /* ends with name NULL; may be NULL */
    /* path of the page about the current operation; NULL unless the path or a parameter is
     * deprecated */
    const char *documentation;
};

extern const struct proto_route proto_routes[];
extern const size_t proto_route_count;

struct proto_route_match {
    const struct proto_route *route;
    uint32_t capture_count;
    struct proto_capture {
        const char *text; /* points into the given path; not NUL-terminated, never empty */
        size_t length;
    } captures[PROTO_ROUTE_CAPTURES]; /* in path order */
};

/* Finds the row of a request. `method` is that of the request line; HEAD finds the row of GET.
 * `path` is percent-decoded and has no query string; the captures borrow it. Problems: not_found;
 * method_not_allowed, with `allow` set. O(count) comparisons of short strings; thread-safe. */
bool proto_route_find(const struct proto_route *routes, size_t count, const char *method,
                      const char *path, struct proto_route_match *out,
                      struct proto_problem *problem);
