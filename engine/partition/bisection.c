#include "partition/bisection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHELL      64 /* samples about equally far from the source */
#define SHELLS     16
#define SAMPLES    (SHELLS * SHELL)
#define DIRECTIONS 99
/* by which the next point of a spiral over a sphere goes round */
#define GOLDEN_TURN 2.399963229728653

struct sample {
    double x, y, z, distance; /* from the source, straight */
    uint32_t number;
};

static double height_of(const struct sample *sample, struct gd_vec3 normal)
{
    return normal.x * sample->x + normal.y * sample->y + normal.z * sample->z;
}

/* A face stands where its first corner does. */
static struct sample sample_face(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 source)
{
    const struct gd_vec3 *p = &mesh->position[mesh->origin[mesh->face_side[face][0]]];
    return (struct sample){.x = p->x - source.x, .y = p->y - source.y, .z = p->z - source.z};
}

/* No two are equal, so that the order is that of any sort. */
static int by_distance(const void *a, const void *b)
{
    const struct sample *first = a, *second = b;
    if (first->distance != second->distance) return first->distance < second->distance ? -1 : 1;
    return first->number < second->number ? -1 : 1;
}

/* The nearest first: a wavefront meets one shell after the other, more or less. */
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

/* Spread evenly over half of a sphere. */
static struct gd_vec3 direction(uint32_t number)
{
    double z = (number + 0.5) / DIRECTIONS, around = number * GOLDEN_TURN, r = sqrt(1 - z * z);
    return (struct gd_vec3){r * cos(around), r * sin(around), z};
}

/* What the busier half has to do in each shell, while the other one waits for it. */
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
        struct gd_vec3 normal = direction(d);
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
            /* boundary; its record would be a cache line more */
            if (mesh->side_face[side ^ 1] == GD_NONE) side_part[side ^ 1] = half;
            vertex_parts[mesh->origin[side]] |= (uint8_t)(1 << half);
        }
    }
}
