/* Smooth: the umbrella header of the library libgeodesic-smooth, which depends on libgeodesic:
 * geodesics on subdivision limit surfaces and on NURBS. */
#ifndef GD_SMOOTH_H
#define GD_SMOOTH_H

#include "gd/discretization.h"
#include "gd/domain_curve.h"
#include "gd/geodesic.h"
#include "gd/geodesic_like.h"
#include "gd/limit.h"
#include "gd/limit_grid.h"
#include "gd/limit_mesh.h"
#include "gd/limit_path.h"
#include "gd/limit_place.h"
#include "gd/limit_shortest.h"
#include "gd/nurbs.h"
#include "gd/parametric.h"
#include "gd/space_distance.h"
#include "gd/subdivision.h"
#include "gd/tessellation.h"

#endif
