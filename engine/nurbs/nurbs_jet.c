#include <string.h>

#include "nurbs/bspline.h"
#include "nurbs/nurbs.h"

/* Sums one row of control points over v: value, first and second derivative. */
static void sum_row(const double (*row)[4], const struct gd__basis *basis, uint32_t order,
                    double sums[3][4])
{
    memset(sums, 0, 3 * sizeof *sums);
    for (uint32_t j = 0; j < order; j++) {
        for (int c = 0; c < 4; c++) {
            sums[0][c] += basis->value[j] * row[j][c];
            sums[1][c] += basis->first[j] * row[j][c];
            sums[2][c] += basis->second[j] * row[j][c];
        }
    }
}

enum { VALUE, U, V, UU, UV, VV, SUMS };

static void homogeneous(const struct gd__nurbs *nurbs, uint32_t cell_u, uint32_t cell_v, double u,
                        double v, double sums[SUMS][4])
{
    struct gd__basis bu, bv;
    uint32_t su = nurbs->u.spans[cell_u], sv = nurbs->v.spans[cell_v], pu = nurbs->u.degree,
             pv = nurbs->v.degree;
    gd__basis(pu, nurbs->u.knots, su, u, &bu);
    gd__basis(pv, nurbs->v.knots, sv, v, &bv);
    memset(sums, 0, SUMS * sizeof *sums);
    for (uint32_t i = 0; i <= pu; i++) {
        double row[3][4];
        sum_row((const double(*)[4])nurbs->control + (size_t)(su - pu + i) * nurbs->v.count +
                    (sv - pv),
                &bv, pv + 1, row);
        for (int c = 0; c < 4; c++) {
            sums[VALUE][c] += bu.value[i] * row[0][c];
            sums[U][c] += bu.first[i] * row[0][c];
            sums[V][c] += bu.value[i] * row[1][c];
            sums[UU][c] += bu.second[i] * row[0][c];
            sums[UV][c] += bu.first[i] * row[1][c];
            sums[VV][c] += bu.value[i] * row[2][c];
        }
    }
}

/* Applies the quotient rule: (A_k - lower terms) / w. The NURBS Book, eq. 4.20. */
static void nurbs_jet_divide(double s[SUMS][4], const double centre[3], struct gd_jet *out)
{
    double inverse = 1 / s[VALUE][3], part[SUMS][3];
    for (int c = 0; c < 3; c++) {
        double x = s[VALUE][c] * inverse;
        double xu = (s[U][c] - s[U][3] * x) * inverse, xv = (s[V][c] - s[V][3] * x) * inverse;
        part[VALUE][c] = x + centre[c];
        part[U][c] = xu;
        part[V][c] = xv;
        part[UU][c] = (s[UU][c] - 2 * s[U][3] * xu - s[UU][3] * x) * inverse;
        part[UV][c] = (s[UV][c] - s[U][3] * xv - s[V][3] * xu - s[UV][3] * x) * inverse;
        part[VV][c] = (s[VV][c] - 2 * s[V][3] * xv - s[VV][3] * x) * inverse;
    }
    struct gd_vec3 *to[SUMS] = {&out->x, &out->u, &out->v, &out->uu, &out->uv, &out->vv};
    for (int k = 0; k < SUMS; k++) *to[k] = (struct gd_vec3){part[k][0], part[k][1], part[k][2]};
}

void gd__nurbs_jet(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                   struct gd_jet *out)
{
    const struct gd__nurbs *nurbs = shape;
    double sums[SUMS][4];
    homogeneous(nurbs, cell_u, cell_v, u, v, sums);
    nurbs_jet_divide(sums, nurbs->centre, out);
}
