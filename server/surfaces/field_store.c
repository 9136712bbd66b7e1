#include "server/surfaces/field_store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/disk.h"
#include "server/base/log.h"
#include "server/base/names.h"
#include "server/base/version.h"

#define FIELD     ".field"
#define LANDMARKS ".landmarks"
#define PREVIEW   ".preview"
#define TEMPORARY "new"
#define FILE_NAME (SERVER_SHA256_HEX + sizeof LANDMARKS)

struct server_field_store {
    char folder[SERVER_DISK_PATH / 2];
    struct server_budget *budget;
};

struct server_field_store *server_field_store_open(const char *folder, struct server_budget *budget)
{
    struct server_field_store *store = calloc(1, sizeof *store);
    if (!store) return NULL;
    store->budget = budget;
    int size = snprintf(store->folder, sizeof store->folder, "%s/fields", folder);
    if (size < (int)sizeof store->folder &&
        server_disk_make_folder(store->folder) == SERVER_STORE_DONE)
        return store;
    free(store);
    return NULL;
}

void server_field_store_close(struct server_field_store *store)
{
    free(store);
}

/* --- files ------------------------------------------------------------------------------------ */

struct folder { /* folder of a surface's files */
    char path[SERVER_DISK_PATH];
};

static struct folder folder_of(const struct server_field_store *store,
                               const struct server_record *record)
{
    struct folder folder;
    snprintf(folder.path, sizeof folder.path, "%s/" SERVER_VERSION "-%s", store->folder,
             record->etag);
    return folder;
}

static void folder_remove(const char *path)
{
    struct server_listing files = server_disk_list(path);
    while (server_listing_next(&files)) unlink(files.path);
    rmdir(path);
}

static bool file_has_suffix(const char *file, const char *suffix)
{
    size_t size = strlen(file), most = strlen(suffix);
    return size > most && strcmp(file + size - most, suffix) == 0;
}

static void file_discard(const char *path, const char *why)
{
    unlink(path);
    server_log_message(SERVER_LOG_WARN, "field_discarded", "the stored file '%s' was deleted: %s",
                       path, why);
}

struct image { /* image of a stored file; SERVER_BUDGET_FLIGHT counts its bytes */
    void *bytes;
    size_t size;
};

static void image_free(struct server_field_store *store, const struct image *image)
{
    free(image->bytes);
    server_budget_give(store->budget, SERVER_BUDGET_FLIGHT, image->size);
}

/* Reads and verifies a file if memory is free. Deletes the file if it does not match its name. */
static bool image_read(struct server_field_store *store, const struct server_listing *file,
                       struct image *out)
{
    char sha256[SERVER_SHA256_HEX];
    struct stat facts;
    size_t read_size;
    if (stat(file->path, &facts) != 0) return false;
    const size_t size = (size_t)facts.st_size;
    if (!server_budget_take_spare(store->budget, SERVER_BUDGET_FLIGHT, size)) return false;
    *out = (struct image){.size = size};
    if (server_disk_read(file->path, &out->bytes, &read_size) == SERVER_STORE_DONE) {
        server_sha256(out->bytes, read_size, sha256);
        if (read_size == size && strncmp(file->name, sha256, strlen(sha256)) == 0) return true;
        file_discard(file->path, "its checksum does not match its name");
    }
    image_free(store, out);
    return false;
}

/* Writes an image as `<folder>/<checksum><suffix>`, unless this file exists, and sets `file` to its
 * name. Returns false if the disk is full or the path is too long. */
static bool image_write(const struct image *image, const char *folder, const char *suffix,
                        char file[FILE_NAME])
{
    char path[SERVER_DISK_PATH], temporary[SERVER_DISK_PATH], sha256[SERVER_SHA256_HEX];
    server_sha256(image->bytes, image->size, sha256);
    snprintf(file, FILE_NAME, "%s%s", sha256, suffix);
    if ((mkdir(folder, 0700) < 0 && !server_disk_exists(folder)) ||
        snprintf(path, sizeof path, "%s/%s", folder, file) >= SERVER_DISK_PATH ||
        snprintf(temporary, sizeof temporary, "%s/" TEMPORARY "%s", folder, suffix) >=
            SERVER_DISK_PATH)
        return false;
    if (server_disk_exists(path)) return true;
    FILE *stream = fopen(temporary, "wbe");
    if (!stream) return false;
    bool is_written = fwrite(image->bytes, 1, image->size, stream) == image->size;
    is_written &= fclose(stream) == 0;
    if (is_written && rename(temporary, path) == 0) return true;
    unlink(temporary);
    return false;
}

