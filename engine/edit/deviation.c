/* Measures the distance between two surfaces from samples. Only the largest distance is needed. So
 * the search for the nearest face of a sample ends as soon as it finds a face that is nearer than
 * the largest distance so far. Consecutive samples lie close to each other. So each search begins
 * at the nearest face of the previous sample and first walks to nearer neighbours. The walk alone
 * serves most samples. A first pass over few vertices finds a distance that is nearly the largest,
 * so that the other samples end early. */
#include <stdatomic.h>

#include "base/share.h"
#include "base/slices.h"
#include "edit/edited.h"
#include "mesh/bvh.h"
#include "mesh/closest_point.h"

/* number of pace steps for one search, because a search takes some microseconds */
#define STEPS_A_SEARCH 40

#define SPARSE 64 /* the first pass measures every 64th vertex */

struct farthest {
    struct gd__bvh_search search; /* a search whose keys are squared distances */
    const struct gd_mesh *mesh;
    struct gd_vec3 q; /* the sample; all lengths here are in the mesh's normalised unit */
    double best;      /* squared distance of q from the surface */
    double largest;   /* squared distance of the farthest sample so far */
    uint32_t face;    /* the nearest face so far; at first a face near the previous sample */
};

static double box_square_distance(const struct gd__bvh_search *search, const struct gd__box *box)
{
    return gd__box_square_distance(box, ((const struct farthest *)search)->q);
}

/* Returns the squared distance of the sample from the nearest corner of a face. */
static double corner_square_distance(const struct farthest *farthest, uint32_t face)
{
    const struct gd_mesh *mesh = farthest->mesh;
    double squared = INFINITY;
    for (int k = 0; k < 3; k++) {
        struct gd_vec3 corner = mesh->position[mesh->origin[mesh->face_side[face][k]]];
        struct gd_vec3 d = gd_vec3_sub(farthest->q, corner);
        squared = fmin(squared, gd_vec3_dot(d, d));
    }
    return squared;
}

/* The distance from a corner is an upper bound, which often shows that the sample is not the
 * farthest one. It is computed in a fraction of the time of the distance from the face. */
static void visit_face(struct gd__bvh_search *search, uint32_t face)
{
    struct farthest *farthest = (struct farthest *)search;
    double squared = corner_square_distance(farthest, face);
    if (squared > farthest->largest)
        squared = gd__face_square_distance(farthest->mesh, face, farthest->q);
    if (squared < farthest->best) {
        farthest->best = squared;
        farthest->face = face;
    }
    search->limit = farthest->best <= farthest->largest ? -1 : farthest->best;
}

/* Visits `face` and its neighbours, then the neighbours of the nearest of them, until no neighbour
 * is nearer, or until the sample cannot be the farthest one. */
static void walk(struct farthest *farthest, uint32_t face)
{
    const struct gd_mesh *mesh = farthest->mesh;
    double before = INFINITY;
    visit_face(&farthest->search, face);
    while (farthest->search.limit >= 0 && farthest->best < before) {
        before = farthest->best;
        const uint32_t *side = mesh->face_side[farthest->face];
        for (int k = 0; k < 3 && farthest->search.limit >= 0; k++) {
            uint32_t across = mesh->side_face[side[k] ^ 1];
            if (across != GD_NONE) visit_face(&farthest->search, across);
        }
    }
}

static void measure(struct farthest *farthest, struct gd_vec3 q)
{
    farthest->q = q;
    farthest->best = INFINITY;
    walk(farthest, farthest->face);
    if (farthest->search.limit >= 0) gd__bvh_run(farthest->mesh, &farthest->search);
    farthest->largest = fmax(farthest->largest, farthest->best);
}

static struct farthest farthest_from(const struct gd_mesh *mesh, double largest)
{
    double inside = largest / mesh->unit;
    return (struct farthest){.search = {INFINITY, box_square_distance, visit_face},
                             .mesh = mesh,
                             .largest = inside * inside};
}

static double farthest_distance(const struct farthest *farthest)
{
    return sqrt(farthest->largest) * farthest->mesh->unit;
}

/* --- samples ---------------------------------------------------------------------------------- */

/* The samples of a surface. Their slices are measured on several threads. A slice does not use the
 * largest distance of the other slices, so that the result does not depend on the threads. */
struct samples {
    const struct gd_mesh *from, *to; /* the distances of `from` from `to` */
    uint32_t kept;                   /* the first faces of `from` have no samples */
    uint32_t stride;                 /* every stride-th vertex is a sample */
    double before;                   /* smaller distances need not be found */
    _Atomic double largest;
};

