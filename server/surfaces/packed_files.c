/* See packed_files.h. */
#include "server/surfaces/packed_files.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/thread.h"

TAILQ_HEAD(packed_list, server_packed_file);

struct server_packed_files {
    struct server_budget *budget;
    pthread_mutex_t lock;
    struct packed_list by_use; /* the least recently used first */
    size_t held;               /* bytes of the listed files */
};

void server_packed_file_release(struct server_packed_file *file)
{
    if (!file || atomic_fetch_sub(&file->references, 1) != 1) return;
    server_budget_give(file->budget, SERVER_BUDGET_PACKED, file->size);
    free(file->bytes);
    free(file);
}

/* Under the lock: returns the listed file with that tag. */
static struct server_packed_file *files_search(struct server_packed_files *files, const char *tag)
{
    struct server_packed_file *file;
    TAILQ_FOREACH(file, &files->by_use, by_use)
    {
        if (strcmp(file->tag, tag) == 0) break;
    }
    return file;
}

/* Removes the least recently used files, except `kept`, until the list holds at most `most`
 * bytes. */
static void files_trim(struct server_packed_files *files, size_t most,
                       const struct server_packed_file *kept)
{
    for (;;) {
        pthread_mutex_lock(&files->lock);
        struct server_packed_file *file = files->held > most ? TAILQ_FIRST(&files->by_use) : NULL;
        if (file == kept) file = NULL;
        if (file) {
            TAILQ_REMOVE(&files->by_use, file, by_use);
            files->held -= file->size;
        }
        pthread_mutex_unlock(&files->lock);
        if (!file) return;
        server_packed_file_release(file);
    }
}

static void files_reclaim(void *user, size_t bytes)
{
    struct server_packed_files *files = user;
    pthread_mutex_lock(&files->lock);
    size_t most = files->held > bytes ? files->held - bytes : 0;
    pthread_mutex_unlock(&files->lock);
    files_trim(files, most, NULL);
}

struct server_packed_file *server_packed_files_find(struct server_packed_files *files,
                                                    const char *tag)
{
    SERVER_LOCK(&files->lock);
    struct server_packed_file *file = files_search(files, tag);
    if (!file) return NULL;
    TAILQ_REMOVE(&files->by_use, file, by_use);
    TAILQ_INSERT_TAIL(&files->by_use, file, by_use);
    atomic_fetch_add(&file->references, 1);
    return file;
}

struct server_packed_file *server_packed_files_add(struct server_packed_files *files,
                                                   const char *tag, char *bytes, size_t size)
{
    size_t most = files->budget->limit / SERVER_PACKED_PART;
    struct server_packed_file *file = size <= most ? calloc(1, sizeof *file) : NULL;
    if (!file || strlen(tag) >= sizeof file->tag ||
        !server_budget_take_spare(files->budget, SERVER_BUDGET_PACKED, size)) {
        free(file);
        return NULL;
    }
    *file = (struct server_packed_file){
        .references = 2, .budget = files->budget, .bytes = bytes, .size = size};
    strcpy(file->tag, tag);
    pthread_mutex_lock(&files->lock);
    bool is_listed = !files_search(files, tag); /* another request may have been faster */
    if (is_listed) {
        TAILQ_INSERT_TAIL(&files->by_use, file, by_use);
        files->held += size;
    }
    pthread_mutex_unlock(&files->lock);
    if (!is_listed) server_packed_file_release(file);
    files_trim(files, most, file);
    return file;
}

struct server_packed_files *server_packed_files_create(struct server_budget *budget)
{
    struct server_packed_files *files = calloc(1, sizeof *files);
    if (!files) return NULL;
    files->budget = budget;
    pthread_mutex_init(&files->lock, NULL);
    TAILQ_INIT(&files->by_use);
    budget->reclaimers[SERVER_RECLAIM_PACKED] =
        (struct server_reclaimer){files_reclaim, NULL, files};
    return files;
}

void server_packed_files_destroy(struct server_packed_files *files)
{
    if (!files) return;
    files->budget->reclaimers[SERVER_RECLAIM_PACKED] = (struct server_reclaimer){0};
    files_trim(files, 0, NULL);
    pthread_mutex_destroy(&files->lock);
    free(files);
}
