#include "field/layout.h"

/* The distance at a point of a face: the least over the face's corners, the seeds in the face, and the wedges of its edges whose source lies
 * across the edge (a source on the face's own side reaches the point through another edge or through a corner). */

void gd__point_weights(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t face, double weight[3])
{
    weight[0] = weight[1] = weight[2] = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t side = mesh->face_side[face][k];
        switch (point->kind) {
        case GD_POINT_VERTEX:
            if (mesh->origin[side] == point->element) weight[k] = 1;
            break;
        case GD_POINT_EDGE:
            if (side >> 1 != point->element) break;
            weight[k] = side & 1 ? point->weight[0] : 1 - point->weight[0];
            weight[(k + 1) % 3] = side & 1 ? 1 - point->weight[0] : point->weight[0];
            break;
        case GD_POINT_FACE:
            weight[k] = point->weight[k];
            break;
        }
    }
}

struct gd__local gd__face_local(const struct gd_mesh *mesh, uint32_t side, const double weight[3])
{
    const struct gd_side *s = &mesh->side[side];
    return (struct gd__local){weight[1] * s->length + weight[2] * s->left_length * s->left_x,
                              weight[2] * s->left_length * s->left_y};
}

/* Weights rotated so that they belong to origin, destination and apex of side k of the face. */
static struct gd__local local_of_side(const struct gd_mesh *mesh, uint32_t face, int k, const double weight[3])
{
    double rotated[3] = {weight[k], weight[(k + 1) % 3], weight[(k + 2) % 3]};
    return gd__face_local(mesh, mesh->face_side[face][k], rotated);
}

static void try_corner(const struct gd_field *field, uint32_t face, int k, struct gd__local at, struct gd__leg *best)
{
    uint32_t vertex = field->mesh->origin[field->mesh->face_side[face][k]];
    double distance = field->distance[vertex] + sqrt(at.x * at.x + at.y * at.y);
    if (distance < best->distance)
        *best = (struct gd__leg){
            .distance = distance, .kind = GD__LEG_VERTEX, .face = face, .from = vertex, .source = GD_NONE};
}

static void try_seeds(const struct gd_field *field, uint32_t face, struct gd__local at, struct gd__leg *best)
{
    const struct gd_mesh *mesh = field->mesh;
    const struct gd__face_seed *end = field->face_seeds + field->face_seed_count;
    for (const struct gd__face_seed *f = gd__field_seeds_in(field, face); f < end && f->face == face; f++) {
        double weight[3];
        gd__point_weights(mesh, &field->seeds[f->seed].point, face, weight);
        struct gd__local seed = gd__face_local(mesh, mesh->face_side[face][0], weight);
        double dx = at.x - seed.x, dy = at.y - seed.y,
               distance = field->seeds[f->seed].offset + sqrt(dx * dx + dy * dy);
        if (distance < best->distance || (distance == best->distance && best->kind == GD__LEG_VERTEX))
            *best = (struct gd__leg){.distance = distance, .kind = GD__LEG_SEED, .face = face, .from = f->seed};
    }
}

/* The leg through one wedge [b0, b1] with its source at (x, -y) in the frame of the side. */
static void try_wedge(double sigma, double x, double y, double b0, double b1, struct gd__local at, struct gd__leg *best,
                      uint32_t face, uint32_t side, uint32_t source)
{
    double dx = at.x - x, dy = at.y + y, straight2 = dx * dx + dy * dy, room = best->distance - sigma;
    if (room <= 0 || straight2 >= room * room) return;
    double t = dy > 0 ? x + dx * (y / dy) : at.x, distance;
    if (t < b0 || t > b1) { /* round the wedge's nearer end */
        t = t < b0 ? b0 : b1;
        double ex = t - x, fx = at.x - t;
        distance = sigma + sqrt(ex * ex + y * y) + sqrt(fx * fx + at.y * at.y);
        if (distance >= best->distance) return;
    } else {
        distance = sigma + sqrt(straight2);
    }
    *best = (struct gd__leg){.distance = distance,
                             .kind = GD__LEG_WEDGE,
                             .face = face,
                             .side = side,
                             .parameter = t,
                             .x = x,
                             .y = y,
                             .source = source};
}

/* The wedges of a chunk of a side's edge whose source lies across the side. */
static void try_chunk(const struct gd_field *field, const struct gd__chunk *chunk, uint32_t face, uint32_t side,
                      struct gd__local at, struct gd__leg *best)
{
    double length = field->mesh->side[side].length, unit = length * GD__WEDGE_UNIT;
    struct gd__wedges wedges = gd__chunk_wedges(chunk);
    uint32_t across = side & 1 ? GD__WINDOW_FAR_SIDE : 0;
    for (uint32_t i = 0; i < chunk->count; i++) {
        struct gd__window w = gd__wedge_window(wedges, chunk->count, i, length);
        if (w.source == GD_NONE || w.tags != across) continue;
        if (across) w = gd__window_mirrored(&w, length);
        /* ends are stored to one unit: a crossing of the edge within two of them counts as inside, where a neighbour is as short */
        w.b0 = fmax(w.b0 - 2 * unit, 0);
        w.b1 = fmin(w.b1 + 2 * unit, length);
        try_wedge(gd__field_sigma(field, w.source), w.x, w.y, w.b0, w.b1, at, best, face, side, w.source);
    }
}

static void try_side(const struct gd_field *field, uint32_t face, uint32_t side, struct gd__local at,
                     struct gd__leg *best)
{
    uint32_t next = field->newest[side >> 1];
    while (next != GD_NONE) {
        const struct gd__chunk *chunk = gd__field_chunk(field, next);
        try_chunk(field, chunk, face, side, at, best);
        next = chunk->previous;
    }
}

static void try_face(const struct gd_field *field, const struct gd_point *point, uint32_t face, struct gd__leg *best)
{
    double weight[3];
    gd__point_weights(field->mesh, point, face, weight);
    struct gd__local at[3];
    for (int k = 0; k < 3; k++) {
        at[k] = local_of_side(field->mesh, face, k, weight);
        try_corner(field, face, k, at[k], best);
    }
    try_seeds(field, face, at[0], best);
    for (int k = 0; k < 3; k++) try_side(field, face, field->mesh->face_side[face][k], at[k], best);
}

struct gd__leg gd__field_leg(const struct gd_field *field, const struct gd_point *point)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__leg best = {.distance = GD__FAR, .kind = GD__LEG_NONE, .source = GD_NONE};
    switch (point->kind) {
    case GD_POINT_VERTEX:
        best.distance = field->distance[point->element];
        best.from = point->element;
        if (best.distance < GD__FAR) best.kind = GD__LEG_VERTEX;
        break;
    case GD_POINT_EDGE:
        for (uint32_t side = 2 * point->element; side < 2 * point->element + 2; side++)
            if (!gd__side_is_boundary(mesh, side)) try_face(field, point, mesh->side_face[side], &best);
        break;
    case GD_POINT_FACE:
        try_face(field, point, point->element, &best);
        break;
    }
    return best;
}
