#include "tests/samples/transform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/samples/random.h"

void sample_scale(struct gd_polygons *mesh, double x, double y, double z)
{
    for (uint32_t i = 0; i < mesh->position_count; i++) {
        mesh->positions[i][0] *= x;
        mesh->positions[i][1] *= y;
        mesh->positions[i][2] *= z;
    }
}

void sample_fit(struct gd_polygons *mesh)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
           side = 0;
    for (uint32_t i = 0; i < mesh->position_count; i++) {
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], mesh->positions[i][k]);
            high[k] = fmax(high[k], mesh->positions[i][k]);
        }
    }
    for (int k = 0; k < 3; k++) side = fmax(side, high[k] - low[k]);
    for (uint32_t i = 0; i < mesh->position_count; i++)
        for (int k = 0; k < 3; k++)
            mesh->positions[i][k] = (mesh->positions[i][k] - 0.5 * (low[k] + high[k])) * (2 / side);
}

static void rotate_plane(struct gd_polygons *mesh, int a, int b, double angle)
{
    double c = cos(angle), s = sin(angle);
    for (uint32_t i = 0; i < mesh->position_count; i++) {
        double *p = mesh->positions[i], u = p[a], v = p[b];
        p[a] = c * u - s * v;
        p[b] = s * u + c * v;
    }
}

void sample_move(struct gd_polygons *mesh, double reach, uint64_t seed)
{
    struct rng rng = {seed};
    for (int axis = 0; axis < 3; axis++)
        rotate_plane(mesh, axis, (axis + 1) % 3, rng_between(&rng, 0, 2 * M_PI));
    double shift[3];
    for (int k = 0; k < 3; k++) shift[k] = rng_between(&rng, -reach, reach);
    for (uint32_t i = 0; i < mesh->position_count; i++)
        for (int k = 0; k < 3; k++) mesh->positions[i][k] += shift[k];
}

void sample_jitter(struct gd_polygons *mesh, double amplitude, uint64_t seed)
{
    struct rng rng = {seed};
    for (uint32_t i = 0; i < mesh->position_count; i++)
        for (int k = 0; k < 3; k++)
            mesh->positions[i][k] += rng_between(&rng, -amplitude, amplitude);
}

void sample_flip_faces(struct gd_polygons *mesh, double probability, uint64_t seed)
{
    struct rng rng = {seed};
    for (uint32_t f = 0; f < mesh->polygon_count; f++) {
        uint32_t *corner = &mesh->corners[3 * f], second = corner[1];
        if (rng_unit(&rng) >= probability) continue;
        corner[1] = corner[2];
        corner[2] = second;
    }
}

/* Returns a random permutation of 0 … count - 1, which the caller frees, or NULL if out of
 * memory. */
static uint32_t *permutation(uint32_t count, struct rng *rng)
{
    uint32_t *order = malloc((count + 1) * sizeof *order);
    if (!order) return NULL;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t j = rng_below(rng, i + 1);
        order[i] = order[j];
        order[j] = i;
    }
    return order;
}

enum gd_status sample_renumber(struct gd_polygons *mesh, uint64_t seed, uint32_t *vertex_map,
                               uint32_t *face_map)
{
    struct rng rng = {seed};
    uint32_t vertices = mesh->position_count, faces = mesh->polygon_count;
    uint32_t *vertex = permutation(vertices, &rng), *face = permutation(faces, &rng);
    double(*positions)[3] = malloc((vertices + 1) * sizeof *positions);
    uint32_t *corners = malloc((3 * faces + 1) * sizeof *corners);
    enum gd_status status = vertex && face && positions && corners ? GD_OK : GD_NO_MEMORY;
    if (status == GD_OK) {
        for (uint32_t v = 0; v < vertices; v++)
            memcpy(positions[vertex[v]], mesh->positions[v], sizeof *positions);
        for (uint32_t f = 0; f < faces; f++) {
            uint32_t turn = rng_below(&rng, 3);
            for (uint32_t k = 0; k < 3; k++)
                corners[3 * face[f] + (k + turn) % 3] = vertex[mesh->corners[3 * f + k]];
        }
        if (vertex_map) memcpy(vertex_map, vertex, vertices * sizeof *vertex);
        if (face_map) memcpy(face_map, face, faces * sizeof *face);
        gd_polygons_free(mesh);
        *mesh = (struct gd_polygons){positions, vertices, faces, corners, NULL};
    } else {
        free(positions);
        free(corners);
    }
    free(vertex);
    free(face);
    return status;
}

