#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "mesh/segment.h"
#include "wedge/asking.h"

enum { DIGIT = 256, FEW = 32 /* are sorted in place */, SEEDS_AHEAD = 24 };

/* The faces that contain a seed inside of them; at most two, GD_NONE fills. False: a segment in no face. */
static bool faces_of_seed(const struct gd_mesh *mesh, const struct gd__seed *seed, uint32_t faces[2])
{
    struct gd__home home = {GD_NONE, GD_NONE};
    if (seed->is_segment && !gd__segment_home(mesh, &seed->point, &seed->end, &home)) return false;
    if (!seed->is_segment && seed->point.kind == GD_POINT_FACE) home.face = seed->point.element;
    if (!seed->is_segment && seed->point.kind == GD_POINT_EDGE) home.edge = seed->point.element;
    for (uint32_t k = 0; k < 2; k++) faces[k] = home.edge == GD_NONE ? GD_NONE : mesh->side_face[2 * home.edge + k];
    if (home.face != GD_NONE) faces[0] = home.face;
    return true;
}

/* Asks for the faces of an edge some seeds ahead: those of a curve are nowhere near each other in memory. */
GD__ASKING ask_ahead(const struct gd_field *field, uint32_t seed)
{
    if (seed >= field->seed_count || field->seeds[seed].point.kind != GD_POINT_EDGE) return;
    __builtin_prefetch(&field->mesh->side_face[2 * field->seeds[seed].point.element]);
}

static void insert_in_place(struct gd__face_seed *list, uint32_t count)
{
    for (uint32_t i = 1; i < count; i++) {
        struct gd__face_seed moved = list[i];
        uint32_t at = i;
        for (; at && list[at - 1].face > moved.face; at--) list[at] = list[at - 1];
        list[at] = moved;
    }
}

/* Orders `from` into `to` by one digit of the face. */
static void sort_by_digit(const struct gd__face_seed *from, struct gd__face_seed *to, uint32_t count, int shift)
{
    uint32_t place[DIGIT] = {0}, before = 0;
    for (uint32_t i = 0; i < count; i++) place[from[i].face >> shift & (DIGIT - 1)]++;
    for (int digit = 0; digit < DIGIT; digit++) {
        uint32_t here = place[digit];
        place[digit] = before;
        before += here;
    }
    for (uint32_t i = 0; i < count; i++) to[place[from[i].face >> shift & (DIGIT - 1)]++] = from[i];
}

/* By face; those of one face stay in their order. O(n) a digit. GD_NO_MEMORY. */
static enum gd_status sort_by_face(struct gd__face_seed *list, uint32_t count, uint32_t face_count)
{
    if (count <= FEW) {
        insert_in_place(list, count);
        return GD_OK;
    }
    struct gd__face_seed *other = malloc(count * sizeof *other), *from = list, *to = other;
    if (!other) return GD_NO_MEMORY;
    for (int shift = 0; shift < 32 && face_count >> shift; shift += 8) {
        sort_by_digit(from, to, count, shift);
        struct gd__face_seed *sorted = to;
        to = from;
        from = sorted;
    }
    if (from != list) memcpy(list, from, count * sizeof *list);
    free(other);
    return GD_OK;
}

enum gd_status gd__field_index_seeds(struct gd_field *field)
{
    const struct gd_mesh *mesh = field->mesh;
    field->face_seeds = malloc(sizeof *field->face_seeds * 2 * field->seed_count);
    if (!field->face_seeds) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < field->seed_count; i++) {
        uint32_t faces[2];
        ask_ahead(field, i + SEEDS_AHEAD);
        field->has_segments |= field->seeds[i].is_segment;
        if (!faces_of_seed(mesh, &field->seeds[i], faces)) return GD_INVALID_ARGUMENT;
        for (int k = 0; k < 2; k++)
            if (faces[k] != GD_NONE) field->face_seeds[field->face_seed_count++] = (struct gd__face_seed){faces[k], i};
    }
    return sort_by_face(field->face_seeds, field->face_seed_count, mesh->face_count);
}

const struct gd__face_seed *gd__field_seeds_in(const struct gd_field *field, uint32_t face)
{
    uint32_t lo = 0, hi = field->face_seed_count;
    while (lo < hi) {
        uint32_t middle = lo + (hi - lo) / 2;
        if (field->face_seeds[middle].face < face)
            lo = middle + 1;
        else
            hi = middle;
    }
    return field->face_seeds + lo;
}