/* Allocates an image from free memory. Returns false if there is too little. */
static bool image_create(struct server_field_store *store, size_t size, struct image *out)
{
    if (!server_budget_take_spare(store->budget, SERVER_BUDGET_FLIGHT, size)) return false;
    *out = (struct image){malloc(size), size};
    if (!out->bytes) image_free(store, out);
    return out->bytes;
}

/* Writes and frees an image. Deletes the surface's older files with that suffix. If the registry no
 * longer has the surface, deletes its folder. */
static void image_replace(struct server_field_store *store, struct server_registry *registry,
                          const struct server_surface *surface, const struct image *image,
                          const char *suffix)
{
    const struct folder folder = folder_of(store, surface->record);
    struct server_listing older = server_disk_list(folder.path);
    char file[FILE_NAME];
    while (server_listing_next(&older))
        if (file_has_suffix(older.name, suffix)) unlink(older.path);
    if (!image_write(image, folder.path, suffix, file))
        server_log_message(SERVER_LOG_WARN,
                           strcmp(suffix, PREVIEW) ? "landmarks_not_stored" : "preview_not_stored",
                           "%s can't be written to '%s': check its rights and the free space",
                           strcmp(suffix, PREVIEW) ? "landmarks" : "the preview", folder.path);
    if (!server_registry_holds(registry, surface->record->etag)) folder_remove(folder.path);
    image_free(store, image);
}

/* --- surfaces that are gone ------------------------------------------------------------------- */

static void on_gone(void *user, const struct server_record *record)
{
    folder_remove(folder_of(user, record).path);
}

void server_field_store_follow(struct server_field_store *store, struct server_registry *registry)
{
    char name[SERVER_ETAG + sizeof SERVER_VERSION + 1];
    struct server_names wanted = {0};
    struct server_listed listed = {0};
    while (server_registry_next(registry, &listed)) {
        snprintf(name, sizeof name, SERVER_VERSION "-%s", listed.record->etag);
        server_names_add(&wanted, name);
    }
    struct server_listing folders = server_disk_list(store->folder);
    while (server_listing_next(&folders)) {
        if (wanted.is_incomplete || server_names_has(&wanted, folders.name)) continue;
        folder_remove(folders.path);
        server_log_message(SERVER_LOG_INFO, "fields_discarded",
                           "the stored fields in '%s' were deleted: their mesh is gone",
                           folders.path);
    }
    server_names_free(&wanted);
    server_registry_watch(registry, on_gone, store);
}

/* --- restoring fields ------------------------------------------------------------------------- */

/* Loads the field of a file into the surface's mesh cache. Returns true on success. */
static bool field_restore(struct server_field_store *store, struct server_surface *surface,
                          const struct server_listing *file)
{
    struct gd_field *field;
    struct image image;
    if (!image_read(store, file, &image)) return false;
    enum gd_status status = gd_field_open_image(
        surface->mesh, &(struct gd_field_image){image.bytes, image.size, free, image.bytes}, &field,
        NULL);
    if (status) {
        if (status != GD_NO_MEMORY) file_discard(file->path, gd_status_sentence(status));
        image_free(store, &image);
        return false;
    }
    if (isfinite(gd_field_reach(field))) { /* only complete fields are restored */
        gd_field_release(field);
        server_budget_give(store->budget, SERVER_BUDGET_FLIGHT, image.size);
        return false;
    }
    server_budget_adjust(store->budget, SERVER_BUDGET_FLIGHT, image.size, gd_field_memsize(field));
    server_cache_restore(surface->fields, field);
    return true;
}