/* A half-edge. `slot` is the corner at which the half-edge begins. */
struct half {
    uint32_t low, high, slot;
};

static int half_compare(const void *a, const void *b)
{
    const struct half *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    return (x->high > y->high) - (x->high < y->high);
}

/* Returns all half-edges, sorted by edge, or NULL if out of memory. */
static struct half *sorted_halves(const struct gd_polygons *mesh)
{
    uint32_t count = 3 * mesh->polygon_count;
    struct half *halves = malloc((count + 1) * sizeof *halves);
    if (!halves) return NULL;
    for (uint32_t slot = 0; slot < count; slot++) {
        uint32_t a = mesh->corners[slot], b = mesh->corners[slot % 3 == 2 ? slot - 2 : slot + 1];
        halves[slot] = (struct half){a < b ? a : b, a < b ? b : a, slot};
    }
    qsort(halves, count, sizeof *halves, half_compare);
    return halves;
}

/* Appends the midpoint of each edge to `positions`, which must have room. Sets middle[slot] to the
 * index of the midpoint. Returns the number of positions. */
static uint32_t add_middles(double (*positions)[3], uint32_t count, const struct half *halves,
                            uint32_t half_count, uint32_t *middle)
{
    for (uint32_t i = 0; i < half_count; i++) {
        if (i == 0 || half_compare(&halves[i - 1], &halves[i])) {
            const double *a = positions[halves[i].low], *b = positions[halves[i].high];
            for (int k = 0; k < 3; k++) positions[count][k] = 0.5 * (a[k] + b[k]);
            count++;
        }
        middle[halves[i].slot] = count - 1;
    }
    return count;
}

static void quarter(const uint32_t corner[3], const uint32_t middle[3], uint32_t out[12])
{
    for (int k = 0; k < 3; k++) {
        out[3 * k] = corner[k];
        out[3 * k + 1] = middle[k];
        out[3 * k + 2] = middle[(k + 2) % 3];
        out[9 + k] = middle[k];
    }
}

enum gd_status sample_subdivide(struct gd_polygons *mesh)
{
    uint32_t slots = 3 * mesh->polygon_count;
    struct half *halves = sorted_halves(mesh);
    uint32_t *middle = malloc((slots + 1) * sizeof *middle);
    uint32_t *corners = malloc((4 * (size_t)slots + 1) * sizeof *corners);
    double(*positions)[3] = malloc((mesh->position_count + (size_t)slots + 1) * sizeof *positions);
    enum gd_status status = halves && middle && corners && positions ? GD_OK : GD_NO_MEMORY;
    if (status == GD_OK) {
        memcpy(positions, mesh->positions, mesh->position_count * sizeof *positions);
        uint32_t count = add_middles(positions, mesh->position_count, halves, slots, middle);
        for (uint32_t slot = 0; slot < slots; slot += 3)
            quarter(&mesh->corners[slot], &middle[slot], &corners[4 * slot]);
        uint32_t faces = 4 * mesh->polygon_count;
        gd_polygons_free(mesh);
        *mesh = (struct gd_polygons){positions, count, faces, corners, NULL};
    } else {
        free(corners);
        free(positions);
    }
    free(halves);
    free(middle);
    return status;
}

enum gd_status sample_append(struct gd_polygons *mesh, const struct gd_polygons *other)
{
    uint32_t vertices = mesh->position_count, slots = 3 * mesh->polygon_count,
             added = 3 * other->polygon_count;
    double(*positions)[3] =
        realloc(mesh->positions, (vertices + other->position_count + 1) * sizeof *positions);
    if (!positions) return GD_NO_MEMORY;
    mesh->positions = positions;
    uint32_t *corners = realloc(mesh->corners, (slots + added + 1) * sizeof *corners);
    if (!corners) return GD_NO_MEMORY;
    mesh->corners = corners;
    memcpy(positions[vertices], other->positions, other->position_count * sizeof *positions);
    for (uint32_t slot = 0; slot < added; slot++)
        corners[slots + slot] = vertices + other->corners[slot];
    mesh->position_count += other->position_count;
    mesh->polygon_count += other->polygon_count;
    return GD_OK;
}
