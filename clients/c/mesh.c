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

struct gdc_point gdc_ray(const double *origin, const double *direction)
{
    return (struct gdc_point){
        .kind = GDC_RAY,
        .number = {origin[0], origin[1], origin[2], direction[0], direction[1], direction[2]}};
}

static json_t *point_json(const struct gdc_point *point)
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
    case GDC_RAY:
        return json_pack("{s:{s:[fff],s:[fff]}}", "ray", "origin", number[0], number[1], number[2],
                         "direction", number[3], number[4], number[5]);
    }
    return NULL;
}

/* Returns a JSON array of points; NULL if memory is short or a number is not finite. */
static json_t *points_json(const struct gdc_point *points, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        if (json_array_append_new(array, point_json(&points[i]))) {
            json_decref(array);
            return NULL;
        }
    return array;
}

/* Returns `json` as text and releases it. Returns NULL if `json` is NULL or memory is short. */
static char *text_of(json_t *json)
{
    char *text = json ? json_dumps(json, JSON_COMPACT) : NULL;
    json_decref(json);
    return text;
}

char *gdc_point_json(const struct gdc_point *point)
{
    return text_of(point_json(point));
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

/* Sends a request for a resource of a mesh. request.path is the part after /v1/meshes/{mesh}. */
static enum gdc_status ask(struct gdc_client *client, const char *mesh, struct gdc_request request,
                           struct gdc_answer *answer, struct gdc_problem *problem)
{
    char *path = gdc__mesh_path(client, mesh, request.path);
    if (!path) return gdc__fail(problem, GDC_NO_MEMORY, "the system is out of memory");
    request.path = path;
    enum gdc_status status = gdc_call(client, &request, answer, problem);
    free(path);
    return status;
}

/* A query of a mesh. Sending the query releases `body`. A NULL body is reported as
 * GDC_NO_MEMORY. */
struct query {
    const char *mesh, *path, *accept;
    json_t *body;
};

static enum gdc_status query_send(struct gdc_client *client, struct query query,
                                  struct gdc_answer *answer, struct gdc_problem *problem)
{
    char *text = text_of(query.body);
    if (!text)
        return gdc__fail(
            problem, GDC_NO_MEMORY,
            "the body cannot be written as JSON: out of memory, or a number that is not finite");
    const struct gdc_request request = {.method = "POST",
                                        .path = query.path,
                                        .body = text,
                                        .body_size = strlen(text),
                                        .accept = query.accept};
    enum gdc_status status = ask(client, query.mesh, request, answer, problem);
    free(text);
    return status;
}

static enum gdc_status query_read(struct gdc_client *client, struct query query, json_t **json,
                                  struct gdc_problem *problem)
{
    struct gdc_answer answer;
    enum gdc_status status = query_send(client, query, &answer, problem);
    return status ? status : gdc__read_json(&answer, json, problem);
}

enum gdc_status gdc_query(struct gdc_client *client, const char *mesh, const char *query,
                          const char *body, struct gdc_answer *answer, struct gdc_problem *problem)
{
    char rest[256];
    snprintf(rest, sizeof rest, "/%s", query);
    return ask(client, mesh,
               (struct gdc_request){
                   .method = "POST", .path = rest, .body = body, .body_size = strlen(body)},
               answer, problem);
}

/* --- meshes ----------------------------------------------------------------------------------- */

static enum gdc_status upload(struct gdc_client *client, const char *mesh, const char *query,
                              struct gdc_request request, struct gdc_problem *problem)
{
    struct gdc_answer answer;
    request.method = "PUT";
    request.path = query;
    request.content_type = BYTES;
    enum gdc_status status = ask(client, mesh, request, &answer, problem);
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
    return gdc_upload_with(client, mesh, &(struct gdc_file){bytes, size}, "repair=split", problem);
}

enum gdc_status gdc_upload_with(struct gdc_client *client, const char *mesh,
                                const struct gdc_file *file, const char *parameters,
                                struct gdc_problem *problem)
{
    size_t size = strlen(parameters) + 2;
    char *query = malloc(size);
    if (!query) return gdc__fail(problem, GDC_NO_MEMORY, "the system is out of memory");
    snprintf(query, size, "?%s", parameters);
    enum gdc_status status =
        upload(client, mesh, query,
               (struct gdc_request){.body = file->bytes, .body_size = file->size}, problem);
    free(query);
    return status;
}

/* Returns a binary PLY file in this machine's byte order; NULL if memory is short. */
static char *write_ply(const struct gdc_arrays *arrays, size_t *size)
{
    static const unsigned short one = 1;
    size_t vertices = arrays->vertex_count * 3 * sizeof(double), row = 1 + 3 * sizeof(uint32_t);
    char head[256];
    int length = snprintf(head, sizeof head,
                          "ply\nformat binary_%s_endian 1.0\nelement vertex %zu\n"
                          "property double x\nproperty double y\nproperty double z\n"
                          "element face %zu\nproperty list uchar uint vertex_indices\nend_header\n",
                          *(const unsigned char *)&one ? "little" : "big", arrays->vertex_count,
                          arrays->face_count);
    *size = (size_t)length + vertices + arrays->face_count * row;
    char *file = malloc(*size), *at = file + length + vertices;
    if (!file) return NULL;
    memcpy(file, head, (size_t)length);
    if (vertices) memcpy(file + length, arrays->vertices, vertices);
    for (size_t i = 0; i < arrays->face_count; i++, at += row) {
        *at = 3;
        memcpy(at + 1, arrays->faces + 3 * i, row - 1);
    }
    return file;
}

enum gdc_status gdc_upload_arrays(struct gdc_client *client, const char *mesh,
                                  const struct gdc_arrays *arrays, struct gdc_problem *problem)
{
    size_t size;
    char *file = write_ply(arrays, &size);
    if (!file) return gdc__fail(problem, GDC_NO_MEMORY, "the system is out of memory");
    enum gdc_status status = gdc_upload(client, mesh, file, size, problem);
    free(file);
    return status;
}

enum gdc_status gdc_list(struct gdc_client *client, const char *prefix, struct gdc_page *page,
                         struct gdc_problem *problem)
{
    char path[PATH_MOST];
    char *escaped = curl_easy_escape(client->curl, prefix ? prefix : "", 0);
    snprintf(path, sizeof path, "/v1/meshes?prefix=%s&", escaped ? escaped : "");
    curl_free(escaped);
    return gdc__turn(client, path, "after", page, problem);
}

/* Returns all bytes of a stream; NULL if it can't be read or memory is short. */
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
        ask(client, mesh, (struct gdc_request){.method = "DELETE", .path = ""}, &answer, problem);
    if (!status) free(answer.body);
    return status;
}

