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
#define PAGE      64 /* surfaces listed at once */

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

/* --- names ------------------------------------------------------------------------------------ */

static void folder_path(const struct server_field_store *store, char path[SERVER_DISK_PATH],
                        const char *etag)
{
    snprintf(path, SERVER_DISK_PATH, "%s/" SERVER_VERSION "-%s", store->folder, etag);
}

static bool file_path(char path[SERVER_DISK_PATH], const char *folder, const char *file)
{
    return snprintf(path, SERVER_DISK_PATH, "%s/%s", folder, file) < SERVER_DISK_PATH;
}

static void discard(const char *path, const char *why)
{
    unlink(path);
    server_log_message(SERVER_LOG_WARN, "field_discarded", "the stored file '%s' was deleted: %s",
                       path, why);
}

/* Is the file a kind (FIELD, LANDMARKS)? */
static bool is_a(const char *file, const char *kind)
{
    size_t size = strlen(file), suffix = strlen(kind);
    return size > suffix && strcmp(file + size - suffix, kind) == 0;
}

/* --- reading ---------------------------------------------------------------------------------- */

struct image { /* of a stored file; as many bytes of SERVER_BUDGET_FLIGHT are taken */
    void *bytes;
    size_t size;
};

static void free_image(struct server_field_store *store, const struct image *image)
{
    free(image->bytes);
    server_budget_give(store->budget, SERVER_BUDGET_FLIGHT, image->size);
}

static bool is_whole(const void *bytes, size_t size, const char *file)
{
    char sha256[SERVER_SHA256_HEX];
    server_sha256(bytes, size, sha256);
    return strncmp(file, sha256, strlen(sha256)) == 0;
}

/* The file, verified, if the budget has room for it. One that is not what its name says is deleted;
 * one that can't be read just now is not. */
static bool read_image(struct server_field_store *store, const char *path, const char *file,
                       struct image *out)
{
    struct image image = {0};
    size_t got = 0;
    if (server_disk_size(path, &image.size) != SERVER_DISK_DONE) return false;
    if (!server_budget_take_spare(store->budget, SERVER_BUDGET_FLIGHT, image.size)) return false;
    if (server_disk_read(path, &image.bytes, &got) == SERVER_DISK_DONE) {
        if (got == image.size && is_whole(image.bytes, got, file)) {
            *out = image;
            return true;
        }
        discard(path, "its checksum is not its name");
    }
    free_image(store, &image);
    return false;
}

/* --- restoring -------------------------------------------------------------------------------- */

struct restoring {
    struct server_field_store *store;
    struct server_surface *surface;
    const struct gd_control *control;
    uint32_t restored;
    bool is_over; /* by the control */
};

/* Puts the field, whose image this was, on the mesh cache, if it is the whole of it. */
static void keep_field(struct restoring *restoring, struct gd_field *field, size_t image_size)
{
    struct server_budget *budget = restoring->store->budget;
    if (isfinite(gd_field_reach(field))) {
        gd_field_release(field);
        server_budget_give(budget, SERVER_BUDGET_FLIGHT, image_size);
        return;
    }
    server_budget_adjust(budget, SERVER_BUDGET_FLIGHT, image_size, gd_field_memsize(field));
    server_cache_restore(restoring->surface->fields, field);
    restoring->restored++;
}

static void on_stored_field(void *user, const char *path, const char *file)
{
    struct restoring *restoring = user;
    struct gd_field *field;
    struct image image;
    if (!is_a(file, FIELD)) return;
    restoring->is_over |= gd_control_check(restoring->control, 1) != GD_OK;
    if (restoring->is_over || !read_image(restoring->store, path, file, &image)) return;
    enum gd_status status = gd_field_open_image(restoring->surface->mesh, image.bytes, image.size,
                                                free, image.bytes, &field, NULL);
    if (!status) {
        keep_field(restoring, field, image.size);
        return;
    }
    if (status != GD_NO_MEMORY) discard(path, gd_status_sentence(status));
    free_image(restoring->store, &image);
}

void server_field_store_restore(struct server_field_store *store, struct server_surface *surface,
                                const struct gd_control *control)
{
    struct restoring restoring = {.store = store, .surface = surface, .control = control};
    char folder[SERVER_DISK_PATH];
    folder_path(store, folder, surface->record->etag);
    (void)server_disk_each(folder, on_stored_field, &restoring);
    if (restoring.restored)
        server_log_message(SERVER_LOG_INFO, "fields_restored", "%u fields of '%s'",
                           restoring.restored, surface->record->name);
}

/* --- cleaning --------------------------------------------------------------------------------- */

static void on_unwanted_file(void *user, const char *path, const char *file)
{
    (void)user, (void)file;
    unlink(path);
}

