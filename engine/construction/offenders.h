/* Offenders: collects the elements with the lowest numbers that a check rejects. The check may find
 * them in any order. */
#pragma once

#include "gd/status.h"

struct gd__offender {
    uint64_t a, b;    /* the element, as in struct gd_detail */
    uint32_t witness; /* another element, which the error text names */
};

struct gd__offenders {
    uint64_t total;
    uint32_t count;
    struct gd__offender lowest[GD_DETAIL_ELEMENTS];
};

void gd__offenders_add(struct gd__offenders *offenders, uint64_t a, uint64_t b, uint32_t witness);

/* Appends the elements to `detail`, which already contains the text of the error. Does nothing if
 * `detail` is NULL. Returns `status`. */
enum gd_status gd__offenders_report(const struct gd__offenders *offenders, enum gd_element kind,
                                    enum gd_status status, struct gd_detail *detail);