void server_field_store_restore(struct server_field_store *store, struct server_surface *surface,
                                const struct gd_control *control)
{
    struct server_listing files = server_disk_list(folder_of(store, surface->record).path);
    uint32_t restored = 0;
    bool is_ended = false;
    while (server_listing_next(&files)) {
        if (is_ended || !file_has_suffix(files.name, FIELD)) continue;
        is_ended = gd_control_check(control, 1) != GD_OK;
        if (!is_ended) restored += field_restore(store, surface, &files);
    }
    if (restored)
        server_log_message(SERVER_LOG_INFO, "fields_restored", "%u fields of '%s'", restored,
                           surface->record->name);
}

/* --- saving fields ---------------------------------------------------------------------------- */

struct saving {
    struct server_field_store *store;
    uint64_t until_ns;
    struct server_names kept; /* names of files */
    bool is_over;             /* true if the time is over, or the disk is full */
};

static void field_save(struct saving *saving, const char *folder, const struct gd_field *field)
{
    struct image image = {.size = gd_field_image_size(field)};
    char file[FILE_NAME];
    saving->is_over |= gd_now_ns() >= saving->until_ns;
    if (saving->is_over || !(image.bytes = malloc(image.size))) return;
    gd_field_write_image(field, image.bytes);
    saving->is_over = !image_write(&image, folder, FIELD, file);
    if (!saving->is_over) server_names_add(&saving->kept, file);
    free(image.bytes);
}

static void surface_save(struct saving *saving, const struct server_surface *surface)
{
    const struct folder folder = folder_of(saving->store, surface->record);
    uint32_t count;
    const struct server_cached **pinned = server_mesh_cache_pin_points(surface->fields, &count);
    for (uint32_t i = 0; i < count; i++) {
        field_save(saving, folder.path, pinned[i]->field);
        server_cache_unpin(pinned[i]);
    }
    free(pinned);
}

static void surface_sweep(const struct saving *saving, const struct server_surface *surface)
{
    const struct folder folder = folder_of(saving->store, surface->record);
    struct server_listing files = server_disk_list(folder.path);
    while (server_listing_next(&files))
        if (!file_has_suffix(files.name, LANDMARKS) && !file_has_suffix(files.name, PREVIEW) &&
            !server_names_has(&saving->kept, files.name))
            unlink(files.path);
    rmdir(folder.path); /* succeeds only if the folder is empty */
}

void server_field_store_save(struct server_field_store *store, struct server_registry *registry,
                             uint64_t until_ns)
{
    struct saving saving = {.store = store, .until_ns = until_ns};
    struct server_listed listed = {0};
    while (server_registry_next(registry, &listed))
        if (listed.surface) surface_save(&saving, listed.surface);
    while (!saving.kept.is_incomplete && !saving.is_over && server_registry_next(registry, &listed))
        if (listed.surface) surface_sweep(&saving, listed.surface);
    server_log_message(saving.is_over ? SERVER_LOG_WARN : SERVER_LOG_INFO, "fields_saved",
                       "%zu fields are stored%s", saving.kept.count,
                       saving.is_over ? "; there was no more time or room" : "");
    server_names_free(&saving.kept);
}

/* --- landmarks -------------------------------------------------------------------------------- */

struct gd_landmarks *server_field_store_read_landmarks(struct server_field_store *store,
                                                       const struct server_surface *surface,
                                                       uint32_t count)
{
    struct server_listing files = server_disk_list(folder_of(store, surface->record).path);
    struct gd_landmarks *found = NULL, *landmarks;
    struct image image;
    while (server_listing_next(&files)) {
        if (found || !file_has_suffix(files.name, LANDMARKS) || !image_read(store, &files, &image))
            continue;
        enum gd_status status =
            gd_landmarks_open_image(surface->mesh, image.bytes, image.size, &landmarks);
        if (status && status != GD_NO_MEMORY) file_discard(files.path, gd_status_sentence(status));
        image_free(store, &image);
        if (status) continue;
        if (gd_landmarks_count(landmarks) == count &&
            server_budget_take_spare(store->budget, SERVER_BUDGET_FLIGHT,
                                     gd_landmarks_memsize(landmarks)))
            found = landmarks;
        else
            gd_landmarks_release(landmarks);
    }
    return found;
}

