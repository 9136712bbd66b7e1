#include "gd/isoline.h"

#include <string.h>

#include "field/array.h"
#include "field/isoline_parts.h"

/* An isoline from edge to edge and face to face: finds all crossings and chains, then follows chain
 * after chain. */

enum { STEPS_AN_ARC = 8 /* to put it into the caller's terms */ };

struct tracer {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    double level; /* inside unit */
    struct gd__pace pace;
    struct gd__parts parts;
    struct gd__places places;
    struct gd__face_scratch scratch;
    /* per crossing: the chain that goes on from it; GD_NONE: it lies on the boundary and a line
       ends there */
    uint32_t *onwards;
    uint32_t *first; /* per line: its first chain; open lines, then closed ones */
    uint32_t line_count, open_count;
};

static void close_tracer(struct tracer *tracer)
{
    free(tracer->parts.crossing);
    free(tracer->parts.first_crossing);
    free(tracer->parts.piece);
    free(tracer->parts.chain);
    free(tracer->places.at);
    gd__face_scratch_destroy(&tracer->scratch);
    free(tracer->onwards);
    free(tracer->first);
}

/* --- crossings and chains --------------------------------------------------------------------- */

/* What is found is held twice when it is put into the caller's terms. */
static enum gd_status step(struct tracer *tracer, double fraction)
{
    const struct gd__parts *parts = &tracer->parts;
    tracer->pace.held = (size_t)tracer->mesh->edge_count * sizeof *parts->first_crossing +
                        2 * (parts->crossing_capacity * sizeof *parts->crossing +
                             parts->piece_capacity * sizeof *parts->piece +
                             parts->chain_capacity * sizeof *parts->chain);
    tracer->pace.fraction = fraction;
    return gd__pace_step(&tracer->pace, 1);
}

/* Along an edge the distance changes by no more than its length; an end that a partial field has
 * not reached counts as that far. */
static bool may_cross_edge(const struct tracer *tracer, uint32_t edge)
{
    const double *distance = tracer->field->distance;
    double length = tracer->mesh->side[2 * edge].length,
           a = distance[tracer->mesh->origin[2 * edge]],
           b = distance[tracer->mesh->origin[2 * edge + 1]];
    double sum = fmin(a, b + length) + fmin(b, a + length), slack = GD_TOL_CHECK * tracer->level;
    return sum - length <= 2 * (tracer->level + slack) &&
           sum + length >= 2 * (tracer->level - slack);
}

static enum gd_status cross_edges(struct tracer *tracer)
{
    const struct gd_mesh *mesh = tracer->mesh;
    enum gd_status status = GD_OK;
    tracer->parts.first_crossing =
        malloc(sizeof *tracer->parts.first_crossing * ((size_t)mesh->edge_count + 1));
    if (!tracer->parts.first_crossing) return GD_NO_MEMORY;
    for (uint32_t edge = 0; edge < mesh->edge_count && !status; edge++) {
        tracer->parts.first_crossing[edge] = tracer->parts.crossing_count;
        status = step(tracer, 0.45 * edge / mesh->edge_count);
        if (!status && may_cross_edge(tracer, edge))
            status = gd__isoline_cross_edge(tracer->field, edge, tracer->level, &tracer->pace,
                                            &tracer->places, &tracer->parts);
    }
    tracer->parts.first_crossing[mesh->edge_count] = tracer->parts.crossing_count;
    return status;
}

static bool has_crossings(const struct tracer *tracer, uint32_t face)
{
    for (int k = 0; k < 3; k++) {
        const uint32_t *first =
            &tracer->parts.first_crossing[tracer->mesh->face_side[face][k] >> 1];
        if (first[0] < first[1]) return true;
    }
    return false;
}

/* A line that crosses no edge of the face lies around a seed in it, or around a maximum: no point
 * is farther than by way of a corner. */
static bool may_hold_loop(const struct tracer *tracer, uint32_t face)
{
    const struct gd_field *field = tracer->field;
    const struct gd__face_seed *seed = gd__field_seeds_in(field, face);
    if (seed < field->face_seeds + field->face_seed_count && seed->face == face) return true;
    const struct gd_side *s = &tracer->mesh->side[tracer->mesh->face_side[face][0]];
    double a = s->length, b = s->right_length, c = s->left_length,
           reach[3] = {fmax(a, c), fmax(a, b), fmax(b, c)};
    for (int k = 0; k < 3; k++) {
        double distance = field->distance[tracer->mesh->origin[tracer->mesh->face_side[face][k]]];
        if (distance >= tracer->level || distance + reach[k] < tracer->level) return false;
    }
    return true;
}

