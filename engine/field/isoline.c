#include "gd/isoline.h"

#include <string.h>

#include "base/array.h"
#include "base/prefetch.h"
#include "field/isoline_parts.h"

/* An isoline across edges and faces: finds all crossings and chains, then joins the chains to
 * lines.
 *
 * DESIGN. Edges and faces are grouped in blocks of BLOCK neighbours. For each block the index has
 * the range of levels whose isolines can meet one of its elements. Tracing a level only visits the
 * elements of blocks whose range contains the level. Such blocks are a small part of the surface,
 * because neighbours on the surface share a block. */

#define INDEX_SHARE 0.4 /* fraction of gd_isoline_trace's progress for building the index */

/* STEPS_AN_ARC: work of converting an arc to the caller's units */
enum { STEPS_AN_ARC = 8, BLOCK = GD__CROSSING_BLOCK };

/* lesser and larger return the minimum and the maximum in one instruction, without the NaN handling
 * of fmin and fmax. */
static inline double lesser(double a, double b)
{
    return a < b ? a : b;
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

struct gd_isoline_index {
    const struct gd_field *field;     /* retained */
    struct gd__levels *edges, *faces; /* by block; `faces` points into the memory of `edges` */
    uint32_t edge_blocks, face_blocks;
};

struct tracer {
    const struct gd_isoline_index *index;
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    double level;    /* normalised unit */
    double progress; /* fraction of the call that was done before tracing */
    struct gd__pace pace;
    struct gd__isoline_parts parts;
    struct gd__places places;
    struct gd__face_scratch scratch;
    /* for each crossing, the chain that starts at it; GD_NONE means that a line ends at it, on the
       boundary */
    uint32_t *onwards;
    uint32_t *first; /* for each line, its first chain; open lines first */
    uint32_t line_count, open_count;
};

/* --- crossings and chains --------------------------------------------------------------------- */

/* Updates the held bytes and checks the control. During the conversion to the caller's units the
 * result exists twice. */
static enum gd_status check_work(struct tracer *tracer, double fraction)
{
    tracer->pace.held = 2 * tracer->parts.arena.budget.held;
    tracer->pace.fraction = tracer->progress + (1 - tracer->progress) * fraction;
    return gd__pace_step(&tracer->pace, 1);
}

/* Returns the range of distances on an edge. Along the edge, the distance changes by at most the
 * edge's length. An unreached end counts as one such length farther than the other end. */
static struct gd__levels edge_levels(double a, double b, double length)
{
    double sum = lesser(a, b + length) + lesser(b, a + length);
    return (struct gd__levels){0.5 * (sum - length), 0.5 * (sum + length)};
}

static bool levels_have(const struct gd__levels *levels, double level)
{
    double slack = GD_TOL_CHECK * level;
    return levels->least <= level + slack && levels->most >= level - slack;
}

static bool may_cross_edge(const struct tracer *tracer, uint32_t edge)
{
    const double *distance = tracer->field->distance;
    const uint32_t *origin = &tracer->mesh->origin[2 * (size_t)edge];
    const struct gd__levels levels = edge_levels(distance[origin[0]], distance[origin[1]],
                                                 tracer->mesh->side[2 * (size_t)edge].length);
    return levels_have(&levels, tracer->level);
}

/* Finds the crossings of a block's edges. */
static enum gd_status cross_edge_block(struct tracer *tracer, uint32_t block)
{
    uint32_t edge = block * BLOCK, count = tracer->mesh->edge_count,
             end = count - edge < BLOCK ? count : edge + BLOCK;
    struct gd__isoline_parts *parts = &tracer->parts;
    enum gd_status status =
        gd__arena_extend(&parts->arena, &parts->first_crossing, &parts->first_capacity,
                         parts->first_count + UINT64_C(1) + BLOCK, sizeof *parts->first_crossing);
    parts->block[block] = parts->first_count;
    for (; edge < end && !status; edge++) {
        parts->first_crossing[parts->first_count++] = parts->crossing_count;
        status = check_work(tracer, 0.45 * edge / count);
        if (!status && may_cross_edge(tracer, edge))
            status = gd__isoline_cross_edge(tracer->field, edge, tracer->level, &tracer->pace,
                                            &tracer->places, parts);
    }
    if (!status) parts->first_crossing[parts->first_count++] = parts->crossing_count;
    return status;
}

static enum gd_status cross_edges(struct tracer *tracer)
{
    const struct gd_isoline_index *index = tracer->index;
    enum gd_status status = GD_OK;
    struct gd__isoline_parts *parts = &tracer->parts;
    parts->block = gd__arena_take(&parts->arena, index->edge_blocks, sizeof *parts->block);
    if (!parts->block) return parts->arena.status;
    for (uint32_t block = 0; block < index->edge_blocks; block++) parts->block[block] = GD_NONE;
    for (uint32_t block = 0; block < index->edge_blocks && !status; block++)
        if (levels_have(&index->edges[block], tracer->level))
            status = cross_edge_block(tracer, block);
    return status;
}

static bool has_crossings(const struct tracer *tracer, uint32_t face)
{
    for (int k = 0; k < 3; k++) {
        uint32_t first, end;
        gd__edge_crossings(&tracer->parts, tracer->mesh->face_side[face][k] >> 1, &first, &end);
        if (first < end) return true;
    }
    return false;
}

/* Returns true if a line may lie inside the face without crossing its edges. Such a line encloses a
 * seed or a maximum. */
static bool may_hold_loop(const struct tracer *tracer, uint32_t face)
{
    struct gd__face_seeds seeds = gd__field_seeds_in(tracer->field, face);
    if (seeds.at < seeds.end) return true;
    const struct gd__levels levels = gd__field_face_levels(tracer->field, face);
    return levels.least < tracer->level && levels.most >= tracer->level;
}

static enum gd_status cross_face_block(struct tracer *tracer, uint32_t block)
{
    uint32_t face = block * BLOCK, count = tracer->mesh->face_count,
             end = count - face < BLOCK ? count : face + BLOCK;
    enum gd_status status = GD_OK;
    for (; face < end && !status; face++) {
        status = check_work(tracer, 0.45 + 0.45 * face / count);
        if (!status && (has_crossings(tracer, face) || may_hold_loop(tracer, face)))
            status = gd__isoline_cross_face(tracer->field, face, tracer->level, &tracer->pace,
                                            &tracer->scratch, &tracer->parts);
    }
    return status;
}

static enum gd_status cross_faces(struct tracer *tracer)
{
    const struct gd_isoline_index *index = tracer->index;
    enum gd_status status = GD_OK;
    for (uint32_t block = 0; block < index->face_blocks && !status; block++)
        if (levels_have(&index->faces[block], tracer->level))
            status = cross_face_block(tracer, block);
    return status;
}

/* --- lines ------------------------------------------------------------------------------------ */

/* Returns the chain that continues `chain`; GD_NONE at the end of a line. */
static uint32_t next_chain(const struct tracer *tracer, uint32_t chain)
{
    uint32_t exit = tracer->parts.chain[chain].exit;
    return exit == GD_NONE ? chain : tracer->onwards[exit];
}

/* Follows the chains from `first`. Adds a line that begins with `first`, unless all its arcs are
 * due to rounding. */
static enum gd_status follow_chains(struct tracer *tracer, uint32_t first, bool *visited)
{
    bool has_arcs = false;
    enum gd_status status = GD_OK;
    for (uint32_t chain = first; chain != GD_NONE && !visited[chain] && !status;
         chain = next_chain(tracer, chain)) {
        visited[chain] = true;
        has_arcs |= tracer->parts.chain[chain].has_arcs;
        status = gd__pace_step(&tracer->pace, 1);
    }
    if (has_arcs) tracer->first[tracer->line_count++] = first;
    return status;
}

/* Finds all lines, open ones first: an open line begins at a crossing where no chain arrives. */
static enum gd_status find_lines(struct tracer *tracer)
{
    struct gd__isoline_parts *parts = &tracer->parts;
    struct gd__arena *arena = &parts->arena;
    bool *arrives = gd__arena_zeroed(arena, parts->crossing_count, sizeof *arrives),
         *visited = gd__arena_zeroed(arena, parts->chain_count, sizeof *visited);
    tracer->onwards = gd__arena_take(arena, parts->crossing_count, sizeof *tracer->onwards);
    tracer->first = gd__arena_take(arena, parts->chain_count, sizeof *tracer->first);
    enum gd_status status = arena->status;
    if (status) return status;
    for (uint32_t i = 0; i < parts->crossing_count; i++) tracer->onwards[i] = GD_NONE;
    for (uint32_t i = 0; i < parts->chain_count; i++) {
        if (parts->chain[i].entry == GD_NONE) continue;
        tracer->onwards[parts->chain[i].entry] = i;
        arrives[parts->chain[i].exit] = true;
    }
    for (uint32_t i = 0; i < parts->crossing_count && !status; i++)
        if (!arrives[i] && tracer->onwards[i] != GD_NONE)
            status = follow_chains(tracer, tracer->onwards[i], visited);
    tracer->open_count = tracer->line_count;
    for (uint32_t i = 0; i < parts->chain_count && !status; i++)
        if (!visited[i]) status = follow_chains(tracer, i, visited);
    return status;
}

/* --- export ----------------------------------------------------------------------------------- */

static struct gd_isoline_arc export_arc(const struct gd_mesh *mesh,
                                        const struct gd__isoline_piece *piece)
{
    struct gd__axes axes = gd__axes_of_side(mesh, mesh->face_side[piece->face][0]);
    struct gd_vec3 centre = gd_vec3_along(gd_vec3_along(axes.origin, piece->centre.x, axes.along),
                                          piece->centre.y, axes.across);
    return (struct gd_isoline_arc){.face = {mesh->index_of_face[piece->face]},
                                   .u = piece->centre.x * mesh->unit,
                                   .v = piece->centre.y * mesh->unit,
                                   .radius = piece->radius * mesh->unit,
                                   .from = piece->from,
                                   .to = piece->radius > 0 ? piece->to : piece->to * mesh->unit,
                                   .centre = gd_vec3_scale(centre, mesh->unit)};
}

/* Returns true if an arc has length zero: its ends are the same point, and it is not a full
 * circle. */
static bool is_point(const struct gd_isoline_arc *arc, const struct gd_point *start,
                     const struct gd_point *stop)
{
    return gd_point_equal(start, stop) && (arc->radius == 0 || arc->to - arc->from < M_PI);
}

struct exporter {
    const struct gd_mesh *mesh;
    struct gd_isoline *to;
    uint32_t arcs, points;           /* numbers exported so far */
    uint32_t first_arc, first_point; /* first arc and first point of the current line */
};

/* Removes the last arc if its length is zero. `next` is the arc's end. */
static void drop_point(struct exporter *exporter, const struct gd_point *next)
{
    const struct gd_isoline *to = exporter->to;
    if (exporter->arcs == exporter->first_arc) return;
    if (!is_point(&to->arcs[exporter->arcs - 1], &to->points[exporter->points - 1], next)) return;
    exporter->arcs--;
    exporter->points--;
}

static void export_chain(struct exporter *exporter, const struct gd__isoline_parts *parts,
                         uint32_t chain)
{
    for (uint32_t i = 0; i < parts->chain[chain].count; i++) {
        const struct gd__isoline_piece *piece = &parts->piece[parts->chain[chain].first + i];
        drop_point(exporter, &piece->start);
        exporter->to->arcs[exporter->arcs++] = export_arc(exporter->mesh, piece);
        exporter->to->points[exporter->points++] = piece->start;
    }
}

/* Finishes the current line. Removes it if all its arcs are due to rounding. */
static void end_line(struct exporter *exporter, bool closed)
{
    struct gd_isoline *to = exporter->to;
    struct gd_isoline_line line = {.closed = closed,
                                   .arc_count = exporter->arcs - exporter->first_arc,
                                   .arcs = to->arcs + exporter->first_arc,
                                   .point_count = exporter->points - exporter->first_point,
                                   .points = to->points + exporter->first_point};
    for (uint32_t i = 0; i < line.arc_count; i++)
        line.length += gd_isoline_arc_length(&line.arcs[i]);
    if (line.arc_count) to->lines[to->line_count++] = line;
}

static enum gd_status export_line(struct exporter *exporter, struct tracer *tracer, uint32_t first,
                                  bool closed)
{
    struct gd_isoline *to = exporter->to;
    uint32_t chain = first, last;
    enum gd_status status;
    exporter->first_arc = exporter->arcs;
    exporter->first_point = exporter->points;
    do {
        export_chain(exporter, &tracer->parts, chain);
        status =
            gd__pace_step(&tracer->pace, STEPS_AN_ARC * (tracer->parts.chain[chain].count + 1));
        last = chain;
        chain = next_chain(tracer, chain);
    } while (chain != GD_NONE && chain != first && !status);
    if (status) return status;
    if (closed) {
        drop_point(exporter, &to->points[exporter->first_point]);
    } else {
        struct gd_point end = gd__crossing_point(
            exporter->mesh, &tracer->parts.crossing[tracer->parts.chain[last].exit]);
        drop_point(exporter, &end);
        to->points[exporter->points++] = end;
    }
    end_line(exporter, closed);
    return GD_OK;
}

static enum gd_status export_lines(struct tracer *tracer, double level, struct gd_isoline *out)
{
    struct gd_isoline isoline = {.level = level};
    size_t pieces = tracer->parts.piece_count, lines = tracer->line_count;
    size_t of_lines = sizeof *isoline.lines * (lines + 1),
           of_arcs = sizeof *isoline.arcs * (pieces + 1),
           of_points = sizeof *isoline.points * (pieces + lines + 1);
    isoline.lines = malloc(of_lines);
    isoline.arcs = malloc(of_arcs);
    isoline.points = malloc(of_points);
    isoline.bytes = of_lines + of_arcs + of_points;
    struct exporter exporter = {.mesh = tracer->mesh, .to = &isoline};
    enum gd_status status = isoline.lines && isoline.arcs && isoline.points ? GD_OK : GD_NO_MEMORY;
    for (uint32_t i = 0; i < tracer->line_count && !status; i++)
        status = export_line(&exporter, tracer, tracer->first[i], i >= tracer->open_count);
    if (status)
        gd_isoline_free(&isoline);
    else
        *out = isoline;
    return status;
}

/* --- the index -------------------------------------------------------------------------------- */

static void levels_widen(struct gd__levels *levels, struct gd__levels by)
{
    levels->least = lesser(levels->least, by.least);
    levels->most = larger(levels->most, by.most);
}

/* Prefetches the data that index_face reads for a later face. */
GD__PREFETCH index_prefetch(const struct gd_mesh *mesh, uint32_t face)
{
    const uint32_t ahead = 32; /* faces */
    if (mesh->face_count - face > ahead)
        __builtin_prefetch(&mesh->side[mesh->face_side[face + ahead][0]]);
}

/* Widens the ranges of a face's block and of its edges' blocks by the levels whose isolines may
 * meet the face. */
static void index_face(struct gd_isoline_index *index, uint32_t face)
{
    const struct gd_mesh *mesh = index->field->mesh;
    const double *distance = index->field->distance;
    const uint32_t *sides = mesh->face_side[face];
    const struct gd_side *s = &mesh->side[sides[0]];
    const double length[3] = {s->length, s->right_length, s->left_length};
    struct gd__levels *whole = &index->faces[face / BLOCK],
                      inner = gd__field_face_levels(index->field, face);
    for (int k = 0; k < 3; k++) {
        struct gd__levels levels =
            edge_levels(distance[mesh->origin[sides[k]]],
                        distance[mesh->origin[sides[(k + 1) % 3]]], length[k]);
        levels_widen(&index->edges[(sides[k] >> 1) / BLOCK], levels);
        levels_widen(whole, levels);
    }
    if (inner.least <= inner.most) levels_widen(whole, inner);
}

static enum gd_status index_faces(struct gd_isoline_index *index, double share,
                                  const struct gd_control *control)
{
    const struct gd_field *field = index->field;
    uint32_t count = field->mesh->face_count;
    struct gd__pace pace = {.control = control, .held = gd_isoline_index_bytes(field->mesh)};
    enum gd_status status = gd__pace_step(&pace, GD__PACE_STEPS);
    for (uint32_t i = 0; i < index->edge_blocks + index->face_blocks; i++)
        index->edges[i] = (struct gd__levels){INFINITY, -INFINITY};
    for (uint32_t face = 0; face < count && !status; face++) {
        pace.fraction = share * face / count;
        status = gd__pace_step(&pace, 2);
        index_prefetch(field->mesh, face);
        index_face(index, face);
    }
    for (uint32_t i = 0; i < field->face_seed_count; i++)
        levels_widen(&index->faces[field->face_seeds[i].face / BLOCK],
                     (struct gd__levels){-INFINITY, INFINITY});
    return status;
}

static uint32_t blocks_of(uint32_t count)
{
    return count / BLOCK + (count % BLOCK > 0);
}

size_t gd_isoline_index_bytes(const struct gd_mesh *mesh)
{
    return sizeof(struct gd_isoline_index) +
           ((size_t)blocks_of(mesh->edge_count) + blocks_of(mesh->face_count)) *
               sizeof(struct gd__levels);
}

/* Creates an index. `share` is the part of the control's progress that it reports. */
static enum gd_status index_create(const struct gd_field *field, double share,
                                   const struct gd_control *control, struct gd_isoline_index **out)
{
    struct gd_isoline_index *index = calloc(1, sizeof *index);
    if (!index) return GD_NO_MEMORY;
    index->field = gd_field_retain(field);
    index->edge_blocks = blocks_of(field->mesh->edge_count);
    index->face_blocks = blocks_of(field->mesh->face_count);
    index->edges = malloc(((size_t)index->edge_blocks + index->face_blocks) * sizeof *index->edges);
    enum gd_status status = GD_NO_MEMORY;
    if (index->edges) {
        index->faces = index->edges + index->edge_blocks;
        status = index_faces(index, share, control);
    }
    if (status)
        gd_isoline_index_destroy(index);
    else
        *out = index;
    return status;
}

enum gd_status gd_isoline_index_create(const struct gd_field *field,
                                       const struct gd_control *control,
                                       struct gd_isoline_index **out)
{
    return index_create(field, 1, control, out);
}

void gd_isoline_index_destroy(struct gd_isoline_index *index)
{
    if (!index) return;
    gd_field_release(index->field);
    free(index->edges);
    free(index);
}

/* --- one level -------------------------------------------------------------------------------- */

static enum gd_status trace_level(const struct gd_isoline_index *index, double level,
                                  double progress, const struct gd_control *control,
                                  struct gd_isoline *out)
{
    const struct gd_field *field = index->field;
    if (!(level >= 0 && isfinite(level))) return GD_INVALID_ARGUMENT;
    struct tracer tracer = {.index = index,
                            .field = field,
                            .mesh = field->mesh,
                            .level = level / field->mesh->unit,
                            .progress = progress,
                            .pace = {.control = control},
                            .parts.arena.budget.control = control};
    if (field->reach < GD__FAR && tracer.level > field->reach) return GD_BEYOND_REACH;
    /* no distance is half as large as GD__FAR, which unreached vertices have */
    if (tracer.level >= 0.5 * GD__FAR) return export_lines(&tracer, level, out);
    enum gd_status status = gd_control_check(control, progress);
    if (!status) status = cross_edges(&tracer);
    if (!status) status = cross_faces(&tracer);
    if (!status) status = gd__pace_step(&tracer.pace, GD__PACE_STEPS);
    if (!status) status = find_lines(&tracer);
    if (!status) status = export_lines(&tracer, level, out);
    gd__arena_free(&tracer.parts.arena);
    free(tracer.places.at);
    gd__face_scratch_destroy(&tracer.scratch);
    return status;
}

enum gd_status gd_isoline_trace_indexed(const struct gd_isoline_index *index, double level,
                                        const struct gd_control *control, struct gd_isoline *out)
{
    return trace_level(index, level, 0, control, out);
}

enum gd_status gd_isoline_trace(const struct gd_field *field, double level,
                                const struct gd_control *control, struct gd_isoline *out)
{
    struct gd_isoline_index *index;
    if (!(level >= 0 && isfinite(level))) return GD_INVALID_ARGUMENT;
    enum gd_status status = index_create(field, INDEX_SHARE, control, &index);
    if (status) return status;
    status = trace_level(index, level, INDEX_SHARE, control, out);
    gd_isoline_index_destroy(index);
    return status;
}

void gd_isoline_free(struct gd_isoline *isoline)
{
    if (!isoline) return;
    free(isoline->lines);
    free(isoline->arcs);
    free(isoline->points);
    *isoline = (struct gd_isoline){0};
}

void gd_isoline_arc_axes(const struct gd_mesh *mesh, const struct gd_isoline_arc *arc,
                         struct gd_vec3 *x, struct gd_vec3 *y)
{
    struct gd__axes axes =
        gd__axes_of_side(mesh, mesh->face_side[mesh->face_of_index[arc->face.index]][0]);
    *x = axes.along;
    *y = axes.across;
}
