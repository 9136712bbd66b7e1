#include "proto/values/pen.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

bool proto_label_decode(const json_t *value, const char *place, struct proto_label *out,
                        struct proto_problem *problem)
{
    const char *text = json_string_value(value);
    size_t length = text ? json_string_length(value) : 0;
    bool ok = text && length <= GD_PICTURE_LABEL;
    for (size_t i = 0; ok && i < length; i++) ok = text[i] >= ' ' && text[i] <= '~';
    if (!ok)
        return proto_problem_refuse(problem, place,
                                    "a label is a text of at most %d printable ASCII characters",
                                    GD_PICTURE_LABEL);
    memcpy(out->text, text, length + 1);
    return true;
}

bool proto_color_decode(const json_t *value, const char *place, uint32_t *out,
                        struct proto_problem *problem)
{
    const char *text = json_string_value(value);
    bool ok = text && text[0] == '#' && json_string_length(value) == 7;
    for (int i = 1; ok && i < 7; i++) ok = isxdigit((unsigned char)text[i]);
    if (!ok)
        return proto_problem_refuse(problem, place,
                                    "a color is a text of six hexadecimal digits: \"#1a5fb4\"");
    *out = GD_PICTURE_RGB(strtoul(text + 1, NULL, 16));
    return true;
}
