/* Motion: the binary data of the object that moves along a line, in a file of glTF
 * (gd/result_file.h). gltf_write.c describes the data in the document. */
#ifndef GD_IO_GLTF_MOTION_H
#define GD_IO_GLTF_MOTION_H

#include "gd/result_file.h"
#include "io/output.h"

/* number of points of the object: the two ends of each of its three axes */
#define GD__AXIS_POINTS      6
#define GD__POSITION_BYTES   12
#define GD__COLOUR_BYTES     8
#define GD__TIME_BYTES       4
#define GD__QUATERNION_BYTES 16

/* Returns the number of keys of the animation: poses whose times, as floats, ascend strictly.
 * Returns 0 if the result has no poses or the line has the length 0. There is no animation then. */
uint32_t gd__motion_count(const struct gd_result *result);

/* Returns the length of an axis of the object. */
float gd__motion_axis(const struct gd_result *result);

/* Returns false if a position, relative to `origin`, is beyond the range of floats. */
bool gd__motion_fits(const struct gd_result *result, const double origin[3]);

/* Writes the positions and colours of the object's lines, then the times, the translations relative
 * to `origin`, and the rotations of all keys. The rotations are unit quaternions x, y, z, w. The
 * dot product of two consecutive quaternions is at least 0, so that interpolation turns the object
 * by the smaller angle. */
void gd__motion_write(struct gd__output *output, const struct gd_result *result,
                      const double origin[3]);

#endif
