/* Finds the faces that share an edge. Rejects edges of more than two faces, and duplicate faces. */
#include <stdatomic.h>
#include <stdlib.h>

#include "base/slices.h"
#include "construction/steps.h"
#include "mesh/edge_table.h"
#include "construction/offenders.h"
#include "repair/repair.h"

static uint32_t opposite_corner(const struct gd__construction *work, uint32_t side)
{
    return work->corner[side / 3][gd__previous_corner(side % 3)];
}

struct findings {
    /* `a` is a face, `witness` an earlier face with the same vertices */
    struct gd__offenders duplicates;
    /* (`a`, `b`) is an edge of more than two faces, `witness` its first entry in the edge table */
    struct gd__offenders crowded;
};

static void add_duplicate(const struct gd__construction *work, uint32_t f, uint32_t g,
                          struct findings *findings)
{
    uint32_t a = gd__input_polygon(work->mesh, f), b = gd__input_polygon(work->mesh, g);
    gd__offenders_add(&findings->duplicates, a > b ? a : b, 0, a > b ? b : a);
}

/* Returns true if the two faces of an edge have the same vertices, and this edge joins the two
 * lowest of them. */
static bool is_duplicate(const struct gd__construction *work, const struct gd__edge_use pair[2])
{
    uint32_t apex = opposite_corner(work, pair[0].side);
    return apex > pair[0].high && apex == opposite_corner(work, pair[1].side);
}

/* Finds faces with the same vertices. Such faces share the edge between their two lowest vertices.
 * Only this edge is tested, so each duplicate is found once. */
static enum gd_status find_duplicates(const struct gd__construction *work,
                                      const struct gd__edge_use *use, uint32_t count,
                                      struct findings *findings)
{
    /* here, the member `high` is the apex of the face */
    struct gd__edge_use *by_apex = malloc(count * sizeof *by_apex);
    if (!by_apex) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < count; i++)
        by_apex[i] = (struct gd__edge_use){opposite_corner(work, use[i].side), use[i].side};
    qsort(by_apex, count, sizeof *by_apex, gd__edge_use_compare);
    for (uint32_t i = 1; i < count; i++) {
        if (by_apex[i].high == by_apex[i - 1].high && by_apex[i].high > use[0].high)
            add_duplicate(work, by_apex[i].side / 3, by_apex[i - 1].side / 3, findings);
    }
    free(by_apex);
    return GD_OK;
}

/* Records an edge with more than two faces. */
static enum gd_status note_crowded(const struct gd__construction *work,
                                   const struct gd__edge_table *table,
                                   const struct gd__edge_run *run, struct findings *findings)
{
    uint32_t a = work->mesh->index_of_vertex[run->low], b = work->mesh->index_of_vertex[run->high];
    gd__offenders_add(&findings->crowded, a < b ? a : b, a < b ? b : a, run->begin);
    return find_duplicates(work, table->use + run->begin, run->count, findings);
}

/* Finds duplicate faces and edges of more than two faces. */
static enum gd_status find_offenders(struct gd__construction *work,
                                     const struct gd__edge_table *table, struct findings *findings)
{
    enum gd_status status = GD_OK;
    for (struct gd__edge_run run = {0};
         !status && gd__pace(&work->pace, 1) && gd__edge_table_next(table, &run);) {
        const struct gd__edge_use *use = table->use + run.begin;
        if (run.count == 2 && is_duplicate(work, use))
            add_duplicate(work, use[0].side / 3, use[1].side / 3, findings);
        else if (run.count > 2)
            status = note_crowded(work, table, &run, findings);
    }
    return status;
}

struct joining {
    struct gd__construction *work;
    const struct gd__edge_table *table;
    atomic_bool has_offenders;
};

/* Joins the sides of the edges whose lower vertex is in the slice. */
static void join_slice(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct joining *joining = context;
    const struct gd__edge_table *table = joining->table;
    uint32_t *neighbour = joining->work->neighbour;
    bool has_offenders = false;
    struct gd__edge_run run = {.low = begin, .begin = table->first[begin]};
    while (gd__pace(pace, 1) && gd__edge_table_next(table, &run) && run.low < end) {
        const struct gd__edge_use *use = table->use + run.begin;
        neighbour[use[0].side] = run.count == 2 ? use[1].side : GD_NONE;
        if (run.count == 2) neighbour[use[1].side] = use[0].side;
        has_offenders |= run.count > 2 || (run.count == 2 && is_duplicate(joining->work, use));
    }
    if (has_offenders) atomic_store_explicit(&joining->has_offenders, true, memory_order_relaxed);
}

