#include "tests/samples/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- start and finish ------------------------------------------------------------------------- */

struct half {
    uint32_t low, high, slot;
};

static int half_compare(const void *a, const void *b)
{
    const struct half *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->slot > y->slot) - (x->slot < y->slot);
}

static bool pair_twins(struct surface *surface)
{
    uint32_t slots = 3 * surface->face_slots;
    struct half *halves = malloc((slots + 1) * sizeof *halves);
    if (!halves) return false;
    for (uint32_t slot = 0; slot < slots; slot++) {
        uint32_t a = surface->corners[slot], b = surface_destination(surface, slot);
        halves[slot] = (struct half){a < b ? a : b, a < b ? b : a, slot};
        surface->outgoing[a] = slot;
    }
    qsort(halves, slots, sizeof *halves, half_compare);
    for (uint32_t i = 0; i + 1 < slots; i += 2) {
        surface->twin[halves[i].slot] = halves[i + 1].slot;
        surface->twin[halves[i + 1].slot] = halves[i].slot;
    }
    free(halves);
    return true;
}

enum gd_status surface_start(struct gd_polygons *mesh, struct surface *out)
{
    struct surface surface = {.positions = mesh->positions,
                              .vertex_count = mesh->position_count,
                              .face_slots = mesh->polygon_count,
                              .faces = mesh->polygon_count,
                              .corners = mesh->corners};
    surface.twin = malloc((3 * (size_t)mesh->polygon_count + 1) * sizeof *surface.twin);
    surface.outgoing = malloc((mesh->position_count + (size_t)1) * sizeof *surface.outgoing);
    if (!surface.twin || !surface.outgoing || !pair_twins(&surface)) {
        free(surface.twin);
        free(surface.outgoing);
        return GD_NO_MEMORY;
    }
    *mesh = (struct gd_polygons){0};
    *out = surface;
    return GD_OK;
}

void surface_finish(struct surface *surface, struct gd_polygons *out)
{
    uint32_t *index = surface->outgoing, vertices = 0, faces = 0;
    for (uint32_t v = 0; v < surface->vertex_count; v++) {
        if (index[v] == GD_NONE) continue;
        memmove(surface->positions[vertices], surface->positions[v], sizeof *surface->positions);
        index[v] = vertices++;
    }
    for (uint32_t f = 0; f < surface->face_slots; f++) {
        if (surface->corners[3 * f] == GD_NONE) continue;
        for (uint32_t k = 0; k < 3; k++)
            surface->corners[3 * faces + k] = index[surface->corners[3 * f + k]];
        faces++;
    }
    free(surface->twin);
    free(surface->outgoing);
    *out = (struct gd_polygons){surface->positions, vertices, faces, surface->corners, NULL};
}

/* --- collapse --------------------------------------------------------------------------------- */

double surface_length(const struct surface *surface, uint32_t slot)
{
    const double *a = surface->positions[surface->corners[slot]],
                 *b = surface->positions[surface_destination(surface, slot)];
    double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return sqrt(x * x + y * y + z * z);
}

static bool is_neighbour(const struct surface *surface, uint32_t vertex, uint32_t other)
{
    uint32_t first = surface->outgoing[vertex], slot = first;
    do {
        if (surface_destination(surface, slot) == other) return true;
    } while ((slot = surface_turn(surface, slot)) != first);
    return false;
}

uint32_t surface_valence(const struct surface *surface, uint32_t vertex)
{
    uint32_t first = surface->outgoing[vertex], slot = first, count = 0;
    do count++;
    while ((slot = surface_turn(surface, slot)) != first);
    return count;
}

/* Returns whether the edge may be collapsed. Its ends must have exactly two common neighbours,
 * which are the apexes of its faces, and both apexes must keep at least three faces. */
static bool may_collapse(const struct surface *surface, uint32_t slot)
{
    uint32_t a = surface->corners[slot], b = surface_destination(surface, slot), common = 0;
    uint32_t first = surface->outgoing[a], turn = first;
    do common += is_neighbour(surface, b, surface_destination(surface, turn));
    while ((turn = surface_turn(surface, turn)) != first);
    return common == 2 && surface_valence(surface, surface_apex(surface, slot)) > 3 &&
           surface_valence(surface, surface_apex(surface, surface->twin[slot])) > 3;
}

