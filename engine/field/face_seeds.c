#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "mesh/segment.h"
#include "base/prefetch.h"

enum {
    DIGIT_BITS = 8,
    DIGIT = 1 << DIGIT_BITS,
    FEW = 32 /* up to this number, entries are sorted in place */,
    SEEDS_AHEAD = 24
};

/* --- by face ---------------------------------------------------------------------------------- */

/* Finds the edge or the face whose interior contains a seed; both are GD_NONE for a seed at a
 * vertex. Returns false if the seed is a segment that no face contains. */
static bool home_of(const struct gd_mesh *mesh, const struct gd__seed *seed,
                    struct gd__segment_location *location)
{
    if (seed->is_segment) return gd__segment_locate(mesh, &seed->point, &seed->end, location);
    location->face = seed->point.kind == GD_POINT_FACE ? seed->point.element : GD_NONE;
    location->edge = seed->point.kind == GD_POINT_EDGE ? seed->point.element : GD_NONE;
    return true;
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

/* A run of consecutive seeds in one face. */
struct run {
    uint32_t face, first, count;
};

static uint32_t find_runs(const struct gd__face_seed *list, uint32_t count, struct run *runs)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!found || runs[found - 1].face != list[i].face)
            runs[found++] = (struct run){list[i].face, i, 0};
        runs[found - 1].count++;
    }
    return found;
}

/* Sorts runs by one digit of the face: one pass of a radix sort. */
static void sort_by_digit(const struct run *from, struct run *to, uint32_t count, int shift)
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

/* Writes the entries in the order of the runs. */
static void put_runs(const struct run *runs, uint32_t count, const struct gd__face_seed *list,
                     struct gd__face_seed *out)
{
    for (const struct run *run = runs; run < runs + count; run++)
        for (uint32_t i = run->first; i < run->first + run->count; i++) *out++ = list[i];
}

/* Sorts the entries by face, stably. The function sorts runs instead of single entries, because
 * there are fewer runs. O(n) for each digit. Error: GD_NO_MEMORY. */
static enum gd_status sort_by_face(struct gd_field *field)
{
    uint32_t count = field->face_seed_count;
    struct run *room = malloc(sizeof *room * 2 * count), *runs = room;
    struct gd__face_seed *sorted = malloc(sizeof *sorted * 2 * field->seed_count);
    bool has_room = room && sorted;
    if (has_room) {
        count = find_runs(field->face_seeds, count, runs);
        struct run *other = room + count;
        for (int shift = 0; shift < 32 && field->mesh->face_count >> shift; shift += DIGIT_BITS) {
            sort_by_digit(runs, other, count, shift);
            struct run *ordered = other;
            other = runs;
            runs = ordered;
        }
        put_runs(runs, count, field->face_seeds, sorted);
        struct gd__face_seed *unsorted = field->face_seeds;
        field->face_seeds = sorted;
        sorted = unsorted;
    }
    free(sorted);
    free(room);
    return has_room ? GD_OK : GD_NO_MEMORY;
}

/* --- adding seeds ----------------------------------------------------------------------------- */

static enum gd_status open_index(struct gd_field *field)
{
    field->face_seeds = malloc(sizeof *field->face_seeds * 2 * field->seed_count);
    return field->face_seeds ? GD_OK : GD_NO_MEMORY;
}

static void append_face_seed(struct gd_field *field, uint32_t face, uint32_t seed)
{
    if (face != GD_NONE)
        field->face_seeds[field->face_seed_count++] = (struct gd__face_seed){face, seed};
}

/* Adds a seed for both faces of an edge. The face of the previous seed comes first, so that the
 * seeds of a curve form long runs. */
static void enter_both(struct gd_field *field, const uint32_t face[2], uint32_t seed)
{
    uint32_t count = field->face_seed_count;
    bool second = count && field->face_seeds[count - 1].face == face[1];
    append_face_seed(field, face[second], seed);
    append_face_seed(field, face[!second], seed);
}

