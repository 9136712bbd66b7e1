#include "wavefront/outbox.h"

#include <stdlib.h>

static enum gd_status make_room(void **array, uint32_t count, uint32_t *capacity, size_t size)
{
    if (count < *capacity) return GD_OK;
    uint32_t larger = *capacity ? 2 * *capacity : 256;
    void *grown = realloc(*array, larger * size);
    if (!grown) return GD_NO_MEMORY;
    *array = grown;
    *capacity = larger;
    return GD_OK;
}

enum gd_status gd__partition_send_vertex(struct gd__partition *partition,
                                         const struct gd__vertex_message *message)
{
    struct gd__outbox *outbox = &partition->outbox;
    enum gd_status status = make_room((void **)&outbox->vertices, outbox->vertex_count,
                                      &outbox->vertex_capacity, sizeof *outbox->vertices);
    if (!status) outbox->vertices[outbox->vertex_count++] = *message;
    return status;
}

enum gd_status gd__partition_send_windows(struct gd__partition *partition, uint32_t side,
                                          const struct gd__children *children)
{
    struct gd__outbox *outbox = &partition->outbox;
    enum gd_status status = make_room((void **)&outbox->lists, outbox->list_count,
                                      &outbox->list_capacity, sizeof *outbox->lists);
    if (!status)
        status = gd__stack_reserve(&outbox->windows, outbox->windows.count + children->count);
    if (status) return status;
    outbox->lists[outbox->list_count++] = (struct gd__list_message){side, children->count};
    gd__stack_load(&outbox->windows, &children->at, 0, children->count);
    return GD_OK;
}

void gd__outbox_destroy(struct gd__outbox *outbox)
{
    free(outbox->vertices);
    free(outbox->lists);
    gd__stack_destroy(&outbox->windows);
}
