/* The tolerances of the engine, each with its reason. A tolerance that only one file of `nurbs` or
 * `loops` uses, for an iteration or a check, may be a named constant in that file. No code of the
 * engine compares with a literal epsilon. */
#pragma once

/* "Strictly shorter" means shorter by more than this times the compared quantities (distances and
 * the edge's length), about 45 ulps. A tie changes nothing, so rounding cannot make two equal
 * wedges replace each other forever. The tolerance is relative, because a small part in a large
 * assembly has its own scale. */
#define GD_TOL_BETTER 1e-14

/* Suppose that two windows tie at an end of their overlap. They count as equal on the whole overlap
 * only if the overlap is narrower than the distance to the sources, divided by GD_TOL_TIE_FACTOR.
 * Inside a wider overlap one of the windows may give a shorter distance. */
#define GD_TOL_TIE_FACTOR 1024

/* A window is stale if, since its source cast it, the distance of the source has decreased by more
 * than this times the window's distance. The source casts new windows, which replace the stale one.
 * The tolerance is ten times GD_TOL_BETTER, so that a single tie of a contest makes no window
 * stale. */
#define GD_TOL_STALE 1e-13

/* A window narrower than this part of its edge is dropped. In the gap, distances come from paths
 * that bend at the ends of the neighbouring windows. The error is of second order in the angle that
 * the gap subtends. This angle is at most GD_TOL_WIDTH / GD_TOL_FLAT. */
#define GD_TOL_WIDTH 1e-13

/* Replaces GD_TOL_WIDTH if there are several seeds. A seed close to an edge may see the edge
 * through a window that is only slightly wider than the rounding error of its ends. So only windows
 * that are as narrow as this error are dropped. */
#define GD_TOL_NARROW 1e-15

/* A face is rejected as degenerate if its height over its longest edge is less than this part of
 * that edge. A source in a corner of such a face lies so close to the edge that parameters along
 * the edge do not determine the angle at which the source is seen. */
#define GD_TOL_FLAT 1e-7

/* A source beyond the ends of an edge casts no window onto the edge if its distance from the edge's
 * line is less than this part of the edge's length. The path through the edge's end covers this
 * case. */
#define GD_TOL_GRAZING 1e-13

/* If a ray passes the apex of its face at more than this distance, relative to the length of the
 * crossed edge, rounding is not the reason that the ray misses the apex. */
#define GD_TOL_BESIDE_APEX 1e-2

/* Exception to GD_TOL_GRAZING: a source that is nearer to the edge itself than this part of the
 * edge's length sees the edge at all angles. */
#define GD_TOL_BESIDE 1e-6

/* A point is beside a vertex if its distance from the vertex is less than this part of the least
 * altitude of the vertex' faces. Outside the vertex' fan (the faces around the vertex), the point
 * sees the same part of the surface as the vertex. Its rays leave the fan's edges near the vertex.
 * If the point is farther away, the ends of its windows, which are rounded by 2e-16 of their edges,
 * determine angles to 1e-13 (doc 002). */
#define GD_TOL_BESIDE_VERTEX 1e-2

/* The quadratic equation a u^2 - 2 b u + e = 0 of a bisector (window/contest.c). DISCRIMINANT:
 * there is no root if the discriminant is farther below zero than this part of b^2. BRANCH: a root
 * may miss the branch condition by this part of the condition's terms. ROOT_RESIDUAL: a candidate
 * is a root if the two distances differ by at most this part. One step of Newton's method improves
 * a root. POLISH_SLOPE: no step is made at a smaller slope, because near a double root the step
 * would be far too large. POLISH_STEP: a step of more than this part of the interval is not made.
 * ROOT_SEPARATION: closer roots count as one. */
#define GD_TOL_DISCRIMINANT    1e-12
#define GD_TOL_BRANCH          1e-10
#define GD_TOL_ROOT_RESIDUAL   1e-6
#define GD_TOL_POLISH_SLOPE    1e-6
#define GD_TOL_POLISH_STEP     1e-4
#define GD_TOL_ROOT_SEPARATION 1e-12

