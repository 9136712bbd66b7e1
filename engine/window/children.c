#include "window/children.h"

void gd__scratch_destroy(struct gd__scratch *scratch)
{
    for (int i = 0; i < 3; i++) gd__stack_destroy(&scratch->stack[i]);
    gd__window_builder_destroy(&scratch->tail);
}

/* --- blocks ----------------------------------------------------------------------------------- */

enum gd_status gd__block_enlarge(void **block, uint8_t *size_class, struct gd__pool *pool,
                                 uint32_t windows, uint32_t kept)
{
    uint32_t class = gd__pool_class((windows + GD__WINDOWS_GROUP - 1) / GD__WINDOWS_GROUP);
    void *larger = gd__pool_take(pool, class);
    if (!larger) return pool->status;
    if (*block) {
        struct gd__windows to = gd__block_windows(larger, class),
                           from = gd__block_windows(*block, *size_class);
        gd__windows_copy(&to, 0, &from, 0, kept);
        gd__pool_release(pool, *block, *size_class);
    }
    *block = larger;
    *size_class = (uint8_t) class;
    return GD_OK;
}

enum gd_status gd__children_grow(struct gd__children *children, struct gd__pool *pool,
                                 uint32_t count, uint32_t kept)
{
    uint32_t need = count + GD__WINDOWS_GROUP;
    if (children->block && need <= GD__WINDOWS_GROUP * gd__pool_items(children->size_class))
        return GD_OK;
    enum gd_status status =
        gd__block_enlarge(&children->block, &children->size_class, pool, need, kept);
    if (!status) children->at = gd__block_windows(children->block, children->size_class);
    return status;
}

/* --- sorting ---------------------------------------------------------------------------------- */

/* The tangled (unsorted) windows are sorted together with this number of sorted windows before
 * them. An unsorted window rarely belongs farther back. */
#define BEFORE_TANGLE 4

/* Sorts windows [base, count) into scratch->stack[0]. The windows before children->tangled are
 * already sorted. Stops at the first window that follows the last tangled one and overlaps no
 * earlier window. *rest is the index of this window. This window and all later ones stay unchanged.
 * Returns false if a window belongs before `base`. */
static bool untangle_from(const struct gd__children *children, uint32_t base, double min_width,
                          struct gd__scratch *scratch, uint32_t *rest, enum gd_status *status)
{
    struct gd__stack *list = &scratch->stack[0];
    const struct gd__windows *windows = &children->at;
    list->count = 0;
    *status = gd__stack_reserve(list, gd__merged_bound(children->count - base, 0));
    if (*status) return true;
    gd__stack_load(list, windows, base, children->tangled);
    for (uint32_t i = children->tangled; i < children->count; i++) {
        struct gd__window w = gd__windows_get(windows, i);
        *rest = i;
        if (w.b1 - w.b0 <= min_width) continue; /* too narrow to keep */
        if (scratch->apart) w.tags = (i + 1) * GD__WINDOW_SERIAL;
        bool is_clear = list->count && w.b0 >= list->windows[list->count - 1].b1 - min_width;
        if (is_clear && i > children->tangled_last) return true;
        *status = gd__stack_push(list, &w, min_width, &scratch->stack[1]);
        if (*status) return true;
        if (base > 0 && (!list->count || list->windows[0].b0 != windows->b0[base])) return false;
    }
    *rest = children->count;
    return true;
}

/* Writes the sorted windows to the children from index `base` on, followed by the unchanged windows
 * from `rest` on. */
static enum gd_status children_put_back(struct gd__children *children, struct gd__pool *pool,
                                        uint32_t base, uint32_t rest, struct gd__scratch *scratch)
{
    const struct gd__stack *list = &scratch->stack[0];
    uint32_t behind = children->count - rest, end = base + list->count;
    enum gd_status status = gd__children_grow(children, pool, end + behind, children->count);
    if (status) return status;
    if (end != rest) gd__windows_move(&children->at, end, rest, behind);
    for (uint32_t i = 0; i < list->count; i++)
        gd__windows_put(&children->at, base + i, &list->windows[i]);
    children->count = end + behind;
    children->tangled = GD_NONE;
    return GD_OK;
}

enum gd_status gd__children_sort(struct gd__children *children, struct gd__pool *pool,
                                 double min_width, struct gd__scratch *scratch)
{
    enum gd_status status;
    uint32_t base = children->tangled > BEFORE_TANGLE ? children->tangled - BEFORE_TANGLE : 0, rest;
    if (!untangle_from(children, base, min_width, scratch, &rest, &status))
        untangle_from(children, base = 0, min_width, scratch, &rest, &status);
    return status ? status : children_put_back(children, pool, base, rest, scratch);
}
