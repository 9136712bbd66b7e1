#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "mesh/segment.h"
#include "base/prefetch.h"

enum {
    DIGIT_BITS = 8,
    DIGIT = 1 << DIGIT_BITS,
    FEW = 32 /* are sorted in place */,
    SEEDS_AHEAD = 24
};

/* --- by face ---------------------------------------------------------------------------------- */

/* Where a seed is inside of, or GD_NONE twice. False: a segment in no face. */
static bool home_of(const struct gd_mesh *mesh, const struct gd__seed *seed, struct gd__home *home)
{
    if (seed->is_segment) return gd__segment_home(mesh, &seed->point, &seed->end, home);
    home->face = seed->point.kind == GD_POINT_FACE ? seed->point.element : GD_NONE;
    home->edge = seed->point.kind == GD_POINT_EDGE ? seed->point.element : GD_NONE;
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

/* Seeds that follow each other in one face. */
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

/* Orders `from` into `to` by one digit of the face. */
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

/* The list in the order of the runs. */
static void put_runs(const struct run *runs, uint32_t count, const struct gd__face_seed *list,
                     struct gd__face_seed *out)
{
    for (const struct run *run = runs; run < runs + count; run++)
        for (uint32_t i = run->first; i < run->first + run->count; i++) *out++ = list[i];
}

/* By face; those of one face stay in their order. Runs are sorted instead of seeds, as there are
 * fewer. O(n) a digit. GD_NO_MEMORY. */
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

/* --- taking them in --------------------------------------------------------------------------- */

static enum gd_status open_index(struct gd_field *field)
{
    field->face_seeds = malloc(sizeof *field->face_seeds * 2 * field->seed_count);
    return field->face_seeds ? GD_OK : GD_NO_MEMORY;
}

static void enter(struct gd_field *field, uint32_t face, uint32_t seed)
{
    if (face != GD_NONE)
        field->face_seeds[field->face_seed_count++] = (struct gd__face_seed){face, seed};
}

/* First the one that the seed before was entered in, if it is one of them: seeds of a curve come in
 * runs. */
static void enter_both(struct gd_field *field, const uint32_t face[2], uint32_t seed)
{
    uint32_t count = field->face_seed_count;
    bool second = count && field->face_seeds[count - 1].face == face[1];
    enter(field, face[second], seed);
    enter(field, face[!second], seed);
}

/* False: a segment in no face. */
static bool enter_seed(struct gd_field *field, uint32_t seed)
{
    struct gd__seed *s = &field->seeds[seed];
    struct gd__home home;
    if (!home_of(field->mesh, s, &home)) return false;
    field->has_segments |= s->is_segment;
    /* images are not written to, and not propagated from */
    if (s->is_segment && !field->is_image) s->face = home.face;
    enter(field, home.face, seed);
    if (home.edge != GD_NONE) enter_both(field, &field->mesh->side_face[2 * home.edge], seed);
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
    memset(to, 0, sizeof *to); /* its gaps, too: they are written to images */
    to->point = from->point;
    to->offset = from->offset / unit;
    to->is_segment = from->is_segment;
    if (from->is_segment) to->end = from->end;
}

/* Asks for the faces of an edge: those of a curve are nowhere near each other in memory. */
GD__ASKING ask_for_faces(const struct gd_mesh *mesh, const struct gd_seed *seed)
{
    if (seed->point.kind == GD_POINT_EDGE)
        __builtin_prefetch(&mesh->side_face[2 * seed->point.element]);
}

/* Checks, copies and enters each while it is at hand. */
static enum gd_status take_each(struct gd_field *field, const struct gd_field_request *request,
                                struct gd_detail *detail)
{
    for (uint32_t i = 0; i < request->seed_count; i++) {
        const struct gd_seed *seed = &request->seeds[i];
        if (i + SEEDS_AHEAD < request->seed_count) ask_for_faces(field->mesh, seed + SEEDS_AHEAD);
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
    return status ? gd_fail(detail, status, "%s", gd_status_sentence(status)) : GD_OK;
}

/* --- looking them up -------------------------------------------------------------------------- */

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