/* If an edge is shorter than this part of the distance of its end, its length is below the rounding
 * error of that distance. Any path to its end is then as good as the path along the edge. */
#define GD_TOL_LOST 1e-12

/* Two windows of one pseudo-source are joined if their unfolded sources agree to this part of their
 * distance. */
#define GD_TOL_SAME_SOURCE 1e-13

/* Windows of one source that are less than this part of their width apart leave no gap between
 * them. */
#define GD_TOL_ADJACENT 1e-9

/* A vertex is a saddle if its total angle exceeds 2 pi by more than this. At a smaller excess no
 * shortest path bends measurably. A flat vertex, whose angles sum to 2 pi only up to rounding, must
 * not become a source. */
#define GD_TOL_SADDLE 1e-9

/* An edge of a fan lies in a saddle's shadow cone if it is inside the cone or within this angle of
 * it. */
#define GD_TOL_CONE 1e-7

/* A face flatter than this (height over its longest edge) counts as nearly degenerate. A vertex of
 * such a face, close to the opposite edge, casts a window through the whole edge, because the ends
 * of a clipped window would not determine the angle. Windows are clipped to the shadow cone only to
 * save work, so a wider window is correct. */
#define GD_TOL_CAP 1e-6

/* A traced path that passes a vertex closer than this part of the edge goes through the vertex. The
 * side that rounding picks does not matter: the length changes only by the square of the offset.
 * The tolerance is well above the rounding error of a thousand unfolded faces. */
#define GD_TOL_SNAP 1e-10

/* If the length of a traced path disagrees with the distance, the path is traced again with a wider
 * tolerance. A leg then passes through a vertex if the vertex is off the leg by less than this part
 * of the distance to the leg's nearer end. The detour is of the order of the square of this part.
 * The first attempt uses LEAST. Each further attempt uses STEP times the tolerance of the previous
 * one. */
#define GD_TOL_ASIDE_LEAST 1e-16
#define GD_TOL_ASIDE_STEP  100

/* Two terms are added to the tolerance of GD_TOL_ASIDE_LEAST. END: at most this part of the crossed
 * edge, because the ends of wedges are stored with an error of 2^-32 of the edge. NOISE: this part
 * of the distance, because in faces smaller than this length, the rounding error decides which
 * wedge gives the shorter distance. */
#define GD_TOL_ASIDE_END   1e-9
#define GD_TOL_ASIDE_NOISE 1e-14

/* Tracing a leg recomputes the source's position in the face's frame when less than this part of
 * the leg is left, because this position has the rounding error of the whole leg. */
#define GD_TOL_ANEW 1e-4

/* A traced ray has reached a pseudo-source if the unfolded source is this close to the
 * pseudo-source, relative to the sizes of the ray and the face. */
#define GD_TOL_ARRIVED 1e-6

/* Barycentric coordinates and edge parameters that are this close to the border count as on the
 * border. The tolerance is the rounding error of their sum. */
#define GD_TOL_ON_BORDER 4e-15

/* A corner of a curve this close to an edge is moved onto it. The view from the corner ends close
 * to the foot of the perpendicular from the corner to the edge, and the ends of windows are stored
 * as parameters of the edge. If the corner were closer to the edge, these parameters would not
 * determine the angle well enough for distances with an error of 1e-9. */
#define GD_TOL_CORNER 4e-12

/* The sum of a caller's barycentric coordinates may differ from one by at most this, and a caller's
 * t may lie outside [0,1] by at most this. More is an error. */
#define GD_TOL_INPUT 1e-9

/* A mesh is graded if its shortest edge is less than this part of the longest one. */
#define GD_TOL_GRADED 1e-6

