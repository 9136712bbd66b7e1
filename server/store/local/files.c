/* See store_files.h. */
#include "server/store/local/files.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define BALLAST_BYTES   ((size_t)1 << 20)
#define HEX_DIGITS      "0123456789abcdef"
#define HASH            (SERVER_SHA256_HEX - 1)
#define MANIFEST_SUFFIX ".manifest"
#define ASIDE           "temporary/aside" /* the manifest that one is taking the place of */

enum server_store_outcome server_files_outcome(enum server_disk_result result)
{
    switch (result) {
    case SERVER_DISK_DONE:
        return SERVER_STORE_DONE;
    case SERVER_DISK_ABSENT:
        return SERVER_STORE_ABSENT;
    case SERVER_DISK_FULL:
        return SERVER_STORE_FULL;
    case SERVER_DISK_LOST:
        return SERVER_STORE_READ_ONLY;
    case SERVER_DISK_NO_MEMORY:
        return SERVER_STORE_NO_MEMORY;
    case SERVER_DISK_REFUSED:
        break;
    }
    return SERVER_STORE_REFUSED;
}

/* Of writing a file of the store: one whose folder is not there can't be. */
static enum server_store_outcome written(enum server_disk_result result)
{
    return result == SERVER_DISK_ABSENT ? SERVER_STORE_REFUSED : server_files_outcome(result);
}

/* --- paths ------------------------------------------------------------------------------------ */

void server_files_path(const struct server_store_files *files, char path[SERVER_DISK_PATH],
                       const char *name)
{
    snprintf(path, SERVER_DISK_PATH, "%s/%s", files->folder, name);
}

static void object_folder(const struct server_store_files *files, char path[SERVER_DISK_PATH],
                          const char *object)
{
    snprintf(path, SERVER_DISK_PATH, "%s/objects/%.2s", files->folder, object);
}

void server_files_object_path(const struct server_store_files *files, char path[SERVER_DISK_PATH],
                              const char *object)
{
    snprintf(path, SERVER_DISK_PATH, "%s/objects/%.2s/%s", files->folder, object, object);
}

void server_files_manifest_path(const struct server_store_files *files, char path[SERVER_DISK_PATH],
                                const char *key)
{
    snprintf(path, SERVER_DISK_PATH, "%s/manifests/%s" MANIFEST_SUFFIX, files->folder, key);
}

static void temporary_path(struct server_store_files *files, char path[SERVER_DISK_PATH])
{
    snprintf(path, SERVER_DISK_PATH, "%s/temporary/%u", files->folder, files->serial++);
}

bool server_files_manifest_key(const char *file, char key[SERVER_KEY_TEXT])
{
    size_t size = strlen(file), suffix = strlen(MANIFEST_SUFFIX);
    if (size <= suffix || strcmp(file + size - suffix, MANIFEST_SUFFIX) != 0) return false;
    if (!server_key_check(file, size - suffix)) return false;
    snprintf(key, SERVER_KEY_TEXT, "%.*s", (int)(size - suffix), file);
    return true;
}

bool server_files_object_check(const char *file)
{
    size_t digits = strspn(file, HEX_DIGITS);
    if (digits != HASH) return false;
    return !file[digits] || (file[digits] == '.' && server_tenant_check(file + digits + 1));
}

/* --- open ------------------------------------------------------------------------------------- */

/* The folder and those above it that are missing. */
static enum server_disk_result make_folders(const char *folder)
{
    char path[SERVER_STORE_FOLDER];
    snprintf(path, sizeof path, "%s", folder);
    for (char *slash = path + 1; (slash = strchr(slash, '/')); slash++) {
        *slash = '\0';
        enum server_disk_result result =
            server_disk_exists(path) ? SERVER_DISK_DONE : server_disk_make_folder(path);
        *slash = '/';
        if (result) return result;
    }
    return server_disk_make_folder(path);
}

static enum server_disk_result make_layout(const struct server_store_files *files)
{
    static const char *const folders[] = {"objects", "manifests", "temporary"};
    char path[SERVER_DISK_PATH];
    enum server_disk_result result = make_folders(files->folder);
    for (size_t i = 0; !result && i < sizeof folders / sizeof *folders; i++) {
        server_files_path(files, path, folders[i]);
        result = server_disk_make_folder(path);
    }
    return result;
}

