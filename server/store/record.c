/* See record.h. */
#include "server/store/record.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/surfaces/catalogue.h"
#include "server/surfaces/kind.h"

#define TITLE         "geodesicd record "
#define VERSION       "2"
#define FIRST_VERSION "1" /* has no kinds, tenants, attachments */
#define HEX_DIGITS    "0123456789abcdef"
#define CHECKSUM_LINE (sizeof "checksum \n" - 1 + SERVER_SHA256_HEX - 1)
#define SLOT_BYTES    128 /* of the registry, for each */
#define ETAG_TEXT     (2 * SERVER_SHA256_HEX + SERVER_OPTIONS + SERVER_KEY_WORD + SERVER_TENANT + 64)

/* --- life ------------------------------------------------------------------------------------- */

/* What there is not is not named, so that the tags of version 1 are what they were. */
static void make_etag(struct server_record *record)
{
    char text[ETAG_TEXT], hex[SERVER_SHA256_HEX];
    int size = snprintf(text, sizeof text, "%s %s", record->sha256, record->options);
    if (record->attachment_sha256[0])
        size += snprintf(text + size, sizeof text - (size_t)size, " attachment %s",
                         record->attachment_sha256);
    if (record->kind != &server_kind_mesh)
        size += snprintf(text + size, sizeof text - (size_t)size, " kind %s", record->kind->word);
    if (record->tenant[0])
        size += snprintf(text + size, sizeof text - (size_t)size, " tenant %s", record->tenant);
    server_sha256(text, (size_t)size, hex);
    snprintf(record->etag, sizeof record->etag, "%.*s", SERVER_ETAG - 1, hex);
}

/* What follows from the rest. */
static void complete(struct server_record *record)
{
    const struct server_key key = server_record_key(record);
    server_key_write(&key, record->key);
    make_etag(record);
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
    complete(record);
    return record;
}

/* With what the registry has for it. */
static size_t bytes_of(const struct server_record *record)
{
    return sizeof *record + SLOT_BYTES +
           (record->description ? strlen(record->description) + 1 : 0);
}

bool server_record_take(struct server_record *record, struct server_budget *budget)
{
    if (record->budget) return true;
    if (!server_budget_take(budget, SERVER_BUDGET_RECORDS, bytes_of(record))) return false;
    record->budget = budget;
    return true;
}

void server_record_count(struct server_record *record, struct server_budget *budget)
{
    if (record->budget || !budget) return;
    server_budget_adjust(budget, SERVER_BUDGET_RECORDS, 0, bytes_of(record));
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
    size_t catalogue = atomic_load(&record->catalogue) ? SERVER_CATALOGUE_MEMSIZE : 0;
    if (record->budget)
        server_budget_give(record->budget, SERVER_BUDGET_RECORDS, bytes_of(record) + catalogue);
    server_catalogue_destroy(atomic_load(&record->catalogue));
    free(record->description);
    free(record);
}

struct server_key server_record_key(const struct server_record *record)
{
    return (struct server_key){
        .tenant = record->tenant, .kind = record->kind, .name = record->name};
}

struct server_catalogue *server_record_catalogue(struct server_record *record)
{
    struct server_catalogue *catalogue = atomic_load(&record->catalogue), *none = NULL;
    if (catalogue) return catalogue;
    catalogue = server_catalogue_create();
    if (!catalogue) return NULL;
    if (atomic_compare_exchange_strong(&record->catalogue, &none, catalogue)) {
        if (record->budget)
            server_budget_adjust(record->budget, SERVER_BUDGET_RECORDS, 0,
                                 SERVER_CATALOGUE_MEMSIZE);
        return catalogue;
    }
    server_catalogue_destroy(catalogue);
    return none; /* another was quicker */
}

bool server_record_equal(const struct server_record *a, const struct server_record *b)
{
    return strcmp(a->key, b->key) == 0 && strcmp(a->etag, b->etag) == 0;
}

