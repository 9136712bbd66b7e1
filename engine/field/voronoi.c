#include "gd/voronoi.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/slices.h"
#include "field/voronoi_parts.h"

/* The diagram: computes the owners of vertices, the owner changes along edges, the parts of
 * bisectors in faces, and the lines that the parts form. */

enum {
    /* steps of pace.h for an edge or face with more than one owner */
    STEPS_OF_ELEMENT = GD__PACE_STEPS / 16,
    /* limit on rounds of settle_owners; one round suffices unless ties are nested, which is rare */
    ROUNDS_MOST = 4
};

/* Progress of the call when a step begins. */
static const struct {
    double switches, bisector_parts, lines;
} progress = {0.1, 0.3, 0.9};

/* --- the graph -------------------------------------------------------------------------------- */

enum gd_status gd__diagram_add_node(struct gd__diagram *diagram, const struct gd_point *point,
                                    uint32_t *out)
{
    const struct gd__node node = {.point = *point, .bisector_part = {GD_NONE, GD_NONE}};
    *out = diagram->node_count;
    return gd__arena_append(&diagram->arena, &diagram->node, &diagram->node_count,
                            &diagram->node_capacity, &node, sizeof node);
}

enum gd_status gd__diagram_add_bisector_part(struct gd__diagram *diagram,
                                             const struct gd__bisector_part *bisector_part,
                                             uint32_t *out)
{
    *out = diagram->bisector_part_count;
    return gd__arena_append(&diagram->arena, &diagram->bisector_part, &diagram->bisector_part_count,
                            &diagram->bisector_part_capacity, bisector_part, sizeof *bisector_part);
}

enum gd_status gd__diagram_add_arc(struct gd__diagram *diagram, const struct gd__arc *arc,
                                   uint32_t *out)
{
    *out = diagram->arc_count;
    return gd__arena_append(&diagram->arena, &diagram->arc, &diagram->arc_count,
                            &diagram->arc_capacity, arc, sizeof *arc);
}

void gd__diagram_count_end(struct gd__diagram *diagram, uint32_t part, uint32_t end)
{
    struct gd__node *node = &diagram->node[diagram->bisector_part[part].node[end]];
    if (node->bisector_part[0] == GD_NONE)
        node->bisector_part[0] = part;
    else if (node->bisector_part[1] == GD_NONE)
        node->bisector_part[1] = part;
    else
        node->is_end = true;
}

static enum gd_status open_diagram(struct gd__diagram *diagram)
{
    const struct gd_mesh *mesh = diagram->mesh;
    struct gd__arena *arena = &diagram->arena;
    diagram->owner = gd__arena_take(arena, mesh->vertex_count, sizeof *diagram->owner);
    diagram->nearest = gd__arena_take(arena, mesh->vertex_count, sizeof *diagram->nearest);
    diagram->first_switch =
        gd__arena_take(arena, mesh->edge_count + (size_t)1, sizeof *diagram->first_switch);
    diagram->mixture = gd__arena_zeroed(arena, mesh->edge_count, sizeof *diagram->mixture);
    return gd__members_find(diagram->field, diagram->member_of_seed, arena, &diagram->members);
}

/* Returns true if a seed lies at the vertex. The seed's member then wins ties of paths that begin
 * at the vertex. */
static bool is_seed(const struct gd_field *field, uint32_t vertex)
{
    struct gd__predecessor predecessor = field->predecessor[vertex];
    if (predecessor.side != GD_NONE || predecessor.source == GD_NONE ||
        predecessor.source < field->mesh->vertex_count)
        return false;
    return field->seeds[gd__field_seed_of(field, predecessor.source)].point.kind == GD_POINT_VERTEX;
}

/* Sets each vertex' owner to the member of its pseudo-source. */
static void reset_owners(struct gd__diagram *diagram)
{
    diagram->changed = 0;
    for (uint32_t v = 0; v < diagram->mesh->vertex_count; v++) {
        uint32_t member = diagram->owner[v] = diagram->members.of[v];
        double nudge = member == GD_NONE ? 0 : diagram->members.nudge[member];
        diagram->nearest[v] = is_seed(diagram->field, v) ? 0 : diagram->field->distance[v] + nudge;
    }
}

static void close_scratch(struct gd__voronoi_scratch *scratch)
{
    gd__stack_destroy(&scratch->envelope);
    gd__stack_destroy(&scratch->tail);
    gd__sources_destroy(&scratch->sources);
    free(scratch->view);
    free(scratch->loose);
    free(scratch->tie);
}

/* --- the steps -------------------------------------------------------------------------------- */

struct tracer {
    struct gd__diagram diagram;
    struct gd__voronoi_scratch scratch;
    const struct gd_control *control;
};

static enum gd_status check_work(struct tracer *tracer, double fraction)
{
    tracer->scratch.pace.fraction = fraction;
    return gd__pace_step(&tracer->scratch.pace, STEPS_OF_ELEMENT);
}

static bool is_reached(const struct gd__diagram *diagram, uint32_t edge)
{
    return diagram->members.of[diagram->mesh->origin[2 * edge]] != GD_NONE;
}

/* Makes gd__edge_is_mixed remember its results, which takes most of the time of a diagram. */
static void find_mixtures(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct gd__diagram *diagram = context;
    (void)pace;
    for (uint32_t edge = begin; edge < end; edge++) {
        gd__edge_prefetch(diagram, edge);
        if (is_reached(diagram, edge)) (void)gd__edge_is_mixed(diagram, edge);
    }
}