void server_field_store_write_landmarks(struct server_field_store *store,
                                        struct server_registry *registry,
                                        const struct server_surface *surface,
                                        const struct gd_landmarks *landmarks)
{
    struct image image;
    if (!image_create(store, gd_landmarks_image_size(landmarks), &image)) return;
    gd_landmarks_write_image(landmarks, image.bytes);
    image_replace(store, registry, surface, &image, LANDMARKS);
}

/* --- previews --------------------------------------------------------------------------------- */

/* The head of a preview's file, in the byte order of this machine. Positions and corners follow. */
struct preview_head {
    char word[8]; /* without a NUL */
    uint32_t wanted, positions, faces, zero;
    double largest_distance;
};

#define PREVIEW_WORD "preview1"

static size_t preview_size(const struct preview_head *head)
{
    return head->positions * sizeof(double[3]) + head->faces * sizeof(uint32_t[3]);
}

/* Copies the polygons of an image. The caller has taken their bytes from the budget. */
static bool preview_copy(const struct preview_head *head, struct server_stored_preview *out)
{
    size_t positions = head->positions * sizeof(double[3]);
    struct gd_polygons polygons = {.positions = malloc(positions),
                                   .position_count = head->positions,
                                   .polygon_count = head->faces,
                                   .corners = malloc(preview_size(head) - positions)};
    if (!polygons.positions || !polygons.corners) {
        gd_polygons_free(&polygons);
        return false;
    }
    memcpy(polygons.positions, head + 1, positions);
    memcpy(polygons.corners, (const char *)(head + 1) + positions, preview_size(head) - positions);
    *out = (struct server_stored_preview){head->wanted, head->largest_distance, polygons,
                                          preview_size(head)};
    return true;
}

static bool preview_open(struct server_field_store *store, const struct image *image,
                         struct server_stored_preview *preview)
{
    const struct preview_head *head = image->bytes;
    if (image->size < sizeof *head || memcmp(head->word, PREVIEW_WORD, sizeof head->word) ||
        image->size != sizeof *head + preview_size(head) || head->wanted != preview->wanted ||
        !server_budget_take_spare(store->budget, SERVER_BUDGET_FLIGHT, preview_size(head)))
        return false;
    if (preview_copy(head, preview)) return true;
    server_budget_give(store->budget, SERVER_BUDGET_FLIGHT, preview_size(head));
    return false;
}

bool server_field_store_read_preview(struct server_field_store *store,
                                     const struct server_surface *surface,
                                     struct server_stored_preview *preview)
{
    struct server_listing files = server_disk_list(folder_of(store, surface->record).path);
    struct image image;
    bool is_found = false;
    while (server_listing_next(&files)) {
        if (is_found || !file_has_suffix(files.name, PREVIEW) || !image_read(store, &files, &image))
            continue;
        is_found = preview_open(store, &image, preview);
        image_free(store, &image);
    }
    return is_found;
}

void server_field_store_write_preview(struct server_field_store *store,
                                      struct server_registry *registry,
                                      const struct server_surface *surface,
                                      const struct server_stored_preview *preview)
{
    const struct gd_polygons *polygons = &preview->polygons;
    struct preview_head head = {.wanted = preview->wanted,
                                .positions = polygons->position_count,
                                .faces = polygons->polygon_count,
                                .largest_distance = preview->largest_distance};
    size_t positions = head.positions * sizeof(double[3]);
    struct image image;
    memcpy(head.word, PREVIEW_WORD, sizeof head.word);
    if (!image_create(store, sizeof head + preview_size(&head), &image)) return;
    char *at = image.bytes;
    memcpy(at, &head, sizeof head);
    memcpy(at + sizeof head, polygons->positions, positions);
    memcpy(at + sizeof head + positions, polygons->corners, preview_size(&head) - positions);
    image_replace(store, registry, surface, &image, PREVIEW);
}
