#include "internal.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_MOST 512

#define BYTES "application/octet-stream"

/* --- points ----------------------------------------------------------------------------------- */

struct gdc_point gdc_vertex(unsigned vertex)
{
    return (struct gdc_point){.kind = GDC_VERTEX, .element = {vertex}};
}

struct gdc_point gdc_edge(unsigned from, unsigned to, double t)
{
    return (struct gdc_point){.kind = GDC_EDGE, .element = {from, to}, .number = {t}};
}

struct gdc_point gdc_face(unsigned face, double a, double b, double c)
{
    return (struct gdc_point){.kind = GDC_FACE, .element = {face}, .number = {a, b, c}};
}

struct gdc_point gdc_near(double x, double y, double z)
{
    return (struct gdc_point){.kind = GDC_NEAR, .number = {x, y, z}};
}

json_t *gdc_point_json(const struct gdc_point *point)
{
    const unsigned *element = point->element;
    const double *number = point->number;
    switch (point->kind) {
    case GDC_VERTEX:
        return json_pack("{s:I}", "vertex", (json_int_t)element[0]);
    case GDC_EDGE:
        return json_pack("{s:[II],s:f}", "edge", (json_int_t)element[0], (json_int_t)element[1],
                         "t", number[0]);
    case GDC_FACE:
        return json_pack("{s:I,s:[fff]}", "face", (json_int_t)element[0], "barycentric", number[0],
                         number[1], number[2]);
    case GDC_NEAR:
        return json_pack("{s:[fff]}", "xyz", number[0], number[1], number[2]);
    }
    return NULL;
}

/* --- queries ---------------------------------------------------------------------------------- */

char *gdc__mesh_path(struct gdc_client *client, const char *mesh, const char *rest)
{
    char *name = curl_easy_escape(client->curl, mesh, 0), *path = NULL;
    size_t size = name ? strlen("/v1/meshes/") + strlen(name) + strlen(rest) + 1 : 0;
    if (name) path = malloc(size);
    if (path) snprintf(path, size, "/v1/meshes/%s%s", name, rest);
    curl_free(name);
    return path;
}

/* A request below a mesh. `body` may be NULL. */
static enum gdc_status ask(struct gdc_client *client, const char *mesh, const char *rest,
                           struct gdc_request request, struct gdc_answer *answer,
                           struct gdc_problem *problem)
{
    char *path = gdc__mesh_path(client, mesh, rest);
    if (!path) return gdc__fail(problem, GDC_NO_MEMORY, "the system is out of memory");
    request.path = path;
    enum gdc_status status = gdc_call(client, &request, answer, problem);
    free(path);
    return status;
}

enum gdc_status gdc_query(struct gdc_client *client, const char *mesh, const char *query,
                          const json_t *body, json_t **answer, struct gdc_problem *problem)
{
    char *text = body ? json_dumps(body, JSON_COMPACT) : NULL, rest[256];
    if (!text)
        return gdc__fail(problem, GDC_NO_MEMORY,
                         "the body is no JSON: out of memory, or a number that is not finite");
    struct gdc_answer received;
    snprintf(rest, sizeof rest, "/%s", query);
    enum gdc_status status =
        ask(client, mesh, rest,
            (struct gdc_request){.method = "POST", .body = text, .body_size = strlen(text)},
            &received, problem);
    free(text);
    return status ? status : gdc__read_json(&received, answer, problem);
}

/* --- meshes ----------------------------------------------------------------------------------- */

static enum gdc_status upload(struct gdc_client *client, const char *mesh, const char *query,
                              struct gdc_request request, struct gdc_problem *problem)
{
    struct gdc_answer answer;
    request.method = "PUT";
    request.content_type = BYTES;
    enum gdc_status status = ask(client, mesh, query, request, &answer, problem);
    if (!status) free(answer.body);
    return status;
}

enum gdc_status gdc_upload(struct gdc_client *client, const char *mesh, const void *bytes,
                           size_t size, struct gdc_problem *problem)
{
    return upload(client, mesh, "", (struct gdc_request){.body = bytes, .body_size = size},
                  problem);
}

enum gdc_status gdc_upload_split(struct gdc_client *client, const char *mesh, const void *bytes,
                                 size_t size, struct gdc_problem *problem)
{
    return upload(client, mesh, "?repair=split",
                  (struct gdc_request){.body = bytes, .body_size = size}, problem);
}

enum gdc_status gdc_list(struct gdc_client *client, const char *prefix, const char *after,
                         json_t **page, struct gdc_problem *problem)
{
    char path[PATH_MOST];
    struct gdc_answer answer;
    snprintf(path, sizeof path, "/v1/meshes?prefix=%s%s%s", prefix ? prefix : "",
             after ? "&after=" : "", after ? after : "");
    enum gdc_status status =
        gdc_call(client, &(struct gdc_request){.method = "GET", .path = path}, &answer, problem);
    return status ? status : gdc__read_json(&answer, page, problem);
}

/* All of a stream; NULL: it can't be read, or there is no memory. */
static char *read_all(FILE *file, size_t *size)
{
    size_t capacity = 1 << 16, count = 0;
    char *bytes = malloc(capacity);
    while (bytes && (count += fread(bytes + count, 1, capacity - count, file)) == capacity) {
        char *more = capacity < SIZE_MAX / 2 ? realloc(bytes, 2 * capacity) : NULL;
        if (!more) free(bytes);
        bytes = more;
        capacity *= 2;
    }
    *size = count;
    if (!bytes || !ferror(file)) return bytes;
    free(bytes);
    return NULL;
}

