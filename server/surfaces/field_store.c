/* See field_store.h. */
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
        server_disk_make_folder(store->folder) == SERVER_DISK_DONE)
        return store;
    free(store);
    return NULL;
}

void server_field_store_close(struct server_field_store *store)
{
    free(store);
}

/* --- files ------------------------------------------------------------------------------------ */

static void folder_path(const struct server_field_store *store, char path[SERVER_DISK_PATH],
                        const struct server_record *record)
{
    snprintf(path, SERVER_DISK_PATH, "%s/" SERVER_VERSION "-%s", store->folder, record->etag);
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

struct image { /* of a stored file; as many bytes of SERVER_BUDGET_FLIGHT are taken */
    void *bytes;
    size_t size;
};

static void image_free(struct server_field_store *store, const struct image *image)
{
    free(image->bytes);
    server_budget_give(store->budget, SERVER_BUDGET_FLIGHT, image->size);
}

/* Writes the name of an image: its checksum and a suffix. */
static void image_name(const struct image *image, const char *suffix, char file[FILE_NAME])
{
    char sha256[SERVER_SHA256_HEX];
    server_sha256(image->bytes, image->size, sha256);
    snprintf(file, FILE_NAME, "%s%s", sha256, suffix);
}

/* Reads and verifies a file if there is free memory. Deletes it if it does not match its name. */
static bool image_read(struct server_field_store *store, const char *path, const char *file,
                       struct image *out)
{
    struct image image = {0};
    char sha256[SERVER_SHA256_HEX];
    size_t size;
    if (server_disk_size(path, &size) != SERVER_DISK_DONE) return false;
    if (!server_budget_take_spare(store->budget, SERVER_BUDGET_FLIGHT, size)) return false;
    if (server_disk_read(path, &image.bytes, &image.size) == SERVER_DISK_DONE) {
        server_sha256(image.bytes, image.size, sha256);
        if (image.size == size && strncmp(file, sha256, strlen(sha256)) == 0) {
            *out = image;
            return true;
        }
        file_discard(path, "its checksum is not its name");
    }
    image.size = size;
    image_free(store, &image);
    return false;
}

static bool image_write(const char *folder, const char *file, const struct image *image)
{
    char path[SERVER_DISK_PATH], temporary[SERVER_DISK_PATH];
    if (snprintf(path, sizeof path, "%s/%s", folder, file) >= SERVER_DISK_PATH ||
        snprintf(temporary, sizeof temporary, "%s/" TEMPORARY, folder) >= SERVER_DISK_PATH)
        return false;
    FILE *stream = fopen(temporary, "wbe");
    if (!stream) return false;
    bool is_written = fwrite(image->bytes, 1, image->size, stream) == image->size;
    is_written &= fclose(stream) == 0;
    if (is_written && rename(temporary, path) == 0) return true;
    unlink(temporary);
    return false;
}

static bool folder_make(const char *folder)
{
    return mkdir(folder, 0700) == 0 || server_disk_exists(folder);
}

/* --- surfaces that are gone ------------------------------------------------------------------- */

static void on_unwanted_file(void *user, const char *path, const char *file)
{
    (void)user, (void)file;
    unlink(path);
}

static void folder_remove(const char *path)
{
    (void)server_disk_each(path, on_unwanted_file, NULL);
    rmdir(path);
}

static void on_folder(void *user, const char *path, const char *file)
{
    const struct server_names *wanted = user;
    if (server_names_has(wanted, file)) return;
    folder_remove(path);
    server_log_message(SERVER_LOG_INFO, "fields_discarded",
                       "the stored fields in '%s' were deleted: their mesh is gone", path);
}

static bool on_wanted_surface(void *user, struct server_listed *listed)
{
    char name[SERVER_ETAG + sizeof SERVER_VERSION + 1];
    snprintf(name, sizeof name, SERVER_VERSION "-%s", listed->record->etag);
    server_names_add(user, name);
    return true;
}

static void on_gone(void *user, const struct server_record *record)
{
    char folder[SERVER_DISK_PATH];
    folder_path(user, folder, record);
    folder_remove(folder);
}

void server_field_store_follow(struct server_field_store *store, struct server_registry *registry)
{
    struct server_names wanted = {0};
    server_registry_each(registry, on_wanted_surface, &wanted);
    if (!wanted.is_incomplete) (void)server_disk_each(store->folder, on_folder, &wanted);
    server_names_free(&wanted);
    server_registry_watch(registry, on_gone, store);
}

/* --- restoring fields ------------------------------------------------------------------------- */

struct restoring {
    struct server_field_store *store;
    struct server_surface *surface;
    const struct gd_control *control;
    uint32_t restored;
    bool is_ended; /* by the control */
};

static void on_stored_field(void *user, const char *path, const char *file)
{
    struct restoring *restoring = user;
    struct server_budget *budget = restoring->store->budget;
    struct gd_field *field;
    struct image image;
    if (!file_has_suffix(file, FIELD)) return;
    restoring->is_ended |= gd_control_check(restoring->control, 1) != GD_OK;
    if (restoring->is_ended || !image_read(restoring->store, path, file, &image)) return;
    enum gd_status status = gd_field_open_image(restoring->surface->mesh, image.bytes, image.size,
                                                free, image.bytes, &field, NULL);
    if (status) {
        if (status != GD_NO_MEMORY) file_discard(path, gd_status_sentence(status));
        image_free(restoring->store, &image);
    } else if (isfinite(gd_field_reach(field))) { /* only whole fields are wanted */
        gd_field_release(field);
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, image.size);
    } else {
        server_budget_adjust(budget, SERVER_BUDGET_FLIGHT, image.size, gd_field_memsize(field));
        server_cache_restore(restoring->surface->fields, field);
        restoring->restored++;
    }
}

