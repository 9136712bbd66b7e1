/* Computes the internal numbering: vertices by the Morton code of their position, faces by their
 * lowest vertex in that order. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "construction/steps.h"

#define CODE_BITS   21 /* bits per coordinate */
#define DIGIT_BITS  9
#define DIGIT_COUNT (1u << DIGIT_BITS)
#define PASSES      (3 * CODE_BITS / DIGIT_BITS)

struct keyed_vertex {
    uint64_t code;
    uint32_t index;
};

/* Inserts two zero bits above each of the 21 low bits. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x001f00000000ffffu;
    x = (x | x << 16) & 0x001f0000ff0000ffu;
    x = (x | x << 8) & 0x100f00f00f00f00fu;
    x = (x | x << 4) & 0x10c30c30c30c30c3u;
    x = (x | x << 2) & 0x1249249249249249u;
    return x;
}

static void mark_referenced(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    gd__pace_fill(&work->pace, mesh->vertex_of_index,
                  mesh->summary.index_count * sizeof *mesh->vertex_of_index);
    GD__PACED (&work->pace, i, mesh->face_count) {
        for (int k = 0; k < 3; k++) mesh->vertex_of_index[work->triangle[i][k]] = 0;
    }
    mesh->vertex_count = 0;
    GD__PACED (&work->pace, i, mesh->summary.index_count)
        mesh->vertex_count += mesh->vertex_of_index[i] != GD_NONE;
}

static void find_bounding_box(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    struct gd_vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    GD__PACED (&work->pace, i, mesh->summary.index_count) {
        if (mesh->vertex_of_index[i] == GD_NONE) continue;
        struct gd_vec3 p = gd__input_position(work, i);
        low = (struct gd_vec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
        high = (struct gd_vec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
    }
    mesh->summary.min = low;
    mesh->summary.max = high;
}

/* Computes the codes of the referenced vertices, in the order of their indices. */
static void encode(struct gd__construction *work, struct keyed_vertex *keyed)
{
    const struct gd_mesh *mesh = work->mesh;
    struct gd_vec3 low = mesh->summary.min, size = gd_vec3_sub(mesh->summary.max, low);
    double largest = fmax(fmax(size.x, size.y), size.z), cells = (double)((1u << CODE_BITS) - 1);
    uint32_t n = 0;
    GD__PACED (&work->pace, i, mesh->summary.index_count) {
        if (mesh->vertex_of_index[i] == GD_NONE) continue;
        struct gd_vec3 p = gd_vec3_sub(gd__input_position(work, i), low);
        uint64_t x = (uint64_t)(p.x / largest * cells), y = (uint64_t)(p.y / largest * cells);
        uint64_t z = (uint64_t)(p.z / largest * cells);
        keyed[n++] = (struct keyed_vertex){spread(x) | spread(y) << 1 | spread(z) << 2, i};
    }
}

/* Sorts by code (radix sort, stable). The result is in `spare`, which has the same size. */
static void sort_by_code(struct keyed_vertex *keyed, struct keyed_vertex *spare, uint32_t count,
                         struct gd__pace *pace)
{
    static_assert(PASSES % 2 == 1, "an odd number of passes ends in the other array");
    for (int pass = 0; pass < PASSES; pass++) {
        uint32_t start[DIGIT_COUNT + 1] = {0};
        int shift = pass * DIGIT_BITS;
        GD__PACED (pace, i, count) start[(keyed[i].code >> shift) % DIGIT_COUNT + 1]++;
        for (uint32_t d = 0; d < DIGIT_COUNT; d++) start[d + 1] += start[d];
        GD__PACED (pace, i, count)
            spare[start[(keyed[i].code >> shift) % DIGIT_COUNT]++] = keyed[i];
        struct keyed_vertex *swap = keyed;
        keyed = spare;
        spare = swap;
    }
}

