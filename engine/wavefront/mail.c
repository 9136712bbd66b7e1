#include "wavefront/mail.h"

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
                                         const struct gd__vertex_letter *letter)
{
    struct gd__mail *mail = &partition->mail;
    enum gd_status status = make_room((void **)&mail->vertices, mail->vertex_count,
                                      &mail->vertex_capacity, sizeof *mail->vertices);
    if (!status) mail->vertices[mail->vertex_count++] = *letter;
    return status;
}

enum gd_status gd__partition_send_windows(struct gd__partition *partition, uint32_t side,
                                          const struct gd__children *children)
{
    struct gd__mail *mail = &partition->mail;
    enum gd_status status = make_room((void **)&mail->lists, mail->list_count, &mail->list_capacity,
                                      sizeof *mail->lists);
    if (!status) status = gd__stack_reserve(&mail->windows, mail->windows.count + children->count);
    if (status) return status;
    mail->lists[mail->list_count++] = (struct gd__list_letter){side, children->count};
    gd__stack_load(&mail->windows, &children->at, 0, children->count);
    return GD_OK;
}

void gd__mail_destroy(struct gd__mail *mail)
{
    free(mail->vertices);
    free(mail->lists);
    gd__stack_destroy(&mail->windows);
}
