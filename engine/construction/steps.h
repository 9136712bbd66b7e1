/* The steps of gd_mesh_build in this folder, in order. */
#pragma once

#include "mesh/construction.h"

enum gd_status gd__validate(struct gd__construction *work);
enum gd_status gd__validate_corners(struct gd__construction *work);
enum gd_status gd__triangulate(struct gd__construction *work);
enum gd_status gd__order(struct gd__construction *work);
enum gd_status gd__scale(struct gd__construction *work);
enum gd_status gd__connect(struct gd__construction *work);
enum gd_status gd__orient(struct gd__construction *work);
enum gd_status gd__check_vertices(struct gd__construction *work);
enum gd_status gd__make_sides(struct gd__construction *work);
enum gd_status gd__measure(struct gd__construction *work);
enum gd_status gd__make_fans(struct gd__construction *work);
enum gd_status gd__summarise(struct gd__construction *work);
