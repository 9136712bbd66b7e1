#include "construction/offenders.h"

#include <stdbool.h>

static bool offenders_precedes(const struct gd__offender *x, const struct gd__offender *y)
{
    return x->a != y->a ? x->a < y->a : x->b < y->b;
}

void gd__offenders_add(struct gd__offenders *offenders, uint64_t a, uint64_t b, uint32_t witness)
{
    struct gd__offender offender = {a, b, witness};
    offenders->total++;
    if (offenders->count < GD_DETAIL_ELEMENTS)
        offenders->count++;
    else if (!offenders_precedes(&offender, &offenders->lowest[GD_DETAIL_ELEMENTS - 1]))
        return;
    uint32_t i = offenders->count - 1;
    for (; i > 0 && offenders_precedes(&offender, &offenders->lowest[i - 1]); i--)
        offenders->lowest[i] = offenders->lowest[i - 1];
    offenders->lowest[i] = offender;
}

enum gd_status gd__offenders_report(const struct gd__offenders *offenders, enum gd_element kind,
                                    enum gd_status status, struct gd_detail *detail)
{
    if (!detail) return status;
    for (uint32_t i = 0; i < offenders->count; i++)
        gd_detail_add(detail, kind, offenders->lowest[i].a, offenders->lowest[i].b);
    detail->total = offenders->total;
    return status;
}
