/* See local.h. */
#include "server/store/local/local.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define BALLAST_BYTES ((size_t)1 << 20)
#define HASH          (SERVER_SHA256_HEX - 1)
#define ASIDE         "temporary/aside" /* name of the old manifest while it is being replaced */
#define UNFINISHED    "unfinished"

/* --- paths ------------------------------------------------------------------------------------ */

struct server_path server_files_path(const struct server_files *files, const char *format, ...)
{
    struct server_path path;
    va_list arguments;
    int size = snprintf(path.text, sizeof path.text, "%s/", files->folder);
    va_start(arguments, format);
    vsnprintf(path.text + size, sizeof path.text - (size_t)size, format, arguments);
    va_end(arguments);
    return path;
}

static struct server_path object_path(const struct server_files *files, const char *object)
{
    return server_files_path(files, "objects/%.2s/%s", object, object);
}

struct server_path server_files_manifest_path(const struct server_files *files, const char *key)
{
    return server_files_path(files, "manifests/%s" SERVER_MANIFEST, key);
}

struct server_listing server_files_list(const struct server_files *files, const char *folder)
{
    return server_disk_list(server_files_path(files, "%s", folder).text);
}

bool server_files_manifest_key(const char *file, char key[SERVER_KEY_TEXT])
{
    size_t size = strlen(file), suffix = strlen(SERVER_MANIFEST);
    if (size <= suffix || strcmp(file + size - suffix, SERVER_MANIFEST) != 0) return false;
    if (!server_key_check(file, size - suffix)) return false;
    snprintf(key, SERVER_KEY_TEXT, "%.*s", (int)(size - suffix), file);
    return true;
}

bool server_files_object_check(const char *file)
{
    return server_sha256_check(file) &&
           (!file[HASH] || (file[HASH] == '.' && server_tenant_check(file + HASH + 1)));
}

/* --- open ------------------------------------------------------------------------------------- */

static bool files_refuse_path(struct server_files *files, const char *path)
{
    return server_refuse(files->error, "can't open '%s': %s", path, strerror(errno));
}

/* Makes the names in a folder durable. Skips a folder without write permission, because the process
 * can't have created a name in it. In the sandbox (sandbox.h) the folder may be inaccessible. */
static enum server_outcome sync_names(const char *folder)
{
    if (access(folder, W_OK) != 0) return SERVER_STORE_DONE;
    enum server_outcome outcome = server_disk_sync_folder(folder);
    return outcome == SERVER_STORE_READ_ONLY && errno == EACCES ? SERVER_STORE_DONE : outcome;
}

/* Creates a folder and its parents. Also makes the names of existing folders durable, because a
 * process that created them may have been killed before it made them durable. */
static enum server_outcome make_path(const char *folder)
{
    char path[SERVER_STORE_FOLDER];
    enum server_outcome outcome = sync_names(*folder == '/' ? "/" : ".");
    snprintf(path, sizeof path, "%s", folder);
    for (char *slash = path; !outcome && (slash = strchr(slash + 1, '/')); *slash = '/') {
        *slash = '\0';
        outcome = server_disk_make_folder(path);
        if (!outcome) outcome = sync_names(path);
    }
    return outcome ? outcome : server_disk_make_folder(path);
}

static bool make_layout(struct server_files *files)
{
    static const char *const folders[] = {"", "temporary", "manifests", "objects"};
    enum server_outcome outcome = make_path(files->folder);
    for (size_t i = 0; !outcome && i < sizeof folders / sizeof *folders; i++)
        outcome = server_disk_make_folder(server_files_path(files, "%s", folders[i]).text);
    if (!outcome) outcome = server_disk_sync_folder(files->folder);
    if (!outcome) outcome = server_disk_sync_folder(server_files_path(files, "objects").text);
    return !outcome ||
           server_refuse(files->error,
                         "can't make the data folder '%s': %s; choose another --data-dir, or "
                         "--store memory",
                         files->folder, strerror(errno));
}

/* Locks the folder, and the file `lock` for earlier versions and for NFS, where folders can't be
 * locked. A lock of the file alone would be lost when the file is removed. */
