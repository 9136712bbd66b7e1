#include "base/share.h"

#include <math.h>

static bool share_report(void *user, double fraction)
{
    struct gd__share *share = user;
    share->most = fmax(share->most, (share->done + fraction) / share->total);
    return share->control->progress(share->control->user, share->most);
}

struct gd_control gd__share_control(struct gd__share *share, size_t held)
{
    struct gd_control own = share->control ? *share->control : (struct gd_control){0};
    /* 0 means no limit */
    if (own.budget_bytes) own.budget_bytes = own.budget_bytes > held ? own.budget_bytes - held : 1;
    own.progress = own.progress ? share_report : NULL;
    own.user = share;
    return own;
}