/* A leg counts as straight if its crossing of an edge is off the straight line by at most this part
 * of the edge. The reason is that the ends of wedges are stored with an error of 2^-32 of the
 * edge. */
#define GD_TOL_STRAIGHT 1e-9

/* ENVELOPE: a source that is seen through several wedges has unfolded images that differ by this
 * part of its distance, because each image is unfolded along its own faces. PLACE: positions in a
 * face are rounded by this part of the face's size. In an envelope (the minimum of the distances
 * from all sources of a face), two sources tie if their distances differ by no more than the sum of
 * both errors. */
#define GD_TOL_ENVELOPE 1e-12
#define GD_TOL_PLACE    4e-15

/* The nudge of a Voronoi diagram increases each member's distance, by a different amount for each
 * member. The amounts are less than this part of the field's greatest distance. This part is well
 * above the rounding error of ties and well below the promised precision. */
#define GD_TOL_TIE 1e-11

/* Nodes of a diagram are searched within this distance of their nudged positions, relative to the
 * edge or the face. Ends of bisectors within this distance of each other are one node. If a
 * bisector meets the border of the views of two sources at a small angle, the bisector's end moves
 * by much more than nudge and rounding. */
#define GD_TOL_NODE 1e-6

/* If two bisectors of three sources meet at a smaller angle than this, in radians, the distances do
 * not determine the common point precisely. The point then keeps its nudged position, whose error
 * is at most the nudge. */
#define GD_TOL_TANGENT 1e-3

/* A ridge is traced where the two directions of arrival differ by at least this angle, in radians.
 * Rounding moves a ridge of this angle by about 1e-6 of its distance. */
#define GD_TOL_RIDGE 1e-6

/* Loose ends of ridges are not joined if they are farther apart than this part of the size of the
 * face. */
#define GD_TOL_RIDGE_GAP 1e-2

/* If an end of a ridge is this near to an edge, a vertex or another end, it is moved there.
 * Relative to the size of the face. */
#define GD_TOL_RIDGE_END 1e-10

/* A span of a bisector's angles is empty if it is at most this wide. This is the rounding error of
 * an angle. */
#define GD_TOL_SPAN 0x1p-52

/* To close gaps due to rounding, the strip that a segment source sees may be widened by this part
 * of the distance from the segment. Distances in the added margin are too short by at most half of
 * GD_TOL_LENGTHENED times the width of the margin. */
#define GD_TOL_LENGTHENED 1e-3

/* Ends of arcs within this distance of each other, relative to the face, are matched first. The
 * tolerance saves time. Ends that are farther apart may also match. */
#define GD_TOL_MEET 1e-6

/* Largest relative difference between a path's own length and the distance of the wedges. The
 * interface promises this precision. */
#define GD_TOL_CHECK 1e-9

/* A point in space counts as on a vertex or an edge that is this close, relative to the largest
 * coordinate. This is 8 ulps, the rounding error of a computed, printed or stored position. */
#define GD_TOL_LOCATE 1.8e-15

/* Bounds that prune a search are changed to the safe side by this part of the bound, and by this
 * part of the coordinates. The rounding error of the bounds is smaller. But across faces as flat as
 * GD_TOL_FLAT, a distance may have an error of about 1e-10. A path that is pruned by mistake cannot
 * be replaced by another one. */
#define GD_TOL_BOUND 1e-8

/* Rounding error of a bound by landmarks, in steps. A distance from a landmark has at most 65535
 * steps, so its error is far below this. */
#define GD_TOL_LANDMARK 1e-6

/* A straight line goes through a vertex if it passes this close to the vertex. The tolerance is
 * relative to the crossed edge or to the line's length so far, whichever is shorter; GD_TOL_PLACE
 * times the edge's length is added. If an edge or a vertex is this close to the line's end,
 * relative to the shorter of the edge and the line, the end is moved there. GD_TOL_HIT is also the
 * largest angle by which a direction may miss a boundary edge and still run along it. */
#define GD_TOL_HIT 1e-12

