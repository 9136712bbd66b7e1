/* Request: the parts of a struct gd_picture that images and scenes have in common. Members are
 * checked, defaults replaced, the path becomes a layer, and isolines become polylines. */
#pragma once

#include "base/arena.h"
#include "base/share.h"
#include "render/layer.h"
#include "render/scale.h"

/* Returns false if a member is out of the range given in gd/picture.h. */
bool gd__request_is_sound(const struct gd_picture *picture);

uint32_t gd__request_width(const struct gd_picture *picture);
uint32_t gd__request_height(const struct gd_picture *picture);
struct gd__palette gd__request_palette(const struct gd_picture *picture);
struct gd__scale gd__request_scale(const struct gd_picture *picture); /* there must be a field */

/* The layers in the order of drawing: first the path, if there is one. An all-zero list is empty. A
 * list that is open must not be moved. */
struct gd__layer_list {
    struct gd__layer *items;
    uint32_t count;
    struct gd_picture_layer path; /* the layer of the picture's path */
    struct gd_vec3 *path_points;
    uint32_t path_first[2];
    char path_name[48];
};

/* Lists the layers with their colours, not projected, with arrays in the arena. Errors:
 * GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__layer_list_open(struct gd__layer_list *list,
                                               const struct gd_picture *picture,
                                               const struct gd__palette *palette,
                                               struct gd__arena *arena);

/* Returns the number of isolines. `scale` is used only if there is a field. */
uint32_t gd__isoline_count(const struct gd_picture *picture, const struct gd__scale *scale);

struct gd__isoline_request { /* all borrowed */
    const struct gd_picture *picture;
    const struct gd__scale *scale;
    struct gd__share *share; /* one part for the index, and one for each isoline */
    struct gd__budget *budget;
    double tolerance; /* tolerance of the polylines, in the caller's unit */
    enum gd_status (*take)(void *own, const struct gd_path *line);
    void *own;
};

/* Calls `take` for each line of each isoline. Errors: those of gd_isoline_trace and of `take`. */
GD_MUST_USE enum gd_status gd__isolines_flatten(const struct gd__isoline_request *request);
