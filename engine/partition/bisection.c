#include "partition/bisection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHELL      64 /* number of samples at about the same distance from the source */
#define SHELLS     16
#define SAMPLES    (SHELLS * SHELL)
#define DIRECTIONS 99
/* Turn between neighbouring points of a spiral over a sphere. */
#define GOLDEN_TURN 2.399963229728653

struct sample {
    /* position relative to the source, and straight-line distance from it */
    double x, y, z, distance;
    uint32_t number;
};

static double height_of(const struct sample *sample, struct gd_vec3 normal)
{
    return normal.x * sample->x + normal.y * sample->y + normal.z * sample->z;
}

/* Returns the sample of a face: its first corner. */
static struct sample sample_face(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 source)
{
    const struct gd_vec3 *p = &mesh->position[mesh->origin[mesh->face_side[face][0]]];
    return (struct sample){.x = p->x - source.x, .y = p->y - source.y, .z = p->z - source.z};
}

/* Compares samples by distance. No two samples are equal, so the order does not depend on the
 * sorting algorithm. */
static int by_distance(const void *a, const void *b)
{
    const struct sample *first = a, *second = b;
    if (first->distance != second->distance) return first->distance < second->distance ? -1 : 1;
    return first->number < second->number ? -1 : 1;
}

/* Takes samples, sorted by distance from the source. A shell is a group of SHELL consecutive
 * samples; a wavefront meets the shells roughly one after another. */
static void take_samples(const struct gd_mesh *mesh, struct gd_vec3 source, struct sample *samples)
{
    for (uint32_t i = 0; i < SAMPLES; i++) {
        struct sample *s = &samples[i];
        *s = sample_face(mesh, (uint32_t)((uint64_t)i * mesh->face_count / SAMPLES), source);
        s->number = i;
        s->distance = sqrt(s->x * s->x + s->y * s->y + s->z * s->z);
    }
    qsort(samples, SAMPLES, sizeof *samples, by_distance);
}

/* Returns one of DIRECTIONS directions that are spread evenly over a hemisphere. */
static struct gd_vec3 sample_direction(uint32_t number)
{
    double z = (number + 0.5) / DIRECTIONS, around = number * GOLDEN_TURN, r = sqrt(1 - z * z);
    return (struct gd_vec3){r * cos(around), r * sin(around), z};
}

/* Returns the sum, over all shells, of the work in the busier half. The other half waits for this
 * work. */
static uint32_t wait_of(const struct sample *samples, struct gd_vec3 normal)
{
    uint32_t sum = 0;
    for (uint32_t shell = 0; shell < SHELLS; shell++) {
        uint32_t above = 0;
        for (uint32_t i = 0; i < SHELL; i++)
            above += height_of(&samples[shell * SHELL + i], normal) > 0;
        sum += above > SHELL / 2 ? above : SHELL - above;
    }
    return sum;
}

static struct gd_vec3 find_plane(const struct gd_mesh *mesh, struct gd_vec3 source)
{
    struct sample samples[SAMPLES];
    take_samples(mesh, source, samples);
    struct gd_vec3 best = {0, 0, 1};
    uint32_t least = UINT32_MAX;
    for (uint32_t d = 0; d < DIRECTIONS; d++) {
        struct gd_vec3 normal = sample_direction(d);
        uint32_t wait = wait_of(samples, normal);
        if (wait >= least) continue;
        least = wait;
        best = normal;
    }
    return best;
}

void gd__bisection_divide(const struct gd_mesh *mesh, struct gd_vec3 source, uint8_t *side_part,
                          uint8_t *vertex_parts)
{
    struct gd_vec3 normal = find_plane(mesh, source);
    memset(vertex_parts, 0, mesh->vertex_count);
    for (uint32_t face = 0; face < mesh->face_count; face++) {
        struct sample place = sample_face(mesh, face, source);
        uint8_t half = height_of(&place, normal) > 0;
        for (int k = 0; k < 3; k++) {
            uint32_t side = mesh->face_side[face][k];
            side_part[side] = half;
            /* Also sets the part of the edge's boundary side, which has no face of its own. */
            if (mesh->side_face[side ^ 1] == GD_NONE) side_part[side ^ 1] = half;
            vertex_parts[mesh->origin[side]] |= (uint8_t)(1 << half);
        }
    }
}
