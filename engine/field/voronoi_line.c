#include <stdlib.h>

#include "base/array.h"
#include "field/voronoi_parts.h"

/* Bisectors as polylines: appends part after part, each with as many points as the tolerance
 * needs. */

enum {
    HALVINGS_MOST = 10,    /* limit on halvings of a quarter turn of a branch */
    CHECK_INTERVAL = 1024, /* points */
    PARTS_CHECKED = 65536  /* number of parts between two checks if no line begins at them */
};

struct line {
    uint32_t first; /* point */
    struct gd_bisector bisector;
};

struct writer {
    struct gd__diagram *diagram;
    const struct gd__export_options *how;
    double least;  /* lines no longer than this, the size of nudges, count as points */
    bool *visited; /* per bisector_part */
    struct gd_point *point;
    struct line *line;
    uint32_t point_count, point_capacity, line_count, line_capacity;
    uint32_t strands_done;
    double length; /* length of the current line, normalised unit */
    enum gd_status status;
};

/* --- points ----------------------------------------------------------------------------------- */

static enum gd_status check_work(const struct writer *writer)
{
    double done = (double)writer->strands_done / writer->diagram->bisector_part_count,
           progress = writer->how->progress;
    return gd_control_check(writer->how->control, progress + (1 - progress) * done);
}

/* Makes room for points. The budget must cover the larger array and the smaller one. */
static enum gd_status make_room(struct writer *writer, uint64_t count)
{
    if (count <= writer->point_capacity) return GD_OK;
    if (count > UINT32_MAX) return GD_TOO_LARGE;
    uint64_t larger = gd__array_capacity(writer->point_capacity, (uint32_t)count),
             points = larger + writer->point_capacity;
    size_t lines = writer->line_capacity * sizeof(struct gd_bisector);
    enum gd_status status =
        gd_control_afford(writer->how->control, writer->diagram->arena.budget.held + lines +
                                                    points * sizeof *writer->point);
    return status ? status
                  : gd__array_extend(&writer->point, &writer->point_capacity, count,
                                     sizeof *writer->point, NULL);
}

static void append_point(struct writer *writer, const struct gd_point *point)
{
    if (!writer->status && writer->point_count % CHECK_INTERVAL == 0)
        writer->status = check_work(writer);
    if (!writer->status) writer->status = make_room(writer, writer->point_count + UINT64_C(1));
    if (!writer->status)
        writer->status = gd__array_append(&writer->point, &writer->point_count,
                                          &writer->point_capacity, point, sizeof *point);
}

/* A face that the line enters from its last point. */
struct leg {
    struct gd__face_frame frame;
    uint32_t face;
    struct gd__local at; /* the last point */
};

/* Appends a point, unless it equals the last one. */
static void go_to(struct writer *writer, struct leg *leg, const struct gd_point *point)
{
    if (writer->status || gd_point_equal(&writer->point[writer->point_count - 1], point)) return;
    struct gd__local at = gd__point_local(writer->diagram->mesh, leg->face, point);
    writer->length += hypot(at.x - leg->at.x, at.y - leg->at.y);
    leg->at = at;
    append_point(writer, point);
}

static void go_to_place(struct writer *writer, struct leg *leg, struct gd__local at)
{
    struct gd_point point = gd__face_frame_point(writer->diagram->mesh, leg->face, &leg->frame, at);
    go_to(writer, leg, &point);
}

/* --- a part of a bisector --------------------------------------------------------------------- */

/* Appends points between two positions of a branch that are at most a quarter turn apart. The
 * branch deviates most from the chord near the middle. */
static void flatten_branch(struct writer *writer, struct leg *leg, const struct gd__focus focus[2],
                           struct gd__local from, struct gd__local to, int halvings_left)
{
    struct gd__local middle = {0.5 * (from.x + to.x), 0.5 * (from.y + to.y)};
    double chord = hypot(to.x - from.x, to.y - from.y);
    struct gd__local at = gd__between_two(focus, middle, chord);
    if (writer->status || !halvings_left ||
        hypot(at.x - middle.x, at.y - middle.y) <= writer->how->tolerance)
        return;
    flatten_branch(writer, leg, focus, from, at, halvings_left - 1);
    go_to_place(writer, leg, at);
    flatten_branch(writer, leg, focus, at, to, halvings_left - 1);
}