/* This part of the length of a walk is added to GD_TOL_HIT, because each unfolded face adds
 * rounding. */
#define GD_TOL_DRIFT 1e-15

/* A vector may consist of several segments. If the end of a segment is this close to a vertex,
 * relative to the segment's length, the next segment begins at the vertex. If a segment reaches the
 * boundary and at most this part of its length is left, it is complete. Rounding in faces as flat
 * as GD_TOL_FLAT is nearly as large. */
#define GD_TOL_JOINT 1e-9

/* A line touches one of its earlier segments if their distance is less than this part of the
 * lengths of both. The rounding error of a line grows with its whole length. */
#define GD_TOL_TOUCH 1e-9

/* A cut's curve is moved onto a vertex or an edge that is nearer than this part of a face's longest
 * edge. This is ten times the flatness below which a face is rejected. If the cut fails with this
 * part in faces that are nearly that flat, larger parts are tried: each is STEP times the previous
 * one, up to MOST. */
#define GD_TOL_SEAM      1e-6
#define GD_TOL_SEAM_MOST 1.5e-2
#define GD_TOL_SEAM_STEP 10

/* An edge of a triangulation is flipped if the sine of the sum of its opposite angles is less than
 * minus this value. The rounding error is smaller, so no later flip undoes this one. */
#define GD_TOL_DELAUNAY 1e-12

/* The iteration for a mean has converged if the next step is at most this part of the root mean
 * square distance from the points. The tolerance is the rounding error of directions and
 * lengths. */
#define GD_TOL_MEAN 1e-11

/* A line that bends at a vertex by less than this angle counts as straight there. Another line that
 * passes the vertex on the other side would be shorter only by the square of the angle. */
#define GD_TOL_BEND 1e-10

/* A closed curve counts as a geodesic if it bends by less than this angle at the point where it
 * begins and ends. The error of its length is of the order of the square of the angle. */
#define GD_TOL_CLOSED_TURN 1e-9

/* A closed curve that shrinks to less than this part of its first length counts as shrinking to a
 * point. */
#define GD_TOL_VANISH 1e-9

/* Two points of a spline count as one point if their distance is less than this part of the
 * distance to their farthest neighbour, because no direction between them is defined. */
#define GD_TOL_SAME_POINT 1e-12

/* Simplification makes no face flatter than this, because a face that is nearly a line has no
 * reliable normal. The faces that gd_mesh_build warns about are much flatter. */
#define GD_TOL_EDIT_FLAT 1e-2

/* A filled hole avoids triangles flatter than this: their normals have few digits, and later edge
 * flips need a normal. */
#define GD_TOL_EDIT_PATCH 1e-5

/* An edge of a patch is flipped if the sum of the angles opposite to it exceeds pi by more than
 * this part of pi. In a triangle as flat as GD_TOL_EDIT_PATCH, angles have an error of about 1e-16
 * / GD_TOL_EDIT_PATCH = 1e-11. The bound is larger than this error. So if four points lie on a
 * circle, and the opposite angles sum to pi for both diagonals, the diagonals do not replace each
 * other forever. */
#define GD_TOL_EDIT_FLIP 1e-9

/* Two faces are folded onto each other if they meet at less than this angle, in radians: about five
 * degrees. If a patch folds back in a plane, the faces at the fold meet at an angle of zero, except
 * for the noise in the positions of the hole's boundary. */
#define GD_TOL_EDIT_FOLD 0.09

/* Coordinates and extents beyond this and its inverse are rejected: their squares leave the range
 * of doubles. */
#define GD_EXTENT_MAX 1e150

/* Within one mesh, lengths and coordinates stay within this factor of the mean edge, so fourth
 * powers stay in range. */
#define GD_EXTENT_RATIO 1e75

/* A parametric surface is rejected if its size, the width of its domain or their quotient is beyond
 * this or its inverse. The quotient is the size of first derivatives, whose fourth powers must stay
 * in range, with a reserve for parts of the surface where derivatives are smaller or larger. */