bool server_record_object(const struct server_record *record, enum server_part part,
                          struct server_object *out)
{
    bool is_file = part == SERVER_PART_FILE;
    const char *sha256 = is_file ? record->sha256 : record->attachment_sha256;
    if (!sha256[0]) return false;
    snprintf(out->id, sizeof out->id, "%s%s%s", sha256, record->tenant[0] ? "." : "",
             record->tenant);
    out->size = is_file ? record->size : record->attachment_size;
    return true;
}

/* --- to text ---------------------------------------------------------------------------------- */

/* As snprintf: the bytes that the lines above the checksum have. */
static int print_lines(const struct server_record *record, char *text, size_t size)
{
    char attachment[SERVER_SHA256_HEX + 32] = "";
    if (record->attachment_sha256[0])
        snprintf(attachment, sizeof attachment, "%s %" PRIu64, record->attachment_sha256,
                 record->attachment_size);
    return snprintf(text, size,
                    TITLE VERSION "\nkind %s\ntenant %s\nname %s\nsha256 %s\nsize %" PRIu64
                                  "\nattachment %s\ncreated %" PRId64 "\nmemory %" PRIu64
                                  "\noptions %s\ndescription %s\n",
                    record->kind->word, record->tenant, record->name, record->sha256, record->size,
                    attachment, record->created, record->memory, record->options,
                    record->description ? record->description : "{}");
}

char *server_record_write(const struct server_record *record, size_t *size)
{
    char checksum[SERVER_SHA256_HEX], *text;
    int body = print_lines(record, NULL, 0);
    if (body < 0 || !(text = malloc((size_t)body + CHECKSUM_LINE + 1))) return NULL;
    print_lines(record, text, (size_t)body + 1);
    server_sha256(text, (size_t)body, checksum);
    sprintf(text + body, "checksum %s\n", checksum);
    *size = (size_t)body + CHECKSUM_LINE;
    return text;
}

/* --- from text -------------------------------------------------------------------------------- */

static bool is_whole(const char *text, size_t size)
{
    char checksum[SERVER_SHA256_HEX], line[CHECKSUM_LINE + 1];
    if (size < CHECKSUM_LINE) return false;
    server_sha256(text, size - CHECKSUM_LINE, checksum);
    snprintf(line, sizeof line, "checksum %s\n", checksum);
    return memcmp(text + size - CHECKSUM_LINE, line, CHECKSUM_LINE) == 0;
}

/* Ends the line at `*rest`, advances past it, and returns what stands behind its key; NULL when it
 * is another line. */
static char *next_line(char **rest, const char *key)
{
    char *line = strsep(rest, "\n");
    size_t size = strlen(key);
    return line && strncmp(line, key, size) == 0 ? line + size : NULL;
}

static bool read_number(const char *text, int64_t *out)
{
    char *end;
    if (!text) return false;
    *out = strtoll(text, &end, 10);
    return end != text && !*end && *out >= 0;
}

static bool read_size(const char *text, uint64_t *out)
{
    int64_t number;
    if (!read_number(text, &number)) return false;
    *out = (uint64_t)number;
    return true;
}

static bool read_hash(const char *text, char out[SERVER_SHA256_HEX])
{
    if (!text || strlen(text) != SERVER_SHA256_HEX - 1 || text[strspn(text, HEX_DIGITS)])
        return false;
    strcpy(out, text);
    return true;
}

/* The lines that version 2 begins with. */
static enum server_record_reading read_owner(struct server_record *record, char **rest)
{
    const char *word = next_line(rest, "kind "), *tenant = next_line(rest, "tenant ");
    if (!word || !tenant || (tenant[0] && !server_tenant_check(tenant)))
        return SERVER_RECORD_DAMAGED;
    record->kind = server_kind_by_word(word);
    strcpy(record->tenant, tenant);
    return record->kind ? SERVER_RECORD_READ : SERVER_RECORD_NEWER;
}

