/* Exact geodesics on surfaces, from a geodesicd daemon. This header is C99; the library needs
 * libcurl and jansson. geodesicd.hpp is for C++.
 *
 *     struct gdc_client *client = gdc_client_create(NULL, NULL);
 *     struct gdc_problem problem = {0};
 *     double distance;
 *     if (gdc_upload_file(client, "bunny", "bunny.obj", &problem) == GDC_OK &&
 *         gdc_distance(client, "bunny", gdc_vertex(12), gdc_near(0.01, 0.12, 0.03), &distance,
 *                      &problem) == GDC_OK) {
 *         printf("%g\n", distance);
 *     } else {
 *         fprintf(stderr, "%s\n", problem.detail);
 *     }
 *     gdc_client_destroy(client);
 *
 * A client is one connection, which stays open between requests. Only one thread at a time may use
 * a client; different clients are independent. Output parameters come last. A function that fails
 * leaves its outputs unchanged, except `problem`, which may be NULL. Call curl_global_init before
 * you start threads that use clients. */
#ifndef GEODESICD_H
#define GEODESICD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum gdc_status {
    GDC_OK,
    GDC_PROBLEM,       /* the daemon reports an error: see struct gdc_problem */
    GDC_NO_CONNECTION, /* the daemon did not answer */
    GDC_BAD_ANSWER,    /* the answer does not match the contract */
    GDC_NO_PATH,       /* the points lie on different components */
    GDC_FILE,          /* the file can't be read */
    GDC_CANCELLED,     /* the progress function or another client cancelled */
    GDC_NO_MEMORY
};

/* Describes why a call failed. */
struct gdc_problem {
    int status; /* HTTP status; 0 without an answer */
    /* error code of the contract: invalid_request, invalid_mesh, not_found, ...; "" without one */
    char code[32];
    char pointer[128]; /* JSON Pointer into the request's body; "" without one */
    char detail[1024]; /* a sentence that says what to change */
};

/* One connection to a daemon, with its settings. */
struct gdc_client;

/* Returns a new client, or NULL if memory is short. `url` is http://HOST:PORT, https://HOST:PORT or
 * unix:PATH. NULL selects $GEODESICD_URL, or http://127.0.0.1:8080 if that is not set. `key` is the
 * access key, if the daemon requires one. NULL selects $GEODESICD_KEY, if it is set. The client
 * copies both texts. */
struct gdc_client *gdc_client_create(const char *url, const char *key);
/* Closes the connection and frees the client. Ignores NULL. */
void gdc_client_destroy(struct gdc_client *client);

/* Sets how often the client repeats a request if the daemon is busy (429, 503) or the connection
 * fails; the default is 5. Between attempts the client waits as long as the Retry-After header
 * says, and does not repeat the request if that is longer than two minutes. Without this header,
 * the pauses grow exponentially. */
void gdc_client_set_retries(struct gdc_client *client, unsigned retries);
/* Sets the number of seconds after which a request fails if the connection is not open or no byte
 * arrives; the default is 120. */
void gdc_client_set_timeout(struct gdc_client *client, long seconds);

/* Receives the progress of a job, in [0,1], several times a second. Returns nonzero to cancel the
 * job. */
typedef int (*gdc_progress)(void *user, double progress);

/* Sets the progress function. With a progress function the client sends POST and PUT requests as
 * jobs and waits for their results. With NULL, requests do not run as jobs. */
void gdc_client_set_progress(struct gdc_client *client, gdc_progress progress, void *user);

/* --- requests of any kind --------------------------------------------------------------------- */

/* A request. The client borrows all pointers during the call. */
struct gdc_request {
    /* "POST", "/v1/meshes/bunny/trace?geometry=xyz"; the path is URL-encoded */
    const char *method, *path;
    const void *body; /* NULL if the request has no body */
    size_t body_size;
    const char *content_type; /* NULL means application/json */
    const char *accept;       /* NULL means application/json */
    /* nonzero if each request creates something new, as POST /v1/batches does; if the connection
     * then fails after it was opened, or the daemon refuses the request without Retry-After, the
     * client does not repeat the request */
    int once;
};

/* An answer with a status below 400. */
struct gdc_answer {
    int status;
    char *body; /* the caller frees it with gdc_free; a NUL follows the last byte */
    size_t size;
};

/* Sends a request and reads its answer. Errors: GDC_PROBLEM, GDC_NO_CONNECTION, GDC_CANCELLED,
 * GDC_BAD_ANSWER (of a job), GDC_NO_MEMORY. */
enum gdc_status gdc_call(struct gdc_client *client, const struct gdc_request *request,
                         struct gdc_answer *answer, struct gdc_problem *problem);

/* Blocks until the job with this id has ended, and reads its answer. The job may belong to another
 * client. Calls the progress function as gdc_call does. Errors: those of gdc_call. */