#define GD_EXTENT_SURFACE 1e60

/* --- parametric surfaces (nurbs) -------------------------------------------------------------- */

/* Two borders of a surface count as one curve if they differ by at most this part of the surface's
 * size. A border counts as one point if its size is at most this part. The error of a length across
 * the border is at most this part of the surface's size. */
#define GD_TOL_CLOSED 1e-11

/* Derivatives in u and v count as parallel, as at a pole, if the area of their parallelogram is
 * less than this part of the sum of their squares. */
#define GD_TOL_REGULAR 1e-14

/* A pivot of Cholesky's method below this part of its diagonal entry is zero up to rounding: the
 * matrix is not positive definite. */
#define GD_TOL_PIVOT 1e-13

/* A second derivative of a length with respect to the position of the path's end counts as zero if
 * it is less than this part of 1 / length. */
#define GD_TOL_DEGENERATE 1e-9

/* Newton's method on a length has converged if the next step would save less than this part of the
 * length. This is the square of the gradient's rounding error. */
#define GD_TOL_STATIONARY 1e-24

/* If a step is expected to save less than this part of the length, the computed lengths do not show
 * whether it helps. Such steps are accepted as long as the expected saving decreases. */
#define GD_TOL_BLIND 1e-12

/* A curve may leave its cell (the part of the surface with one polynomial) by this part of the
 * cell's width. The cell's polynomial continues smoothly there. If the parameters are smooth across
 * the line, it differs from the neighbour's polynomial by at most the square of this part.
 * Otherwise gd__chain_straying measures the difference. */
#define GD_TOL_CELL 1e-8

/* An initial curve of a path must begin and end this near to the path's ends, relative to the size
 * of the surface. The tolerance is large, because the caller may round the curve to a few
 * digits. */
#define GD_TOL_INITIAL 1e-3

/* If two locally shortest paths, and all paths between them, have the same length up to this part,
 * they are one family of equally long paths. The error of a length is smaller. */
#define GD_TOL_FAMILY 1e-9

/* Two curves on a surface meet if points of them are this close in space, relative to the surface's
 * size. Their distance is then 0. */
#define GD_TOL_COINCIDE 1e-13

/* The two points must also be this close in the domain, relative to its width, because a surface
 * may intersect itself. */
#define GD_TOL_ONE_PLACE 1e-6

/* The end of a spline on a curve is refined if its angle with the curve is off a right angle by
 * more than this. */
#define GD_TOL_END 1e-9

/* A path through a pole is straight there, and so a geodesic, if its direction changes by less than
 * this. The error of its length is the square of the change. */
#define GD_TOL_POLE_BEND 1e-6

/* Geodesics of a subdivision surface: the largest error of an integration step, relative to the
 * patch and the speed. It is a few hundred times the rounding error. Near a spike, where the
 * derivatives become parallel, the bound is divided by the sine of the angle between them. */
#define GD_TOL_GEODESIC 1e-13

/* A path along the border of a patch counts as inside up to this distance beyond the border,
 * relative to the patch. The polynomial continues there, with an error of the third power of the
 * distance. */
#define GD_TOL_PATCH 1e-12

/* A path that passes a vertex at a distance below this, relative to the surface's extent, passes
 * through the vertex. Such a small distance does not change the path measurably. */
#define GD_TOL_VERTEX 1e-11

/* Two directions from a corner of a limit surface count as parallel if their cross product is
 * shorter than this part of the product of their lengths. The corner then has no normal. If there
 * is a normal, take the components of one direction perpendicular and parallel to the other. The
 * perpendicular component exceeds this part of the parallel one, even after the last halving and
 * for any number of faces. */
#define GD_TOL_SPIKE 1e-10

/* Newton's method for the closest point of a limit surface has converged if its step is this small
 * in the face's coordinates. */
