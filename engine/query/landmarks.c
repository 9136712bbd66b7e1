#include "query/landmarks.h"

#include <stdlib.h>
#include <string.h>

#include "base/share.h"
#include "field/layout.h"
#include "mesh/canonical.h"
#include "mesh/image_header.h"

/* The step before any distance is known. Far below the rounding error of distances. */
#define LEAST_STEP 0x1p-64

struct gd_landmarks {
    const struct gd_mesh *mesh;
    uint32_t count;
    double step; /* normalised unit */
    /* GD__LANDMARKS_MOST distances for each vertex, in steps, rounded down. A distance of 0 means
       that there is no such landmark, or that it is on another component. */
    uint16_t distance[];
};

void gd__landmarks_offer(const struct gd_landmarks *landmarks, const struct gd_mesh *mesh,
                         struct gd__guide *guide)
{
    bool fit = landmarks && landmarks->mesh == mesh;
    guide->landmark = fit ? landmarks->distance : NULL;
    guide->landmark_step = fit ? landmarks->step : 0;
}

/* --- creation --------------------------------------------------------------------------------- */

static size_t distance_bytes(const struct gd_mesh *mesh)
{
    return sizeof(uint16_t) * GD__LANDMARKS_MOST * (size_t)mesh->vertex_count;
}

static size_t landmarks_bytes_of(const struct gd_mesh *mesh)
{
    return sizeof(struct gd_landmarks) + distance_bytes(mesh);
}

static struct gd_landmarks *landmarks_create(const struct gd_mesh *mesh, uint32_t count)
{
    struct gd_landmarks *landmarks = malloc(landmarks_bytes_of(mesh));
    if (!landmarks) return NULL;
    landmarks->mesh = gd_mesh_retain(mesh);
    landmarks->count = count;
    landmarks->step = LEAST_STEP;
    return landmarks;
}

void gd_landmarks_release(const struct gd_landmarks *landmarks)
{
    if (!landmarks) return;
    gd_mesh_release(landmarks->mesh);
    free((void *)landmarks);
}

uint32_t gd_landmarks_count(const struct gd_landmarks *landmarks)
{
    return landmarks->count;
}

size_t gd_landmarks_memsize(const struct gd_landmarks *landmarks)
{
    return landmarks_bytes_of(landmarks->mesh);
}

/* --- building --------------------------------------------------------------------------------- */

/* The distances from the current landmark, and the state from which the next landmark is chosen. */
struct column {
    struct gd_landmarks *landmarks;
    uint32_t index;
    double *nearest; /* for each vertex, its distance from the nearest landmark so far */
    /* for each input index, its distance from this landmark, in the caller's unit */
    double *distance;
};

/* Enlarges the step by a power of two until distances up to `longest` fit. Distances that are
 * stored already are divided by the same power; they remain rounded down. */
static void fit_step(struct gd_landmarks *landmarks, double longest)
{
    int shift = 0;
    while (longest / landmarks->step >= UINT16_MAX) {
        landmarks->step *= 2;
        shift += shift < 16;
    }
    size_t count = (size_t)GD__LANDMARKS_MOST * landmarks->mesh->vertex_count;
    for (size_t i = 0; i < count && shift; i++)
        landmarks->distance[i] = (uint16_t)((uint32_t)landmarks->distance[i] >> shift);
}

static void landmarks_take(struct column *column, uint32_t vertex, double distance)
{
    struct gd_landmarks *landmarks = column->landmarks;
    landmarks->distance[(size_t)GD__LANDMARKS_MOST * vertex + column->index] =
        isfinite(distance) ? (uint16_t)(distance / landmarks->step) : 0;
    if (distance < column->nearest[vertex]) column->nearest[vertex] = distance;
}

/* Returns the distance of a vertex from the present landmark; infinite if it is not reached. */
static double column_at(const struct column *column, uint32_t vertex)
{
    const struct gd_mesh *mesh = column->landmarks->mesh;
    return column->distance[mesh->index_of_vertex[vertex]] / mesh->unit;
}

static double longest_of(const struct column *column)
{
    double longest = 0;
    for (uint32_t v = 0; v < column->landmarks->mesh->vertex_count; v++) {
        double distance = column_at(column, v);
        if (isfinite(distance) && distance > longest) longest = distance;
    }
    return longest;
}

/* Computes the distances from one landmark. If the field fails its check, there are no distances,
 * and the vertex is not chosen again. */
static enum gd_status landmarks_measure(struct column *column, uint32_t vertex,
                                        const struct gd_control *control)
{
    const struct gd_mesh *mesh = column->landmarks->mesh;
    struct gd_seed seed = {.point = gd__point_of_vertex(vertex)};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    enum gd_status status =
        gd_field_distances_only(mesh, &request, control, column->distance, NULL);
    if (status == GD_INTERNAL) column->nearest[vertex] = 0;
    if (!status) fit_step(column->landmarks, longest_of(column));
    for (uint32_t v = 0; v < mesh->vertex_count && !status; v++)
        landmarks_take(column, v, column_at(column, v));
    return status == GD_INTERNAL ? GD_OK : status;
}