static void remove_folder(const char *path)
{
    (void)server_disk_each(path, on_unwanted_file, NULL);
    rmdir(path);
}

static void on_folder(void *user, const char *path, const char *file)
{
    const struct server_names *wanted = user;
    if (server_names_has(wanted, file)) return;
    remove_folder(path);
    server_log_message(SERVER_LOG_INFO, "fields_discarded",
                       "the stored fields in '%s' were deleted: their mesh is gone", path);
}

/* Calls `visit` with each surface of the registry. */
static void each_surface(struct server_registry *registry,
                         void (*visit)(void *user, const struct server_listed *listed), void *user)
{
    struct server_listed listed[PAGE];
    struct server_record *last = NULL;
    struct server_key after;
    uint32_t count = 0;
    do {
        count = server_registry_list_all(registry, last ? &after : NULL, PAGE, listed);
        server_record_release(last);
        last = count ? server_record_retain(listed[count - 1].record) : NULL;
        if (last) after = server_record_key(last);
        for (uint32_t i = 0; i < count; i++) {
            visit(user, &listed[i]);
            server_listed_release(&listed[i]);
        }
    } while (count == PAGE);
    server_record_release(last);
}

static void on_wanted_surface(void *user, const struct server_listed *listed)
{
    char name[SERVER_ETAG + sizeof SERVER_VERSION + 1];
    snprintf(name, sizeof name, SERVER_VERSION "-%s", listed->record->etag);
    server_names_add(user, name);
}

static void on_gone(void *user, const struct server_record *record)
{
    char folder[SERVER_DISK_PATH];
    folder_path(user, folder, record->etag);
    remove_folder(folder);
}

void server_field_store_follow(struct server_field_store *store, struct server_registry *registry)
{
    struct server_names wanted = {0};
    each_surface(registry, on_wanted_surface, &wanted);
    if (!wanted.is_incomplete) (void)server_disk_each(store->folder, on_folder, &wanted);
    server_names_free(&wanted);
    server_registry_watch(registry, on_gone, store);
}

/* --- writing ---------------------------------------------------------------------------------- */

static bool make_folder(const char *folder)
{
    return mkdir(folder, 0700) == 0 || server_disk_exists(folder);
}

static bool write_file(const char *folder, const char *path, const void *bytes, size_t size)
{
    char temporary[SERVER_DISK_PATH];
    if (!file_path(temporary, folder, TEMPORARY)) return false;
    FILE *file = fopen(temporary, "wbe");
    if (!file) return false;
    bool written = fwrite(bytes, 1, size, file) == size;
    written &= fclose(file) == 0;
    if (written && rename(temporary, path) == 0) return true;
    unlink(temporary);
    return false;
}

#define FILE_NAME (SERVER_SHA256_HEX + sizeof LANDMARKS)

/* The name that an image is stored under. */
static void name_image(char file[FILE_NAME], const void *image, size_t size, const char *kind)
{
    char sha256[SERVER_SHA256_HEX];
    server_sha256(image, size, sha256);
    snprintf(file, FILE_NAME, "%s%s", sha256, kind);
}

/* --- landmarks -------------------------------------------------------------------------------- */

struct reading {
    struct server_field_store *store;
    const struct gd_mesh *mesh;
    uint32_t count;
    struct gd_landmarks *out;
};

/* Keeps the landmarks, if they are as many as they should be and the budget has room. */
static void keep_landmarks(struct reading *reading, struct gd_landmarks *landmarks)
{
    size_t bytes = gd_landmarks_memsize(landmarks);
    if (!reading->out && gd_landmarks_count(landmarks) == reading->count &&
        server_budget_take_spare(reading->store->budget, SERVER_BUDGET_FLIGHT, bytes))
        reading->out = landmarks;
    else
        gd_landmarks_release(landmarks);
}

static void on_stored_landmarks(void *user, const char *path, const char *file)
{
    struct reading *reading = user;
    struct gd_landmarks *landmarks;
    struct image image;
    if (!is_a(file, LANDMARKS) || !read_image(reading->store, path, file, &image)) return;
    enum gd_status status =
        gd_landmarks_open_image(reading->mesh, image.bytes, image.size, &landmarks);
    if (!status)
        keep_landmarks(reading, landmarks);
    else if (status != GD_NO_MEMORY)
        discard(path, gd_status_sentence(status));
    free_image(reading->store, &image);
}

struct gd_landmarks *server_field_store_read_landmarks(struct server_field_store *store,
                                                       const struct server_surface *surface,
                                                       uint32_t count)
{
    struct reading reading = {.store = store, .mesh = surface->mesh, .count = count};
    char folder[SERVER_DISK_PATH];
    folder_path(store, folder, surface->record->etag);
    (void)server_disk_each(folder, on_stored_landmarks, &reading);
    return reading.out;
}