/* Appends the points of a part, computed without the nudge, in steps of at most a quarter turn. */
static void flatten_arc(struct writer *writer, struct leg *leg, const struct gd__arc *arc,
                        bool reversed, const struct gd_point *stop)
{
    struct gd__branch branch;
    struct gd__local from = leg->at, to = gd__point_local(writer->diagram->mesh, leg->face, stop),
                     origin = {0, 0};
    double size = leg->frame.size;
    double start = reversed ? arc->to : arc->from,
           turn = (arc->to - arc->from) * (reversed ? -1 : 1);
    uint32_t parts = (uint32_t)(fabs(turn) / M_PI_2) + 1;
    if (parts > 1 && !gd__branch_between(&arc->focus[0], &arc->focus[1], origin, size, &branch))
        parts = 1;
    for (uint32_t i = 1; i <= parts; i++) {
        struct gd__local next =
            i < parts ? gd__branch_place(&branch, start + turn * i / parts - branch.zero) : to;
        flatten_branch(writer, leg, arc->focus, from, next, HALVINGS_MOST);
        if (i < parts) go_to_place(writer, leg, next);
        from = next;
    }
}

/* Appends a part of a bisector, from one of its nodes to the other. */
static void go_along(struct writer *writer, const struct gd__bisector_part *bisector_part,
                     bool reversed)
{
    const struct gd__diagram *diagram = writer->diagram;
    const struct gd_point *start = &diagram->node[bisector_part->node[reversed]].point,
                          *stop = &diagram->node[bisector_part->node[!reversed]].point;
    struct leg leg = {gd__face_frame_of(diagram->mesh, bisector_part->face), bisector_part->face,
                      gd__point_local(diagram->mesh, bisector_part->face, start)};
    const struct gd__arc *arc =
        bisector_part->arc == GD_NONE ? NULL : &diagram->arc[bisector_part->arc];
    if (arc && !arc->focus[0].linear) flatten_arc(writer, &leg, arc, reversed, stop);
    go_to(writer, &leg, stop);
}

/* --- lines ------------------------------------------------------------------------------------ */

/* Returns the part that continues a line at a node; GD_NONE if the line ends there. */
static uint32_t bisector_part_behind(const struct gd__diagram *diagram, uint32_t bisector_part,
                                     uint32_t number)
{
    const struct gd__node *node = &diagram->node[number];
    if (node->is_end) return GD_NONE;
    return node->bisector_part[0] == bisector_part ? node->bisector_part[1]
                                                   : node->bisector_part[0];
}

/* Writes the line that begins with a part at one of the part's nodes, unless the line is no longer
 * than the rounding error. */
static void write_line(struct writer *writer, uint32_t bisector_part, uint32_t node)
{
    const struct gd__diagram *diagram = writer->diagram;
    const struct gd__bisector_part *first = &diagram->bisector_part[bisector_part];
    struct line line = {.first = writer->point_count,
                        .bisector = {.members = {first->member[0], first->member[1]}}};
    uint32_t start = node;
    writer->length = 0;
    append_point(writer, &diagram->node[node].point);
    while (bisector_part != GD_NONE && !writer->visited[bisector_part] && !writer->status) {
        const struct gd__bisector_part *at = &diagram->bisector_part[bisector_part];
        bool reversed = at->node[0] != node;
        writer->visited[bisector_part] = true;
        writer->strands_done++;
        go_along(writer, at, reversed);
        node = at->node[!reversed];
        bisector_part = bisector_part_behind(diagram, bisector_part, node);
    }
    line.bisector.closed = bisector_part != GD_NONE && node == start;
    line.bisector.point_count = writer->point_count - line.first;
    line.bisector.length = writer->length * diagram->mesh->unit;
    if (writer->length <= writer->least)
        writer->point_count = line.first;
    else if (!writer->status)
        writer->status =
            gd__arena_append(&writer->diagram->arena, &writer->line, &writer->line_count,
                             &writer->line_capacity, &line, sizeof line);
}

