/* Every tolerance of the engine, with its reason. Nothing else in the engine compares with a
 * literal epsilon. */
#ifndef GD_BASE_TOLERANCE_H
#define GD_BASE_TOLERANCE_H

/* "Strictly shorter" means by more than this times the compared quantities (distances and the
 * edge's length): some 45 ulps. Ties stay with what exists, so that rounding can't make two equal
 * wedges replace each other for ever. Never a global constant: a small part in a large assembly has
 * its own scale. */
#define GD_TOL_BETTER 1e-14

/* A window gives way to what its source casts again once the source is nearer by more than this
 * times the window's distance: some ties of a contest. */
#define GD_TOL_STALE 1e-13

/* A window narrower than this part of its edge is dropped; the vertex candidates close the gap to
 * second order in the angle that it subtends, which is at most GD_TOL_WIDTH / GD_TOL_FLAT. */
#define GD_TOL_WIDTH 1e-13

/* ... and where several seeds are put together only a part as narrow as rounding makes them: to a
 * seed beside the edge, whose view others end there, it may be half of what it sees. */
#define GD_TOL_NARROW 1e-15

/* A face whose height over its longest edge is less than this part of that edge is refused as
 * degenerate: a source in its corner lies so close to the edge that parameters along the edge no
 * longer tell the angle at which it is seen. */
#define GD_TOL_FLAT 1e-7

/* A source outside an edge's ends and less than this part of its length off its line sees it end
 * on: the end's candidate covers it. */
#define GD_TOL_GRAZING 1e-13

/* ... unless the source lies within this part of the length of the edge itself: then it sees the
 * edge at all angles. */
#define GD_TOL_BESIDE 1e-6

/* A point nearer to a vertex than this part of the least altitude of the vertex' faces is beside
 * it: it sees out of the vertex' fan all that the vertex sees, and its rays leave the fan's edges
 * near the vertex. From farther away the ends of windows, which are places on edges rounded by
 * 2e-16, tell angles to 1e-13 (doc 002). */
#define GD_TOL_BESIDE_VERTEX 1e-2

/* The bisector's quadratic: a discriminant this far below zero (relative to b^2) has no root but
 * for rounding; a root may miss the branch condition by this part of its terms; its residual in the
 * distances shows whether it is a root at all; Newton polishes it once, only where there is a slope
 * (at a tangential double root the step would jump far) and only by this part of the interval;
 * closer roots are one. */
#define GD_TOL_DISCRIMINANT    1e-12
#define GD_TOL_BRANCH          1e-10
#define GD_TOL_ROOT_RESIDUAL   1e-6
#define GD_TOL_POLISH_SLOPE    1e-6
#define GD_TOL_POLISH_STEP     1e-4
#define GD_TOL_ROOT_SEPARATION 1e-12

/* An edge shorter than this part of the distance of its end is no more than rounding to distances
 * there: the way along it is as good as any other. */
#define GD_TOL_LOST 1e-12

/* Two windows of one pseudo-source are one when their unfolded sources agree to this part of their
 * distance. */
#define GD_TOL_SAME_SOURCE 1e-13

/* Windows of one source that are this part of their width apart leave no gap between them. */
#define GD_TOL_ADJACENT 1e-9

/* A vertex is a saddle when its total angle exceeds 2 pi by more than this: below it no shortest
 * path can bend there measurably, and a flat vertex, whose angles sum to 2 pi only up to rounding,
 * must not become a source. */
#define GD_TOL_SADDLE 1e-9

/* An edge of a fan lies in a saddle's shadow cone when it is inside it or within this angle of
 * it. */
#define GD_TOL_CONE 1e-7

/* A face flatter than this (height over its longest edge) counts as nearly degenerate. A vertex so
 * close to its opposite edge casts its whole window through the face: the ends of a clipped one
 * would not tell the angle. The cone saves work only; more than it is never wrong. */
#define GD_TOL_CAP 1e-6

