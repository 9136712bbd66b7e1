/* See files.h. */
#include "server/store/local/files.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/store/sql.h"

#define BALLAST_BYTES ((size_t)1 << 20)
#define HEX_DIGITS    "0123456789abcdef"
#define HASH          (SERVER_SHA256_HEX - 1)
#define ASIDE         "temporary/aside" /* the manifest that is being replaced */
#define UNFINISHED    "unfinished"

enum server_store_outcome server_files_outcome(enum server_disk_result result)
{
    static const enum server_store_outcome outcomes[] = {
        [SERVER_DISK_DONE] = SERVER_STORE_DONE,
        [SERVER_DISK_ABSENT] = SERVER_STORE_ABSENT,
        [SERVER_DISK_FULL] = SERVER_STORE_FULL,
        [SERVER_DISK_REFUSED] = SERVER_STORE_REFUSED,
        [SERVER_DISK_LOST] = SERVER_STORE_READ_ONLY,
        [SERVER_DISK_NO_MEMORY] = SERVER_STORE_NO_MEMORY};
    return outcomes[result];
}

/* The outcome of writing a file: REFUSED if its folder is missing. */
static enum server_store_outcome write_outcome(enum server_disk_result result)
{
    return result == SERVER_DISK_ABSENT ? SERVER_STORE_REFUSED : server_files_outcome(result);
}

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

struct server_path server_files_object_path(const struct server_files *files, const char *object)
{
    return server_files_path(files, "objects/%.2s/%s", object, object);
}

static struct server_path manifest_path(const struct server_files *files, const char *key)
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
    const char *rest = file + strspn(file, HEX_DIGITS);
    return rest - file == HASH && (!*rest || (*rest == '.' && server_tenant_check(rest + 1)));
}

/* --- folders ---------------------------------------------------------------------------------- */

/* Creates the folder and those above it. */
static enum server_disk_result make_folders(const char *folder)
{
    char path[SERVER_STORE_FOLDER];
    enum server_disk_result result = SERVER_DISK_DONE;
    snprintf(path, sizeof path, "%s", folder);
    for (char *slash = path; !result && (slash = strchr(slash + 1, '/'));) {
        *slash = '\0';
        result = server_disk_make_folder(path);
        *slash = '/';
    }
    return result ? result : server_disk_make_folder(path);
}

/* Makes durable the names of the folders above. A process that was killed may have made one without
 * that. It can't have made one in a folder that it may not write to. */
static enum server_disk_result sync_path(const char *folder)
{
    char text[SERVER_STORE_FOLDER], *path = text;
    enum server_disk_result result = SERVER_DISK_DONE;
    snprintf(text, sizeof text, "%s", folder);
    do {
        path = dirname(path);
        if (access(path, W_OK) == 0) result = server_disk_sync_folder(path);
        if (result == SERVER_DISK_LOST && errno == EACCES)
            result = SERVER_DISK_DONE; /* out of reach in the sandbox (sandbox.h) */
    } while (!result && strcmp(path, "/") != 0 && strcmp(path, ".") != 0);
    return result;
}

/* Writes the sentence. Returns false. */
__attribute__((format(printf, 2, 3))) static bool refuse(struct server_files *files,
                                                         const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(files->error, sizeof files->error, format, arguments);
    va_end(arguments);
    return false;
}

static bool refuse_folder(struct server_files *files)
{
    return refuse(files,
                  "can't make the data folder '%s': %s; choose another --data-dir, or --store "
                  "memory",
                  files->folder, strerror(errno));
}

/* Creates the folders of the store and makes all their names durable. */
static bool make_layout(struct server_files *files)
{
    static const char *const folders[] = {"temporary", "manifests", "objects"};
    struct server_path path;
    enum server_disk_result result = make_folders(files->folder);
    for (size_t i = 0; !result && i < sizeof folders / sizeof *folders; i++) {
        path = server_files_path(files, "%s", folders[i]);
        result = server_disk_make_folder(path.text);
    }
    if (!result) result = sync_path(files->folder);
    if (!result) result = server_disk_sync_folder(files->folder);
    if (!result) result = server_disk_sync_folder(path.text);
    return !result || refuse_folder(files);
}

