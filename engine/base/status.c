#include "gd/status.h"

#include <stdarg.h>
#include <stdio.h>

const char *gd_status_name(enum gd_status status)
{
    switch (status) {
#define GD_STATUS_NAME(number, NAME, name, sentence)                                               \
    case GD_##NAME:                                                                                \
        return #name;
        GD_STATUS_MAP(GD_STATUS_NAME)
#undef GD_STATUS_NAME
    }
    return "unknown";
}

const char *gd_status_sentence(enum gd_status status)
{
    switch (status) {
#define GD_STATUS_SENTENCE(number, NAME, name, sentence)                                           \
    case GD_##NAME:                                                                                \
        return sentence;
        GD_STATUS_MAP(GD_STATUS_SENTENCE)
#undef GD_STATUS_SENTENCE
    }
    return "unknown status";
}

enum gd_status gd_fail(struct gd_detail *detail, enum gd_status status, const char *format, ...)
{
    if (!detail) return status;
    *detail = (struct gd_detail){.kind = GD_ELEMENT_NONE};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(detail->text, sizeof detail->text, format, arguments);
    va_end(arguments);
    return status;
}

enum gd_status gd_fail_status(struct gd_detail *detail, enum gd_status status)
{
    return gd_fail(detail, status, "%s", gd_status_sentence(status));
}

void gd_detail_add(struct gd_detail *detail, enum gd_element kind, uint64_t a, uint64_t b)
{
    if (!detail) return;
    detail->kind = kind;
    detail->total++;
    if (detail->count == GD_DETAIL_ELEMENTS) return;
    detail->elements[detail->count][0] = a;
    detail->elements[detail->count][1] = b;
    detail->count++;
}