static enum gd_status cross_faces(struct tracer *tracer)
{
    const struct gd_mesh *mesh = tracer->mesh;
    enum gd_status status = GD_OK;
    for (uint32_t face = 0; face < mesh->face_count && !status; face++) {
        status = step(tracer, 0.45 + 0.45 * face / mesh->face_count);
        if (!status && (has_crossings(tracer, face) || may_hold_loop(tracer, face)))
            status = gd__isoline_cross_face(tracer->field, face, tracer->level, &tracer->pace,
                                            &tracer->scratch, &tracer->parts);
    }
    return status;
}

/* --- lines ------------------------------------------------------------------------------------ */

/* The chain behind one, or GD_NONE. */
static uint32_t next_chain(const struct tracer *tracer, uint32_t chain)
{
    uint32_t exit = tracer->parts.chain[chain].exit;
    return exit == GD_NONE ? chain : tracer->onwards[exit];
}

/* Follows the chains from one on; notes it as the first of a line if there is more to the line than
 * rounding. */
static enum gd_status follow(struct tracer *tracer, uint32_t first, bool *visited)
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

/* Open lines begin at a crossing at which no chain arrives. */
static enum gd_status find_lines(struct tracer *tracer)
{
    const struct gd__parts *parts = &tracer->parts;
    enum gd_status status = GD_NO_MEMORY;
    bool *arrives = calloc((size_t)parts->crossing_count + 1, sizeof *arrives),
         *visited = calloc((size_t)parts->chain_count + 1, sizeof *visited);
    tracer->onwards = malloc(sizeof *tracer->onwards * ((size_t)parts->crossing_count + 1));
    tracer->first = malloc(sizeof *tracer->first * ((size_t)parts->chain_count + 1));
    if (!arrives || !visited || !tracer->onwards || !tracer->first) goto done;
    for (uint32_t i = 0; i < parts->crossing_count; i++) tracer->onwards[i] = GD_NONE;
    for (uint32_t i = 0; i < parts->chain_count; i++) {
        if (parts->chain[i].entry == GD_NONE) continue;
        tracer->onwards[parts->chain[i].entry] = i;
        arrives[parts->chain[i].exit] = true;
    }
    status = GD_OK;
    for (uint32_t i = 0; i < parts->crossing_count && !status; i++)
        if (!arrives[i] && tracer->onwards[i] != GD_NONE)
            status = follow(tracer, tracer->onwards[i], visited);
    tracer->open_count = tracer->line_count;
    for (uint32_t i = 0; i < parts->chain_count && !status; i++)
        if (!visited[i]) status = follow(tracer, i, visited);
done:
    free(arrives);
    free(visited);
    return status;
}

/* --- what the caller gets --------------------------------------------------------------------- */

static struct gd_isoline_arc export_arc(const struct gd_mesh *mesh, const struct gd__piece *piece)
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

/* From a point back to it without going round: an arc of no length. */
static bool is_point(const struct gd_isoline_arc *arc, const struct gd_point *start,
                     const struct gd_point *stop)
{
    return gd_point_equal(start, stop) && (arc->radius == 0 || arc->to - arc->from < M_PI);
}

struct exporter {
    const struct gd_mesh *mesh;
    struct gd_isoline *to;
    uint32_t arcs, points;           /* so far */
    uint32_t first_arc, first_point; /* of the line at hand */
};

/* Takes the last arc back if it has no length: then `next` lies where it starts. */
static void drop_point(struct exporter *exporter, const struct gd_point *next)
{
    const struct gd_isoline *to = exporter->to;
    if (exporter->arcs == exporter->first_arc) return;
    if (!is_point(&to->arcs[exporter->arcs - 1], &to->points[exporter->points - 1], next)) return;
    exporter->arcs--;
    exporter->points--;
}

static void export_chain(struct exporter *exporter, const struct gd__parts *parts, uint32_t chain)
{
    for (uint32_t i = 0; i < parts->chain[chain].count; i++) {
        const struct gd__piece *piece = &parts->piece[parts->chain[chain].first + i];
        drop_point(exporter, &piece->start);
        exporter->to->arcs[exporter->arcs++] = export_arc(exporter->mesh, piece);
        exporter->to->points[exporter->points++] = piece->start;
    }
}

/* What was appended since the line began; an arc that is all rounding is no line. */
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

enum gd_status gd_isoline_trace(const struct gd_field *field, double level,
                                const struct gd_control *control, struct gd_isoline *out)
{
    if (!(level >= 0 && isfinite(level))) return GD_INVALID_ARGUMENT;
    struct tracer tracer = {.field = field,
                            .mesh = field->mesh,
                            .level = level / field->mesh->unit,
                            .pace = {.control = control}};
    if (tracer.level > field->reach) return GD_BEYOND_REACH;
    enum gd_status status = gd_control_check(control, 0);
    if (!status) status = cross_edges(&tracer);
    if (!status) status = cross_faces(&tracer);
    if (!status) status = gd__pace_check(&tracer.pace);
    if (!status) status = find_lines(&tracer);
    if (!status) status = export_lines(&tracer, level, out);
    close_tracer(&tracer);
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