/* --- open ------------------------------------------------------------------------------------- */

static bool refuse_path(struct server_files *files, const char *path)
{
    return refuse(files, "can't open '%s': %s", path, strerror(errno));
}

static bool refuse_second(struct server_files *files)
{
    return refuse(files,
                  "the data folder '%s' is in use by another geodesicd: stop that one, or choose "
                  "another --data-dir",
                  files->folder);
}

/* Locks the folder, since a locked file can be removed, and the file, for earlier versions and
 * where folders can't be locked (NFS). */
static bool lock_both(struct server_files *files, int flags)
{
    const struct server_path path = server_files_path(files, "lock");
    files->held = open(files->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (files->held < 0) return refuse_path(files, files->folder);
    if (flock(files->held, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return refuse_second(files);
    files->lock = open(path.text, flags | O_CLOEXEC | O_NONBLOCK, 0600);
    /* without O_CREAT: a copy has no such file yet */
    if (files->lock < 0 && errno == ENOENT) return true;
    if (files->lock < 0) return refuse_path(files, path.text);
    return flock(files->lock, LOCK_EX | LOCK_NB) == 0 || refuse_second(files);
}

static bool lock_take(struct server_files *files, int flags)
{
    if (lock_both(files, flags)) return true;
    server_files_close(files);
    return false;
}

static bool set_folder(struct server_files *files, const char *folder)
{
    *files = (struct server_files){.held = -1, .lock = -1};
    if (strlen(folder) >= sizeof files->folder)
        return refuse(files, "the path of the data folder is longer than %d bytes",
                      SERVER_STORE_FOLDER - 1);
    strcpy(files->folder, folder);
    return true;
}

bool server_files_open(struct server_files *files, const char *folder)
{
    struct stat facts;
    if (!set_folder(files, folder) || server_files_is_unfinished(files) || !make_layout(files) ||
        !lock_take(files, O_RDWR | O_CREAT))
        return false;
    /* earlier versions made databases with the rights of umask */
    struct server_listing listing = server_disk_list(folder);
    while (server_listing_next(&listing))
        if (lstat(listing.path, &facts) == 0 && S_ISREG(facts.st_mode) && (facts.st_mode & 077))
            (void)chmod(listing.path, 0600);
    return true;
}

static bool is_folder(const char *path)
{
    struct stat facts;
    return stat(path, &facts) == 0 && S_ISDIR(facts.st_mode);
}

bool server_files_open_existing(struct server_files *files, const char *folder)
{
    if (!set_folder(files, folder)) return false;
    if (!is_folder(server_files_path(files, "objects").text) ||
        !is_folder(server_files_path(files, "manifests").text)) {
        return refuse(
            files, "there is no data folder at '%s': name one that a daemon or --backup has made",
            folder);
    }
    return !server_files_is_unfinished(files) && lock_take(files, O_RDWR);
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

bool server_files_is_unfinished(struct server_files *files)
{
    return server_disk_exists(server_files_path(files, UNFINISHED).text) &&
           !refuse(files,
                   "'%s' is an unfinished copy: run the --restore or --backup that began it again, "
                   "or delete the folder",
                   files->folder);
}

static bool has_data(const struct server_files *files)
{
    bool has_some = server_disk_exists(server_files_path(files, SERVER_STORE_DATABASE).text) ||
                    server_disk_exists(server_files_path(files, SERVER_SQL_BATCHES).text);
    struct server_listing objects = server_files_list(files, "objects"),
                          manifests = server_files_list(files, "manifests");
    while (server_listing_next(&objects)) has_some = true;
    while (server_listing_next(&manifests)) has_some = true;
    return has_some;
}

/* Removes the files in a folder whose names begin with a text. */
static void remove_files(const struct server_files *files, const char *folder,
                         const char *beginning)
{
    struct server_listing listing = server_files_list(files, folder);
    while (server_listing_next(&listing))
        if (strncmp(listing.name, beginning, strlen(beginning)) == 0) (void)unlink(listing.path);
}

/* Creates the marker, durably. */
static bool mark_unfinished(const struct server_files *files, const char *path)
{
    int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0) return false;
    close(file);
    return server_disk_sync_file(path) == SERVER_DISK_DONE &&
           server_disk_sync_folder(files->folder) == SERVER_DISK_DONE;
}

/* The marker comes before the lock's file, so that an interrupted copy is no empty folder. What an
 * earlier attempt left is deleted, since it may be of another moment or backup, except objects. */
bool server_files_open_copy(struct server_files *files, const char *folder)
{
    if (!set_folder(files, folder)) return false;
    if (make_folders(folder)) return refuse_folder(files);
    bool is_new = !server_files_is_unfinished(files);
    if (is_new && has_data(files))
        return refuse(files, "'%s' holds a data folder already: name a new one", folder);
    const struct server_path path = server_files_path(files, UNFINISHED);
    if (!mark_unfinished(files, path.text)) return refuse_path(files, path.text);
    if (!lock_take(files, O_RDWR | O_CREAT)) {
        if (is_new) (void)server_disk_remove(folder, path.text);
        return false;
    }
    remove_files(files, "manifests", "");
    remove_files(files, "temporary", "");
    remove_files(files, "", SERVER_STORE_DATABASE);
    remove_files(files, "", SERVER_SQL_BATCHES);
    if (make_layout(files)) return true;
    server_files_close(files);
    return false;
}

enum server_store_outcome server_files_finish(const struct server_files *files)
{
    enum server_disk_result result = server_disk_sync_folder(files->folder);
    if (!result)
        result = server_disk_remove(files->folder, server_files_path(files, UNFINISHED).text);
    return server_files_outcome(result);
}

/* --- objects ---------------------------------------------------------------------------------- */

enum server_store_outcome server_files_read_object(const struct server_files *files,
                                                   const struct server_object *object, void **bytes)
{
    char found[SERVER_SHA256_HEX];
    size_t size;
    void *read;
    enum server_disk_result result =
        server_disk_read(server_files_object_path(files, object->id).text, &read, &size);
    if (result) return server_files_outcome(result);
    server_sha256(read, size, found);
    if (size != object->size || strncmp(found, object->id, HASH) != 0) {
        free(read);
        return SERVER_STORE_DAMAGED;
    }
    *bytes = read;
    return SERVER_STORE_DONE;
}

bool server_files_has_object(const struct server_files *files, const struct server_object *object)
{
    void *bytes = NULL;
    enum server_store_outcome outcome = server_files_read_object(files, object, &bytes);
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

static bool on_piece(void *user, const void *bytes, size_t size)
{
    struct verification *verification = user;
    server_sha256_add(verification->sum, bytes, size);
    verification->size += size;
    verification->was_ended = !verification->pace(verification->user, size);
    return !verification->was_ended;
}

enum server_store_verdict server_files_verify_object(const struct server_files *files,
                                                     const struct server_object *object,
                                                     server_pace *pace, void *user)
{
    char found[SERVER_SHA256_HEX];
    struct verification verification = {.sum = server_sha256_begin(), .pace = pace, .user = user};
    if (!verification.sum) return SERVER_VERDICT_NONE;
    enum server_disk_result result =
        server_disk_scan(server_files_object_path(files, object->id).text, on_piece, &verification);
    server_sha256_end(verification.sum, found);
    if (result == SERVER_DISK_ABSENT) return SERVER_VERDICT_MISSING;
    if (result == SERVER_DISK_NO_MEMORY || verification.was_ended) return SERVER_VERDICT_NONE;
    if (result) return SERVER_VERDICT_UNREADABLE;
    return verification.size == object->size && strncmp(found, object->id, HASH) == 0
               ? SERVER_VERDICT_SOUND
               : SERVER_VERDICT_DAMAGED;
}

static struct server_path temporary_path(struct server_files *files)
{
    return server_files_path(files, "temporary/%u", files->serial++);
}

enum server_store_outcome server_files_write_object(struct server_files *files,
                                                    const struct server_object *object,
                                                    const void *bytes)
{
    const struct server_path folder = server_files_path(files, "objects/%.2s", object->id),
                             path = server_files_object_path(files, object->id),
                             temporary = temporary_path(files);
    enum server_disk_result result = server_disk_make_folder(folder.text);
    if (result) return write_outcome(result);
    result = server_files_has_object(files, object)
                 ? server_disk_sync_folder(folder.text)
                 : server_disk_write(folder.text, path.text, temporary.text, bytes,
                                     (size_t)object->size);
    return write_outcome(result);
}

void server_files_remove_object(const struct server_files *files, const char *object)
{
    /* the next start collects a file that stays */
    (void)server_disk_remove(NULL, server_files_object_path(files, object).text);
}

/* --- manifests -------------------------------------------------------------------------------- */

enum server_record_reading server_files_read_manifest(const struct server_files *files,
                                                      const char *key, struct server_record **out,
                                                      char sha256[SERVER_SHA256_HEX])
{
    void *text;
    size_t size;
    enum server_disk_result result = server_disk_read(manifest_path(files, key).text, &text, &size);
    if (result)
        return result == SERVER_DISK_NO_MEMORY ? SERVER_RECORD_NO_MEMORY : SERVER_RECORD_DAMAGED;
    enum server_record_reading reading = server_record_read(key, text, size, out);
    server_sha256(text, size, sha256);
    free(text);
    return reading;
}

enum server_store_outcome server_files_write_manifest(struct server_files *files,
                                                      const struct server_record *record)
{
    const struct server_path folder = server_files_path(files, "manifests"),
                             path = manifest_path(files, record->key),
                             temporary = temporary_path(files),
                             aside = server_files_path(files, ASIDE);
    size_t size;
    char *text = server_record_write(record, &size);
    if (!text) return SERVER_STORE_NO_MEMORY;
    server_files_settle_manifest(files);
    enum server_disk_result result = server_disk_link(path.text, aside.text);
    if (!result || result == SERVER_DISK_ABSENT)
        result = server_disk_write(folder.text, path.text, temporary.text, text, size);
    free(text);
    return write_outcome(result);
}

void server_files_settle_manifest(const struct server_files *files)
{
    (void)server_disk_remove(NULL, server_files_path(files, ASIDE).text);
}

enum server_store_outcome server_files_undo_manifest(const struct server_files *files,
                                                     const char *key)
{
    const struct server_path folder = server_files_path(files, "manifests"),
                             path = manifest_path(files, key),
                             aside = server_files_path(files, ASIDE);
    return server_files_outcome(rename(aside.text, path.text) == 0
                                    ? server_disk_sync_folder(folder.text)
                                    : server_disk_remove(folder.text, path.text));
}

enum server_store_outcome server_files_remove_manifest(const struct server_files *files,
                                                       const char *key)
{
    enum server_disk_result result = server_disk_remove(server_files_path(files, "manifests").text,
                                                        manifest_path(files, key).text);
    return result == SERVER_DISK_ABSENT ? SERVER_STORE_DONE : server_files_outcome(result);
}

/* --- ballast ---------------------------------------------------------------------------------- */

enum server_store_outcome server_files_load_ballast(struct server_files *files)
{
    const struct server_path path = server_files_path(files, "ballast"),
                             temporary = temporary_path(files);
    if (server_disk_exists(path.text)) return SERVER_STORE_DONE;
    void *zeros = calloc(1, BALLAST_BYTES);
    if (!zeros) return SERVER_STORE_NO_MEMORY;
    enum server_disk_result result =
        server_disk_write(files->folder, path.text, temporary.text, zeros, BALLAST_BYTES);
    free(zeros);
    return write_outcome(result);
}

bool server_files_drop_ballast(const struct server_files *files)
{
    return server_disk_remove(NULL, server_files_path(files, "ballast").text) == SERVER_DISK_DONE;
}
