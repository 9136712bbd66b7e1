#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "mesh/segment.h"

enum { DIGIT_BITS = 11, DIGIT = 1 << DIGIT_BITS, FEW = 32 /* are sorted in place */ };

/* Where a seed is inside of, or GD_NONE twice. False: a segment in no face. */
static bool home_of(const struct gd_mesh *mesh, const struct gd__seed *seed, struct gd__home *home)
{
    if (seed->is_segment) return gd__segment_home(mesh, &seed->point, &seed->end, home);
    home->face = seed->point.kind == GD_POINT_FACE ? seed->point.element : GD_NONE;
    home->edge = seed->point.kind == GD_POINT_EDGE ? seed->point.element : GD_NONE;
    return true;
}

static void enter(struct gd_field *field, uint32_t face, uint32_t seed)
{
    if (face != GD_NONE) field->face_seeds[field->face_seed_count++] = (struct gd__face_seed){face, seed};
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
static enum gd_status sort_by_face(struct gd_field *field)
{
    uint32_t count = field->face_seed_count;
    if (count <= FEW) {
        insert_in_place(field->face_seeds, count);
        return GD_OK;
    }
    struct gd__face_seed *sorted = malloc(sizeof *sorted * 2 * field->seed_count), *from = field->face_seeds;
    if (!sorted) return GD_NO_MEMORY;
    for (int shift = 0; shift < 32 && field->mesh->face_count >> shift; shift += DIGIT_BITS) {
        sort_by_digit(from, sorted, count, shift);
        field->face_seeds = sorted;
        sorted = from;
        from = field->face_seeds;
    }
    free(sorted);
    return GD_OK;
}

enum gd_status gd__field_open_index(struct gd_field *field)
{
    field->face_seeds = malloc(sizeof *field->face_seeds * 2 * field->seed_count);
    return field->face_seeds ? GD_OK : GD_NO_MEMORY;
}

bool gd__field_index_seed(struct gd_field *field, uint32_t seed)
{
    struct gd__seed *s = &field->seeds[seed];
    struct gd__home home;
    if (!home_of(field->mesh, s, &home)) return false;
    field->has_segments |= s->is_segment;
    if (s->is_segment && !field->is_image) s->face = home.face; /* images are not written to, and not propagated from */
    enter(field, home.face, seed);
    for (uint32_t k = 0; k < 2 && home.edge != GD_NONE; k++)
        enter(field, field->mesh->side_face[2 * home.edge + k], seed);
    return true;
}

enum gd_status gd__field_close_index(struct gd_field *field)
{
    return sort_by_face(field);
}

enum gd_status gd__field_index_seeds(struct gd_field *field)
{
    enum gd_status status = gd__field_open_index(field);
    for (uint32_t i = 0; i < field->seed_count && !status; i++)
        if (!gd__field_index_seed(field, i)) status = GD_INVALID_ARGUMENT;
    return status ? status : gd__field_close_index(field);
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
