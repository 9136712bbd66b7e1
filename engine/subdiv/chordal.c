#include "subdiv/chordal.h"

#include <math.h>
#include <stdlib.h>

#include "base/large.h"

enum { FINER = 2, STEP = 1 << FINER };

enum gd_status gd__grid_room(uint32_t level, struct gd__grid_room *out)
{
    size_t side = ((size_t)1 << level) + 1;
    struct gd__grid_room room = {gd__large_array(side * side, sizeof *room.positions),
                                 gd__large_array(side * side, sizeof *room.normals)};
    if (!room.positions || !room.normals) {
        gd__grid_room_free(&room);
        return GD_NO_MEMORY;
    }
    *out = room;
    return GD_OK;
}

void gd__grid_room_free(struct gd__grid_room *room)
{
    free(room->positions);
    free(room->normals);
    *room = (struct gd__grid_room){0};
}

/* The fine grid of a face; `side` is the number of vertices in a row. */
struct fine {
    const struct gd_vec3 *positions, *normals;
    uint32_t cells, side;
    bool triangles;
};

static struct gd_vec3 point(const struct fine *fine, uint32_t i, uint32_t j)
{
    return fine->positions[i * fine->side + j];
}

/* Returns a + x (b - a) + y (c - a). */
static struct gd_vec3 on_triangle(struct gd_vec3 a, struct gd_vec3 b, struct gd_vec3 c, double x,
                                  double y)
{
    return gd_vec3_along(gd_vec3_along(a, x, gd_vec3_sub(b, a)), y, gd_vec3_sub(c, a));
}

/* Returns the distance of the fine vertex (i,j), along its normal, from the triangles of its coarse
 * cell. A quad cell can be divided along either diagonal; returns the greater of the two
 * distances. */
static double off_triangles(const struct fine *fine, uint32_t i, uint32_t j)
{
    uint32_t i0 = i / STEP * STEP, j0 = j / STEP * STEP;
    double x = (double)(i - i0) / STEP, y = (double)(j - j0) / STEP;
    struct gd_vec3 p = point(fine, i, j), normal = fine->normals[i * fine->side + j];
    struct gd_vec3 b = point(fine, i0 + STEP, j0), d = point(fine, i0, j0 + STEP),
                   a = point(fine, i0, j0);
    struct gd_vec3 flat = x + y <= 1
                              ? on_triangle(a, b, d, x, y)
                              : on_triangle(point(fine, i0 + STEP, j0 + STEP), d, b, 1 - x, 1 - y);
    double off = fabs(gd_vec3_dot(gd_vec3_sub(p, flat), normal));
    if (fine->triangles) return off;
    struct gd_vec3 c = point(fine, i0 + STEP, j0 + STEP);
    flat = x >= y ? on_triangle(b, a, c, 1 - x, y) : on_triangle(d, c, a, x, 1 - y);
    return fmax(off, fabs(gd_vec3_dot(gd_vec3_sub(p, flat), normal)));
}

static double off_inside(const struct fine *fine, struct gd__pace *pace)
{
    double most = 0;
    for (uint32_t i = 0; i < fine->cells && gd__pace(pace, fine->cells); i++) {
        uint32_t end = fine->triangles ? fine->cells - i : fine->cells;
        for (uint32_t j = 0; j < end; j++) most = fmax(most, off_triangles(fine, i, j));
    }
    return most;
}

static double off_chord(struct gd_vec3 p, struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 chord = gd_vec3_sub(b, a), way = gd_vec3_sub(p, a);
    double square = gd_vec3_dot(chord, chord);
    if (!(square > 0)) return gd_vec3_length(way);
    return gd_vec3_length(gd_vec3_along(way, -gd_vec3_dot(way, chord) / square, chord));
}

static struct gd_vec3 on_side(const struct fine *fine, uint32_t k, uint32_t m)
{
    uint32_t at[2];
    gd__side_place(fine->triangles ? 3 : 4, k, fine->cells, m, at);
    return point(fine, at[0], at[1]);
}

static double off_sides(const struct fine *fine)
{
    double most = 0;
    for (uint32_t k = 0; k < (fine->triangles ? 3 : 4); k++) {
        for (uint32_t m = 0; m < fine->cells; m++) {
            uint32_t begin = m / STEP * STEP;
            double off = off_chord(on_side(fine, k, m), on_side(fine, k, begin),
                                   on_side(fine, k, begin + STEP));
            most = fmax(most, off);
        }
    }
    return most;
}

struct search {
    struct gd__walker *walker; /* a walker with enough stages for the finest grid */
    struct gd__grid_room room; /* grows as needed */
    uint32_t room_level;
    double tolerance;
    struct gd__pace *pace;
};

/* Finds the level of one face. */
static enum gd_status find_level(struct search *search, uint32_t face, uint32_t least, uint8_t *out)
{
    struct gd__walker *walker = search->walker;
    struct gd__grid_room *room = &search->room;
    for (uint32_t level = least; level <= GD__LEVEL_MOST - FINER; level++) {
        uint32_t fine_level = level + FINER;
        if (fine_level > search->room_level) {
            struct gd__grid_room larger;
            enum gd_status status = gd__grid_room(fine_level, &larger);
            if (status) return status;
            gd__grid_room_free(room);
            *room = larger;
            search->room_level = fine_level;
        }
        enum gd_status status = gd__grid(walker, face, fine_level, room, search->pace);
        if (status) return status;
        uint32_t cells = 1u << fine_level;
        struct fine fine = {room->positions, room->normals, cells, cells + 1,
                            walker->surface->rules->arity == 3};
        double off = fmax(off_inside(&fine, search->pace), off_sides(&fine));
        if (search->pace->status) return search->pace->status;
        if (off <= search->tolerance) {
            *out = (uint8_t)level;
            return GD_OK;
        }
    }
    return GD_TOO_LARGE;
}

enum gd_status gd__chordal_levels(const struct gd_subdivision *surface, double tolerance,
                                  const struct gd_control *control, struct gd__tiling *tiling)
{
    /* a face with finer edges must have an inner vertex */
    uint32_t least = surface->rules->arity == 4 ? 1 : 2, faces = surface->base.face_count;
    struct gd__walker walker = {0};
    struct gd__pace pace = {.control = control};
    struct search search = {
        .walker = &walker, .room_level = least + FINER, .tolerance = tolerance, .pace = &pace};
    enum gd_status status =
        gd__walker_create(&walker, surface, gd__grid_stages(GD__LEVEL_MOST), control);
    if (!status) status = gd__grid_room(search.room_level, &search.room);
    for (uint32_t face = 0; !status && face < faces; face++) {
        if (face % 16 == 0) status = gd_control_check(control, 0.5 * face / faces);
        pace.fraction = 0.5 * face / faces;
        if (!status) status = find_level(&search, face, least, &tiling->face_level[face]);
    }
    gd__grid_room_free(&search.room);
    gd__walker_free(&walker);
    return status;
}
