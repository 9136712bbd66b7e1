#include "mesh/orientation.h"

#include <stdlib.h>

#include "base/large.h"
#include "gd/polygons.h"

struct search {
    struct gd__orientation *o;
    uint32_t *queue; /* all faces, component by component */
    uint32_t end;
};

static void visit_neighbours(struct search *search, uint32_t face, bool *contradicted)
{
    struct gd__orientation *o = search->o;
    for (uint32_t side = 3 * face; side < 3 * face + 3; side++) {
        uint32_t other = o->neighbour[side];
        if (other == GD_NONE) continue;
        bool are_alike = o->corner[side / 3][side % 3] == o->corner[other / 3][other % 3];
        uint8_t wanted = o->flipped[face] ^ (uint8_t)are_alike;
        if (o->component[other / 3] == GD_NONE) {
            o->component[other / 3] = o->component[face];
            o->flipped[other / 3] = wanted;
            search->queue[search->end++] = other / 3;
        } else if (o->flipped[other / 3] != wanted && !*contradicted) {
            if (o->contradicted) o->contradicted(o->user, side);
            *contradicted = true;
        }
    }
}

/* Counts the faces in the queue from `begin` on that are marked as flipped. If these are more than
 * half of the faces, inverts all marks, so that at most half of the faces are flipped. Returns the
 * number of flipped faces. */
static uint32_t side_with_majority(const struct search *search, uint32_t begin)
{
    uint8_t *flipped = search->o->flipped;
    const uint32_t *member = search->queue + begin;
    uint32_t turned = 0, count = search->end - begin;
    GD__PACED (search->o->pace, i, count) turned += flipped[member[i]];
    if (2 * (uint64_t)turned <= count) return turned;
    GD__PACED (search->o->pace, i, count) flipped[member[i]] ^= 1;
    return count - turned;
}

static void orient_component(struct search *search, uint32_t seed)
{
    struct gd__orientation *o = search->o;
    uint32_t begin = search->end;
    bool contradicted = false;
    o->component[seed] = o->component_count++;
    search->queue[search->end++] = seed;
    for (uint32_t i = begin; i < search->end && gd__pace(o->pace, 1); i++)
        visit_neighbours(search, search->queue[i], &contradicted);
    o->flipped_count += side_with_majority(search, begin);
}

enum gd_status gd__orient_faces(struct gd__orientation *orientation)
{
    struct search search = {orientation,
                            gd__large_array(orientation->face_count, sizeof *search.queue), 0};
    if (!search.queue) return GD_NO_MEMORY;
    gd__pace_fill(orientation->pace, orientation->component,
                  orientation->face_count * sizeof *orientation->component);
    orientation->component_count = orientation->flipped_count = 0;
    GD__PACED (orientation->pace, i, orientation->seed_count) {
        uint32_t seed = orientation->seeds ? orientation->seeds[i] : i;
        if (seed != GD_NONE && orientation->component[seed] == GD_NONE)
            orient_component(&search, seed);
    }
    free(search.queue);
    return orientation->pace->status;
}
