#include "wavefront/outbox.h"

#include "base/array.h"

enum gd_status gd__partition_send_vertex(struct gd__partition *partition,
                                         const struct gd__vertex_message *message)
{
    struct gd__outbox *outbox = &partition->outbox;
    return gd__array_append(&outbox->vertices, &outbox->vertex_count, &outbox->vertex_capacity,
                            message, sizeof *message);
}

enum gd_status gd__partition_send_windows(struct gd__partition *partition, uint32_t side,
                                          const struct gd__children *children)
{
    struct gd__outbox *outbox = &partition->outbox;
    const struct gd__list_message message = {side, children->count};
    enum gd_status status = gd__array_append(&outbox->lists, &outbox->list_count,
                                             &outbox->list_capacity, &message, sizeof message);
    if (!status)
        status = gd__stack_reserve(&outbox->windows, outbox->windows.count + children->count);
    if (status) return status;
    gd__stack_load(&outbox->windows, &children->at, 0, children->count);
    return GD_OK;
}

void gd__outbox_destroy(struct gd__outbox *outbox)
{
    free(outbox->vertices);
    free(outbox->lists);
    gd__stack_destroy(&outbox->windows);
}
