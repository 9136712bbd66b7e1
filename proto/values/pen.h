/* Pen: colours and labels of a figure. */
#pragma once

#include <jansson.h>

#include "gd/picture.h"
#include "proto/json/problem.h"

/* A text of printable ASCII. */
struct proto_label {
    char text[GD_PICTURE_LABEL + 1];
};
bool proto_label_decode(const json_t *value, const char *place, struct proto_label *out,
                        struct proto_problem *problem);

/* Reads "#rrggbb" as GD_PICTURE_RGB. */
bool proto_color_decode(const json_t *value, const char *place, uint32_t *out,
                        struct proto_problem *problem);
