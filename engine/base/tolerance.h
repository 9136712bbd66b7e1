/* Every tolerance of the engine, with its reason. Nothing else in the engine compares with a literal epsilon. */
#ifndef GD_BASE_TOLERANCE_H
#define GD_BASE_TOLERANCE_H

/* "Strictly shorter" means by more than this times the compared quantities (distances and the edge's length): some 45 ulps. Ties stay
 * with what exists, so that rounding can't make two equal wedges replace each other for ever. Never a global constant: a small part in
 * a large assembly has its own scale. */
#define GD_TOL_BETTER 1e-14

/* A window narrower than this part of its edge is dropped; the vertex candidates close the gap to second order in the angle that it subtends,
 * which is at most GD_TOL_WIDTH / GD_TOL_FLAT. */
#define GD_TOL_WIDTH 1e-13

/* A face whose height over its longest edge is less than this part of that edge is refused as degenerate: a source in its corner lies so close
 * to the edge that parameters along the edge no longer tell the angle at which it is seen. */
#define GD_TOL_FLAT 1e-7

/* A source outside an edge's ends and less than this part of its length off its line sees it end on: the end's candidate covers it. */
#define GD_TOL_GRAZING 1e-13

/* ... unless the source lies within this part of the length of the edge itself: then it sees the edge at all angles. */
#define GD_TOL_BESIDE 1e-6

/* The bisector's quadratic: a discriminant this far below zero (relative to b^2) has no root but for rounding; a root may miss the branch
 * condition by this part of its terms; its residual in the distances shows whether it is a root at all; Newton polishes it once, only where
 * there is a slope (at a tangential double root the step would jump far) and only by this part of the interval; closer roots are one. */
#define GD_TOL_DISCRIMINANT    1e-12
#define GD_TOL_BRANCH          1e-10
#define GD_TOL_ROOT_RESIDUAL   1e-6
#define GD_TOL_POLISH_SLOPE    1e-6
#define GD_TOL_POLISH_STEP     1e-4
#define GD_TOL_ROOT_SEPARATION 1e-12

/* Two windows of one pseudo-source are one when their unfolded sources agree to this part of their distance. */
#define GD_TOL_SAME_SOURCE 1e-11

/* Windows of one source that are this part of their width apart leave no gap between them. */
#define GD_TOL_ADJACENT 1e-9

/* A vertex is a saddle when its total angle exceeds 2 pi by more than this: below it no shortest path can bend there measurably, and a
 * flat vertex, whose angles sum to 2 pi only up to rounding, must not become a source. */
#define GD_TOL_SADDLE 1e-9

/* An edge of a fan lies in a saddle's shadow cone when it is inside it or within this angle of it. */
#define GD_TOL_CONE 1e-7

/* A face flatter than this (height over its longest edge) counts as nearly degenerate. A vertex so close to its opposite edge casts its whole
 * window through the face: the ends of a clipped one would not tell the angle. The cone saves work only; more than it is never wrong. */
#define GD_TOL_CAP 1e-6

/* A traced path that passes a vertex closer than this part of the edge goes through the vertex: which side rounding picks is no matter,
 * the length changes by its square. Well above what unfolding a thousand faces rounds away. */
#define GD_TOL_SNAP 1e-10

/* ... and up to this part when the finer snap leads past the source: a ray that begins at a wedge's stored end (2^-32 of the edge) is off by more. */
#define GD_TOL_SNAP_MOST 1e-7

/* A traced ray has reached its pseudo-source when the image lies this close to it, relative to the ray and the face. */
#define GD_TOL_ARRIVED 1e-6

/* Barycentric coordinates and edge parameters this close to the border are on it: the rounding of their own sum. */
#define GD_TOL_ON_BORDER 4e-15

/* How far a caller's barycentrics may be from summing to one, or t from [0,1], before they are an error and not rounding. */
#define GD_TOL_INPUT 1e-9

/* A leg that crosses an edge within this part of it from where it would do so straight is straight: wedges' ends are stored to 2^-32. */
#define GD_TOL_STRAIGHT 1e-9

/* One source that a face sees through several wedges has images that differ by this part of its distance, as each was unfolded on its own way;
 * and places in a face are rounded by this part of its size. Envelopes take sources for tied that differ by no more than both. */
#define GD_TOL_ENVELOPE 1e-12
#define GD_TOL_PLACE    4e-15

/* In a Voronoi diagram each member is taken to be farther than it is by less than this part of the field's greatest distance, another one for each:
 * well above what rounding makes of ties, well below the promise of the interface. */
#define GD_TOL_TIE 1e-11

/* ... and its nodes are looked for this close, relative to the edge or the face, to where the nudge put them; ends that lie so close together are one.
 * Where a bisector meets an edge of two sources' sight at a small angle, the nudge and rounding move its end by much more than they are. */
#define GD_TOL_NODE 1e-6

/* Ends of an isoline's arcs this close together, relative to the face, are looked at first to find which of them are one. It bounds the work, not
 * what is matched. */
#define GD_TOL_MEET 1e-6

/* A path's own length against the distance from the wedges, relative: the promise of the interface. */
#define GD_TOL_CHECK 1e-9

/* A point of space this close to a vertex or an edge is on it, relative to the largest coordinate in play: the rounding of a position that was
 * computed, printed or stored, 8 ulps. */
#define GD_TOL_LOCATE 1.8e-15

/* Bounds that prune a search are rounded to the safe side by this part, and by this part of the coordinates. Not for their own rounding: across faces as
 * flat as GD_TOL_FLAT a distance along the way may be off by some 1e-10, and what is pruned there has no other way on. */
#define GD_TOL_BOUND 1e-8

/* Rounding of a distance that is kept as a float, or of a difference of such: by this part, and in components so small that floats no longer tell
 * lengths well by a few of the smallest one. */
#define GD_TOL_FLOAT       6e-8
#define GD_TOL_FLOAT_LEAST 1e-44

/* Coordinates and extents beyond this and its inverse are refused: their squares leave the range of doubles. */
#define GD_EXTENT_MAX 1e150

/* Within one mesh lengths and coordinates stay within this factor of the mean edge: fourth powers stay in range. */
#define GD_EXTENT_RATIO 1e75

#endif
