/* Face frame: the plane of a face, with corner 0 at the origin and corner 1 on the positive x axis.
 * It is the frame of the face's side 0. Normalised unit. */
#pragma once

#include "field/layout.h"
#include "mesh/axes.h"
#include "mesh/canonical.h"

struct gd__face_frame {
    /* side k runs from corner k in the unit direction along[k] */
    struct gd__local corner[3], along[3];
    double length[3], size; /* size: the longest edge */
};

static inline struct gd__face_frame gd__face_frame_of(const struct gd_mesh *mesh, uint32_t face)
{
    const struct gd_side *s = &mesh->side[mesh->face_side[face][0]];
    struct gd__face_frame frame = {
        .corner = {{0, 0},
                   {s->length, 0},
                   {s->left_length * s->left_x, s->left_length * s->left_y}},
        .along = {{1, 0}, {-s->right_x, -s->right_y}, {-s->left_x, -s->left_y}},
        .length = {s->length, s->right_length, s->left_length},
    };
    frame.size = fmax(s->length, fmax(s->right_length, s->left_length));
    return frame;
}

/* Transforms a vector from side k's frame to the face's frame. */
static inline struct gd__local gd__face_frame_turn(const struct gd__face_frame *frame, int k,
                                                   double x, double y)
{
    struct gd__local u = frame->along[k];
    return (struct gd__local){x * u.x - y * u.y, x * u.y + y * u.x};
}

static inline struct gd__local gd__face_frame_place(const struct gd__face_frame *frame, int k,
                                                    double x, double y)
{
    struct gd__local turned = gd__face_frame_turn(frame, k, x, y);
    return (struct gd__local){frame->corner[k].x + turned.x, frame->corner[k].y + turned.y};
}

static inline struct gd__local gd__face_frame_middle(const struct gd__face_frame *frame)
{
    const struct gd__local *c = frame->corner;
    return (struct gd__local){(c[0].x + c[1].x + c[2].x) / 3, (c[0].y + c[1].y + c[2].y) / 3};
}

/* Returns true if a position is in the face, or outside by at most `slack`. */
static inline bool gd__face_frame_has(const struct gd__face_frame *frame, struct gd__local at,
                                      double slack)
{
    for (int k = 0; k < 3; k++)
        if (gd__local_cross(frame->along[k], gd__local_minus(at, frame->corner[k])) < -slack)
            return false;
    return true;
}

/* Returns the point of the face at a position, clamped to the face, because rounding may move a
 * position outside. */
static inline struct gd_point gd__face_frame_point(const struct gd_mesh *mesh, uint32_t face,
                                                   const struct gd__face_frame *frame,
                                                   struct gd__local at)
{
    double w2 = fmax(at.y / frame->corner[2].y, 0),
           w1 = fmax((at.x - w2 * frame->corner[2].x) / frame->corner[1].x, 0),
           w0 = fmax(1 - w1 - w2, 0);
    double sum = w0 + w1 + w2;
    return gd__point_of_face(mesh, face, (double[3]){w0 / sum, w1 / sum, w2 / sum});
}