static bool read_name(struct server_record *record, const char *name)
{
    struct proto_problem problem;
    if (!name || !proto_mesh_name_check(name, strlen(name), &problem)) return false;
    strcpy(record->name, name);
    return true;
}

static bool read_attachment(struct server_record *record, char *text)
{
    if (!text || !text[0]) return text != NULL;
    const char *sha256 = strsep(&text, " ");
    return read_hash(sha256, record->attachment_sha256) &&
           read_size(text, &record->attachment_size);
}

/* Options count only if they are the text that their kind would write. */
static bool read_options(struct server_record *record, const char *text)
{
    struct server_options options;
    struct proto_problem problem;
    if (!text || !server_options_split(text, &options)) return false;
    const struct proto_parameters parameters = server_options_parameters(&options);
    return record->kind->read_options(&parameters, NULL, record->options, &problem) &&
           strcmp(record->options, text) == 0;
}

static bool read_lines(struct server_record *record, char *rest, bool is_first)
{
    if (!read_name(record, next_line(&rest, "name "))) return false;
    if (!read_hash(next_line(&rest, "sha256 "), record->sha256)) return false;
    if (!read_size(next_line(&rest, "size "), &record->size)) return false;
    if (!is_first && !read_attachment(record, next_line(&rest, "attachment "))) return false;
    if (!read_number(next_line(&rest, "created "), &record->created)) return false;
    if (!read_size(next_line(&rest, "memory "), &record->memory)) return false;
    if (!read_options(record, next_line(&rest, "options "))) return false;
    const char *description = next_line(&rest, "description ");
    if (!description) return false;
    bool is_long = strlen(description) > SERVER_DESCRIPTION_USUAL;
    if (is_long && record->kind->shorten) record->description = record->kind->shorten(description);
    if (!record->description) record->description = strdup(description);
    complete(record);
    return true;
}

static enum server_record_reading read_text(struct server_record *record, char *text, bool is_first)
{
    enum server_record_reading reading = SERVER_RECORD_READ;
    (void)next_line(&text, TITLE);
    if (is_first)
        record->kind = &server_kind_mesh;
    else
        reading = read_owner(record, &text);
    if (reading) return reading;
    if (!read_lines(record, text, is_first)) return SERVER_RECORD_DAMAGED;
    return record->description ? SERVER_RECORD_READ : SERVER_RECORD_NO_MEMORY;
}

static bool begins_with(const char *text, const char *beginning)
{
    return strncmp(text, beginning, strlen(beginning)) == 0;
}

enum server_record_reading server_record_read(const char *text, size_t size,
                                              struct server_record **out)
{
    static const char first[] = TITLE FIRST_VERSION "\n", second[] = TITLE VERSION "\n";
    if (size < sizeof first || !begins_with(text, TITLE) || !is_whole(text, size))
        return SERVER_RECORD_DAMAGED;
    bool is_first = begins_with(text, first);
    if (!is_first && !begins_with(text, second)) return SERVER_RECORD_NEWER;
    struct server_record *record = calloc(1, sizeof *record);
    char *copy = strndup(text, size);
    enum server_record_reading reading = SERVER_RECORD_NO_MEMORY;
    if (record) record->references = 1;
    if (record && copy) reading = read_text(record, copy, is_first);
    free(copy);
    if (reading == SERVER_RECORD_READ)
        *out = record;
    else
        server_record_release(record);
    return reading;
}

enum server_record_reading server_record_read_named(const char *key, const char *text, size_t size,
                                                    struct server_record **out)
{
    struct server_record *record = NULL;
    enum server_record_reading reading = server_record_read(text, size, &record);
    if (reading) return reading;
    if (strcmp(record->key, key) != 0) {
        server_record_release(record);
        return SERVER_RECORD_DAMAGED;
    }
    *out = record;
    return SERVER_RECORD_READ;
}