#define GD_TOL_FOOT 1e-14

/* Shooting. BESIDE_SHOT: the change of direction, in radians, by which the derivative of a
 * geodesic's end is measured. SHOT: an end this near to its target, relative to the length, has
 * arrived. SAME_WAY: if the length of a geodesic differs from the length of the polyline by more
 * than this part, it is not the geodesic near the polyline. */
#define GD_TOL_BESIDE_SHOT 1e-6
#define GD_TOL_SHOT        1e-11
#define GD_TOL_SAME_WAY    0.1

/* Gaps between neighbouring strips of a segment's profile are narrower than this part of the
 * profile. The cause of these gaps is that ends of windows are rounded to 2^-32 of an edge. */
#define GD_TOL_GAP 1e-6

/* Two paths to a point are different if their arrival directions differ by this angle, in radians.
 * Two paths that pass a vertex closely on opposite sides differ by less. The point counts as a
 * point of the cut locus if a position where both paths are equally long is nearer to the point
 * than GD_TOL_CUT times the point's distance. This bound is the rounding error of such a position.
 */
#define GD_TOL_CUT_ANGLE 1e-3
#define GD_TOL_CUT       1e-10

/* A path that bounds a search is straightened until a round shortens it by less than this part of
 * its length. The path is then longer than a geodesic by a few times this part, which hardly
 * enlarges the search. */
#define GD_TOL_TETHER 1e-5

/* Largest rounding error, in floats, of a step from one ring of faces around the target to the next
 * (kernel/kernel_ring.h), relative to the search's bound. No coordinate exceeds this bound. */
#define GD_TOL_RING 2e-6

/* If a position is nearer to a point of a ring than this, relative to the search's bound, this
 * value replaces their distance. It avoids a division by zero, and is far below GD_TOL_RING. */
#define GD_TOL_RING_NEAR 1e-9

/* If a curve turns by less than this angle, in radians, at the joint of two segments, the joint
 * counts as straight. The sector between the windows of the two segments then has at most this
 * angle. A path into the sector that bends at an end of these windows is longer than the shortest
 * path only by the square of the angle. A point this near to the line across a joint also belongs
 * to the joint. */
#define GD_TOL_ONWARD 1e-10

/* Rounding error of the foot of a perpendicular from a corner of a face to a segment of a curve,
 * relative to the lengths of the face's sides. */
#define GD_TOL_ONWARD_ROUNDING 2e-15

/* Curves of a trimming loop meet if their ends are this close, relative to the domain's width.
 * Files of CAD systems hold about ten digits. */
#define GD_TOL_LOOP_CLOSED 1e-8

/* If a parameter on a loop is this close to the end of a span, it counts as that end. */
#define GD_TOL_LOOP_PLACE 1e-12

/* A place may lie this far outside a trimmed domain, relative to the domain's width. This is twice
 * the rounding error of a place that was computed on a loop, stored and read again. */
#define GD_TOL_TRIMMED 1e-9

/* A path in a trimmed domain is taut if it meets and leaves loops at angles below this. The error
 * of its length is of the order of the third power of the angle. */
#define GD_TOL_TAUT 1e-8

/* The ends of a contact (a part of a loop that the path follows) are not moved if the path meets
 * the loop at an angle below this. This is the rounding error of directions. */
#define GD_TOL_CALM 1e-13

/* Largest error of the quadrature along a part of a loop, relative to the surface's size. */
#define GD_TOL_ARC 1e-15

/* A path leaves a trimmed domain if it is this far outside, relative to the domain's width. Places
 * of a path are rounded, and a path that should touch a loop crosses it by the square of its angle
 * with the loop. */
#define GD_TOL_LEAVES 1e-8

/* A path can follow a loop only where the loop does not bend away from the obstacle. The loop
 * counts as straight if its geodesic curvature away from the obstacle, times the surface's size, is
 * at most this. */
#define GD_TOL_PRESSING 1e-7