enum gdc_status gdc_job_wait(struct gdc_client *client, const char *id, struct gdc_answer *answer,
                             struct gdc_problem *problem);

/* Sends any query of the contract: posts `body` to /v1/meshes/{mesh}/{query}. Body and answer are
 * JSON. Errors: those of gdc_call. */
enum gdc_status gdc_query(struct gdc_client *client, const char *mesh, const char *query,
                          const char *body, struct gdc_answer *answer, struct gdc_problem *problem);

/* Frees memory that a function of this header returned. Ignores NULL. */
void gdc_free(void *memory);

/* --- points ----------------------------------------------------------------------------------- */

enum gdc_point_kind { GDC_VERTEX, GDC_EDGE, GDC_FACE, GDC_NEAR, GDC_RAY };

/* A point of a surface in a request. */
struct gdc_point {
    enum gdc_point_kind kind;
    unsigned element[2]; /* the vertex; the two vertices of the edge; or the face */
    /* GDC_EDGE: fraction t of the edge, from its first vertex; GDC_FACE: barycentric coordinates;
     * GDC_NEAR: a point in space; GDC_RAY: origin and direction */
    double number[6];
};

struct gdc_point gdc_vertex(unsigned vertex);
struct gdc_point gdc_edge(unsigned from, unsigned to, double t);
struct gdc_point gdc_face(unsigned face, double a, double b, double c);
/* Returns the surface point that is nearest to a point in space. */
struct gdc_point gdc_near(double x, double y, double z);
/* Returns the first surface point that the ray hits. Origin and direction are three doubles each;
 * both are copied. */
struct gdc_point gdc_ray(const double *origin, const double *direction);

/* Returns the point as JSON text for bodies of gdc_query; the caller frees it with gdc_free.
 * Returns NULL if memory is short or a number is not finite. */
char *gdc_point_json(const struct gdc_point *point);

/* --- meshes ----------------------------------------------------------------------------------- */

/* Creates or replaces the mesh with this name from the bytes of a file (OBJ, PLY, STL, OFF, JSON,
 * glTF or 3MF). Errors: those of gdc_call; GDC_PROBLEM has the code invalid_mesh if the mesh is not
 * a valid surface. */
enum gdc_status gdc_upload(struct gdc_client *client, const char *mesh, const void *bytes,
                           size_t size, struct gdc_problem *problem);
/* Like gdc_upload, but with repair=split: separates the mesh where it is not manifold, such as at
 * an edge with three faces. */
enum gdc_status gdc_upload_split(struct gdc_client *client, const char *mesh, const void *bytes,
                                 size_t size, struct gdc_problem *problem);
/* Like gdc_upload, but also sends URL-encoded parameters of the contract, such as "repair=split" or
 * "fill=1000&simplify=50000". */
struct gdc_file {
    const void *bytes; /* borrowed */
    size_t size;
};
enum gdc_status gdc_upload_with(struct gdc_client *client, const char *mesh,
                                const struct gdc_file *file, const char *parameters,
                                struct gdc_problem *problem);

/* Creates the mesh `name` from `mesh` by applying a JSON array of operations in order:
 * [{"operation": "simplify", "faces": 10000}]. Errors: those of gdc_query. */
enum gdc_status gdc_derive(struct gdc_client *client, const char *mesh, const char *name,
                           const char *operations, struct gdc_problem *problem);

/* Applies the operations as gdc_derive does. Then stores each component of the result as a separate
 * mesh with the name NAME-1, NAME-2 and so on, by decreasing area. There may be at most 64
 * components. Errors: those of gdc_query. */
enum gdc_status gdc_split(struct gdc_client *client, const char *mesh, const char *name,
                          const char *operations, struct gdc_problem *problem);

/* Reads a simplified mesh for display, with about `faces` faces, as a GLB file. The caller frees
 * the body with gdc_free. Blocks until the daemon has built the file, and calls the progress
 * function twice a second. Errors: those of gdc_call. */
enum gdc_status gdc_preview(struct gdc_client *client, const char *mesh, unsigned faces,
                            struct gdc_answer *answer, struct gdc_problem *problem);

/* Like gdc_upload, but the mesh is given as arrays. `vertices` has rows of three coordinates;
 * `faces` has rows of three vertex indices, which begin at 0. Both are borrowed. */
struct gdc_arrays {
    const double *vertices;
    size_t vertex_count;
    const uint32_t *faces;
    size_t face_count;
};
enum gdc_status gdc_upload_arrays(struct gdc_client *client, const char *mesh,
                                  const struct gdc_arrays *arrays, struct gdc_problem *problem);

/* A page of a list. Pass a struct of zeros to the first call, and the same struct to each further
 * call. A further call frees `json` and reads the next page into the struct. A call that fails
 * leaves the page unchanged. */