static void samples_raise(struct samples *samples, double distance)
{
    double largest = atomic_load(&samples->largest);
    while (distance > largest &&
           !atomic_compare_exchange_weak(&samples->largest, &largest, distance))
        continue;
}

/* Measures vertices of `from`. */
static void measure_vertices(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct samples *samples = context;
    const struct gd_mesh *from = samples->from;
    struct farthest farthest = farthest_from(samples->to, samples->before);
    double scale = from->unit / samples->to->unit;
    for (uint32_t v = begin; v < end && gd__pace(pace, STEPS_A_SEARCH); v++)
        measure(&farthest, gd_vec3_scale(from->position[v * samples->stride], scale));
    samples_raise(samples, farthest_distance(&farthest));
}

static void measure_face(struct farthest *farthest, const struct gd_mesh *from, uint32_t face)
{
    struct gd_vec3 sum = {0};
    double scale = from->unit / farthest->mesh->unit;
    for (int k = 0; k < 3; k++) {
        uint32_t side = from->face_side[face][k];
        struct gd_vec3 p = from->position[from->origin[side]];
        struct gd_vec3 q = from->position[gd__side_destination(from, side)];
        sum = gd_vec3_add(sum, p);
        if (side % 2 == 0 || gd__side_is_boundary(from, side ^ 1))
            measure(farthest, gd_vec3_scale(gd_vec3_add(p, q), scale / 2));
    }
    measure(farthest, gd_vec3_scale(sum, scale / 3));
}

/* Measures the middles of faces of `from` and of their edges. */
static void measure_middles(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct samples *samples = context;
    const struct gd_mesh *from = samples->from;
    struct farthest farthest = farthest_from(samples->to, samples->before);
    for (uint32_t f = begin; f < end; f++) {
        if (from->index_of_face[f] < samples->kept) continue;
        if (!gd__pace(pace, 3 * STEPS_A_SEARCH)) break;
        measure_face(&farthest, from, f);
    }
    samples_raise(samples, farthest_distance(&farthest));
}

/* Measures the distance of `made`, whose first `kept` faces are faces of `mesh`. */
static enum gd_status measure_both(const struct gd_mesh *mesh, const struct gd_mesh *made,
                                   uint32_t kept, const struct gd_control *control, double *out)
{
    struct gd__pace pace = {.control = control, .fraction = 0};
    struct samples vertices = {.from = mesh, .to = made, .stride = SPARSE};
    if (kept < mesh->face_count) {
        gd__slices_run(&pace, mesh->vertex_count / SPARSE, measure_vertices, &vertices);
        vertices.stride = 1;
        vertices.before = vertices.largest;
        gd__slices_run(&pace, mesh->vertex_count, measure_vertices, &vertices);
    }
    pace.fraction = 0.3;
    struct samples middles = {.from = made, .to = mesh, .kept = kept, .before = vertices.largest};
    gd__slices_run(&pace, made->face_count, measure_middles, &middles);
    if (!pace.status) *out = fmax(vertices.largest, middles.largest);
    return pace.status;
}

enum gd_status gd__edited_measure(struct gd_edited *edited, const struct gd_mesh *mesh,
                                  uint32_t kept, const struct gd_control *control,
                                  struct gd_detail *detail)
{
    struct gd__share share = {.control = control, .total = 2};
    struct gd_control part = gd__share_control(&share, 0);
    struct gd_mesh *made;
    if (kept == mesh->face_count && kept == edited->polygons.polygon_count) return GD_OK;
    enum gd_status status = gd_mesh_build(&edited->polygons, NULL, &part, &made, detail);
    if (status) return status;
    share.done = 1;
    status = measure_both(mesh, made, kept, &part, &edited->largest_distance);
    if (status) {
        gd_mesh_release(made);
        return status;
    }
    edited->mesh = made;
    edited->bytes += gd_mesh_memsize(made);
    return GD_OK;
}

enum gd_status gd_edit_deviation(const struct gd_mesh *mesh, const struct gd_polygons *edited,
                                 const struct gd_control *control, double *out,
                                 struct gd_detail *detail)
{
    struct gd_edited own = {.polygons = *edited};
    enum gd_status status = gd__edited_measure(&own, mesh, 0, control, detail);
    gd_mesh_release(own.mesh);
    if (!status) *out = own.largest_distance;
    return status;
}
