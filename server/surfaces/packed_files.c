/* See packed_files.h. */
#include "server/surfaces/packed_files.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/thread.h"

struct server_packed_files {
    struct server_lru lru; /* must be the first member */
};

static void file_free(struct server_lru_item *item)
{
    free(((struct server_packed_file *)item)->bytes);
    free(item);
}

void server_packed_file_release(struct server_packed_file *file)
{
    if (file) server_lru_release(&file->item);
}

/* Returns the place of the file with that tag, or NULL if the file is not in the list. Called under
 * the lock. */
static struct server_lru_item **files_search(struct server_packed_files *files, const char *tag)
{
    struct server_lru_item *item;
    TAILQ_FOREACH(item, &files->lru.by_use, by_use)
    {
        if (strcmp(((struct server_packed_file *)item)->tag, tag) == 0) return item->place;
    }
    return NULL;
}

struct server_packed_file *server_packed_files_find(struct server_packed_files *files,
                                                    const char *tag)
{
    SERVER_LOCK(&files->lru.lock);
    struct server_lru_item **place = files_search(files, tag);
    return place ? (struct server_packed_file *)server_lru_get(place) : NULL;
}

struct server_packed_file *server_packed_files_add(struct server_packed_files *files,
                                                   const char *tag, char *bytes, size_t size)
{
    struct server_lru *lru = &files->lru;
    size_t most = lru->budget->limit / SERVER_PACKED_PART;
    struct server_packed_file *file = size <= most ? malloc(sizeof *file) : NULL;
    if (!file || strlen(tag) >= sizeof file->tag ||
        !server_budget_take_spare(lru->budget, SERVER_BUDGET_FLIGHT, size)) {
        free(file);
        return NULL;
    }
    server_lru_adopt(lru, &file->item, size);
    file->bytes = bytes;
    file->size = size;
    strcpy(file->tag, tag);
    pthread_mutex_lock(&lru->lock);
    if (!files_search(files, tag)) { /* another request may have been faster */
        server_lru_put(&file->place, &file->item);
        (void)server_lru_get(&file->place);
    }
    pthread_mutex_unlock(&lru->lock);
    server_lru_trim(lru, most);
    return file;
}

struct server_packed_files *server_packed_files_create(struct server_budget *budget)
{
    struct server_packed_files *files = calloc(1, sizeof *files);
    if (!files) return NULL;
    files->lru = (struct server_lru){.budget = budget,
                                     .class = SERVER_BUDGET_PACKED,
                                     .turn = SERVER_RECLAIM_PACKED,
                                     .free = file_free};
    server_lru_begin(&files->lru);
    return files;
}

void server_packed_files_destroy(struct server_packed_files *files)
{
    if (!files) return;
    server_lru_trim(&files->lru, 0);
    server_lru_end(&files->lru);
    free(files);
}
