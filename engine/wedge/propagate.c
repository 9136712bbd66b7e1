#include "wedge/wavefront.h"

#define REMIND_AFTER 8 /* visits of a side: on meshes of any sense few sides have more than three */

/* --- by any thread ------------------------------------------------------------------------------------------------------- */

/* Takes the windows off the side's list; the block is the job's. */
static void take(const struct gd__wavefront *front, struct gd__job *job)
{
    const struct gd_mesh *mesh = front->mesh;
    struct gd__list *list = &front->lists[job->node];
    job->windows = gd__list_windows(list);
    job->block = list->block;
    job->count = list->count;
    job->size_class = list->size_class;
    list->block = NULL;
    list->count = 0;
    if (list->visits < UINT16_MAX) list->visits++;
    uint32_t origin = mesh->origin[job->node], destination = mesh->origin[job->node ^ 1];
    job->at.side = job->node;
    job->at.length = mesh->side[job->node].length;
    job->at.d0 = front->distance[origin];
    job->at.d1 = front->distance[destination];
    job->at.l0 = gd__wavefront_rest(front, origin);
    job->at.l1 = gd__wavefront_rest(front, destination);
}

/* Drops windows whose source is nearer now than when it cast them: it casts them again. See remind.c. */
static uint32_t drop_stale(const struct gd__wavefront *front, const struct gd__windows *w, uint32_t count)
{
    uint32_t vertices = front->mesh->vertex_count, stale = 0, kept = 0;
    for (uint32_t i = 0; i < count; i++)
        stale += w->source[i] < vertices && w->sigma[i] != front->distance[w->source[i]];
    for (uint32_t i = 0; i < count && stale; i++) {
        if (w->source[i] < vertices && w->sigma[i] != front->distance[w->source[i]]) continue;
        struct gd__window window = gd__windows_get(w, i);
        gd__windows_put(w, kept++, &window);
    }
    return stale ? kept : count;
}

/* Leaves of a side's windows what is of use after all that is known of the edge, and comes within the bound. */
static enum gd_status prune(const struct gd__wavefront *front, struct gd__job *job, struct gd__hand *hand)
{
    double d0 = job->at.d0, d1 = job->at.d1;
    if (front->guide) { /* what lies beyond the bound is as useless as what lies behind a shorter way */
        d0 = fmin(d0, front->bound - job->at.l0);
        d1 = fmin(d1, front->bound - job->at.l1);
    }
    job->count = drop_stale(front, &job->windows, job->count);
    bool own = front->lists[job->node].visits > (front->methods.no_filter ? 1 : REMIND_AFTER),
         twin = front->methods.one_list;
    enum gd_status status = own || twin ? gd__remind(front, job, hand, own, twin) : GD_OK;
    if (!status && !front->methods.no_filter)
        job->count = front->kernel->filter(&job->windows, job->count, job->at.length, d0, d1);
    if (!status && front->bound < GD__FAR && !front->guide)
        job->count = front->kernel->within(&job->windows, job->count, front->bound);
    return status;
}

static enum gd_status untangle(struct gd__children *children, double length, struct gd__hand *hand)
{
    if (children->tangled == GD_NONE) return GD_OK;
    return gd__untangle(children, &hand->pool, GD_TOL_WIDTH * length, &hand->scratch);
}

/* Casts the windows of a side with a face. */
static enum gd_status cast(const struct gd__wavefront *front, struct gd__job *job, struct gd__hand *hand)
{
    const struct gd_side *s = &front->mesh->side[job->node];
    enum gd_status status = gd__children_reserve(&job->left, &hand->pool, job->count);
    if (!status) status = gd__children_reserve(&job->right, &hand->pool, job->count);
    if (status) return status;
    job->is_cast = true;
    job->vertex = gd__side_apex(front->mesh, job->node);
    job->apex.distance = front->distance[job->vertex];
    job->apex.improved = false;
    front->kernel->cast(s, &job->windows, job->count, !front->methods.no_coalescing, &job->apex, &job->left,
                        &job->right);
    status = untangle(&job->left, s->left_length, hand);
    return status ? status : untangle(&job->right, s->right_length, hand);
}

void gd__propagate_begin(struct gd__wavefront *front, struct gd__job *job, struct gd__hand *hand)
{
    take(front, job);
    job->is_cast = false;
    job->recalled = 0;
    job->status = prune(front, job, hand);
    if (!job->status && job->count && !gd__side_is_boundary(front->mesh, job->node))
        job->status = cast(front, job, hand);
}

/* --- by the leader ------------------------------------------------------------------------------------------------------- */

/* Stores windows as a chunk of wedges of the side's edge. */
static enum gd_status store(struct gd__wavefront *front, uint32_t side, const struct gd__windows *windows,
                            uint32_t count)
{
    struct gd__region *wedges = &front->work->wedges;
    enum gd_status status = gd__region_reserve(wedges, gd__chunk_most(count));
    if (status) return status;
    struct gd__chunk *chunk = (struct gd__chunk *)(wedges->base + wedges->used);
    double length = front->mesh->side[side].length;
    *chunk = (struct gd__chunk){.previous = front->newest[side >> 1], .count = count};
    if (!front->kernel->store(windows, count, length, side & 1, gd__chunk_wedges(chunk)))
        chunk->count = gd__wedges_write(windows, count, length, side & 1, chunk->data);
    front->newest[side >> 1] = (uint32_t)(wedges->used / GD__CHUNK_UNIT);
    wedges->used += sizeof *chunk + (size_t)chunk->count * GD__WEDGE_BYTES;
    front->wedge_count += chunk->count;
    return GD_OK;
}

static void count_effort(struct gd__wavefront *front, const struct gd__job *job)
{
    if (front->lists[job->node].visits == 1) front->sides_visited++;
    front->effort.sides_propagated++;
    front->effort.wedges_recalled += job->recalled;
    if (job->is_cast) front->effort.windows_propagated += job->count;
}

static void hand_on(struct gd__wavefront *front, struct gd__job *job)
{
    const struct gd_side *s = &front->mesh->side[job->node];
    if (job->apex.improved) {
        struct gd__birth birth = {.x = job->apex.x, .y = job->apex.y, .side = job->node, .source = job->apex.source};
        gd__wavefront_reach(front, job->vertex, job->apex.distance, birth);
    }
    double rest = gd__wavefront_rest(front, job->vertex), distance = front->distance[job->vertex];
    gd__wavefront_deliver(
        front, &(struct gd__receiver){s->left, s->left_length, job->at.d0, distance, job->at.l0, rest}, &job->left);
    gd__wavefront_deliver(
        front, &(struct gd__receiver){s->right, s->right_length, distance, job->at.d1, rest, job->at.l1}, &job->right);
}

void gd__propagate_end(struct gd__wavefront *front, struct gd__job *job)
{
    count_effort(front, job);
    if (!front->status) front->status = job->status;
    if (!front->status && job->count && !front->without_wedges)
        front->status = store(front, job->node, &job->windows, job->count);
    if (!front->status && job->is_cast) hand_on(front, job);
    gd__pool_release(&front->work->hand[job->hand].pool, job->block, job->size_class);
}