void server_field_store_restore(struct server_field_store *store, struct server_surface *surface,
                                const struct gd_control *control)
{
    struct restoring restoring = {.store = store, .surface = surface, .control = control};
    char folder[SERVER_DISK_PATH];
    folder_path(store, folder, surface->record);
    (void)server_disk_each(folder, on_stored_field, &restoring);
    if (restoring.restored)
        server_log_message(SERVER_LOG_INFO, "fields_restored", "%u fields of '%s'",
                           restoring.restored, surface->record->name);
}

/* --- saving fields ---------------------------------------------------------------------------- */

struct saving {
    struct server_field_store *store;
    uint64_t until_ns;
    struct server_names kept; /* files */
    uint32_t written;
    bool is_over; /* no more time or room */
};

static void save_field(struct saving *saving, const char *folder, const struct gd_field *field)
{
    struct image image = {.size = gd_field_image_size(field)};
    char file[FILE_NAME], path[SERVER_DISK_PATH];
    saving->is_over |= gd_now_ns() >= saving->until_ns;
    if (saving->is_over || !(image.bytes = malloc(image.size))) return;
    gd_field_write_image(field, image.bytes);
    image_name(&image, FIELD, file);
    if (snprintf(path, sizeof path, "%s/%s", folder, file) < SERVER_DISK_PATH) {
        if (!server_disk_exists(path)) {
            saving->is_over |= !image_write(folder, file, &image);
            saving->written += !saving->is_over;
        }
        server_names_add(&saving->kept, file);
    }
    free(image.bytes);
}

static bool save_surface(void *user, struct server_listed *listed)
{
    struct saving *saving = user;
    char folder[SERVER_DISK_PATH];
    uint32_t count;
    if (!listed->surface) return true;
    const struct server_cached **pinned =
        server_mesh_cache_pin_points(listed->surface->fields, &count);
    folder_path(saving->store, folder, listed->record);
    if (count && !folder_make(folder)) saving->is_over = true;
    for (uint32_t i = 0; i < count; i++) {
        save_field(saving, folder, pinned[i]->field);
        server_cache_unpin(pinned[i]);
    }
    free(pinned);
    return true;
}

