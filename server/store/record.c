#include "server/store/record.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/base/thread.h"

#define TITLE          "geodesicd record "
#define VERSION        "3"
#define SECOND_VERSION "2" /* has no caption */
#define FIRST_VERSION  "1" /* this version also has no kind, tenant and attachment */
#define CHECKSUM_LINE  (sizeof "checksum \n" - 1 + SERVER_SHA256_HEX - 1)
#define SLOT_BYTES     128 /* bytes that the registry needs for each record */

/* --- life ------------------------------------------------------------------------------------- */

static void object_set(struct server_object *object, const char *sha256, uint64_t size,
                       const char *tenant)
{
    if (!sha256[0]) return;
    snprintf(object->id, sizeof object->id, "%s%s%s", sha256, tenant[0] ? "." : "", tenant);
    object->size = size;
}

/* Sets objects, key and ETag. The ETag omits absent parts, so that ETags of version 1 stay
 * valid. */
static void record_complete(struct server_record *record)
{
    const struct server_key key = server_record_key(record);
    char text[2 * SERVER_SHA256_HEX + SERVER_OPTIONS + SERVER_KEY_TEXT + 64],
        hex[SERVER_SHA256_HEX];
    bool has_attachment = record->attachment_sha256[0], is_mesh = record->kind == &server_kind_mesh;
    object_set(&record->objects[SERVER_PART_FILE], record->sha256, record->size, record->tenant);
    object_set(&record->objects[SERVER_PART_ATTACHMENT], record->attachment_sha256,
               record->attachment_size, record->tenant);
    server_key_write(&key, record->key);
    int size = snprintf(text, sizeof text, "%s %s%s%s%s%s%s%s", record->sha256, record->options,
                        has_attachment ? " attachment " : "", record->attachment_sha256,
                        is_mesh ? "" : " kind ", is_mesh ? "" : record->kind->word,
                        record->tenant[0] ? " tenant " : "", record->tenant);
    server_sha256(text, (size_t)size, hex);
    snprintf(record->etag, sizeof record->etag, "%.*s", SERVER_ETAG - 1, hex);
}

struct server_record *server_record_create(const struct server_origin *origin)
{
    struct server_record *record = calloc(1, sizeof *record);
    if (!record) return NULL;
    record->references = 1;
    record->kind = origin->key.kind;
    snprintf(record->tenant, sizeof record->tenant, "%s", origin->key.tenant);
    snprintf(record->name, sizeof record->name, "%s", origin->key.name);
    memcpy(record->sha256, origin->sha256, SERVER_SHA256_HEX);
    record->size = origin->size;
    snprintf(record->options, sizeof record->options, "%s", origin->options);
    if (origin->attachment_sha256) {
        memcpy(record->attachment_sha256, origin->attachment_sha256, SERVER_SHA256_HEX);
        record->attachment_size = origin->attachment_size;
    }
    record->created = time(NULL);
    record_complete(record);
    return record;
}

static size_t text_bytes(const char *text)
{
    return text ? strlen(text) + 1 : 0;
}

static size_t record_bytes(const struct server_record *record)
{
    const struct server_attached *attached = atomic_load(&record->attached);
    return sizeof *record + SLOT_BYTES + text_bytes(record->description) +
           text_bytes(record->caption) + (attached ? attached->bytes : 0);
}

bool server_record_take(struct server_record *record, struct server_budget *budget)
{
    if (record->budget) return true;
    if (!server_budget_take(budget, SERVER_BUDGET_RECORDS, record_bytes(record))) return false;
    record->budget = budget;
    return true;
}

void server_record_count(struct server_record *record, struct server_budget *budget)
{
    if (record->budget || !budget) return;
    server_budget_adjust(budget, SERVER_BUDGET_RECORDS, 0, record_bytes(record));
    record->budget = budget;
}

struct server_record *server_record_retain(struct server_record *record)
{
    atomic_fetch_add(&record->references, 1);
    return record;
}

void server_record_release(struct server_record *record)
{
    if (!record || atomic_fetch_sub(&record->references, 1) != 1) return;
    struct server_attached *attached = atomic_load(&record->attached);
    if (record->budget)
        server_budget_give(record->budget, SERVER_BUDGET_RECORDS, record_bytes(record));
    if (attached) attached->destroy(attached);
    free(record->description);
    free(record->caption);
    free(record);
}

/* --- caption ---------------------------------------------------------------------------------- */

/* protects the captions of all shared records */
static pthread_mutex_t caption_lock = PTHREAD_MUTEX_INITIALIZER;

