/* Tools: the umbrella header of the library libgeodesic-tools, which depends on libgeodesic:
 * straightest geodesics, vectors, splines, curve operations, edits, cuts and pictures. */
#ifndef GD_TOOLS_H
#define GD_TOOLS_H

#include "gd/cut.h"
#include "gd/edit.h"
#include "gd/flat_strip.h"
#include "gd/frame.h"
#include "gd/geodesic.h"
#include "gd/mean.h"
#include "gd/offset.h"
#include "gd/picture.h"
#include "gd/resampling.h"
#include "gd/shortening.h"
#include "gd/spline.h"
#include "gd/trace.h"
#include "gd/vector.h"

#endif