/* A traced path that passes a vertex closer than this part of the edge goes through the vertex:
 * which side rounding picks is no matter, the length changes by its square. Well above what
 * unfolding a thousand faces rounds away. */
#define GD_TOL_SNAP 1e-10

/* A path whose length disagrees with the distance is traced again with care. A leg then passes
 * through a vertex that is this part of the way to the leg's nearer end aside. The detour is the
 * square of this part. The first attempt uses the least value, each further one a step more. */
#define GD_TOL_ASIDE_LEAST 1e-16
#define GD_TOL_ASIDE_STEP  100

/* ... added to it: this part of the crossed edge at most, because wedges' ends are stored to 2^-32
 * of the edge; and this part of the distance, because rounding decides between wedges in faces that
 * are smaller. */
#define GD_TOL_ASIDE_END   1e-9
#define GD_TOL_ASIDE_NOISE 1e-14

/* ... and when less than this part of a leg is left, its source is looked up again: its place in
 * the frame of the face has the rounding of the whole leg. */
#define GD_TOL_ANEW 1e-4

/* A traced ray has reached its pseudo-source when the image lies this close to it, relative to the
 * ray and the face. */
#define GD_TOL_ARRIVED 1e-6

/* Barycentric coordinates and edge parameters this close to the border are on it: the rounding of
 * their own sum. */
#define GD_TOL_ON_BORDER 4e-15

/* A curve's corner this close to the border is put there. What it sees ends right beside its foot
 * on the edge, where the ends of windows are places on the edge: from nearer by they would not tell
 * the angle well enough for distances to be right to 1e-9. */
#define GD_TOL_CORNER 4e-12

/* How far a caller's barycentrics may be from summing to one, or t from [0,1], before they are an
 * error and not rounding. */
#define GD_TOL_INPUT 1e-9

/* A field that reaches less far than this part of the longest edge is not resumed but built anew.
 * So is one of a graded mesh: its shortest edge is less than that part of the longest one. */
#define GD_TOL_COARSE_REACH 1e-3
#define GD_TOL_GRADED       1e-6

/* A leg that crosses an edge within this part of it from where it would do so straight is straight:
 * wedges' ends are stored to 2^-32. */
#define GD_TOL_STRAIGHT 1e-9

/* One source that a face sees through several wedges has images that differ by this part of its
 * distance, as each was unfolded on its own way; and places in a face are rounded by this part of
 * its size. Envelopes take sources for tied that differ by no more than both. */
#define GD_TOL_ENVELOPE 1e-12
#define GD_TOL_PLACE    4e-15

/* In a Voronoi diagram each member is taken to be farther than it is by less than this part of the
 * field's greatest distance, another one for each: well above what rounding makes of ties, well
 * below the promise of the interface. */
#define GD_TOL_TIE 1e-11

/* ... and its nodes are looked for this close, relative to the edge or the face, to where the nudge
 * put them; ends that lie so close together are one. Where a bisector meets an edge of two sources'
 * sight at a small angle, the nudge and rounding move its end by much more than they are. */
#define GD_TOL_NODE 1e-6

/* Where two bisectors of three sources meet at a smaller angle, their place in common is not told
 * well by the distances: a line and its end have one tangent there. Left where it is, it is off by
 * no more than the nudge. */
#define GD_TOL_TANGENT 1e-3

/* A line may be taken to see more than it does by this part of its distance there, where rounding
 * would leave a gap: it is too near then by half that part of what it is lengthened by. */
#define GD_TOL_LENGTHENED 1e-3

/* Ends of an isoline's arcs this close together, relative to the face, are looked at first to find
 * which of them are one. It bounds the work, not what is matched. */
#define GD_TOL_MEET 1e-6

/* A path's own length against the distance from the wedges, relative: the promise of the
 * interface. */
#define GD_TOL_CHECK 1e-9

/* A point of space this close to a vertex or an edge is on it, relative to the largest coordinate
 * in play: the rounding of a position that was computed, printed or stored, 8 ulps. */
