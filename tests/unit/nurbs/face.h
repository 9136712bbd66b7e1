/* A human face after the second experiment of W.-H. Chen, "Improvement of the shortest path problem
 * with geodesic-like method": the front of a head as one bicubic B-spline with brow, sockets, nose,
 * lips and chin, and the outlines of two holes for the eyes. Lengths are similar to the paper's. */
#pragma once

#include <math.h>

#include "gd/domain_curve.h"
#include "gd/nurbs.h"

enum { FACE_COLUMNS = 22, FACE_ROWS = 26, FACE_DEGREE = 3, FACE_CORNERS = 8 };

static inline double face_hill(double x, double y, double width, double height)
{
    return exp(-(x * x) / (width * width) - (y * y) / (height * height));
}

/* Returns the height over (x, y) in [-1, 1]^2. x runs from ear to ear, y from chin to forehead. The
 * face is slightly asymmetric. */
static inline double face_height(double x, double y)
{
    double skull = 9 * sqrt(1.02 - 0.6 * x * x - 0.4 * y * y), eye = fabs(x - 0.01) - 0.42;
    double nose = 6 * face_hill(x - 0.02, y - 0.05, 0.13 - 0.05 * y, 0.4);
    double brow = 0.9 * face_hill(x, y - 0.48, 0.6, 0.1),
           socket = 1.5 * face_hill(eye, y - 0.3, 0.2, 0.14);
    double lips = 0.6 * face_hill(x, y + 0.52, 0.25, 0.05),
           chin = 1.1 * face_hill(x + 0.02, y + 0.85, 0.3, 0.14);
    return skull + nose + brow - socket + lips + chin;
}

static inline void face_knots(uint32_t count, double *knots)
{
    for (uint32_t i = 0; i < count + FACE_DEGREE + 1; i++)
        knots[i] = i <= FACE_DEGREE ? 0
                   : i >= count     ? 1
                                    : (double)(i - FACE_DEGREE) / (count - FACE_DEGREE);
}

static inline enum gd_status face_create(struct gd_parametric **out, struct gd_detail *detail)
{
    static double points[FACE_COLUMNS * FACE_ROWS][3];
    double knots[2][FACE_ROWS + FACE_DEGREE + 1];
    face_knots(FACE_COLUMNS, knots[0]);
    face_knots(FACE_ROWS, knots[1]);
    for (int i = 0; i < FACE_COLUMNS * FACE_ROWS; i++) {
        double x = 2.0 * (i / FACE_ROWS) / (FACE_COLUMNS - 1) - 1,
               y = 2.0 * (i % FACE_ROWS) / (FACE_ROWS - 1) - 1;
        points[i][0] = 17 * x, points[i][1] = 22 * y, points[i][2] = 1.6 * face_height(x, y);
    }
    const struct gd_nurbs_data data = {.degree_u = FACE_DEGREE,
                                       .degree_v = FACE_DEGREE,
                                       .count_u = FACE_COLUMNS,
                                       .count_v = FACE_ROWS,
                                       .knots_u = knots[0],
                                       .knots_v = knots[1],
                                       .knot_count_u = FACE_COLUMNS + FACE_DEGREE + 1,
                                       .knot_count_v = FACE_ROWS + FACE_DEGREE + 1,
                                       .points = (const double(*)[3])points};
    return gd_nurbs_create(&data, out, detail);
}

/* Creates the outline of a hole around (u, v). The outline is a closed cubic B-spline, nearly an
 * ellipse with the half axes a and b. */
static inline enum gd_status face_outline(const struct gd_parametric *surface, double u, double v,
                                          double a, double b, struct gd_domain_curve **out)
{
    double knots[FACE_CORNERS + 2 * FACE_DEGREE + 1], points[FACE_CORNERS + FACE_DEGREE][2];
    for (int i = 0; i < FACE_CORNERS + 2 * FACE_DEGREE + 1; i++) knots[i] = i - FACE_DEGREE;
    for (int i = 0; i < FACE_CORNERS + FACE_DEGREE; i++) {
        double angle = 2 * M_PI * i / FACE_CORNERS;
        points[i][0] = u + a * cos(angle);
        points[i][1] = v + b * sin(angle);
    }
    return gd_domain_curve_bspline(surface,
                                   &(struct gd_domain_bspline){FACE_DEGREE, knots,
                                                               (const double(*)[2])points,
                                                               FACE_CORNERS + FACE_DEGREE},
                                   NULL, out, NULL);
}

static inline enum gd_status face_eye(const struct gd_parametric *face, int side,
                                      struct gd_domain_curve **out)
{
    return face_outline(face, side ? 0.73 : 0.28, side ? 0.64 : 0.66, 0.1, 0.055, out);
}
