/* Face frame: the plane of a face, with corner 0 at the origin and corner 1 on the positive x axis.
 * It is the frame of the face's side 0. Normalised unit. */
#ifndef GD_FIELD_FACE_FRAME_H
#define GD_FIELD_FACE_FRAME_H

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

/* Returns the point of the face at a place, clamped to the face, because rounding may move a place
 * outside. */
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

#endif
