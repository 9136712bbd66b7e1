#include "tests/oracle/closed_forms.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* --- box -------------------------------------------------------------------------------------- */

/* Faces have the number 2 axis + side. On this face, the coordinate `axis` is 0 (side 0) or
 * size[axis] (side 1). */
enum { BOX_FACES = 6 };

/* A position of the box while it rolls over the plane. One face lies in the plane. The map x -> map
 * x + shift maps this face isometrically to its place in the plane. */
struct roll {
    double map[2][3], shift[2];
    int face;
    unsigned passed; /* bit f is set if face f has been in the plane */
};

/* The edges over which the box has rolled, in the plane. Each edge has an end on the right and an
 * end on the left of the path. */
struct hinges {
    double end[BOX_FACES][2][2];
    int count;
};

struct box_search {
    const double *size, *target;
    double start[2];
    double best;
};

static void image(const struct roll *roll, const double x[3], double out[2])
{
    for (int i = 0; i < 2; i++)
        out[i] = roll->shift[i] + roll->map[i][0] * x[0] + roll->map[i][1] * x[1] +
                 roll->map[i][2] * x[2];
}

static bool is_on_face(const double size[3], const double x[3], int face)
{
    return x[face / 2] == (face % 2 ? size[face / 2] : 0);
}

static double orientation(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Returns whether the straight line from p to q crosses every hinge, up to rounding. A line that
 * misses a corner by a rounding error has the right length up to this error. */
static bool passes_all(const struct hinges *hinges, const double p[2], const double q[2])
{
    for (int i = 0; i < hinges->count; i++) {
        double right = -orientation(p, q, hinges->end[i][0]),
               left = orientation(p, q, hinges->end[i][1]);
        if (fmin(left, right) < -1e-14 * (fabs(left) + fabs(right))) return false;
    }
    return true;
}

static void swap_ends(double end[2][2])
{
    for (int i = 0; i < 2; i++) {
        double first = end[0][i];
        end[0][i] = end[1][i];
        end[1][i] = first;
    }
}

/* Rolls the box over the edge shared with the neighbour `next`. This edge becomes the last
 * hinge. */
static struct roll roll_over(const struct roll *roll, const double size[3], int next,
                             struct hinges *hinges)
{
    int from = roll->face / 2, to = next / 2, third = 3 - from - to;
    double from_sign = roll->face % 2 ? 1 : -1, to_sign = next % 2 ? 1 : -1;
    double edge[2][3] = {{0}};
    for (int i = 0; i < 2; i++) {
        edge[i][from] = roll->face % 2 ? size[from] : 0;
        edge[i][to] = next % 2 ? size[to] : 0;
        edge[i][third] = i ? size[third] : 0;
        image(roll, edge[i], hinges->end[hinges->count][i]);
    }
    const double outward[2] = {to_sign * roll->map[0][to], to_sign * roll->map[1][to]};
    double(*end)[2] = hinges->end[hinges->count++];
    if (outward[0] * (end[1][1] - end[0][1]) < outward[1] * (end[1][0] - end[0][0])) swap_ends(end);
    struct roll rolled = *roll;
    rolled.face = next;
    rolled.passed |= 1u << next;
    /* a line that leaves the old face continues on the new face in the direction opposite to the
     * old face's outward normal */
    for (int i = 0; i < 2; i++) {
        rolled.map[i][from] = -from_sign * to_sign * roll->map[i][to];
        rolled.map[i][to] = 0;
        rolled.shift[i] = 0;
    }
    double before[2], after[2];
    image(roll, edge[0], before);
    image(&rolled, edge[0], after);
    for (int i = 0; i < 2; i++) rolled.shift[i] = before[i] - after[i];
    return rolled;
}

static void roll_on(struct box_search *search, const struct roll *roll, const struct hinges *hinges)
{
    if (is_on_face(search->size, search->target, roll->face)) {
        double end[2];
        image(roll, search->target, end);
        double distance = hypot(end[0] - search->start[0], end[1] - search->start[1]);
        if (distance < search->best && passes_all(hinges, search->start, end))
            search->best = distance;
    }
    for (int next = 0; next < BOX_FACES; next++) {
        if (next / 2 == roll->face / 2 || roll->passed & 1u << next) continue;
        struct hinges more = *hinges;
        struct roll rolled = roll_over(roll, search->size, next, &more);
        roll_on(search, &rolled, &more);
    }
}

double closed_form_box(const double size[3], const double p[3], const double q[3])
{
    struct box_search search = {.size = size, .target = q, .best = INFINITY};
    for (int face = 0; face < BOX_FACES; face++) {
        if (!is_on_face(size, p, face)) continue;
        struct roll roll = {.face = face, .passed = 1u << face};
        roll.map[0][(face / 2 + 1) % 3] = 1;
        roll.map[1][(face / 2 + 2) % 3] = 1;
        image(&roll, p, search.start);
        roll_on(&search, &roll, &(struct hinges){0});
    }
    return search.best;
}

/* --- fan -------------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double angle_between(const double a[3], const double b[3])
{
    double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    return atan2(sqrt(dot(c, c)), dot(a, b));
}

/* Returns which of n equal sectors about the z axis contains the point. */
static uint32_t sector_of(const double p[3], uint32_t n)
{
    double turn = atan2(p[1], p[0]) / (2 * M_PI);
    return (uint32_t)floor((turn < 0 ? turn + 1 : turn) * n) % n;
}

static void spoke(const struct closed_form_fan *fan, uint32_t i, double out[3])
{
    double azimuth = 2 * M_PI * i / fan->sectors;
    out[0] = fan->radius * cos(azimuth);
    out[1] = fan->radius * sin(azimuth);
    out[2] = fan->corner_z[i % 2] - fan->apex_z;
}

double closed_form_fan(const struct closed_form_fan *fan, const double p[3], const double q[3])
{
    double first[3], second[3], at[2][3], reach[2], angle[2];
    spoke(fan, 0, first);
    spoke(fan, 1, second);
    double sector_angle = angle_between(first, second);
    for (int i = 0; i < 2; i++) {
        const double *x = i ? q : p;
        uint32_t sector = sector_of(x, fan->sectors);
        memcpy(at[i], x, sizeof at[i]);
        at[i][2] -= fan->apex_z;
        spoke(fan, sector, first);
        reach[i] = sqrt(dot(at[i], at[i]));
        angle[i] = sector * sector_angle + angle_between(first, at[i]);
    }
    double gap = fabs(angle[0] - angle[1]);
    gap = fmin(gap, fan->sectors * sector_angle - gap);
    if (gap >= M_PI) return reach[0] + reach[1];
    return hypot(reach[0] - reach[1], 2 * sqrt(reach[0] * reach[1]) * sin(0.5 * gap));
}

/* --- prism ------------------------------------------------------------------------------------ */

static double girth(double radius, uint32_t sides, const double p[3])
{
    double azimuth = 2 * M_PI * sector_of(p, sides) / sides;
    double x = p[0] - radius * cos(azimuth), y = p[1] - radius * sin(azimuth);
    return 2 * radius * sin(M_PI / sides) * sector_of(p, sides) + hypot(x, y);
}

double closed_form_prism(double radius, uint32_t sides, const double p[3], const double q[3])
{
    double round = 2 * radius * sin(M_PI / sides) * sides;
    double gap = fabs(girth(radius, sides, p) - girth(radius, sides, q));
    return hypot(fmin(gap, round - gap), p[2] - q[2]);
}

/* --- tetrahedron ------------------------------------------------------------------------------ */

/* Computes a position of the point in the plane, in lattice coordinates. The lattice point (i,j) is
 * an image of corner (i mod 2) + 2 (j mod 2). */
static void lay_down(const double weight[4], double out[2])
{
    static const int lattice[4][4][2] = {/* indexed by the corner that the face lacks */
                                         {{0, 0}, {1, 0}, {0, 1}, {1, 1}},
                                         {{0, 2}, {0, 0}, {0, 1}, {1, 1}},
                                         {{2, 0}, {1, 0}, {0, 0}, {1, 1}},
                                         {{0, 0}, {1, 0}, {0, 1}, {0, 0}}};
    int lacking = 0;
    for (int k = 1; k < 4; k++)
        if (weight[k] < weight[lacking]) lacking = k;
    out[0] = out[1] = 0;
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 2; i++) out[i] += weight[k] * lattice[lacking][k][i];
}

double closed_form_tetrahedron(double edge, const double p[4], const double q[4])
{
    double a[2], b[2], best = INFINITY;
    lay_down(p, a);
    lay_down(q, b);
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int i = -4; i <= 4; i += 2) {
            for (int j = -4; j <= 4; j += 2) {
                double u = sign * b[0] + i - a[0], v = sign * b[1] + j - a[1];
                best = fmin(best, edge * hypot(u + 0.5 * v, sqrt(0.75) * v));
            }
        }
    }
    return best;
}