/* Adds the entries of a seed. Returns false if the seed is a segment that no face contains. */
static bool enter_seed(struct gd_field *field, uint32_t seed)
{
    struct gd__seed *s = &field->seeds[seed];
    struct gd__segment_location location;
    if (!home_of(field->mesh, s, &location)) return false;
    field->has_segments |= s->is_segment;
    /* The seeds of an image are read-only, and they are not propagated. */
    if (s->is_segment && !field->is_image) s->face = location.face;
    append_face_seed(field, location.face, seed);
    if (location.edge != GD_NONE)
        enter_both(field, &field->mesh->side_face[2 * location.edge], seed);
    return true;
}

static enum gd_status close_index(struct gd_field *field)
{
    if (field->face_seed_count > FEW) return sort_by_face(field);
    insert_in_place(field->face_seeds, field->face_seed_count);
    return GD_OK;
}

enum gd_status gd__field_index_seeds(struct gd_field *field)
{
    enum gd_status status = open_index(field);
    for (uint32_t i = 0; i < field->seed_count && !status; i++)
        if (!enter_seed(field, i)) status = GD_INVALID_ARGUMENT;
    return status ? status : close_index(field);
}

static void copy_seed(struct gd__seed *to, const struct gd_seed *from, double unit)
{
    memset(to, 0, sizeof *to); /* zeroes the padding too, because images contain it */
    to->point = from->point;
    to->offset = from->offset / unit;
    to->is_segment = from->is_segment;
    if (from->is_segment) to->end = from->end;
}

/* Prefetches the faces of a seed's edge, because consecutive faces along a curve are not neighbours
 * in memory. */
GD__PREFETCH prefetch_faces(const struct gd_mesh *mesh, const struct gd_seed *seed)
{
    if (seed->point.kind == GD_POINT_EDGE)
        __builtin_prefetch(&mesh->side_face[2 * seed->point.element]);
}

/* Checks, copies and indexes each seed while it is in the cache. */
static enum gd_status take_each(struct gd_field *field, const struct gd_field_request *request,
                                struct gd_detail *detail)
{
    for (uint32_t i = 0; i < request->seed_count; i++) {
        const struct gd_seed *seed = &request->seeds[i];
        if (i + SEEDS_AHEAD < request->seed_count) prefetch_faces(field->mesh, seed + SEEDS_AHEAD);
        if (!(seed->offset >= 0 && isfinite(seed->offset)))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "source %u: the offset must be a finite number, zero or more", i);
        copy_seed(&field->seeds[i], seed, field->mesh->unit);
        if (!enter_seed(field, i))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "source %u: a segment must join two different points of one face", i);
    }
    return GD_OK;
}

enum gd_status gd__field_take_seeds(struct gd_field *field, const struct gd_field_request *request,
                                    struct gd_detail *detail)
{
    field->seed_count = request->seed_count;
    field->seeds = malloc(request->seed_count * sizeof *field->seeds);
    enum gd_status status = field->seeds ? open_index(field) : GD_NO_MEMORY;
    if (!status) {
        status = take_each(field, request, detail);
        if (status) return status;
        status = close_index(field);
    }
    return status ? gd_fail_status(detail, status) : GD_OK;
}

/* --- lookup ----------------------------------------------------------------------------------- */

struct gd__face_seeds gd__field_seeds_in(const struct gd_field *field, uint32_t face)
{
    uint32_t lo = 0, hi = field->face_seed_count;
    while (lo < hi) {
        uint32_t middle = lo + (hi - lo) / 2;
        if (field->face_seeds[middle].face < face)
            lo = middle + 1;
        else
            hi = middle;
    }
    while (hi < field->face_seed_count && field->face_seeds[hi].face == face) hi++;
    return (struct gd__face_seeds){field->face_seeds + lo, field->face_seeds + hi};
}