static void on_saved_file(void *user, const char *path, const char *file)
{
    const struct saving *saving = user;
    if (!file_has_suffix(file, LANDMARKS) && !server_names_has(&saving->kept, file)) unlink(path);
}

/* Deletes the files of fields that are no longer cached. */
static bool sweep_surface(void *user, struct server_listed *listed)
{
    struct saving *saving = user;
    char folder[SERVER_DISK_PATH];
    if (!listed->surface) return true;
    folder_path(saving->store, folder, listed->record);
    (void)server_disk_each(folder, on_saved_file, saving);
    rmdir(folder); /* if it is empty */
    return true;
}

void server_field_store_save(struct server_field_store *store, struct server_registry *registry,
                             uint64_t until_ns)
{
    struct saving saving = {.store = store, .until_ns = until_ns};
    server_registry_each(registry, save_surface, &saving);
    if (!saving.kept.is_incomplete && !saving.is_over)
        server_registry_each(registry, sweep_surface, &saving);
    server_log_message(saving.is_over ? SERVER_LOG_WARN : SERVER_LOG_INFO, "fields_saved",
                       "%u fields written, %zu in all%s", saving.written, saving.kept.count,
                       saving.is_over ? "; there was no more time or room" : "");
    server_names_free(&saving.kept);
}

/* --- landmarks -------------------------------------------------------------------------------- */

struct landmarks_reading {
    struct server_field_store *store;
    const struct gd_mesh *mesh;
    uint32_t count;
    struct gd_landmarks *out;
};

static void on_stored_landmarks(void *user, const char *path, const char *file)
{
    struct landmarks_reading *reading = user;
    struct gd_landmarks *landmarks;
    struct image image;
    if (reading->out || !file_has_suffix(file, LANDMARKS) ||
        !image_read(reading->store, path, file, &image))
        return;
    enum gd_status status =
        gd_landmarks_open_image(reading->mesh, image.bytes, image.size, &landmarks);
    if (status && status != GD_NO_MEMORY) file_discard(path, gd_status_sentence(status));
    image_free(reading->store, &image);
    if (status) return;
    if (gd_landmarks_count(landmarks) == reading->count &&
        server_budget_take_spare(reading->store->budget, SERVER_BUDGET_FLIGHT,
                                 gd_landmarks_memsize(landmarks)))
        reading->out = landmarks;
    else
        gd_landmarks_release(landmarks);
}

struct gd_landmarks *server_field_store_read_landmarks(struct server_field_store *store,
                                                       const struct server_surface *surface,
                                                       uint32_t count)
{
    struct landmarks_reading reading = {.store = store, .mesh = surface->mesh, .count = count};
    char folder[SERVER_DISK_PATH];
    folder_path(store, folder, surface->record);
    (void)server_disk_each(folder, on_stored_landmarks, &reading);
    return reading.out;
}

static void on_older_landmarks(void *user, const char *path, const char *file)
{
    (void)user;
    if (file_has_suffix(file, LANDMARKS)) unlink(path);
}

void server_field_store_write_landmarks(struct server_field_store *store,
                                        struct server_registry *registry,
                                        const struct server_surface *surface,
                                        const struct gd_landmarks *landmarks)
{
    struct image image = {.size = gd_landmarks_image_size(landmarks)};
    char folder[SERVER_DISK_PATH], file[FILE_NAME];
    if (!server_budget_take_spare(store->budget, SERVER_BUDGET_FLIGHT, image.size)) return;
    image.bytes = malloc(image.size);
    if (image.bytes) {
        gd_landmarks_write_image(landmarks, image.bytes);
        image_name(&image, LANDMARKS, file);
        folder_path(store, folder, surface->record);
        (void)server_disk_each(folder, on_older_landmarks, NULL);
        if (!folder_make(folder) || !image_write(folder, file, &image))
            server_log_message(SERVER_LOG_WARN, "landmarks_not_stored", "'%s' can't be written",
                               folder);
        if (!server_registry_holds(registry, surface->record->etag))
            on_gone(store, surface->record);
    }
    image_free(store, &image);
}
