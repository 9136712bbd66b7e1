#include "proto/http/route.h"

#include <stdio.h>
#include <string.h>

/* --- the path --------------------------------------------------------------------------------- */

struct split_path {
    uint32_t count;
    struct proto_capture segments[PROTO_ROUTE_SEGMENTS];
};

/* Splits a path. "/" has no segments; "/a/" has two, the second one empty. Returns false for more
 * segments than any route has and for text that is not a path. */
static bool split(const char *path, struct split_path *out)
{
    out->count = 0;
    if (*path != '/') return false;
    if (path[1] == '\0') return true;
    while (*path == '/') {
        if (out->count == PROTO_ROUTE_SEGMENTS) return false;
        size_t length = strcspn(++path, "/");
        out->segments[out->count++] = (struct proto_capture){path, length};
        path += length;
    }
    return true;
}

static bool is_literal(struct proto_capture segment, const char *text)
{
    return *text == *segment.text && strncmp(text, segment.text, segment.length) == 0 &&
           text[segment.length] == '\0';
}

/* Compares the last segments first, because most routes differ in them. */
static bool may_match(const struct proto_route *route, const struct split_path *path)
{
    if (route->segment_count != path->count) return false;
    const char *last = path->count ? route->segments[path->count - 1] : NULL;
    return !last || is_literal(path->segments[path->count - 1], last);
}

static bool match(const struct proto_route *route, const struct split_path *path,
                  struct proto_route_match *out)
{
    if (!may_match(route, path)) return false;
    out->route = route;
    out->capture_count = 0;
    for (uint32_t i = 0; i < path->count; i++) {
        struct proto_capture segment = path->segments[i];
        if (route->segments[i]) {
            if (!is_literal(segment, route->segments[i])) return false;
        } else if (segment.length == 0 || out->capture_count == PROTO_ROUTE_CAPTURES) {
            return false;
        } else {
            out->captures[out->capture_count++] = segment;
        }
    }
    return true;
}

/* --- the method ------------------------------------------------------------------------------- */

/* The methods in the order of the Allow header. */
static const struct {
    const char *name;
    enum proto_method method;
} methods[] = {
    {"GET", PROTO_METHOD_GET},   {"HEAD", PROTO_METHOD_GET},    {"PUT", PROTO_METHOD_PUT},
    {"POST", PROTO_METHOD_POST}, {"PATCH", PROTO_METHOD_PATCH}, {"DELETE", PROTO_METHOD_DELETE},
};
#define METHODS (sizeof methods / sizeof methods[0])

static uint32_t bit_of(const char *name)
{
    for (size_t i = 0; i < METHODS; i++) {
        if (strcmp(name, methods[i].name) == 0) return UINT32_C(1) << methods[i].method;
    }
    return 0;
}

static bool refuse_method(struct proto_problem *problem, uint32_t allowed)
{
    char allow[PROTO_PROBLEM_ALLOW] = "";
    for (size_t i = 0; i < METHODS; i++) {
        if (!(allowed >> methods[i].method & 1)) continue;
        size_t at = strlen(allow);
        snprintf(allow + at, sizeof allow - at, "%s%s", at ? ", " : "", methods[i].name);
    }
    proto_problem_set(problem, PROTO_PROBLEM_METHOD_NOT_ALLOWED, "this path accepts %s", allow);
    memcpy(problem->allow, allow, sizeof allow);
    return false;
}

bool proto_route_find(const struct proto_route *routes, size_t count, const char *method,
                      const char *path, struct proto_route_match *out,
                      struct proto_problem *problem)
{
    struct split_path segments;
    struct proto_route_match found;
    uint32_t wanted = bit_of(method), allowed = 0;
    if (!split(path, &segments)) count = 0;
    for (size_t i = 0; i < count; i++) {
        if (!match(&routes[i], &segments, &found)) continue;
        uint32_t bit = UINT32_C(1) << routes[i].method;
        if (bit == wanted) {
            *out = found;
            return true;
        }
        allowed |= bit;
    }
    if (allowed) return refuse_method(problem, allowed);
    return proto_problem_set(problem, PROTO_PROBLEM_NOT_FOUND,
                             "there is nothing at this path; /openapi.json lists what there is");
}
