/* Exact geodesics on surfaces, from a geodesicd daemon. With libcurl and jansson.
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
 * A client is one connection, which is kept: it may be used by one thread at a time; different
 * clients are independent. Outputs come last and are untouched on failure; `problem` may be NULL.
 * Before threads are started that use clients, call curl_global_init. */
#ifndef GEODESICD_H
#define GEODESICD_H

#include <jansson.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum gdc_status {
    GDC_OK,
    GDC_PROBLEM,       /* the daemon's answer is a problem: see struct gdc_problem */
    GDC_NO_CONNECTION, /* no answer came */
    GDC_BAD_ANSWER,    /* an answer that is not what the contract says */
    GDC_NO_PATH,       /* the points are of different components */
    GDC_FILE,          /* a file can't be read */
    GDC_CANCELLED,     /* by the progress function, or by somebody else */
    GDC_NO_MEMORY
};

/* What went wrong, for a person and for a program. */
struct gdc_problem {
    int status; /* of HTTP; 0: there was no answer */
    /* of the contract: invalid_request, invalid_mesh, not_found, ...; "": there is none */
    char code[32];
    char pointer[128]; /* JSON Pointer into the body that was sent; "": there is none */
    char detail[1024]; /* a sentence that tells what to change */
};

/* A way of the daemon's, of one client. */
struct gdc_client;

/* url: http://HOST:PORT, https://HOST:PORT or unix:PATH; NULL: $GEODESICD_URL, or
 * http://127.0.0.1:8080. key: of a daemon that wants one; NULL: $GEODESICD_KEY, if it is set. Both
 * are copied. NULL without memory. */
struct gdc_client *gdc_client_create(const char *url, const char *key);
void gdc_client_destroy(struct gdc_client *client); /* NULL is harmless */

/* How often a request is sent again that a busy daemon turned away (429, 503; as long as
 * Retry-After says, or with back-off) or whose connection failed (5 if nothing is said), and after
 * how many seconds without a byte it is given up (120). */
void gdc_client_set_retries(struct gdc_client *client, unsigned retries);
void gdc_client_set_timeout(struct gdc_client *client, long seconds);

/* Told how far a job is, in [0,1], several times a second. Nonzero: cancel it. */
typedef int (*gdc_progress)(void *user, double progress);

/* With a progress function whatever takes long is a job of the daemon's that is awaited; NULL:
 * nothing is. */
void gdc_client_set_progress(struct gdc_client *client, gdc_progress progress, void *user);

/* --- requests of any kind --------------------------------------------------------------------- */

/* What is sent. Borrowed. */
struct gdc_request {
    /* "POST", "/v1/meshes/bunny/trace?geometry=xyz": encoded as URLs are */
    const char *method, *path;
    const void *body; /* NULL: none */
    size_t body_size;
    const char *content_type; /* NULL: application/json */
    const char *accept;       /* NULL: application/json */
    /* it makes something new each time, as POST /v1/batches does: not sent again when its
     * connection fails */
    int once;
};

/* What came back, of a status below 400. */
struct gdc_answer {
    int status;
    char *body; /* the caller's to free(); with a NUL after it */
    size_t size;
};

/* Errors: GDC_PROBLEM, GDC_NO_CONNECTION, GDC_CANCELLED, GDC_BAD_ANSWER (of a job),
 * GDC_NO_MEMORY. */
enum gdc_status gdc_call(struct gdc_client *client, const struct gdc_request *request,
                         struct gdc_answer *answer, struct gdc_problem *problem);

/* Blocks until the job of that id has ended, perhaps one of another client, and calls the progress
 * function as gdc_call does. The answer is the job's. Errors: those of gdc_call. */
enum gdc_status gdc_job_wait(struct gdc_client *client, const char *id, struct gdc_answer *answer,
                             struct gdc_problem *problem);

/* Any query of the contract, of the mesh of that name: `body` (borrowed) is posted to
 * /v1/meshes/{mesh}/{query}. The answer is the caller's to json_decref. Errors: those of gdc_call,
 * GDC_BAD_ANSWER (no JSON). */
enum gdc_status gdc_query(struct gdc_client *client, const char *mesh, const char *query,
                          const json_t *body, json_t **answer, struct gdc_problem *problem);

/* --- points ----------------------------------------------------------------------------------- */

enum gdc_point_kind { GDC_VERTEX, GDC_EDGE, GDC_FACE, GDC_NEAR };

/* A point of a surface, as it is asked about. */
struct gdc_point {
    enum gdc_point_kind kind;
    unsigned element[2]; /* vertex; the edge's two vertices; face */
    /* the edge's t from its first vertex; barycentric coordinates; a place in space */
    double number[3];
};