static enum gd_status refuse_duplicates(const struct gd__construction *work,
                                        const struct gd__offenders *duplicates)
{
    const struct gd__offender *face = &duplicates->lowest[0];
    if (face->a == face->witness)
        gd_fail(work->detail, GD_DUPLICATE_FACE, "face %u covers the same three vertices twice",
                face->witness);
    else
        gd_fail(work->detail, GD_DUPLICATE_FACE,
                "face %u has the same vertices as face %u; remove one of them", (unsigned)face->a,
                face->witness);
    uint32_t first = gd_polygons_first(work->polygons, face->witness);
    gd__blame_weld(work, work->polygons->corners + first,
                   gd_polygons_first(work->polygons, face->witness + 1) - first);
    return gd__offenders_report(duplicates, GD_ELEMENT_FACE, GD_DUPLICATE_FACE, work->detail);
}

static enum gd_status refuse_crowded(const struct gd__construction *work,
                                     const struct gd__edge_table *table,
                                     const struct gd__offenders *crowded)
{
    const struct gd__offender *edge = &crowded->lowest[0];
    const struct gd__edge_use *use = &table->use[edge->witness];
    const uint32_t *corner = work->corner[use->side / 3];
    uint32_t a = corner[use->side % 3], b = corner[gd__next_corner(use->side % 3)];
    uint32_t end = table->first[(a < b ? a : b) + 1];
    struct gd__offenders faces = {0};
    for (uint32_t i = edge->witness; i < end && table->use[i].high == use->high; i++)
        gd__offenders_add(&faces, gd__input_polygon(work->mesh, table->use[i].side / 3), 0, 0);
    gd_fail(work->detail, GD_NON_MANIFOLD_EDGE,
            "edge %u-%u belongs to %u faces (%u, %u, %u%s); at most two may share an edge",
            (unsigned)edge->a, (unsigned)edge->b, (unsigned)faces.total,
            (unsigned)faces.lowest[0].a, (unsigned)faces.lowest[1].a, (unsigned)faces.lowest[2].a,
            faces.total > 3 ? ", ..." : "");
    gd__blame_weld(work, (uint32_t[2]){(uint32_t)edge->a, (uint32_t)edge->b}, 2);
    return gd__offenders_report(crowded, GD_ELEMENT_EDGE, GD_NON_MANIFOLD_EDGE, work->detail);
}

enum gd_status gd__connect(struct gd__construction *work)
{
    const struct gd_mesh *mesh = work->mesh;
    size_t sides = 3 * (size_t)mesh->face_count;
    struct gd__loan *loan = &work->until_sides;
    work->neighbour = gd__scratch_array(work, loan, sides, sizeof *work->neighbour);
    struct gd__edge_table table = {
        mesh->vertex_count,
        gd__scratch_array(work, loan, (size_t)mesh->vertex_count + 1, sizeof *table.first),
        gd__scratch_array(work, loan, sides + 1, sizeof *table.use)};
    struct findings findings = {0};
    enum gd_status status = work->neighbour && table.first && table.use ? GD_OK : GD_NO_MEMORY;
    if (!status)
        status = gd__edge_table_fill((const uint32_t(*)[3])work->corner, mesh->face_count,
                                     &work->pace, &table);
    struct joining joining = {.work = work, .table = &table};
    if (!status) gd__slices_run(&work->pace, mesh->vertex_count, join_slice, &joining);
    if (!status && joining.has_offenders) status = find_offenders(work, &table, &findings);
    if (!status && findings.duplicates.total)
        status = refuse_duplicates(work, &findings.duplicates);
    else if (!status && findings.crowded.total)
        status = refuse_crowded(work, &table, &findings.crowded);
    gd__scratch_free(work, table.first);
    gd__scratch_free(work, table.use);
    return status;
}