struct gdc_page {
    char *json;     /* the caller frees the last text with gdc_free */
    char next[128]; /* the position at which the next page begins; "" after the last page */
};
/* Reads a page of the meshes whose names begin with `prefix` (NULL means all): {"meshes":
 * [...]}. */
enum gdc_status gdc_list(struct gdc_client *client, const char *prefix, struct gdc_page *page,
                         struct gdc_problem *problem);
/* Like gdc_upload, but reads the file at `path`. Errors: those of gdc_upload, GDC_FILE. */
enum gdc_status gdc_upload_file(struct gdc_client *client, const char *mesh, const char *path,
                                struct gdc_problem *problem);
enum gdc_status gdc_delete(struct gdc_client *client, const char *mesh,
                           struct gdc_problem *problem);

/* Computes the exact distance. Errors: those of gdc_query, GDC_NO_PATH. */
enum gdc_status gdc_distance(struct gdc_client *client, const char *mesh, struct gdc_point from,
                             struct gdc_point to, double *distance, struct gdc_problem *problem);

/* A path on the surface. */
struct gdc_path {
    double length;
    size_t count; /* number of corners */
    double *xyz;  /* three coordinates of each corner; the caller frees it with gdc_free */
};
/* Computes a shortest path. Errors: those of gdc_query, GDC_NO_PATH. */
enum gdc_status gdc_shortest_path(struct gdc_client *client, const char *mesh,
                                  struct gdc_point from, struct gdc_point to, struct gdc_path *path,
                                  struct gdc_problem *problem);

/* Computes the distances from each source to each target. Writes `source_count * target_count`
 * doubles into memory of the caller, one row for each source. A distance is NaN if no path joins
 * the points or the distance exceeds `max_distance` (0 means no limit). All inputs are borrowed.
 * Errors: those of gdc_query. */
struct gdc_matrix_points {
    const struct gdc_point *sources, *targets;
    size_t source_count, target_count;
    double max_distance;
};
enum gdc_status gdc_matrix(struct gdc_client *client, const char *mesh,
                           const struct gdc_matrix_points *points, double *distances,
                           struct gdc_problem *problem);

/* Computes for each vertex the distance from the nearest of `count` points. The distance is NaN if
 * no path reaches the vertex. The caller frees `*values` with gdc_free. Errors: those of
 * gdc_query. */
enum gdc_status gdc_field(struct gdc_client *client, const char *mesh,
                          const struct gdc_point *sources, size_t count, double **values,
                          size_t *value_count, struct gdc_problem *problem);

/* --- batches ---------------------------------------------------------------------------------- */

/* The state of a batch. */
struct gdc_batch {
    char id[64];
    char state[16];  /* running, done, cancelled */
    double progress; /* in [0,1] */
    /* numbers of all items, of items with an answer, and of answers that are errors */
    size_t items, done, failed;
};

/* Starts a batch: a query for many sources that continues without this client and across restarts
 * of the daemon. `request` is JSON as in the contract: {"query": "all-pairs", "mesh", "vertices"}
 * or {"query": "fields", "meshes", "set"}. The client does not repeat the request if the connection
 * fails: after GDC_NO_CONNECTION the batch may exist; GET /v1/batches lists all batches. Errors:
 * those of gdc_call, GDC_BAD_ANSWER. */
enum gdc_status gdc_batch_create(struct gdc_client *client, const char *request,
                                 struct gdc_batch *batch, struct gdc_problem *problem);

/* Reads the state of a batch. */
enum gdc_status gdc_batch_look(struct gdc_client *client, const char *id, struct gdc_batch *batch,
                               struct gdc_problem *problem);

/* Reads a page of the items that have an answer now, in the order of the request: {"results":
 * [...]}. */
enum gdc_status gdc_batch_results(struct gdc_client *client, const char *id, struct gdc_page *page,
                                  struct gdc_problem *problem);

/* Reads a page of the items in the order in which the daemon answers them. Each call blocks until
 * an item has an answer, at most 30 seconds. The last page is returned after the end of the
 * batch. */
enum gdc_status gdc_batch_next(struct gdc_client *client, const char *id, struct gdc_page *page,
                               struct gdc_problem *problem);

/* Blocks until the batch has ended, and calls the progress function about once a second.
 * Returns GDC_CANCELLED if the progress function returned a nonzero value; the batch then
 * continues. */
enum gdc_status gdc_batch_wait(struct gdc_client *client, const char *id, struct gdc_batch *batch,
                               struct gdc_problem *problem);

/* Cancels a running batch, or removes a batch that has ended. */
enum gdc_status gdc_batch_delete(struct gdc_client *client, const char *id,
                                 struct gdc_problem *problem);

#ifdef __cplusplus
}
#endif

#endif