struct server_record *server_record_copy(const struct server_record *record, const char *caption)
{
    const bool has_attachment = record->attachment_sha256[0];
    struct server_record *copy = server_record_create(&(struct server_origin){
        .key = server_record_key(record),
        .sha256 = record->sha256,
        .size = record->size,
        .options = record->options,
        .attachment_sha256 = has_attachment ? record->attachment_sha256 : NULL,
        .attachment_size = record->attachment_size});
    if (!copy) return NULL;
    copy->created = record->created;
    copy->memory = record->memory;
    copy->description = record->description ? strdup(record->description) : NULL;
    if ((copy->description || !record->description) && server_record_set_caption(copy, caption))
        return copy;
    server_record_release(copy);
    return NULL;
}

/* Under the lock: replaces the caption, and returns the former one. */
static char *caption_replace(struct server_record *record, char *caption)
{
    char *before = record->caption;
    record->caption = caption;
    if (record->budget)
        server_budget_adjust(record->budget, SERVER_BUDGET_RECORDS, text_bytes(before),
                             text_bytes(caption));
    return before;
}

bool server_record_set_caption(struct server_record *record, const char *caption)
{
    char *text = *caption ? strdup(caption) : NULL;
    if (*caption && !text) return false;
    SERVER_LOCK(&caption_lock);
    free(caption_replace(record, text));
    return true;
}

void server_record_caption(const struct server_record *record, char out[SERVER_CAPTION])
{
    SERVER_LOCK(&caption_lock);
    snprintf(out, SERVER_CAPTION, "%s", record->caption ? record->caption : "");
}

void server_record_exchange_captions(struct server_record *to, struct server_record *from)
{
    SERVER_LOCK(&caption_lock);
    (void)caption_replace(from, caption_replace(to, from->caption));
}

struct server_attached *server_record_attach(struct server_record *record,
                                             struct server_attached *made)
{
    struct server_attached *found = NULL;
    if (!atomic_compare_exchange_strong(&record->attached, &found, made)) {
        made->destroy(made);
        return found;
    }
    if (record->budget) server_budget_adjust(record->budget, SERVER_BUDGET_RECORDS, 0, made->bytes);
    return made;
}

struct server_key server_record_key(const struct server_record *record)
{
    return (struct server_key){
        .tenant = record->tenant, .kind = record->kind, .name = record->name};
}

bool server_record_equal(const struct server_record *a, const struct server_record *b)
{
    return strcmp(a->key, b->key) == 0 && strcmp(a->etag, b->etag) == 0;
}

bool server_record_is_same_upload(const struct server_record *a, const struct server_record *b)
{
    return server_record_equal(a, b) && a->created == b->created;
}

/* --- to text ---------------------------------------------------------------------------------- */

char *server_record_write(const struct server_record *record, size_t *size)
{
    char checksum[SERVER_SHA256_HEX], caption[SERVER_CAPTION], *text = NULL;
    FILE *out = open_memstream(&text, size);
    if (!out) return NULL;
    server_record_caption(record, caption);
    fprintf(out, TITLE "%s\nkind %s\ntenant %s\nname %s\nsha256 %s\nsize %" PRIu64,
            *caption ? VERSION : SECOND_VERSION, record->kind->word, record->tenant, record->name,
            record->sha256, record->size);
    fprintf(out, "\nattachment %s", record->attachment_sha256);
    if (record->attachment_sha256[0]) fprintf(out, " %" PRIu64, record->attachment_size);
    fprintf(out, "\ncreated %" PRId64 "\nmemory %" PRIu64 "\noptions %s\n", record->created,
            record->memory, record->options);
    if (*caption) fprintf(out, "caption %s\n", caption);
    fprintf(out, "description %s\n", record->description ? record->description : "{}");
    bool is_written = fflush(out) == 0 && !ferror(out);
    if (is_written) server_sha256(text, *size, checksum);
    if (is_written) is_written = fprintf(out, "checksum %s\n", checksum) > 0;
    if (fclose(out) == 0 && is_written) return text;
    free(text);
    return NULL;
}

/* --- from text -------------------------------------------------------------------------------- */

static bool has_checksum(const char *text, size_t size)
{
    char checksum[SERVER_SHA256_HEX], line[CHECKSUM_LINE + 1];
    if (size < CHECKSUM_LINE) return false;
    server_sha256(text, size - CHECKSUM_LINE, checksum);
    snprintf(line, sizeof line, "checksum %s\n", checksum);
    return memcmp(text + size - CHECKSUM_LINE, line, CHECKSUM_LINE) == 0;
}

/* Splits the next line off `*rest`. Returns the value of the line; NULL means that the line has
 * another name. */
