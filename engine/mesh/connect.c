/* Which faces share an edge: a table of the faces' sides, bucketed by the lower vertex and sorted by the higher one.
 * Linear time but for the sorting within a bucket, and the same for every input, however it was chosen. */
#include <stdlib.h>

#include "mesh/build.h"
#include "mesh/offenders.h"

/* A side of a face as its edge sees it. */
struct use {
    uint32_t high; /* the edge's higher vertex */
    uint32_t side; /* 3 face + k */
};

struct edge_table {
    uint32_t *first; /* per lower vertex, vertex_count + 1 */
    struct use *use; /* 3 face_count */
};

static void ends_of_side(const struct gd__construction *work, uint32_t side, uint32_t *low, uint32_t *high)
{
    const uint32_t *corner = work->corner[side / 3];
    uint32_t a = corner[side % 3], b = corner[gd__next_corner(side % 3)];
    *low = a < b ? a : b;
    *high = a < b ? b : a;
}

static int compare_uses(const void *x, const void *y)
{
    const struct use *a = x, *b = y;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->side < b->side ? -1 : a->side > b->side;
}

#define SHORT_BUCKET 32

static void sort_bucket(struct use *use, uint32_t count)
{
    if (count > SHORT_BUCKET) {
        qsort(use, count, sizeof *use, compare_uses);
        return;
    }
    for (uint32_t i = 1; i < count; i++) {
        struct use moved = use[i];
        uint32_t j = i;
        for (; j > 0 && compare_uses(&moved, &use[j - 1]) < 0; j--) use[j] = use[j - 1];
        use[j] = moved;
    }
}

static void fill_table(const struct gd__construction *work, struct edge_table *table)
{
    uint32_t side_count = 3 * work->mesh->face_count, vertex_count = work->mesh->vertex_count, low, high;
    for (uint32_t s = 0; s < side_count; s++) {
        ends_of_side(work, s, &low, &high);
        table->first[low + 1]++;
    }
    for (uint32_t v = 0; v < vertex_count; v++) table->first[v + 1] += table->first[v];
    for (uint32_t s = 0; s < side_count; s++) {
        ends_of_side(work, s, &low, &high);
        table->use[table->first[low]++] = (struct use){high, s};
    }
    for (uint32_t v = vertex_count; v > 0; v--) table->first[v] = table->first[v - 1];
    table->first[0] = 0;
    for (uint32_t v = 0; v < vertex_count; v++)
        sort_bucket(table->use + table->first[v], table->first[v + 1] - table->first[v]);
}

static uint32_t opposite_corner(const struct gd__construction *work, uint32_t side)
{
    return work->corner[side / 3][gd__previous_corner(side % 3)];
}

struct findings {
    struct gd__offenders duplicates; /* a: a face, witness: an earlier one with the same vertices */
    struct gd__offenders crowded;    /* a, b: an edge of more than two faces, witness: its first entry in the table */
};

static void add_duplicate(const struct gd__construction *work, uint32_t f, uint32_t g, struct findings *findings)
{
    uint32_t a = gd__input_polygon(work->mesh, f), b = gd__input_polygon(work->mesh, g);
    gd__offenders_add(&findings->duplicates, a > b ? a : b, 0, a > b ? b : a);
}

/* Faces with the same vertices meet at the edge of their two lowest ones: looks there only, so that each is found
 * once. */
static enum gd_status find_duplicates(const struct gd__construction *work, const struct use *use, uint32_t count,
                                      struct findings *findings)
{
    struct use *by_apex = malloc(count * sizeof *by_apex); /* `high` is the apex here */
    if (!by_apex) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < count; i++) by_apex[i] = (struct use){opposite_corner(work, use[i].side), use[i].side};
    sort_bucket(by_apex, count);
    for (uint32_t i = 1; i < count; i++) {
        if (by_apex[i].high == by_apex[i - 1].high && by_apex[i].high > use[0].high)
            add_duplicate(work, by_apex[i].side / 3, by_apex[i - 1].side / 3, findings);
    }
    free(by_apex);
    return GD_OK;
}

