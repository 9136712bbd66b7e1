/* gd_simplify: runs the decimater and measures the distance. If the distance exceeds the given
 * bound, it runs the decimater again with a smaller bound. */
#include <math.h>

#include "base/share.h"
#include "edit/decimate.h"
#include "edit/edited.h"

#define ATTEMPTS 7

/* The decimater gets the requested bound times this factor. The rest is a margin. */
#define MARGIN 0.7

static enum gd_status check_options(const struct gd_simplify_options *options,
                                    struct gd_detail *detail)
{
    if (!(options->max_distance >= 0) || !isfinite(options->max_distance))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "max_distance = %.17g is not a length of at least 0", options->max_distance);
    if (!options->faces && options->max_distance == 0)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "give a number of faces, a max_distance, or both");
    return GD_OK;
}

/* Runs the decimater once and measures the distance. */
static enum gd_status run(const struct gd_mesh *mesh, const struct gd_simplify_options *options,
                          double most_distance, struct gd__share *share, struct gd_edited *out)
{
    struct gd_edited made = {0};
    struct gd_control control = gd__share_control(share, 0);
    enum gd_status status = gd__decimate(mesh, options, most_distance, &control, &made);
    share->done++;
    if (!status) {
        control = gd__share_control(share, made.bytes);
        status = gd_edit_deviation(mesh, &made.polygons, &control, &made.largest_distance, NULL);
    }
    share->done++;
    if (status)
        gd_edited_free(&made);
    else
        *out = made;
    return status;
}

/* Repeats the simplification until the distance is within its bound. The second to last attempt
 * sets the decimater's bound to 0, so that it allows only rounding errors. Even this attempt can
 * fail. The decimater measures distances from planes, so it does not detect faces that fold by 180
 * degrees within their plane. Therefore the last attempt collapses nothing. */
static enum gd_status run_bounded(const struct gd_mesh *mesh,
                                  const struct gd_simplify_options *options,
                                  struct gd__share *share, struct gd_edited *out)
{
    double size = gd__edit_box_size(mesh), most = MARGIN * options->max_distance / size;
    for (int attempt = 1;; attempt++) {
        struct gd_edited made;
        const struct gd_simplify_options none = {.faces = gd__edit_counts(mesh).faces};
        enum gd_status status = run(mesh, attempt < ATTEMPTS ? options : &none,
                                    attempt < ATTEMPTS - 1 ? most : 0, share, &made);
        if (status) return status;
        if (made.largest_distance <= options->max_distance || attempt == ATTEMPTS) {
            *out = made;
            return GD_OK;
        }
        most *= MARGIN * options->max_distance / made.largest_distance;
        gd_edited_free(&made);
    }
}

enum gd_status gd_simplify(const struct gd_mesh *mesh, const struct gd_simplify_options *options,
                           const struct gd_control *control, struct gd_edited *out,
                           struct gd_detail *detail)
{
    bool is_bounded = options->max_distance > 0;
    struct gd__share share = {.control = control, .total = is_bounded ? 2 * ATTEMPTS : 2};
    enum gd_status status = check_options(options, detail);
    if (!status) status = gd_control_afford(control, gd_edit_cost(gd_mesh_summary(mesh)->faces));
    if (status) return status;
    return is_bounded ? run_bounded(mesh, options, &share, out)
                      : run(mesh, options, INFINITY, &share, out);
}
