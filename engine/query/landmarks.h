/* Landmarks: passes the distances of landmarks to the guide of a search. */
#pragma once

#include "gd/landmarks.h"
#include "guide/guide.h"

/* Passes the landmarks to the guide, which uses them until it is cleaned. Does nothing if
 * `landmarks` is NULL or belongs to another mesh. */
void gd__landmarks_offer(const struct gd_landmarks *landmarks, const struct gd_mesh *mesh,
                         struct gd__guide *guide);