/* An edge with more faces than a surface can have there. */
static enum gd_status note_crowded(const struct gd__construction *work, const struct edge_table *table, uint32_t low,
                                   uint32_t begin, uint32_t count, struct findings *findings)
{
    const struct use *use = table->use + begin;
    uint32_t a = work->mesh->index_of_vertex[low], b = work->mesh->index_of_vertex[use[0].high];
    gd__offenders_add(&findings->crowded, a < b ? a : b, a < b ? b : a, begin);
    return find_duplicates(work, use, count, findings);
}

static void join_pair(struct gd__construction *work, const struct use pair[2], struct findings *findings)
{
    uint32_t apex = opposite_corner(work, pair[0].side);
    if (apex > pair[0].high && apex == opposite_corner(work, pair[1].side))
        add_duplicate(work, pair[0].side / 3, pair[1].side / 3, findings);
    work->neighbour[pair[0].side] = pair[1].side;
    work->neighbour[pair[1].side] = pair[0].side;
}

static enum gd_status join_all(struct gd__construction *work, const struct edge_table *table, struct findings *findings)
{
    enum gd_status status = GD_OK;
    for (uint32_t v = 0; v < work->mesh->vertex_count && !status; v++) {
        uint32_t end = table->first[v + 1];
        for (uint32_t begin = table->first[v], next; begin < end && !status; begin = next) {
            for (next = begin + 1; next < end && table->use[next].high == table->use[begin].high;) next++;
            if (next - begin == 1)
                work->neighbour[table->use[begin].side] = GD_NONE;
            else if (next - begin == 2)
                join_pair(work, table->use + begin, findings);
            else
                status = note_crowded(work, table, v, begin, next - begin, findings);
        }
    }
    return status;
}

static enum gd_status refuse_duplicates(const struct gd__construction *work, const struct gd__offenders *duplicates)
{
    const struct gd__offender *face = &duplicates->lowest[0];
    if (face->a == face->witness)
        gd_fail(work->detail, GD_DUPLICATE_FACE, "face %u covers the same three vertices twice", face->witness);
    else
        gd_fail(work->detail, GD_DUPLICATE_FACE, "face %u has the same vertices as face %u; remove one of them",
                (unsigned)face->a, face->witness);
    return gd__offenders_report(duplicates, GD_ELEMENT_FACE, GD_DUPLICATE_FACE, work->detail);
}

static enum gd_status refuse_crowded(const struct gd__construction *work, const struct edge_table *table,
                                     const struct gd__offenders *crowded)
{
    const struct gd__offender *edge = &crowded->lowest[0];
    uint32_t low, high;
    ends_of_side(work, table->use[edge->witness].side, &low, &high);
    struct gd__offenders faces = {0};
    for (uint32_t i = edge->witness; i < table->first[low + 1] && table->use[i].high == high; i++)
        gd__offenders_add(&faces, gd__input_polygon(work->mesh, table->use[i].side / 3), 0, 0);
    gd_fail(work->detail, GD_NON_MANIFOLD_EDGE,
            "edge %u-%u belongs to %u faces (%u, %u, %u%s); at most two may share an edge", (unsigned)edge->a,
            (unsigned)edge->b, (unsigned)faces.total, (unsigned)faces.lowest[0].a, (unsigned)faces.lowest[1].a,
            (unsigned)faces.lowest[2].a, faces.total > 3 ? ", ..." : "");
    return gd__offenders_report(crowded, GD_ELEMENT_EDGE, GD_NON_MANIFOLD_EDGE, work->detail);
}

enum gd_status gd__connect(struct gd__construction *work)
{
    size_t side_count = 3 * (size_t)work->mesh->face_count;
    struct edge_table table = {calloc((size_t)work->mesh->vertex_count + 1, sizeof *table.first),
                               malloc(side_count * sizeof *table.use)};
    work->neighbour = malloc(side_count * sizeof *work->neighbour);
    enum gd_status status = GD_NO_MEMORY;
    struct findings findings = {0};
    if (table.first && table.use && work->neighbour) {
        fill_table(work, &table);
        status = join_all(work, &table, &findings);
        if (!status && findings.duplicates.total)
            status = refuse_duplicates(work, &findings.duplicates);
        else if (!status && findings.crowded.total)
            status = refuse_crowded(work, &table, &findings.crowded);
    }
    free(table.first);
    free(table.use);
    return status;
}