static enum gd_status find_owners(struct tracer *tracer, int round)
{
    struct gd__diagram *diagram = &tracer->diagram;
    uint32_t edges = diagram->mesh->edge_count;
    struct gd__pace pace = {.control = tracer->control,
                            .fraction = progress.switches * round / (ROUNDS_MOST + 1)};
    reset_owners(diagram);
    gd__slices_run(&pace, edges, find_mixtures, diagram);
    enum gd_status status = pace.status;
    for (uint32_t edge = 0; edge < edges && !status; edge++) {
        if (!is_reached(diagram, edge) || !gd__edge_is_mixed(diagram, edge)) continue;
        status = check_work(tracer,
                            progress.switches * (round + (double)edge / edges) / (ROUNDS_MOST + 1));
        gd__edge_own_ends(diagram, edge);
    }
    return status;
}

/* Computes the owners of all vertices. If a vertex changes its owner, all vertices that have it as
 * pseudo-source change their owner too. Therefore several rounds may be needed. */
static enum gd_status settle_owners(struct tracer *tracer)
{
    struct gd__diagram *diagram = &tracer->diagram;
    enum gd_status status = find_owners(tracer, 0);
    for (int round = 1; round <= ROUNDS_MOST && diagram->changed && !status; round++) {
        status = gd__members_change(diagram->field, diagram->owner, &diagram->members);
        memset(diagram->mixture, GD__MIXTURE_UNKNOWN, diagram->mesh->edge_count);
        if (!status) status = find_owners(tracer, round);
    }
    return status;
}

static enum gd_status find_switches(struct tracer *tracer, bool *is_mixed)
{
    struct gd__diagram *diagram = &tracer->diagram;
    uint32_t edges = diagram->mesh->edge_count;
    enum gd_status status = GD_OK;
    for (uint32_t edge = 0; edge < edges && !status; edge++) {
        diagram->first_switch[edge] = diagram->switch_count;
        is_mixed[edge] = is_reached(diagram, edge) && gd__edge_is_mixed(diagram, edge);
        if (!is_mixed[edge]) continue;
        status =
            check_work(tracer, progress.switches +
                                   (progress.bisector_parts - progress.switches) * edge / edges);
        if (!status) status = gd__edge_owner_change(diagram, edge, &tracer->scratch);
    }
    diagram->first_switch[edges] = diagram->switch_count;
    return status;
}

/* Returns true if a face may have more than one owner. */
static bool is_mixed_face(const struct gd__diagram *diagram, const bool *is_mixed, uint32_t face)
{
    const struct gd_mesh *mesh = diagram->mesh;
    const struct gd_field *field = diagram->field;
    for (int k = 0; k < 3; k++)
        if (is_mixed[mesh->face_side[face][k] >> 1]) return true;
    uint32_t member = diagram->owner[mesh->origin[mesh->face_side[face][0]]];
    for (struct gd__face_seeds f = gd__field_seeds_in(field, face); f.at < f.end; f.at++)
        if (gd__member_of(&diagram->members, mesh->vertex_count + f.at->seed) != member)
            return true;
    return false;
}

static enum gd_status find_strands(struct tracer *tracer, const bool *is_mixed)
{
    struct gd__diagram *diagram = &tracer->diagram;
    uint32_t faces = diagram->mesh->face_count;
    enum gd_status status = GD_OK;
    for (uint32_t face = 0; face < faces && !status; face++) {
        if (!is_mixed_face(diagram, is_mixed, face)) continue;
        status = check_work(tracer, progress.bisector_parts +
                                        (progress.lines - progress.bisector_parts) * face / faces);
        if (!status) status = gd__face_bisector_parts(diagram, face, &tracer->scratch);
        if (!status) status = gd__face_match(diagram, &tracer->scratch);
    }
    return status;
}

static enum gd_status trace_diagram(struct tracer *tracer, double tolerance, struct gd_voronoi *out)
{
    struct gd__diagram *diagram = &tracer->diagram;
    bool *is_mixed = gd__arena_take(&diagram->arena, diagram->mesh->edge_count, sizeof *is_mixed);
    enum gd_status status = open_diagram(diagram);
    if (!status) status = gd__members_settle(diagram->field, tracer->control, &diagram->members);
    if (!status) status = settle_owners(tracer);
    if (!status) status = find_switches(tracer, is_mixed);
    if (!status) status = find_strands(tracer, is_mixed);
    const struct gd__export_options export = {tolerance / diagram->mesh->unit, tracer->control,
                                              progress.lines};
    if (!status) status = gd__diagram_export(diagram, &export, out);
    return status;
}

enum gd_status gd_voronoi_trace(const struct gd_field *field, const uint32_t *member_of_seed,
                                double tolerance, const struct gd_control *control,
                                struct gd_voronoi *out)
{
    if (!(tolerance > 0)) return GD_INVALID_ARGUMENT;
    if (field->reach < GD__FAR) return GD_BEYOND_REACH;
    struct tracer tracer = {.diagram = {.field = field,
                                        .mesh = field->mesh,
                                        .member_of_seed = member_of_seed,
                                        .arena.budget.control = control},
                            .scratch.pace.control = control,
                            .control = control};
    enum gd_status status = trace_diagram(&tracer, tolerance, out);
    gd__arena_free(&tracer.diagram.arena);
    close_scratch(&tracer.scratch);
    return status;
}

void gd_voronoi_free(struct gd_voronoi *voronoi)
{
    if (!voronoi) return;
    free(voronoi->bisectors);
    free(voronoi->points);
    *voronoi = (struct gd_voronoi){0};
}