enum gdc_status gdc_upload_file(struct gdc_client *client, const char *mesh, const char *path,
                                struct gdc_problem *problem)
{
    size_t size;
    errno = 0;
    FILE *file = fopen(path, "rb");
    char *bytes = file ? read_all(file, &size) : NULL;
    int error = errno;
    if (file) fclose(file);
    if (!bytes)
        return gdc__fail(problem, GDC_FILE, "%s can't be read: %s", path,
                         strerror(error ? error : ENOMEM));
    enum gdc_status status = gdc_upload(client, mesh, bytes, size, problem);
    free(bytes);
    return status;
}

enum gdc_status gdc_delete(struct gdc_client *client, const char *mesh, struct gdc_problem *problem)
{
    struct gdc_answer answer;
    enum gdc_status status =
        ask(client, mesh, "", (struct gdc_request){.method = "DELETE"}, &answer, problem);
    if (!status) free(answer.body);
    return status;
}

/* --- distances and paths ---------------------------------------------------------------------- */

static enum gdc_status ask_pair(struct gdc_client *client, const char *mesh, const char *query,
                                struct gdc_point from, struct gdc_point to, json_t **answer,
                                struct gdc_problem *problem)
{
    json_t *body = json_pack("{s:o,s:o}", "from", gdc_point_json(&from), "to", gdc_point_json(&to));
    enum gdc_status status = gdc_query(client, mesh, query, body, answer, problem);
    json_decref(body);
    return status;
}

enum gdc_status gdc_distance(struct gdc_client *client, const char *mesh, struct gdc_point from,
                             struct gdc_point to, double *distance, struct gdc_problem *problem)
{
    json_t *answer;
    enum gdc_status status =
        ask_pair(client, mesh, "distance?select=distance", from, to, &answer, problem);
    if (status) return status;
    const json_t *value = json_object_get(answer, "distance");
    double found = json_number_value(value);
    if (json_is_null(value))
        status = gdc__fail(problem, GDC_NO_PATH,
                           "no path joins the points: they are of different components");
    else if (!json_is_number(value))
        status = gdc__fail(problem, GDC_BAD_ANSWER, "the answer has no distance");
    json_decref(answer);
    if (!status) *distance = found;
    return status;
}

/* The corners of [[x, y, z], ...]; NULL: they are none, or there is no memory. */
static double *read_corners(const json_t *points, size_t *count)
{
    size_t size = json_array_size(points);
    double *xyz = size ? malloc(3 * size * sizeof *xyz) : NULL;
    for (size_t i = 0; xyz && i < 3 * size; i++)
        xyz[i] = json_number_value(json_array_get(json_array_get(points, i / 3), i % 3));
    *count = size;
    return xyz;
}

enum gdc_status gdc_shortest_path(struct gdc_client *client, const char *mesh,
                                  struct gdc_point from, struct gdc_point to, struct gdc_path *path,
                                  struct gdc_problem *problem)
{
    json_t *answer;
    enum gdc_status status =
        ask_pair(client, mesh, "path?select=path&geometry=xyz", from, to, &answer, problem);
    if (status) return status;
    const json_t *json = json_object_get(answer, "path");
    struct gdc_path found = {.length = json_number_value(json_object_get(json, "length"))};
    found.xyz = read_corners(json_object_get(json, "points"), &found.count);
    if (!json_is_object(json))
        status = gdc__fail(problem, GDC_NO_PATH,
                           "no path joins the points: they are of different components");
    else if (!found.xyz)
        status = gdc__fail(problem, GDC_BAD_ANSWER,
                           "the answer has no path, or there is no memory for it");
    json_decref(answer);
    if (!status) *path = found;
    return status;
}

/* --- fields ----------------------------------------------------------------------------------- */

/* Of little-endian float64, in their place. */
static void to_host_order(unsigned char *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = 0;
        for (int k = 7; k >= 0; k--) bits = bits << 8 | bytes[8 * i + (size_t)k];
        memcpy(bytes + 8 * i, &bits, 8);
    }
}

static enum gdc_status get_values(struct gdc_client *client, const char *mesh, const char *id,
                                  double **values, size_t *count, struct gdc_problem *problem)
{
    char rest[128];
    struct gdc_answer answer;
    snprintf(rest, sizeof rest, "/fields/%s/values", id);
    enum gdc_status status =
        ask(client, mesh, rest, (struct gdc_request){.method = "GET", .accept = BYTES}, &answer,
            problem);
    if (status) return status;
    to_host_order((unsigned char *)answer.body, answer.size / 8);
    *values = (double *)answer.body; /* from malloc: aligned */
    *count = answer.size / 8;
    return GDC_OK;
}

enum gdc_status gdc_field(struct gdc_client *client, const char *mesh,
                          const struct gdc_point *sources, size_t count, double **values,
                          size_t *value_count, struct gdc_problem *problem)
{
    json_t *points = json_array(), *answer;
    for (size_t i = 0; i < count; i++) json_array_append_new(points, gdc_point_json(&sources[i]));
    json_t *body =
        json_array_size(points) == count ? json_pack("{s:{s:O}}", "set", "points", points) : NULL;
    enum gdc_status status = gdc_query(client, mesh, "fields", body, &answer, problem);
    json_decref(points);
    json_decref(body);
    if (status) return status;
    const char *id = json_string_value(json_object_get(answer, "id"));
    status = id ? get_values(client, mesh, id, values, value_count, problem)
                : gdc__fail(problem, GDC_BAD_ANSWER, "the answer has no field");
    json_decref(answer);
    return status;
}