/* --- distances and paths ---------------------------------------------------------------------- */

static enum gdc_status ask_pair(struct gdc_client *client, struct query query,
                                const struct gdc_point ends[2], json_t **answer,
                                struct gdc_problem *problem)
{
    query.body = json_pack("{s:o,s:o}", "from", point_json(&ends[0]), "to", point_json(&ends[1]));
    return query_read(client, query, answer, problem);
}

enum gdc_status gdc_distance(struct gdc_client *client, const char *mesh, struct gdc_point from,
                             struct gdc_point to, double *distance, struct gdc_problem *problem)
{
    json_t *answer;
    enum gdc_status status =
        ask_pair(client, (struct query){.mesh = mesh, .path = "/distance?select=distance"},
                 (const struct gdc_point[]){from, to}, &answer, problem);
    if (status) return status;
    const json_t *value = json_object_get(answer, "distance");
    double found = json_number_value(value);
    if (json_is_null(value))
        status = gdc__fail(problem, GDC_NO_PATH,
                           "no path joins the points: they lie on different components");
    else if (!json_is_number(value))
        status = gdc__fail(problem, GDC_BAD_ANSWER, "the answer has no distance");
    json_decref(answer);
    if (!status) *distance = found;
    return status;
}

/* Returns the coordinates of [[x, y, z], ...]; NULL if the array is empty or memory is short. */
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
        ask_pair(client, (struct query){.mesh = mesh, .path = "/path?select=path&geometry=xyz"},
                 (const struct gdc_point[]){from, to}, &answer, problem);
    if (status) return status;
    const json_t *json = json_object_get(answer, "path");
    struct gdc_path found = {.length = json_number_value(json_object_get(json, "length"))};
    found.xyz = read_corners(json_object_get(json, "points"), &found.count);
    if (json_is_null(json))
        status = gdc__fail(problem, GDC_NO_PATH,
                           "no path joins the points: they lie on different components");
    else if (!found.xyz)
        status = gdc__fail(problem, GDC_BAD_ANSWER,
                           "the answer has no path, or there is no memory for it");
    json_decref(answer);
    if (!status) *path = found;
    return status;
}