static bool ends_at(const struct gd__diagram *diagram, uint32_t bisector_part, int end)
{
    uint32_t node = diagram->bisector_part[bisector_part].node[end];
    return bisector_part_behind(diagram, bisector_part, node) == GD_NONE;
}

/* Makes room for the points of lines whose parts are all straight. */
static enum gd_status make_room_for_lines(struct writer *writer)
{
    const struct gd__diagram *diagram = writer->diagram;
    uint32_t parts = diagram->bisector_part_count;
    uint64_t ends = 0;
    for (uint32_t i = 0; i < parts; i++) ends += ends_at(diagram, i, 0) + ends_at(diagram, i, 1);
    return make_room(writer, parts + ends / 2);
}

/* Writes the open lines first; the remaining lines are closed. */
static void write_lines(struct writer *writer)
{
    const struct gd__diagram *diagram = writer->diagram;
    for (uint32_t i = 0; i < diagram->bisector_part_count && !writer->status; i++) {
        if (i % PARTS_CHECKED == 0) writer->status = check_work(writer);
        for (int end = 0; end < 2; end++)
            if (!writer->visited[i] && ends_at(diagram, i, end))
                write_line(writer, i, diagram->bisector_part[i].node[end]);
    }
    for (uint32_t i = 0; i < diagram->bisector_part_count && !writer->status; i++)
        if (!writer->visited[i]) write_line(writer, i, diagram->bisector_part[i].node[0]);
}

static int by_members(const void *a, const void *b)
{
    const struct line *x = a, *y = b;
    for (int i = 0; i < 2; i++)
        if (x->bisector.members[i] != y->bisector.members[i])
            return x->bisector.members[i] < y->bisector.members[i] ? -1 : 1;
    return (x->first > y->first) - (x->first < y->first);
}

/* Sorts the lines. Those of one pair of members are already sorted. */
static void sort_lines(struct writer *writer)
{
    bool is_sorted = true;
    for (uint32_t i = 1; i < writer->line_count; i++)
        is_sorted &= by_members(&writer->line[i - 1], &writer->line[i]) < 0;
    if (!is_sorted) qsort(writer->line, writer->line_count, sizeof *writer->line, by_members);
}

static enum gd_status hand_over(struct writer *writer, struct gd_voronoi *out)
{
    struct gd_bisector *bisectors = malloc(sizeof *bisectors * ((size_t)writer->line_count + 1));
    size_t points = (writer->point_count + (size_t)1) * sizeof *writer->point;
    struct gd_point *exact = realloc(writer->point, points);
    if (exact) writer->point = exact;
    if (!bisectors || !exact) {
        free(bisectors);
        return GD_NO_MEMORY;
    }
    sort_lines(writer);
    for (uint32_t i = 0; i < writer->line_count; i++) {
        bisectors[i] = writer->line[i].bisector;
        bisectors[i].points = writer->point + writer->line[i].first;
    }
    size_t bytes = sizeof *bisectors * ((size_t)writer->line_count + 1) + points;
    *out = (struct gd_voronoi){writer->line_count, bisectors, writer->point, bytes};
    writer->point = NULL;
    return GD_OK;
}

enum gd_status gd__diagram_export(struct gd__diagram *diagram, const struct gd__export_options *how,
                                  struct gd_voronoi *out)
{
    struct writer writer = {
        .diagram = diagram, .how = how, .least = GD_TOL_CHECK * diagram->members.farthest};
    writer.visited =
        gd__arena_zeroed(&diagram->arena, diagram->bisector_part_count, sizeof *writer.visited);
    if (!writer.visited) return diagram->arena.status;
    writer.status = make_room_for_lines(&writer);
    write_lines(&writer);
    enum gd_status status = writer.status;
    if (!status) status = hand_over(&writer, out);
    free(writer.point);
    return status;
}