static char *line_take(char **rest, const char *name)
{
    char *line = strsep(rest, "\n");
    size_t size = strlen(name);
    return line && strncmp(line, name, size) == 0 ? line + size : NULL;
}

static bool number_read(const char *text, uint64_t *out)
{
    char *end;
    if (!text) return false;
    long long number = strtoll(text, &end, 10);
    *out = (uint64_t)number;
    return end != text && !*end && number >= 0;
}

static bool hash_read(const char *text, char out[SERVER_SHA256_HEX])
{
    if (!text || !server_sha256_check(text) || text[SERVER_SHA256_HEX - 1]) return false;
    strcpy(out, text);
    return true;
}

static bool attachment_read(struct server_record *record, char *text)
{
    if (!text || !text[0]) return text != NULL;
    const char *sha256 = strsep(&text, " ");
    return hash_read(sha256, record->attachment_sha256) &&
           number_read(text, &record->attachment_size);
}

/* Reads the options. They are valid only in the form that their kind writes. */
static bool options_read(struct server_record *record, const char *text)
{
    struct server_options options;
    struct proto_problem problem;
    if (!text || !server_options_split(text, &options)) return false;
    return record->kind->read_options(&options.parameters, NULL, record->options, &problem) &&
           strcmp(record->options, text) == 0;
}

/* Reads a caption. An empty caption is not stored. */
static bool caption_read(struct server_record *record, const char *text)
{
    struct proto_problem problem;
    if (!text || !*text || !proto_caption_check(text, &problem)) return false;
    record->caption = strdup(text);
    return true;
}

static bool lines_read(struct server_record *record, char *rest, char version)
{
    uint64_t created = 0;
    struct proto_problem problem;
    const char *name = line_take(&rest, "name ");
    if (!name || !proto_mesh_name_check(name, strlen(name), &problem)) return false;
    strcpy(record->name, name);
    bool is_read =
        hash_read(line_take(&rest, "sha256 "), record->sha256) &&
        number_read(line_take(&rest, "size "), &record->size) &&
        (version == *FIRST_VERSION || attachment_read(record, line_take(&rest, "attachment "))) &&
        number_read(line_take(&rest, "created "), &created) &&
        number_read(line_take(&rest, "memory "), &record->memory) &&
        options_read(record, line_take(&rest, "options ")) &&
        (version != *VERSION || caption_read(record, line_take(&rest, "caption ")));
    const char *description = is_read ? line_take(&rest, "description ") : NULL;
    if (!description) return false;
    record->created = (int64_t)created;
    if (strlen(description) > SERVER_DESCRIPTION_USUAL && record->kind->shorten)
        record->description = record->kind->shorten(description);
    if (!record->description) record->description = strdup(description);
    record_complete(record);
    return true;
}

/* Reads all lines. Version 1 lacks kind and tenant. */
static enum server_record_reading text_read(struct server_record *record, char *text, char version)
{
    bool is_first = version == *FIRST_VERSION;
    (void)line_take(&text, TITLE);
    const char *word = is_first ? server_kind_mesh.word : line_take(&text, "kind "),
               *tenant = is_first ? "" : line_take(&text, "tenant ");
    if (!word || !tenant || (tenant[0] && !server_tenant_check(tenant)))
        return SERVER_RECORD_DAMAGED;
    record->kind = server_kind_by_word(word);
    strcpy(record->tenant, tenant);
    if (!record->kind) return SERVER_RECORD_NEWER;
    if (!lines_read(record, text, version)) return SERVER_RECORD_DAMAGED;
    bool is_whole = record->description && (record->caption || version != *VERSION);
    return is_whole ? SERVER_RECORD_READ : SERVER_RECORD_NO_MEMORY;
}

enum server_record_reading server_record_read(const char *key, const char *text, size_t size,
                                              struct server_record **out)
{
    const char *version = text + strlen(TITLE);
    if (size < sizeof TITLE VERSION "\n" || strncmp(text, TITLE, strlen(TITLE)) != 0 ||
        !has_checksum(text, size))
        return SERVER_RECORD_DAMAGED;
    if (version[1] != '\n' || !strchr(FIRST_VERSION SECOND_VERSION VERSION, *version))
        return SERVER_RECORD_NEWER;
    struct server_record *record = calloc(1, sizeof *record);
    char *copy = strndup(text, size);
    enum server_record_reading reading = SERVER_RECORD_NO_MEMORY;
    if (record) record->references = 1;
    if (record && copy) reading = text_read(record, copy, *version);
    free(copy);
    if (!reading && key && strcmp(record->key, key) != 0) reading = SERVER_RECORD_DAMAGED;
    if (reading == SERVER_RECORD_READ)
        *out = record;
    else
        server_record_release(record);
    return reading;
}