static bool lock_take(struct server_files *files, int flags)
{
    const struct server_path path = server_files_path(files, "lock");
    files->held = open(files->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (files->held >= 0) files->lock = open(path.text, flags | O_CLOEXEC | O_NONBLOCK, 0600);
    if (files->held >= 0 && files->lock < 0 && errno == EROFS && !(flags & O_CREAT))
        files->lock = open(path.text, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    /* without O_CREAT the file may be missing, because some copies of the folder lack it */
    bool is_open = files->held >= 0 && (files->lock >= 0 || errno == ENOENT);
    if (!is_open) (void)files_refuse_path(files, files->held < 0 ? files->folder : path.text);
    bool is_locked = is_open &&
                     (flock(files->held, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) &&
                     (files->lock < 0 || flock(files->lock, LOCK_EX | LOCK_NB) == 0);
    if (is_open && !is_locked)
        (void)server_refuse(
            files->error,
            "the data folder '%s' is in use by another geodesicd: stop that one, or "
            "choose another --data-dir",
            files->folder);
    if (!is_locked) server_files_close(files);
    return is_locked;
}

static bool set_folder(struct server_files *files, const char *folder)
{
    *files = (struct server_files){.held = -1, .lock = -1};
    int size = snprintf(files->folder, sizeof files->folder, "%s", folder);
    return size < SERVER_STORE_FOLDER ||
           server_refuse(files->error, "the path of the data folder is longer than %d bytes",
                         SERVER_STORE_FOLDER - 1);
}

/* Returns true and sets files->error if the folder is an unfinished copy. */
static bool is_unfinished(struct server_files *files)
{
    return server_disk_exists(server_files_path(files, UNFINISHED).text) &&
           !server_refuse(files->error,
                          "'%s' is an unfinished copy: repeat the --restore or --backup that began "
                          "it, or delete the folder",
                          files->folder);
}

bool server_files_open(struct server_files *files, const char *folder)
{
    struct stat facts;
    if (!set_folder(files, folder) || is_unfinished(files) || !make_layout(files) ||
        !lock_take(files, O_RDWR | O_CREAT))
        return false;
    /* earlier versions created databases with the permissions of the umask */
    struct server_listing listing = server_disk_list(folder);
    while (server_listing_next(&listing))
        if (lstat(listing.path, &facts) == 0 && S_ISREG(facts.st_mode) && (facts.st_mode & 077))
            (void)chmod(listing.path, 0600);
    return true;
}

bool server_files_find(struct server_files *files, const char *folder)
{
    if (!set_folder(files, folder)) return false;
    /* the slash after the name excludes files that are not folders */
    if (!server_disk_exists(server_files_path(files, "objects/").text) ||
        !server_disk_exists(server_files_path(files, "manifests/").text))
        return server_refuse(
            files->error,
            "there is no data folder at '%s': name one that a daemon or --backup has made", folder);
    return !is_unfinished(files);
}

bool server_files_open_existing(struct server_files *files, const char *folder)
{
    return server_files_find(files, folder) && lock_take(files, O_RDWR);
}

void server_files_close(struct server_files *files)
{
    if (files->lock >= 0) close(files->lock);
    if (files->held >= 0) close(files->held);
    files->lock = files->held = -1;
}

bool server_files_are_there(const struct server_files *files)
{
    static const char *const parts[] = {"objects", "manifests", SERVER_STORE_DATABASE};
    struct stat now, held;
    if (stat(files->folder, &now) != 0 || fstat(files->held, &held) != 0) return false;
    bool are_there = now.st_dev == held.st_dev && now.st_ino == held.st_ino;
    for (size_t i = 0; are_there && i < sizeof parts / sizeof *parts; i++)
        are_there = server_disk_exists(server_files_path(files, "%s", parts[i]).text);
    return are_there;
}

/* --- copies ----------------------------------------------------------------------------------- */

static bool mark_unfinished(const struct server_files *files, const char *path)
{
    int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0) return false;
    close(file);
    return !server_disk_sync_file(path) && !server_disk_sync_folder(files->folder);
}

/* Returns true if a folder contains data of a store. With `removes`, also removes all files except
 * objects, because an earlier attempt may have copied an earlier state or another backup. */
static bool has_data(const struct server_files *files, bool removes)
{
    static const struct {
        const char *folder, *beginning;
    } places[] = {{"manifests", ""},
                  {"temporary", ""},
                  {"", SERVER_STORE_DATABASE},
                  {"", SERVER_SQL_BATCHES},
                  {"objects", ""}};
    bool has_some = false;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        struct server_listing listing = server_files_list(files, places[i].folder);
        while (server_listing_next(&listing)) {
            size_t size = strlen(places[i].beginning);
            if (strncmp(listing.name, places[i].beginning, size) != 0) continue;
            has_some = true;
            if (removes) (void)unlink(listing.path);
        }
    }
    return has_some;
}

/* Creates the marker before the file `lock`, so that an interrupted copy is recognized. */
bool server_files_open_copy(struct server_files *files, const char *folder)
{
    if (!set_folder(files, folder)) return false;
    bool is_new = !is_unfinished(files);
    if (is_new && has_data(files, false))
        return server_refuse(files->error, "'%s' holds a data folder already: name a new one",
                             folder);
    const struct server_path path = server_files_path(files, UNFINISHED);
    if (make_path(folder) || !mark_unfinished(files, path.text))
        return files_refuse_path(files, path.text);
    if (!lock_take(files, O_RDWR | O_CREAT)) {
        if (is_new) (void)server_disk_remove(path.text);
        return false;
    }
    (void)has_data(files, true);
    if (make_layout(files)) return true;
    server_files_close(files);
    return false;
}

enum server_outcome server_files_finish(const struct server_files *files)
{
    enum server_outcome outcome = server_disk_sync_folder(files->folder);
    return outcome ? outcome : server_disk_remove(server_files_path(files, UNFINISHED).text);
}

/* --- objects ---------------------------------------------------------------------------------- */

enum server_outcome server_files_read_object(const struct server_files *files,
                                             const struct server_object *object, void **bytes)
{
    char found[SERVER_SHA256_HEX];
    size_t size;
    enum server_outcome outcome =
        server_disk_read(object_path(files, object->id).text, bytes, &size);
    if (outcome) return outcome;
    server_sha256(*bytes, size, found);
    if (size == object->size && strncmp(found, object->id, HASH) == 0) return SERVER_STORE_DONE;
    free(*bytes);
    *bytes = NULL;
    return SERVER_STORE_DAMAGED;
}

static bool has_object(const struct server_files *files, const struct server_object *object)
{
    void *bytes = NULL;
    enum server_outcome outcome = server_files_read_object(files, object, &bytes);
    free(bytes);
    return outcome == SERVER_STORE_DONE;
}

struct verification {
    struct server_sha256 *sum;
    uint64_t size;
    server_pace *pace;
    void *user;
    bool was_ended;
};

static bool verification_on_piece(void *user, const void *bytes, size_t size)
{
    struct verification *verification = user;
    server_sha256_add(verification->sum, bytes, size);
    verification->size += size;
    verification->was_ended = !verification->pace(verification->user, size);
    return !verification->was_ended;
}

enum server_outcome server_files_verify_object(const struct server_files *files,
                                               const struct server_object *object,
                                               server_pace *pace, void *user)
{
    char found[SERVER_SHA256_HEX];
    struct verification verification = {.sum = server_sha256_begin(), .pace = pace, .user = user};
    if (!verification.sum) return SERVER_STORE_UNAVAILABLE;
    enum server_outcome outcome =
        server_disk_scan(object_path(files, object->id).text, verification_on_piece, &verification);
    server_sha256_end(verification.sum, found);
    if (outcome == SERVER_STORE_NO_MEMORY || verification.was_ended)
        return SERVER_STORE_UNAVAILABLE;
    if (!outcome && (verification.size != object->size || strncmp(found, object->id, HASH) != 0))
        return SERVER_STORE_DAMAGED;
    return outcome;
}

static struct server_path object_folder(const struct server_files *files,
                                        const struct server_object *object)
{
    return server_files_path(files, "objects/%.2s", object->id);
}

enum server_outcome server_files_copy_object(const struct server_files *files,
                                             const struct server_files *from,
                                             const struct server_object *object,
                                             server_disk_copier *copy)
{
    const struct server_path folder = object_folder(files, object),
                             path = object_path(files, object->id);
    void *bytes = NULL;
    enum server_outcome outcome = server_disk_make_folder(folder.text);
    if (outcome) return outcome;
    bool is_there = has_object(files, object);
    /* an interrupted attempt may have left part of the file */
    if (!is_there) (void)unlink(path.text);
    outcome = is_there ? server_disk_sync_file(path.text)
                       : copy(object_path(from, object->id).text, path.text);
    if (!outcome) outcome = server_disk_sync_folder(folder.text);
    if (!outcome && !is_there) outcome = server_files_read_object(files, object, &bytes);
    free(bytes);
    return outcome;
}

static enum server_outcome store_file_write(struct server_files *files,
                                            const struct server_path *path, const void *bytes,
                                            size_t size)
{
    const struct server_path temporary = server_files_path(files, "temporary/%u", files->serial++);
    return server_disk_write(path->text, temporary.text, bytes, size);
}

enum server_outcome server_files_write_object(struct server_files *files,
                                              const struct server_object *object, const void *bytes)
{
    const struct server_path folder = object_folder(files, object),
                             path = object_path(files, object->id);
    enum server_outcome outcome = server_disk_make_folder(folder.text);
    if (outcome) return outcome;
    return has_object(files, object) ? server_disk_sync_folder(folder.text)
                                     : store_file_write(files, &path, bytes, (size_t)object->size);
}

void server_files_remove_object(const struct server_files *files, const char *object)
{
    /* if this fails, the next start removes the file */
    (void)unlink(object_path(files, object).text);
}

/* --- manifests -------------------------------------------------------------------------------- */

enum server_record_reading server_files_read_manifest(const struct server_files *files,
                                                      const char *key, struct server_record **out,
                                                      char sha256[SERVER_SHA256_HEX])
{
    void *text;
    size_t size;
    enum server_outcome outcome =
        server_disk_read(server_files_manifest_path(files, key).text, &text, &size);
    if (outcome)
        return outcome == SERVER_STORE_NO_MEMORY ? SERVER_RECORD_NO_MEMORY : SERVER_RECORD_DAMAGED;
    enum server_record_reading reading = server_record_read(key, text, size, out);
    server_sha256(text, size, sha256);
    free(text);
    return reading;
}

enum server_outcome server_files_write_manifest(struct server_files *files,
                                                const struct server_record *record)
{
    const struct server_path path = server_files_manifest_path(files, record->key),
                             aside = server_files_path(files, ASIDE);
    size_t size;
    char *text = server_record_write(record, &size);
    if (!text) return SERVER_STORE_NO_MEMORY;
    (void)unlink(aside.text);
    enum server_outcome outcome = server_disk_link(path.text, aside.text);
    if (!outcome || outcome == SERVER_STORE_ABSENT)
        outcome = store_file_write(files, &path, text, size);
    free(text);
    return outcome;
}

void server_files_settle_manifest(const struct server_files *files)
{
    (void)unlink(server_files_path(files, ASIDE).text);
}

enum server_outcome server_files_undo_manifest(const struct server_files *files, const char *key)
{
    const struct server_path path = server_files_manifest_path(files, key);
    if (rename(server_files_path(files, ASIDE).text, path.text) != 0)
        return server_disk_remove(path.text);
    return server_disk_sync_folder(server_files_path(files, "manifests").text);
}

enum server_outcome server_files_remove_manifest(const struct server_files *files, const char *key)
{
    enum server_outcome outcome = server_disk_remove(server_files_manifest_path(files, key).text);
    return outcome == SERVER_STORE_ABSENT ? SERVER_STORE_DONE : outcome;
}

/* --- ballast ---------------------------------------------------------------------------------- */

enum server_outcome server_files_load_ballast(struct server_files *files)
{
    const struct server_path path = server_files_path(files, "ballast");
    if (server_disk_exists(path.text)) return SERVER_STORE_DONE;
    void *zeros = calloc(1, BALLAST_BYTES);
    if (!zeros) return SERVER_STORE_NO_MEMORY;
    enum server_outcome outcome = store_file_write(files, &path, zeros, BALLAST_BYTES);
    free(zeros);
    return outcome;
}

bool server_files_drop_ballast(const struct server_files *files)
{
    return unlink(server_files_path(files, "ballast").text) == 0;
}
