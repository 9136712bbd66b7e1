#include "nurbs/elimination.h"

#include <math.h>
#include <string.h>

#include "base/tolerance.h"

/* --- band matrices ---------------------------------------------------------------------------- */

/* Band: symmetric positive definite matrices of small bandwidth, factored by Cholesky's method. Row
 * i of the lower triangle is stored as row[i * width + k] = A[i][i - k], k < width; entries before
 * the first column are zero. Golub and Van Loan, Matrix Computations, section 4.3. */

/* Factors A = L L^T in place. Returns false, with an undefined matrix, if a pivot is not clearly
 * positive, given rounding errors. O(size width^2). */
static bool band_factor(uint32_t size, uint32_t width, double *row)
{
    for (uint32_t i = 0; i < size; i++) {
        double *a = row + (size_t)i * width, diagonal = a[0];
        uint32_t reach = i < width - 1 ? i : width - 1;
        for (uint32_t k = reach; k > 0; k--) {
            const double *b = row + (size_t)(i - k) * width;
            double sum = a[k];
            for (uint32_t m = 1; k + m <= reach; m++) sum -= a[k + m] * b[m];
            a[k] = sum / b[0];
        }
        double pivot = diagonal;
        for (uint32_t k = 1; k <= reach; k++) pivot -= a[k] * a[k];
        if (!(pivot > GD_TOL_PIVOT * fabs(diagonal))) return false;
        a[0] = sqrt(pivot);
    }
    return true;
}

/* Solves L L^T x = b in place. O(size width). */
static void band_solve(uint32_t size, uint32_t width, const double *row, double *b)
{
    for (uint32_t i = 0; i < size; i++) {
        const double *a = row + (size_t)i * width;
        for (uint32_t k = 1; k < width && k <= i; k++) b[i] -= a[k] * b[i - k];
        b[i] /= a[0];
    }
    for (uint32_t i = size; i-- > 0;) {
        const double *a = row + (size_t)i * width;
        b[i] /= a[0];
        for (uint32_t k = 1; k < width && k <= i; k++) b[i - k] -= a[k] * b[i];
    }
}

/* Returns true if a coordinate is on a border and the descent direction points out of the
 * domain. */
static bool elimination_is_held(const struct gd_axis *axis, double t, double gradient)
{
    return !axis->closed && ((t <= axis->low && gradient > 0) || (t >= axis->high && gradient < 0));
}

static void hold(const struct gd__chain *chain, const struct gd__piece *piece,
                 struct gd__part *part)
{
    uint32_t unknowns = gd__piece_unknowns(chain, piece);
    part->contact = false;
    for (uint32_t k = 0; k < unknowns; k++) {
        bool end = k < 2 || k >= unknowns - 2;
        bool border =
            !end && elimination_is_held(chain->surface->axis[k % 2], piece->points[k / 2][k % 2],
                                        part->energy.gradient[k]);
        part->held[k] = end || border;
        part->contact = part->contact || border;
    }
}

static double entry(const double *row, uint32_t width, uint32_t i, uint32_t j)
{
    uint32_t high = i > j ? i : j, low = i > j ? j : i;
    return high - low < width ? row[(size_t)high * width + (high - low)] : 0;
}

/* Computes the second derivatives of the energy by each unknown of the piece and the unknown of a
 * joint. This unknown moves the piece's end point by part->end[side].first. */
static void joint_column(const struct gd__chain *chain, const struct gd__part *part,
                         uint32_t unknowns, int side, double *out)
{
    uint32_t width = gd__energy_width(chain), first = side ? unknowns - 2 : 0;
    for (uint32_t k = 0; k < unknowns; k++)
        out[k] = entry(part->energy.hessian, width, k, first) * part->end[side].first[0] +
                 entry(part->energy.hessian, width, k, first + 1) * part->end[side].first[1];
}

static bool factor_interior(const struct gd__chain *chain, struct gd__part *part, uint32_t unknowns)
{
    uint32_t width = gd__energy_width(chain);
    memcpy(part->factor, part->energy.hessian, (size_t)unknowns * width * sizeof *part->factor);
    for (uint32_t i = 0; i < unknowns; i++) {
        double *row = part->factor + (size_t)i * width;
        for (uint32_t k = 0; k < width && k <= i; k++)
            if (part->held[i] || part->held[i - k]) row[k] = k ? 0 : row[0];
        if (part->held[i]) row[0] = 1;
    }
    return band_factor(unknowns, width, part->factor);
}