#define GD_TOL_LOCATE 1.8e-15

/* Bounds that prune a search are rounded to the safe side by this part, and by this part of the
 * coordinates. Not for their own rounding: across faces as flat as GD_TOL_FLAT a distance along the
 * way may be off by some 1e-10, and what is pruned there has no other way on. */
#define GD_TOL_BOUND 1e-8

/* Rounding of a distance that is kept as a float, or of a difference of such: by this part, and in
 * components so small that floats no longer tell lengths well by a few of the smallest one. */
#define GD_TOL_FLOAT       6e-8
#define GD_TOL_FLOAT_LEAST 1e-44

/* A straight line that comes this close to a vertex, relative to the edge that it crosses there and
 * to the way from its start, whichever is shorter, goes through it (GD_TOL_PLACE of the edge is
 * added); and its end lies on the edge or the vertex that it is this close to, relative to the edge
 * and to its length, whichever is shorter. Also, as an angle, how far half a turn may miss a
 * boundary edge: straight boundaries are so up to rounding. */
#define GD_TOL_HIT 1e-12

/* ... and this part of the way that it has come is added: what unfolding face after face rounds
 * away. */
#define GD_TOL_DRIFT 1e-15

/* A segment of a vector that is followed by another ends in the vertex that it comes this close to,
 * relative to its length; and a segment that meets the boundary with so little left has come to its
 * end. Faces as flat as GD_TOL_FLAT round away almost as much. */
#define GD_TOL_JOINT 1e-9

/* A line touches a segment of itself that it misses by this part of the two: it has come round with
 * the rounding of its whole way. */
#define GD_TOL_TOUCH 1e-9

/* What a cut's curve passes more closely than this part of a face's longest edge it is moved to:
 * ten times what a face must not be flatter than. In faces that are nearly flat themselves more is
 * tried, up to the second, by steps of the third. */
#define GD_TOL_SEAM      1e-6
#define GD_TOL_SEAM_MOST 1.5e-2
#define GD_TOL_SEAM_STEP 10

/* A side of a triangulation is flipped when the sine of its opposite angles' sum is this far below
 * zero: the rounding of both, so that no flip is undone. */
#define GD_TOL_DELAUNAY 1e-12

/* A mean is found when the step that would be next is this part of how far the points lie from it:
 * directions and lengths of some searches, rounded. */
#define GD_TOL_MEAN 1e-11

/* A line that bends at a vertex by less than this angle is straight there: going round on the other
 * side would shorten it by the square. */
#define GD_TOL_BEND 1e-10

/* A closed curve is a geodesic when it misses being straight by less than this angle where it
 * begins and ends: its length is off by the square. */
#define GD_TOL_CLOSED_TURN 1e-9

/* A closed curve that is no longer than this part of what it was shrinks to a point. */
#define GD_TOL_VANISH 1e-9

/* Points of a spline that are closer than this part of the distance to the farthest of their
 * neighbours are one point: what is between them has no direction. */
#define GD_TOL_SAME_POINT 1e-12

/* Coordinates and extents beyond this and its inverse are refused: their squares leave the range of
 * doubles. */
#define GD_EXTENT_MAX 1e150

/* Within one mesh lengths and coordinates stay within this factor of the mean edge: fourth powers
 * stay in range. */
#define GD_EXTENT_RATIO 1e75

/* --- parametric surfaces (nurbs) -------------------------------------------------------------- */

/* Two borders of a surface are one curve, or a border is one point, when they agree to this part of
 * the surface's size: lengths across are off by no more. */
#define GD_TOL_CLOSED 1e-11

/* Derivatives in u and v that enclose an area of less than this part of their squares are parallel:
 * a pole. */
#define GD_TOL_REGULAR 1e-14

/* A pivot of Cholesky's method below this part of its diagonal entry is zero but for rounding: the
 * matrix is not positive definite. */
#define GD_TOL_PIVOT 1e-13