static void on_older_landmarks(void *user, const char *path, const char *file)
{
    (void)user;
    if (is_a(file, LANDMARKS)) unlink(path);
}

static void write_landmarks(const char *folder, void *image, size_t size)
{
    char file[FILE_NAME], path[SERVER_DISK_PATH];
    name_image(file, image, size, LANDMARKS);
    (void)server_disk_each(folder, on_older_landmarks, NULL);
    if (!make_folder(folder) || !file_path(path, folder, file) ||
        !write_file(folder, path, image, size))
        server_log_message(SERVER_LOG_WARN, "landmarks_not_stored", "'%s' can't be written",
                           folder);
}

void server_field_store_write_landmarks(struct server_field_store *store,
                                        struct server_registry *registry,
                                        const struct server_surface *surface,
                                        const struct gd_landmarks *landmarks)
{
    size_t size = gd_landmarks_image_size(landmarks);
    char folder[SERVER_DISK_PATH];
    if (!server_budget_take_spare(store->budget, SERVER_BUDGET_FLIGHT, size)) return;
    void *image = malloc(size);
    if (image) {
        folder_path(store, folder, surface->record->etag);
        gd_landmarks_write_image(landmarks, image);
        write_landmarks(folder, image, size);
        if (!server_registry_holds(registry, surface->record->etag))
            on_gone(store, surface->record);
    }
    free(image);
    server_budget_give(store->budget, SERVER_BUDGET_FLIGHT, size);
}

/* --- saving fields ---------------------------------------------------------------------------- */

struct saving {
    struct server_field_store *store;
    uint64_t until_ns;
    struct server_names kept; /* files */
    uint32_t written;
    bool is_over; /* no more time or room */
};

/* Writes an image under the name of its checksum, unless it is there already. */
static void save_image(struct saving *saving, const char *folder, const void *image, size_t size)
{
    char file[FILE_NAME], path[SERVER_DISK_PATH];
    name_image(file, image, size, FIELD);
    if (!file_path(path, folder, file)) return;
    if (!server_disk_exists(path)) {
        saving->is_over |= !write_file(folder, path, image, size);
        saving->written += !saving->is_over;
    }
    server_names_add(&saving->kept, file);
}

static void save_field(struct saving *saving, const char *folder, const struct gd_field *field)
{
    size_t size = gd_field_image_size(field);
    saving->is_over |= gd_now_ns() >= saving->until_ns;
    void *image = saving->is_over ? NULL : malloc(size);
    if (!image) return;
    gd_field_write_image(field, image);
    save_image(saving, folder, image, size);
    free(image);
}

static void save_surface(void *user, const struct server_listed *listed)
{
    struct saving *saving = user;
    char folder[SERVER_DISK_PATH];
    uint32_t count;
    if (!listed->surface) return;
    const struct server_cached **pinned =
        server_mesh_cache_pin_points(listed->surface->fields, &count);
    folder_path(saving->store, folder, listed->record->etag);
    if (count && !make_folder(folder)) saving->is_over = true;
    for (uint32_t i = 0; i < count; i++) {
        save_field(saving, folder, pinned[i]->field);
        server_cache_unpin(pinned[i]);
    }
    free(pinned);
}

static void on_saved_file(void *user, const char *path, const char *file)
{
    const struct saving *saving = user;
    if (!is_a(file, LANDMARKS) && !server_names_has(&saving->kept, file)) unlink(path);
}

/* The folder of a surface that was in memory holds what was cached, and nothing else. */
static void sweep_surface(void *user, const struct server_listed *listed)
{
    struct saving *saving = user;
    char folder[SERVER_DISK_PATH];
    if (!listed->surface) return;
    folder_path(saving->store, folder, listed->record->etag);
    (void)server_disk_each(folder, on_saved_file, saving);
    rmdir(folder); /* if it is empty */
}

void server_field_store_save(struct server_field_store *store, struct server_registry *registry,
                             uint64_t until_ns)
{
    struct saving saving = {.store = store, .until_ns = until_ns};
    each_surface(registry, save_surface, &saving);
    if (!saving.kept.is_incomplete && !saving.is_over)
        each_surface(registry, sweep_surface, &saving);
    server_log_message(saving.is_over ? SERVER_LOG_WARN : SERVER_LOG_INFO, "fields_saved",
                       "%u fields written, %zu in all%s", saving.written, saving.kept.count,
                       saving.is_over ? "; there was no more time or room" : "");
    server_names_free(&saving.kept);
}