static void normal_of(const double a[3], const double b[3], const double c[3], double out[3])
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    for (int k = 0; k < 3; k++)
        out[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

/* Returns whether moving the vertex would turn one of its faces by more than about 60 degrees. The
 * two faces at `gone` are ignored. */
static bool turns_a_face(const struct surface *surface, uint32_t vertex, const double to[3],
                         uint32_t gone)
{
    uint32_t first = surface->outgoing[vertex], slot = first;
    do {
        if (slot / 3 == gone / 3 || slot / 3 == surface->twin[gone] / 3) continue;
        const double *b = surface->positions[surface_destination(surface, slot)],
                     *c = surface->positions[surface_apex(surface, slot)];
        double before[3], after[3], dot = 0, square[2] = {0, 0};
        normal_of(surface->positions[vertex], b, c, before);
        normal_of(to, b, c, after);
        for (int k = 0; k < 3; k++) {
            dot += before[k] * after[k];
            square[0] += before[k] * before[k];
            square[1] += after[k] * after[k];
        }
        if (dot <= 0.5 * sqrt(square[0] * square[1])) return true;
    } while ((slot = surface_turn(surface, slot)) != first);
    return false;
}

/* Removes the slot's face and joins the faces across its other two edges. `kept` is the vertex that
 * replaces the destination. */
static void zip(struct surface *surface, uint32_t slot, uint32_t kept)
{
    uint32_t ahead = surface->twin[surface_next(slot)],
             behind = surface->twin[surface_previous(slot)];
    surface->twin[ahead] = behind;
    surface->twin[behind] = ahead;
    surface->outgoing[surface_apex(surface, slot)] = ahead;
    surface->outgoing[kept] = behind;
    for (uint32_t k = 0, first = slot / 3 * 3; k < 3; k++) surface->corners[first + k] = GD_NONE;
    surface->faces--;
}

bool surface_collapse(struct surface *surface, uint32_t slot)
{
    uint32_t a = surface->corners[slot], b = surface_destination(surface, slot),
             twin = surface->twin[slot];
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (surface->positions[a][k] + surface->positions[b][k]);
    if (!may_collapse(surface, slot) || turns_a_face(surface, a, middle, slot) ||
        turns_a_face(surface, b, middle, slot))
        return false;
    uint32_t first = surface->outgoing[b], turn = first;
    do surface->corners[turn] = a;
    while ((turn = surface_turn(surface, turn)) != first);
    zip(surface, slot, a);
    zip(surface, twin, a);
    memcpy(surface->positions[a], middle, sizeof middle);
    surface->outgoing[b] = GD_NONE;
    return true;
}

/* --- flip ------------------------------------------------------------------------------------- */

static void join(struct surface *surface, uint32_t slot, uint32_t twin)
{
    surface->twin[slot] = twin;
    surface->twin[twin] = slot;
    surface->outgoing[surface->corners[slot]] = slot;
    surface->outgoing[surface->corners[twin]] = twin;
}

/* Faces (a, b, c) and (b, a, d) become (d, b, c) and (c, a, d). The shared edge is in the last slot
 * of each face. */
bool surface_flip(struct surface *surface, uint32_t slot)
{
    uint32_t twin = surface->twin[slot], a = surface->corners[slot], b = surface->corners[twin];
    uint32_t c = surface_apex(surface, slot), d = surface_apex(surface, twin);
    if (is_neighbour(surface, c, d) || surface_valence(surface, a) <= 3 ||
        surface_valence(surface, b) <= 3)
        return false;
    uint32_t bc = surface->twin[surface_next(slot)], ca = surface->twin[surface_previous(slot)];
    uint32_t ad = surface->twin[surface_next(twin)], db = surface->twin[surface_previous(twin)];
    uint32_t f = slot / 3 * 3, g = twin / 3 * 3;
    surface->corners[f] = d, surface->corners[f + 1] = b, surface->corners[f + 2] = c;
    surface->corners[g] = c, surface->corners[g + 1] = a, surface->corners[g + 2] = d;
    join(surface, f, db);
    join(surface, f + 1, bc);
    join(surface, f + 2, g + 2);
    join(surface, g, ca);
    join(surface, g + 1, ad);
    return true;
}