static enum gd_status number_vertices(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    uint32_t count = mesh->vertex_count;
    struct keyed_vertex *keyed =
        gd__scratch_array(work, &work->until_sides, 2 * (size_t)count, sizeof *keyed);
    mesh->index_of_vertex = gd__mesh_array(work, count, sizeof *mesh->index_of_vertex);
    if (!keyed || !mesh->index_of_vertex) {
        gd__scratch_free(work, keyed);
        return GD_NO_MEMORY;
    }
    encode(work, keyed);
    sort_by_code(keyed, keyed + count, count, &work->pace);
    const struct keyed_vertex *sorted = keyed + count;
    GD__PACED (&work->pace, v, count) {
        mesh->index_of_vertex[v] = sorted[v].index;
        mesh->vertex_of_index[sorted[v].index] = v;
    }
    gd__scratch_free(work, keyed);
    return GD_OK;
}

static uint32_t lowest_vertex(const struct gd_mesh *mesh, const uint32_t triangle[3])
{
    uint32_t a = mesh->vertex_of_index[triangle[0]], b = mesh->vertex_of_index[triangle[1]];
    uint32_t c = mesh->vertex_of_index[triangle[2]], least = a < b ? a : b;
    return least < c ? least : c;
}

static void place_face(struct gd__construction *work, uint32_t triangle, uint32_t face)
{
    struct gd_mesh *mesh = work->mesh;
    uint32_t index = work->face_index ? work->face_index[triangle] : triangle;
    mesh->face_of_index[index] = face;
    mesh->index_of_face[face] = index;
    for (int k = 0; k < 3; k++)
        work->corner[face][k] = mesh->vertex_of_index[work->triangle[triangle][k]];
}

/* Numbers the faces by their lowest vertex (counting sort, stable). */
static enum gd_status number_faces(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    uint32_t *start = gd__large_zeroed((size_t)mesh->vertex_count + 1, sizeof *start);
    if (!start) return GD_NO_MEMORY;
    GD__PACED (&work->pace, i, mesh->face_count)
        start[lowest_vertex(mesh, work->triangle[i]) + 1]++;
    GD__PACED (&work->pace, v, mesh->vertex_count) start[v + 1] += start[v];
    gd__pace_fill(&work->pace, mesh->face_of_index,
                  mesh->summary.face_index_count * sizeof *mesh->face_of_index);
    GD__PACED (&work->pace, i, mesh->face_count)
        place_face(work, i, start[lowest_vertex(mesh, work->triangle[i])]++);
    free(start);
    return GD_OK;
}

/* Maps the index of each merged vertex to the internal number of its representative. */
static void name_merged_vertices(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    if (!work->representative) return;
    GD__PACED (&work->pace, i, work->polygons->position_count) {
        if (work->representative[i] != i)
            mesh->vertex_of_index[i] = mesh->vertex_of_index[work->representative[i]];
    }
}

enum gd_status gd__order(struct gd__construction *work)
{
    struct gd_mesh *mesh = work->mesh;
    uint32_t index_count = work->polygons->position_count + work->copy_count;
    mesh->summary.index_count = index_count;
    mesh->vertex_of_index = gd__mesh_array(work, index_count, sizeof *mesh->vertex_of_index);
    mesh->face_of_index =
        gd__mesh_array(work, mesh->summary.face_index_count, sizeof *mesh->face_of_index);
    mesh->index_of_face = gd__mesh_array(work, mesh->face_count, sizeof *mesh->index_of_face);
    enum gd_status status = gd__lend_arrays(work);
    if (status) return status;
    work->corner =
        gd__scratch_array(work, &work->until_fans, mesh->face_count, sizeof *work->corner);
    if (!mesh->vertex_of_index || !mesh->face_of_index || !mesh->index_of_face || !work->corner)
        return GD_NO_MEMORY;
    mark_referenced(work);
    find_bounding_box(work);
    status = number_vertices(work);
    if (!status) status = number_faces(work);
    if (!status) name_merged_vertices(work);
    return status;
}
