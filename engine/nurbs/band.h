/* Band: symmetric positive definite matrices of small bandwidth, factored by Cholesky's method. Row
 * i of the lower triangle is stored as row[i * width + k] = A[i][i - k], k < width; entries before
 * the first column are zero. Golub and Van Loan, Matrix Computations, section 4.3. */
#ifndef GD_NURBS_BAND_H
#define GD_NURBS_BAND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Factors A = L L^T in place. Returns false, with an undefined matrix, if a pivot is not clearly
 * positive, given rounding errors. O(size width^2). */
bool gd__band_factor(uint32_t size, uint32_t width, double *row);

/* Solves L L^T x = b in place. O(size width). */
void gd__band_solve(uint32_t size, uint32_t width, const double *row, double *b);

#endif