struct gdc_point gdc_vertex(unsigned vertex);
struct gdc_point gdc_edge(unsigned from, unsigned to, double t);
struct gdc_point gdc_face(unsigned face, double a, double b, double c);
/* the point of the surface nearest to that place */
struct gdc_point gdc_near(double x, double y, double z);

/* As JSON, for bodies of gdc_query; the caller's to json_decref. NULL without memory or where a
 * number is not finite. */
json_t *gdc_point_json(const struct gdc_point *point);

/* --- meshes ----------------------------------------------------------------------------------- */

/* Creates or replaces the mesh of that name, of a file's bytes (OBJ, PLY, STL, OFF, JSON or glTF).
 * Errors: those of gdc_call; what is no surface is the problem invalid_mesh. */
enum gdc_status gdc_upload(struct gdc_client *client, const char *mesh, const void *bytes,
                           size_t size, struct gdc_problem *problem);
/* The same with repair=split: cuts apart what is no surface, such as edges of three faces. */
enum gdc_status gdc_upload_split(struct gdc_client *client, const char *mesh, const void *bytes,
                                 size_t size, struct gdc_problem *problem);
/* Lists the meshes whose names begin with `prefix` (NULL: all) as {"meshes": [...], "next"};
 * `after`: the "next" of the page before, NULL: from the first. `*page` is the caller's to
 * json_decref. */
enum gdc_status gdc_list(struct gdc_client *client, const char *prefix, const char *after,
                         json_t **page, struct gdc_problem *problem);
/* Errors: also GDC_FILE. */
enum gdc_status gdc_upload_file(struct gdc_client *client, const char *mesh, const char *path,
                                struct gdc_problem *problem);
enum gdc_status gdc_delete(struct gdc_client *client, const char *mesh,
                           struct gdc_problem *problem);

/* The exact distance. Errors: those of gdc_query, GDC_NO_PATH. */
enum gdc_status gdc_distance(struct gdc_client *client, const char *mesh, struct gdc_point from,
                             struct gdc_point to, double *distance, struct gdc_problem *problem);

/* A shortest path: its corners, three doubles each, the caller's to free(). Errors: those of
 * gdc_query, GDC_NO_PATH. */
struct gdc_path {
    double length;
    size_t count;
    double *xyz;
};
enum gdc_status gdc_shortest_path(struct gdc_client *client, const char *mesh,
                                  struct gdc_point from, struct gdc_point to, struct gdc_path *path,
                                  struct gdc_problem *problem);

/* The distance at each vertex index from the nearest of `count` points, NaN where there is none:
 * the caller's to free(). Errors: those of gdc_query. */
enum gdc_status gdc_field(struct gdc_client *client, const char *mesh,
                          const struct gdc_point *sources, size_t count, double **values,
                          size_t *value_count, struct gdc_problem *problem);

/* --- batches ---------------------------------------------------------------------------------- */

/* Begins work of many sources, which outlives this client and the daemon: {"query": "all-pairs",
 * "mesh", "vertices"} or {"query": "fields", "meshes", "set"}, as the contract has it (borrowed).
 * `*batch`, the caller's to json_decref: its "id", "state" (running, done, cancelled), "items",
 * "done", "failed". It is not sent again when its connection fails: after GDC_NO_CONNECTION it may
 * have begun all the same, which GET /v1/batches tells. Errors: those of gdc_query. */
enum gdc_status gdc_batch_create(struct gdc_client *client, const json_t *request, json_t **batch,
                                 struct gdc_problem *problem);

/* How far it is. */
enum gdc_status gdc_batch_look(struct gdc_client *client, const char *id, json_t **batch,
                               struct gdc_problem *problem);

/* Some of the items that have an answer by now, in their order: {"results": [...], "next"};
 * `after`: the "next" of the ones before, NULL: from the first. */
enum gdc_status gdc_batch_results(struct gdc_client *client, const char *id, const char *after,
                                  json_t **page, struct gdc_problem *problem);

/* The next items in the order in which they are answered; blocks until there are some, half a
 * minute at most: {"results": [...], "state", "next"}. `cursor`: the "next" of the page before,
 * NULL: from the first. A "next" that is null: the batch has ended and there are no more. */
enum gdc_status gdc_batch_next(struct gdc_client *client, const char *id, const char *cursor,
                               json_t **page, struct gdc_problem *problem);

/* Blocks until the batch has ended, and calls the progress function about once a second.
 * GDC_CANCELLED: that function returned nonzero; the batch goes on. */
enum gdc_status gdc_batch_wait(struct gdc_client *client, const char *id, json_t **batch,
                               struct gdc_problem *problem);

/* Cancels it; removes one that has ended. */
enum gdc_status gdc_batch_delete(struct gdc_client *client, const char *id,
                                 struct gdc_problem *problem);

#ifdef __cplusplus
}
#endif

#endif