/* Makes durable the names of the folders that the data folder stands in: of those that this process
 * may write to, since in no other can it have made one. */
static enum server_disk_result sync_path(const char *folder)
{
    char text[SERVER_STORE_FOLDER], *path = text;
    enum server_disk_result result = SERVER_DISK_DONE;
    snprintf(text, sizeof text, "%s", folder);
    do {
        path = dirname(path);
        if (access(path, W_OK) == 0) result = server_disk_sync_folder(path);
        if (result == SERVER_DISK_LOST && errno == EACCES)
            result = SERVER_DISK_DONE; /* it is out of reach (sandbox.h) */
    } while (!result && strcmp(path, "/") != 0 && strcmp(path, ".") != 0);
    return result;
}

/* A process may have been killed after it made a folder and before the name was durable: who finds
 * the folder and puts files into it would lose them with it. So all names that are there are made
 * durable before the first use. */
static enum server_disk_result sync_layout(const struct server_store_files *files)
{
    char path[SERVER_DISK_PATH];
    server_files_path(files, path, "objects");
    enum server_disk_result result = sync_path(files->folder);
    if (!result) result = server_disk_sync_folder(files->folder);
    return result ? result : server_disk_sync_folder(path);
}

static bool refuse_second(const struct server_store_files *files, char *error, size_t error_size)
{
    snprintf(error, error_size,
             "the data folder '%s' is in use by another geodesicd: stop that one, or choose "
             "another --data-dir",
             files->folder);
    return false;
}

static bool refuse_path(const char *path, char *error, size_t error_size)
{
    snprintf(error, error_size, "can't open '%s': %s", path, strerror(errno));
    return false;
}

/* The folder itself is locked, since a file that holds a lock can be removed; and the file, by
 * which earlier versions know, and which can be locked where a folder can't (NFS). */
