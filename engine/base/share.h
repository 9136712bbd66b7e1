/* Share: one long call that is done by several, each with a control of its own that tells the
 * caller's of the whole. */
#ifndef GD_BASE_SHARE_H
#define GD_BASE_SHARE_H

#include "gd/control.h"

struct gd__share {
    const struct gd_control *control; /* the caller's; may be NULL */
    /* parts, which count as equally long; the owner counts `done` up */
    uint32_t done, total;
};

/* The parts' control: progress goes on where the last part ended; the `held` bytes that the caller
 * has meanwhile are off the budget. Valid as long as `share`, which it refers to. */
struct gd_control gd__share_control(struct gd__share *share, size_t held);

#endif
