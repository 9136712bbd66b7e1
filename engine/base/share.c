#include "base/share.h"

static bool report(void *user, double fraction)
{
    const struct gd__share *share = user;
    return share->control->progress(share->control->user, (share->done + fraction) / share->total);
}

struct gd_control gd__share_control(struct gd__share *share, size_t held)
{
    struct gd_control own = share->control ? *share->control : (struct gd_control){0};
    /* 0: no limit */
    if (own.budget_bytes) own.budget_bytes = own.budget_bytes > held ? own.budget_bytes - held : 1;
    own.progress = own.progress ? report : NULL;
    own.user = share;
    return own;
}