static bool lock_both(struct server_store_files *files, int flags, char *error, size_t error_size)
{
    char path[SERVER_DISK_PATH];
    server_files_path(files, path, "lock");
    files->held = open(files->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (files->held < 0) return refuse_path(files->folder, error, error_size);
    if (flock(files->held, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return refuse_second(files, error, error_size);
    files->lock = open(path, flags | O_CLOEXEC | O_NONBLOCK, 0600);
    /* without O_CREAT: a copy has no such file as yet */
    if (files->lock < 0 && errno == ENOENT) return true;
    if (files->lock < 0) return refuse_path(path, error, error_size);
    return flock(files->lock, LOCK_EX | LOCK_NB) == 0 || refuse_second(files, error, error_size);
}

static bool take_lock(struct server_store_files *files, int flags, char *error, size_t error_size)
{
    if (lock_both(files, flags, error, error_size)) return true;
    server_files_close(files);
    return false;
}

static bool set_folder(struct server_store_files *files, const char *folder, char *error,
                       size_t error_size)
{
    *files = (struct server_store_files){.held = -1, .lock = -1};
    if (strlen(folder) >= sizeof files->folder) {
        snprintf(error, error_size, "the path of the data folder is longer than %d bytes",
                 SERVER_STORE_FOLDER - 1);
        return false;
    }
    strcpy(files->folder, folder);
    return true;
}

static bool refuse_folder(const char *folder, char *error, size_t error_size)
{
    snprintf(error, error_size,
             "can't make the data folder '%s': %s; choose another --data-dir, or --store memory",
             folder, strerror(errno));
    return false;
}

/* Earlier versions made databases as umask let them. */
static void make_private(void *user, const char *path, const char *file)
{
    struct stat facts;
    (void)user, (void)file;
    if (lstat(path, &facts) == 0 && S_ISREG(facts.st_mode) && (facts.st_mode & 077))
        (void)chmod(path, 0600);
}

bool server_files_open(struct server_store_files *files, const char *folder, char *error,
                       size_t error_size)
{
    if (!set_folder(files, folder, error, error_size)) return false;
    if (server_files_is_unfinished(folder, error, error_size)) return false;
    if (make_layout(files) || sync_layout(files)) return refuse_folder(folder, error, error_size);
    if (!take_lock(files, O_RDWR | O_CREAT, error, error_size)) return false;
    (void)server_disk_each(folder, make_private, NULL);
    return true;
}

static bool has_folder(const struct server_store_files *files, const char *name)
{
    char path[SERVER_DISK_PATH];
    struct stat facts;
    server_files_path(files, path, name);
    return stat(path, &facts) == 0 && S_ISDIR(facts.st_mode);
}

bool server_files_open_existing(struct server_store_files *files, const char *folder, char *error,
                                size_t error_size)
{
    if (!set_folder(files, folder, error, error_size)) return false;
    if (!has_folder(files, "objects") || !has_folder(files, "manifests")) {
        snprintf(error, error_size,
                 "there is no data folder at '%s': name one that a daemon or --backup has made",
                 folder);
        return false;
    }
    if (server_files_is_unfinished(folder, error, error_size)) return false;
    return take_lock(files, O_RDWR, error, error_size);
}

void server_files_close(struct server_store_files *files)
{
    if (files->lock >= 0) close(files->lock);
    if (files->held >= 0) close(files->held);
}

bool server_files_are_there(const struct server_store_files *files)
{
    static const char *const parts[] = {"objects", "manifests", "geodesicd.db"};
    char path[SERVER_DISK_PATH];
    struct stat now, held;
    if (stat(files->folder, &now) != 0 || fstat(files->held, &held) != 0) return false;
    bool are_there = now.st_dev == held.st_dev && now.st_ino == held.st_ino;
    for (size_t i = 0; are_there && i < sizeof parts / sizeof *parts; i++) {
        server_files_path(files, path, parts[i]);
        are_there = server_disk_exists(path);
    }
    return are_there;
}

/* --- copies ----------------------------------------------------------------------------------- */

#define UNFINISHED "unfinished"

bool server_files_is_unfinished(const char *folder, char *error, size_t error_size)
{
    char path[SERVER_DISK_PATH];
    snprintf(path, sizeof path, "%s/" UNFINISHED, folder);
    if (!server_disk_exists(path)) return false;
    snprintf(error, error_size,
             "'%s' is an unfinished copy: run the --restore or --backup that began it again, or "
             "delete the folder",
             folder);
    return true;
}

static void on_some_file(void *user, const char *path, const char *file)
{
    (void)path, (void)file;
    *(bool *)user = true;
}

/* Databases, and what the folders hold. */
static bool has_data(const struct server_store_files *files)
{
    static const char *const databases[] = {"geodesicd.db", "batches.db"};
    static const char *const folders[] = {"objects", "manifests"};
    char path[SERVER_DISK_PATH];
    bool has_some = false;
    for (int i = 0; i < 2; i++) {
        server_files_path(files, path, databases[i]);
        has_some |= server_disk_exists(path);
        server_files_path(files, path, folders[i]);
        (void)server_disk_each(path, on_some_file, &has_some);
    }
    return has_some;
}

static void on_left_file(void *user, const char *path, const char *file)
{
    const char *const *only = user;
    if (!only || strncmp(file, only[0], strlen(only[0])) == 0 ||
        strncmp(file, only[1], strlen(only[1])) == 0)
        (void)unlink(path);
}

/* What an earlier attempt has left may be of another moment, or of another backup: but objects are
 * what their names say. */
static void clear_copy(const struct server_store_files *files)
{
    static const char *databases[] = {"geodesicd.db", "batches.db"};
    char path[SERVER_DISK_PATH];
    server_files_path(files, path, "manifests");
    (void)server_disk_each(path, on_left_file, NULL);
    server_files_path(files, path, "temporary");
    (void)server_disk_each(path, on_left_file, NULL);
    (void)server_disk_each(files->folder, on_left_file, databases);
}

/* The marker is there, durably. Its name says all, so that it is there as soon as it is made. */
static bool mark(const struct server_store_files *files, const char *path)
{
    int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0) return false;
    close(file);
    return server_disk_sync_file(path) == SERVER_DISK_DONE &&
           server_disk_sync_folder(files->folder) == SERVER_DISK_DONE;
}

static bool begin_copy(struct server_store_files *files, char *error, size_t error_size)
{
    clear_copy(files);
    if (!make_layout(files) && !sync_layout(files)) return true;
    server_files_close(files);
    return refuse_folder(files->folder, error, error_size);
}

/* The marker stands before the lock's file, so that an interrupted copy is no empty folder. */
bool server_files_open_copy(struct server_store_files *files, const char *folder, char *error,
                            size_t error_size)
{
    char path[SERVER_DISK_PATH];
    if (!set_folder(files, folder, error, error_size)) return false;
    if (make_folders(folder)) return refuse_folder(folder, error, error_size);
    bool is_new = !server_files_is_unfinished(folder, error, error_size);
    if (is_new && has_data(files)) {
        snprintf(error, error_size, "'%s' holds a data folder already: name a new one", folder);
        return false;
    }
    server_files_path(files, path, UNFINISHED);
    if (!mark(files, path)) return refuse_path(path, error, error_size);
    if (take_lock(files, O_RDWR | O_CREAT, error, error_size))
        return begin_copy(files, error, error_size);
    if (is_new) (void)server_disk_remove(folder, path);
    return false;
}

enum server_store_outcome server_files_finish(const struct server_store_files *files)
{
    char path[SERVER_DISK_PATH];
    server_files_path(files, path, UNFINISHED);
    enum server_disk_result result = server_disk_sync_folder(files->folder);
    return server_files_outcome(result ? result : server_disk_remove(files->folder, path));
}

/* --- objects ---------------------------------------------------------------------------------- */

enum server_store_outcome server_files_read_object(const struct server_store_files *files,
                                                   const struct server_object *object, void **bytes)
{
    char path[SERVER_DISK_PATH], found[SERVER_SHA256_HEX];
    size_t got;
    void *read;
    server_files_object_path(files, path, object->id);
    enum server_disk_result result = server_disk_read(path, &read, &got);
    if (result) return server_files_outcome(result);
    server_sha256(read, got, found);
    if (got != object->size || strncmp(found, object->id, HASH) != 0) {
        free(read);
        return SERVER_STORE_DAMAGED;
    }
    *bytes = read;
    return SERVER_STORE_DONE;
}

struct verification {
    struct server_sha256 *sum;
    uint64_t size;
    bool (*pace)(void *user, size_t bytes);
    void *user;
    bool was_ended;
};

static bool on_piece(void *user, const void *bytes, size_t size)
{
    struct verification *verification = user;
    server_sha256_add(verification->sum, bytes, size);
    verification->size += size;
    verification->was_ended = !verification->pace(verification->user, size);
    return !verification->was_ended;
}

static enum server_store_verdict judge_scan(enum server_disk_result result, bool was_ended,
                                            bool is_same)
{
    if (result == SERVER_DISK_ABSENT) return SERVER_VERDICT_MISSING;
    if (result == SERVER_DISK_NO_MEMORY || was_ended) return SERVER_VERDICT_NONE;
    if (result) return SERVER_VERDICT_UNREADABLE;
    return is_same ? SERVER_VERDICT_SOUND : SERVER_VERDICT_DAMAGED;
}

enum server_store_verdict server_files_verify_object(const struct server_store_files *files,
                                                     const struct server_object *object,
                                                     bool (*pace)(void *user, size_t bytes),
                                                     void *user)
{
    char path[SERVER_DISK_PATH], found[SERVER_SHA256_HEX];
    struct verification verification = {.sum = server_sha256_begin(), .pace = pace, .user = user};
    if (!verification.sum) return SERVER_VERDICT_NONE;
    server_files_object_path(files, path, object->id);
    enum server_disk_result result = server_disk_scan(path, on_piece, &verification);
    server_sha256_end(verification.sum, found);
    bool is_same = verification.size == object->size && strncmp(found, object->id, HASH) == 0;
    return judge_scan(result, verification.was_ended, is_same);
}

static bool has_object(const struct server_store_files *files, const struct server_object *object)
{
    void *bytes = NULL;
    bool found = server_files_read_object(files, object, &bytes) == SERVER_STORE_DONE;
    free(bytes);
    return found;
}

enum server_store_outcome server_files_write_object(struct server_store_files *files,
                                                    const struct server_object *object,
                                                    const void *bytes)
{
    char folder[SERVER_DISK_PATH], path[SERVER_DISK_PATH], temporary[SERVER_DISK_PATH];
    object_folder(files, folder, object->id);
    server_files_object_path(files, path, object->id);
    temporary_path(files, temporary);
    enum server_disk_result result = server_disk_make_folder(folder);
    if (result) return written(result);
    result = has_object(files, object)
                 ? server_disk_sync_folder(folder)
                 : server_disk_write(folder, path, temporary, bytes, (size_t)object->size);
    return written(result);
}

void server_files_remove_object(const struct server_store_files *files, const char *object)
{
    char path[SERVER_DISK_PATH];
    server_files_object_path(files, path, object);
    (void)server_disk_remove(NULL, path); /* one that stays is collected at the next start */
}

/* --- manifests -------------------------------------------------------------------------------- */

static void manifests_folder(const struct server_store_files *files, char path[SERVER_DISK_PATH])
{
    server_files_path(files, path, "manifests");
}

enum server_record_reading server_files_read_manifest(const struct server_store_files *files,
                                                      const char *key, struct server_record **out,
                                                      char sha256[SERVER_SHA256_HEX])
{
    char path[SERVER_DISK_PATH];
    void *text;
    size_t size;
    server_files_manifest_path(files, path, key);
    enum server_disk_result result = server_disk_read(path, &text, &size);
    if (result)
        return result == SERVER_DISK_NO_MEMORY ? SERVER_RECORD_NO_MEMORY : SERVER_RECORD_DAMAGED;
    enum server_record_reading reading = server_record_read_named(key, text, size, out);
    server_sha256(text, size, sha256);
    free(text);
    return reading;
}

static enum server_disk_result put_aside(const struct server_store_files *files, const char *path)
{
    char aside[SERVER_DISK_PATH];
    server_files_path(files, aside, ASIDE);
    enum server_disk_result result = server_disk_link(path, aside);
    return result == SERVER_DISK_ABSENT ? SERVER_DISK_DONE : result;
}

enum server_store_outcome server_files_write_manifest(struct server_store_files *files,
                                                      const struct server_record *record)
{
    char folder[SERVER_DISK_PATH], path[SERVER_DISK_PATH], temporary[SERVER_DISK_PATH];
    size_t size;
    char *text = server_record_write(record, &size);
    if (!text) return SERVER_STORE_NO_MEMORY;
    manifests_folder(files, folder);
    server_files_manifest_path(files, path, record->key);
    temporary_path(files, temporary);
    server_files_settle_manifest(files);
    enum server_disk_result result = put_aside(files, path);
    if (!result) result = server_disk_write(folder, path, temporary, text, size);
    free(text);
    return written(result);
}

void server_files_settle_manifest(const struct server_store_files *files)
{
    char aside[SERVER_DISK_PATH];
    server_files_path(files, aside, ASIDE);
    (void)server_disk_remove(NULL, aside);
}

enum server_store_outcome server_files_undo_manifest(const struct server_store_files *files,
                                                     const char *key)
{
    char folder[SERVER_DISK_PATH], path[SERVER_DISK_PATH], aside[SERVER_DISK_PATH];
    manifests_folder(files, folder);
    server_files_manifest_path(files, path, key);
    server_files_path(files, aside, ASIDE);
    if (rename(aside, path) != 0) return server_files_outcome(server_disk_remove(folder, path));
    return server_files_outcome(server_disk_sync_folder(folder));
}

enum server_store_outcome server_files_remove_manifest(const struct server_store_files *files,
                                                       const char *key)
{
    char folder[SERVER_DISK_PATH], path[SERVER_DISK_PATH];
    manifests_folder(files, folder);
    server_files_manifest_path(files, path, key);
    enum server_disk_result result = server_disk_remove(folder, path);
    return result == SERVER_DISK_ABSENT ? SERVER_STORE_DONE : server_files_outcome(result);
}

/* --- ballast ---------------------------------------------------------------------------------- */

enum server_store_outcome server_files_load_ballast(struct server_store_files *files)
{
    char path[SERVER_DISK_PATH], temporary[SERVER_DISK_PATH];
    server_files_path(files, path, "ballast");
    if (server_disk_exists(path)) return SERVER_STORE_DONE;
    void *zeros = calloc(1, BALLAST_BYTES);
    if (!zeros) return SERVER_STORE_NO_MEMORY;
    temporary_path(files, temporary);
    enum server_disk_result result =
        server_disk_write(files->folder, path, temporary, zeros, BALLAST_BYTES);
    free(zeros);
    return written(result);
}

bool server_files_drop_ballast(const struct server_store_files *files)
{
    char path[SERVER_DISK_PATH];
    server_files_path(files, path, "ballast");
    return server_disk_remove(NULL, path) == SERVER_DISK_DONE;
}
