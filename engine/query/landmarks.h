/* Landmarks from the inside. */
#ifndef GD_QUERY_LANDMARKS_H
#define GD_QUERY_LANDMARKS_H

#include "gd/landmarks.h"
#include "guide/guide.h"

/* Lends a guide what is known, until it is cleaned; nothing when `landmarks` is NULL or of another
 * mesh. */
void gd__landmarks_offer(const struct gd_landmarks *landmarks, const struct gd_mesh *mesh,
                         struct gd__guide *guide);

#endif