/* The second derivative of a length by the place of its end, relative to 1 / length, is zero but
 * for rounding below this. */
#define GD_TOL_DEGENERATE 1e-9

/* Newton's method on a length has arrived when the next step promises less than this part of it:
 * the square of what rounding leaves of the gradient. */
#define GD_TOL_STATIONARY 1e-24

/* ... and below this promise lengths no longer tell steps apart: steps are taken as they come, as
 * long as the promise falls. */
#define GD_TOL_BLIND 1e-12

/* A curve may leave its smooth cell of a surface by this part of the cell's width: the cell goes on
 * smoothly, and differs from its neighbour by the square of that at most. */
#define GD_TOL_CELL 1e-8

/* Two curves on a surface meet when places of them are this close in space, relative to the
 * surface's size; then their distance is 0. */
#define GD_TOL_COINCIDE 1e-13

/* ... and this close in the domain, relative to its width: a surface may pass through itself. */
#define GD_TOL_ONE_PLACE 1e-6

/* Ends of a spline that meet a curve at less than a right angle by more than this are refined. */
#define GD_TOL_END 1e-9

/* A path through a pole is straight there, and so a geodesic, when its direction changes by less
 * than this: the length is off by the square. */
#define GD_TOL_POLE_BEND 1e-6

/* Geodesics of a subdivision surface: the error of an integration step relative to the patch and
 * the speed, a few hundred times rounding; towards a spike, where the derivatives become parallel,
 * over the sine of their angle; */
#define GD_TOL_GEODESIC 1e-13

/* ... how far beyond the border of a patch, relative to it, a path that runs along the border
 * counts as inside: the polynomial goes on there, and is off by the third power of that; */
#define GD_TOL_PATCH 1e-12

/* ... and a vertex this near, relative to the surface's extent, is met: that moves the path no
 * more. */
#define GD_TOL_VERTEX 1e-11

/* Two directions from a corner of a limit surface whose cross product is shorter than this part of
 * them are one, and there is no normal: where there is one, what lies across is after the last
 * halving more than that of what lies along, however many faces meet. */
#define GD_TOL_SPIKE 1e-10

/* A foot on a limit surface is found when Newton's step is this small in the face's coordinates. */
#define GD_TOL_FOOT 1e-14

/* Shooting: the direction beside that measures how a geodesic's end moves, in radians; an end this
 * near to its aim, relative to the length, has arrived; and a length that differs from the
 * polyline's by more than this part is another geodesic's. */
#define GD_TOL_BESIDE_SHOT 1e-6
#define GD_TOL_SHOT        1e-11
#define GD_TOL_SAME_WAY    0.1

/* Gaps between neighbouring strips of a segment's profile are narrower than this part of it: 2^-32
 * of an edge, seen at a slant. */
#define GD_TOL_GAP 1e-6

/* Two paths to a point that come from directions this far apart, in radians, are two: those round
 * both sides of a vertex that they all but pass through differ by less. The point lies on the cut
 * locus if it is no farther from it than this part of its distance: what rounding leaves of a
 * tie. */
#define GD_TOL_CUT_ANGLE 1e-3
#define GD_TOL_CUT       1e-10

/* A way that bounds a search is pulled tight until that makes it shorter by less than this part of
 * its length: what is left of it, some times as much, makes the search wider by next to nothing. */
#define GD_TOL_TETHER 1e-5

/* A step from ring to ring (kernel/ring.h) in floats is rounded by this at most, over the search's
 * bound, where no coordinate is larger than that. */
#define GD_TOL_RING 2e-6

/* Segments of a curve that turn by less than this go on straight: what lies behind their joint is a
 * sector of that angle, to which ways round the ends of the segments' windows are as short but for
 * its square. A place so near to the line across a joint is its own, too. */
#define GD_TOL_ONWARD 1e-10

/* And by how much the foot of its perpendicular is rounded, over the lengths of its face's
 * sides. */
#define GD_TOL_ONWARD_ROUNDING 2e-15

#endif