/* --- matrices and fields ---------------------------------------------------------------------- */

/* Converts little-endian float64 to this machine's byte order, in place. */
static void to_host_order(unsigned char *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = 0;
        for (int k = 7; k >= 0; k--) bits = bits << 8 | bytes[8 * i + (size_t)k];
        memcpy(bytes + 8 * i, &bits, 8);
    }
}

enum gdc_status gdc_matrix(struct gdc_client *client, const char *mesh,
                           const struct gdc_matrix_points *points, double *distances,
                           struct gdc_problem *problem)
{
    size_t size = points->source_count * points->target_count * sizeof *distances;
    struct gdc_answer answer;
    json_t *body =
        json_pack("{s:o,s:o}", "sources", points_json(points->sources, points->source_count),
                  "targets", points_json(points->targets, points->target_count));
    if (body && points->max_distance > 0)
        json_object_set_new(body, "max_distance", json_real(points->max_distance));
    enum gdc_status status = query_send(
        client, (struct query){.mesh = mesh, .path = "/matrix", .accept = BYTES, .body = body},
        &answer, problem);
    if (status) return status;
    if (answer.size == size) {
        to_host_order((unsigned char *)answer.body, size / sizeof *distances);
        memcpy(distances, answer.body, size);
    } else {
        status = gdc__fail(problem, GDC_BAD_ANSWER, "the matrix has another size");
    }
    free(answer.body);
    return status;
}

static enum gdc_status get_values(struct gdc_client *client, const char *mesh, const char *id,
                                  struct gdc_answer *answer, struct gdc_problem *problem)
{
    char rest[128];
    snprintf(rest, sizeof rest, "/fields/%s/values", id);
    return ask(client, mesh, (struct gdc_request){.method = "GET", .path = rest, .accept = BYTES},
               answer, problem);
}

enum gdc_status gdc_field(struct gdc_client *client, const char *mesh,
                          const struct gdc_point *sources, size_t count, double **values,
                          size_t *value_count, struct gdc_problem *problem)
{
    json_t *made;
    struct gdc_answer answer;
    json_t *body = json_pack("{s:{s:o}}", "set", "points", points_json(sources, count));
    enum gdc_status status = query_read(
        client, (struct query){.mesh = mesh, .path = "/fields", .body = body}, &made, problem);
    if (status) return status;
    const char *id = json_string_value(json_object_get(made, "id"));
    status = id ? get_values(client, mesh, id, &answer, problem)
                : gdc__fail(problem, GDC_BAD_ANSWER, "the answer has no field");
    json_decref(made);
    if (status) return status;
    to_host_order((unsigned char *)answer.body, answer.size / 8);
    *values = (double *)answer.body; /* the body is aligned, because realloc returned it */
    *value_count = answer.size / 8;
    return GDC_OK;
}
