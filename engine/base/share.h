/* Share: divides the control of a long call among its parts, which run one after another. Each part
 * has its own control, which reports to the caller's control. */
#pragma once

#include "gd/control.h"

struct gd__share {
    const struct gd_control *control; /* the caller's control; may be NULL */
    /* Number of parts, assumed equally long. The owner increments `done`. */
    uint32_t done, total;
    double most; /* the largest fraction reported so far */
};

/* Returns the control of the current part. Its progress continues where the last part ended, even
 * if the progress that the part reports begins at 0 again. Its budget is the caller's budget minus
 * `held`, the bytes that the caller has allocated. The control refers to `share`. */
struct gd_control gd__share_control(struct gd__share *share, size_t held);
