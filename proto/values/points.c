#include "proto/values/points.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"

#define FIRST_CAPACITY 2
/* limit on the bytes of a compact point; a longer one has useless digits */
#define COMPACT_SIZE 256

void proto_points_free(struct proto_points *points)
{
    free(points->items);
    *points = (struct proto_points){0};
}

static bool refuse_memory(struct proto_problem *problem)
{
    return proto_problem_set(problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                             "there is no memory for the points; try again later");
}

static bool reserve(struct proto_points *points, uint32_t capacity, struct proto_problem *problem)
{
    if (capacity <= points->capacity) return true;
    struct proto_point *items = realloc(points->items, capacity * sizeof *items);
    if (!items) return refuse_memory(problem);
    points->items = items;
    points->capacity = capacity;
    return true;
}

struct proto_point *proto_points_add(struct proto_points *points, struct proto_problem *problem)
{
    uint32_t capacity = points->capacity ? 2 * points->capacity : FIRST_CAPACITY;
    if (points->count == points->capacity && !reserve(points, capacity, problem)) return NULL;
    return &points->items[points->count++];
}

/* --- from the request ------------------------------------------------------------------------- */

static bool refuse_number(const char *place, uint32_t most, struct proto_problem *problem)
{
    return proto_problem_exceed(problem, place, most,
                                "at most %u points are taken here; send fewer", most);
}

bool proto_points_decode(struct proto_points *points, const json_t *value, const char *pointer,
                         uint32_t most, struct proto_problem *problem)
{
    if (!json_is_array(value))
        return proto_problem_refuse(problem, pointer, "expected an array of points here");
    size_t count = json_array_size(value);
    if (count > most) return refuse_number(pointer, most, problem);
    if (!reserve(points, points->count + (uint32_t)count, problem)) return false;
    for (size_t i = 0; i < count; i++) {
        char place[PROTO_KEPT_PLACE];
        snprintf(place, sizeof place, "%s/%zu", pointer, i);
        struct proto_point *point = proto_points_add(points, problem);
        if (!point || !proto_point_decode(json_array_get(value, i), place, point, problem))
            return false;
    }
    return true;
}

bool proto_points_decode_member(struct proto_points *points, const json_t *document,
                                const char *pointer, struct proto_problem *problem)
{
    const json_t *value = proto_decode_member(document, "", pointer + 1, problem);
    struct proto_point *point = value ? proto_points_add(points, problem) : NULL;
    return point && proto_point_decode(value, pointer, point, problem);
}

/* Moves the text before the next semicolon from `*text` to `part`. Returns false if that is too
 * long for a point. */
static bool take_part(const char **text, char part[COMPACT_SIZE])
{
    size_t size = strcspn(*text, ";");
    if (size >= COMPACT_SIZE) return false;
    memcpy(part, *text, size);
    part[size] = '\0';
    *text += size;
    return true;
}

bool proto_points_parse(struct proto_points *points, const char *text, const char *parameter,
                        uint32_t most, struct proto_problem *problem)
{
    for (uint32_t left = most;; left--, text++) {
        char part[COMPACT_SIZE];
        if (!left) return refuse_number(parameter, most, problem);
        if (!take_part(&text, part))
            return proto_problem_refuse(problem, parameter, "a point has too many digits");
        struct proto_point *point = proto_points_add(points, problem);
        if (!point || !proto_point_parse(part, parameter, point, problem)) return false;
        if (!*text) return true;
    }
}

/* --- on the mesh ------------------------------------------------------------------------------ */

void proto_located_points_free(struct proto_located_points *located)
{
    free(located->points);
    *located = (struct proto_located_points){0};
}

bool proto_points_locate(const struct gd_mesh *mesh, const struct proto_points *points,
                         struct proto_located_points *out, struct proto_problem *problem)
{
    struct proto_located_points located = {.mesh = mesh, .count = points->count};
    located.points = malloc(points->count * (sizeof *located.points + sizeof *located.snaps));
    if (!located.points) return refuse_memory(problem);
    located.snaps = (double *)(located.points + points->count);
    for (uint32_t i = 0; i < points->count; i++) {
        if (proto_point_locate(mesh, &points->items[i], &located.points[i], &located.snaps[i],
                               problem))
            continue;
        proto_located_points_free(&located);
        return false;
    }
    *out = located;
    return true;
}

void proto_located_points_encode(struct proto_writer *writer,
                                 const struct proto_located_points *located, uint32_t first,
                                 uint32_t count)
{
    proto_write_array_begin(writer);
    for (uint32_t i = first; i < first + count; i++)
        proto_point_encode(writer, located->mesh, &located->points[i], located->snaps[i]);
    proto_write_array_end(writer);
}