/* Returns the vertex farthest from all landmarks. A vertex of a component without a landmark is
 * infinitely far, so it is returned first. */
static uint32_t farthest(const double *nearest, uint32_t count)
{
    uint32_t best = 0;
    for (uint32_t v = 1; v < count; v++)
        if (nearest[v] > nearest[best]) best = v;
    return best;
}

static enum gd_status measure_all(struct column *column, const struct gd_control *control,
                                  size_t held)
{
    uint32_t vertices = column->landmarks->mesh->vertex_count;
    struct gd__share share = {.control = control, .total = column->landmarks->count + 1};
    struct gd_control own = gd__share_control(&share, held);
    for (size_t i = 0; i < (size_t)GD__LANDMARKS_MOST * vertices; i++)
        column->landmarks->distance[i] = 0;
    for (uint32_t v = 0; v < vertices; v++) column->nearest[v] = GD__FAR;
    /* vertex 0 is an arbitrary start; the vertex farthest from it becomes the first landmark */
    enum gd_status status = landmarks_measure(column, 0, &own);
    uint32_t first = 0;
    for (uint32_t v = 0; v < vertices; v++)
        if (column->nearest[v] < GD__FAR && column->nearest[v] > column->nearest[first]) first = v;
    for (uint32_t v = 0; v < vertices; v++) column->nearest[v] = GD__FAR;
    for (uint32_t i = 0; i < column->landmarks->count && !status; i++) {
        column->index = i;
        share.done = i + 1;
        status = landmarks_measure(column, i ? farthest(column->nearest, vertices) : first, &own);
    }
    return status;
}

enum gd_status gd_landmarks_build(const struct gd_mesh *mesh, uint32_t count,
                                  const struct gd_control *control, struct gd_landmarks **out)
{
    if (count == 0 || count > GD__LANDMARKS_MOST) return GD_INVALID_ARGUMENT;
    size_t held = landmarks_bytes_of(mesh) +
                  sizeof(double) * ((size_t)mesh->vertex_count + mesh->summary.index_count);
    enum gd_status status = gd_control_afford(control, held);
    if (status) return status;
    struct column column = {.landmarks = landmarks_create(mesh, count),
                            .nearest = malloc(sizeof *column.nearest * mesh->vertex_count),
                            .distance =
                                malloc(sizeof *column.distance * mesh->summary.index_count)};
    status = column.landmarks && column.nearest && column.distance
                 ? measure_all(&column, control, held)
                 : GD_NO_MEMORY;
    free(column.nearest);
    free(column.distance);
    if (status)
        gd_landmarks_release(column.landmarks);
    else
        *out = column.landmarks;
    return status;
}

/* --- binary image ----------------------------------------------------------------------------- */

static const char magic[8] = "GDLANDM";
static const uint32_t version = 3;

struct header {
    struct gd__image_header image_header;
    uint32_t count, reserved; /* reserved must be 0 */
    double step;
};

size_t gd_landmarks_image_size(const struct gd_landmarks *landmarks)
{
    return sizeof(struct header) + distance_bytes(landmarks->mesh);
}

void gd_landmarks_write_image(const struct gd_landmarks *landmarks, void *bytes)
{
    struct header header = {.image_header = gd__image_header(landmarks->mesh, magic, version),
                            .count = landmarks->count,
                            .step = landmarks->step};
    memcpy(bytes, &header, sizeof header);
    memcpy((char *)bytes + sizeof header, landmarks->distance, distance_bytes(landmarks->mesh));
}

static enum gd_status check_header(const struct gd_mesh *mesh, const struct header *header,
                                   size_t size)
{
    enum gd_status status =
        gd__image_header_check(mesh, &header->image_header, magic, version, NULL);
    if (status) return status;
    if (header->count == 0 || header->count > GD__LANDMARKS_MOST) return GD_UNRECOGNIZED;
    if (!(header->step > 0 && header->step < GD__FAR / UINT16_MAX)) return GD_NON_FINITE;
    return size == sizeof *header + distance_bytes(mesh) ? GD_OK : GD_TRUNCATED;
}

enum gd_status gd_landmarks_open_image(const struct gd_mesh *mesh, const void *bytes, size_t size,
                                       struct gd_landmarks **out)
{
    struct header header;
    if (size < sizeof header) return GD_TRUNCATED;
    memcpy(&header, bytes, sizeof header);
    enum gd_status status = check_header(mesh, &header, size);
    if (status) return status;
    struct gd_landmarks *landmarks = landmarks_create(mesh, header.count);
    if (!landmarks) return GD_NO_MEMORY;
    landmarks->step = header.step;
    memcpy(landmarks->distance, (const char *)bytes + sizeof header, size - sizeof header);
    *out = landmarks;
    return GD_OK;
}