/* An end of the path can move along a curve. Returns the component of the curve's acceleration
 * along the path, which is a term of the second derivative. Sets *weight to the squared speed of
 * the curve. */
static double end_bend(const struct gd__chain *chain, const struct gd__piece *piece,
                       const struct gd__curve_jet *end, int side, double *weight)
{
    struct gd_jet x;
    struct gd__curve_jet c;
    gd__piece_jet(chain, piece, end->at, &x);
    gd__piece_at(chain, piece, side ? piece->spans - 1 : 0, side, &c);
    struct gd_vec3 slide = gd__velocity(&x, end->first), a = gd__acceleration(&x, end);
    *weight = gd_vec3_dot(slide, slide);
    return (side ? 1 : -1) * gd_vec3_dot(gd__velocity(&x, c.first), a);
}

static double dot_free(const struct gd__part *part, uint32_t unknowns, const double *a,
                       const double *b)
{
    double sum = 0;
    for (uint32_t k = 0; k < unknowns; k++)
        if (!part->held[k]) sum += a[k] * b[k];
    return sum;
}

/* Eliminates the interior unknowns of a piece. Returns false if their Hessian is not positive
 * definite. */
static bool elimination_reduce(const struct gd__chain *chain, const struct gd__piece *piece,
                               enum gd__hessian kind, struct gd__part *part)
{
    uint32_t unknowns = gd__piece_unknowns(chain, piece);
    hold(chain, piece, part);
    if (!factor_interior(chain, part, unknowns)) return false;
    const double *gradient = part->energy.gradient;
    double *column[2] = {part->solution[GD__PART_FROM], part->solution[GD__PART_TO]};
    for (int side = 0; side < 2; side++) {
        uint32_t end = side ? unknowns - 2 : 0;
        joint_column(chain, part, unknowns, side, column[side]);
        part->slope[side] =
            gradient[end] * part->end[side].first[0] + gradient[end + 1] * part->end[side].first[1];
        for (int other = 0; other <= side; other++) {
            uint32_t at = other ? unknowns - 2 : 0;
            part->schur[side][other] = column[side][at] * part->end[other].first[0] +
                                       column[side][at + 1] * part->end[other].first[1];
        }
        double bend = end_bend(chain, piece, &part->end[side], side, &part->weight[side]);
        if (kind == GD__HESSIAN_NEWTON) part->schur[side][side] += bend;
    }
    memcpy(part->solution[GD__PART_GRADIENT], gradient, unknowns * sizeof *gradient);
    double *rhs[GD__PART_SOLUTIONS] = {part->solution[GD__PART_GRADIENT], column[0], column[1]};
    for (int k = 0; k < GD__PART_SOLUTIONS; k++)
        for (uint32_t n = 0; n < unknowns; n++)
            if (part->held[n]) rhs[k][n] = 0;
    return true;
}

/* Solves the piece's system for its right-hand sides, and completes its contribution to the joints'
 * system. */
bool gd__part_eliminate(const struct gd__chain *chain, const struct gd__piece *piece,
                        enum gd__hessian kind, double *scratch, struct gd__part *part)
{
    if (!elimination_reduce(chain, piece, kind, part)) return false;
    uint32_t unknowns = gd__piece_unknowns(chain, piece), width = gd__energy_width(chain);
    band_solve(unknowns, width, part->factor, part->solution[GD__PART_GRADIENT]);
    for (int side = 0; side < 2; side++)
        part->reduced[side] =
            part->slope[side] - dot_free(part, unknowns,
                                         part->solution[side ? GD__PART_TO : GD__PART_FROM],
                                         part->solution[GD__PART_GRADIENT]);
    for (int side = 0; side < 2; side++) {
        double *column = part->solution[side ? GD__PART_TO : GD__PART_FROM];
        memcpy(scratch, column, unknowns * sizeof *scratch);
        band_solve(unknowns, width, part->factor, column);
        part->schur[side][side] -= dot_free(part, unknowns, scratch, column);
        /* The mixed derivative is reduced by the product of the unsolved column of side 1 (in
         * `scratch`) and the solved column of side 0. */
        if (side == 1)
            part->schur[1][0] -= dot_free(part, unknowns, scratch, part->solution[GD__PART_FROM]);
    }
    return true;
}
