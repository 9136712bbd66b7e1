/* See record.h. */
#include "server/record.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gd/io.h"
#include "server/catalogue.h"

#define OPTIONS_TEXT  256
#define OPTIONS_MOST  8
#define TITLE         "geodesicd record "
#define VERSION       "1"
#define HEX_DIGITS    "0123456789abcdef"
#define CHECKSUM_LINE (sizeof "checksum \n" - 1 + SERVER_SHA256_HEX - 1)

/* --- options, as a query string ----------------------------------------------------------------------------------- */

/* The one text of these options: the entity tag is made from it. What is not asked for is not named, so that options
 * that are added leave the tags of others as they were. */
static void write_options(const struct proto_mesh_options *options, char text[OPTIONS_TEXT])
{
    const struct gd_mesh_options *build = &options->build;
    int size = snprintf(text, OPTIONS_TEXT, "format=%s&triangulate=%s%s", gd_format_name(options->format),
                        build->refuse_polygons ? "false" : "true", build->repair_split ? "&repair=split" : "");
    if (build->weld) snprintf(text + size, OPTIONS_TEXT - (size_t)size, "&weld=%.17g", build->weld_tolerance);
}

struct pairs {
    char text[OPTIONS_TEXT];
    char *names[OPTIONS_MOST], *values[OPTIONS_MOST];
    unsigned count;
};

static bool split_pairs(const char *text, struct pairs *pairs)
{
    pairs->count = 0;
    if (strlen(text) >= sizeof pairs->text) return false;
    strcpy(pairs->text, text);
    for (char *rest = pairs->text, *pair; (pair = strsep(&rest, "&"));) {
        char *equals = strchr(pair, '=');
        if (!equals || pairs->count == OPTIONS_MOST) return false;
        *equals = '\0';
        pairs->names[pairs->count] = pair;
        pairs->values[pairs->count++] = equals + 1;
    }
    return true;
}

static const char *pairs_get(void *user, const char *name)
{
    const struct pairs *pairs = user;
    for (unsigned i = 0; i < pairs->count; i++)
        if (strcmp(pairs->names[i], name) == 0) return pairs->values[i];
    return NULL;
}

static void pairs_each(void *user, bool (*visit)(void *context, const char *name), void *context)
{
    const struct pairs *pairs = user;
    for (unsigned i = 0; i < pairs->count; i++)
        if (!visit(context, pairs->names[i])) return;
}

static bool read_options(const char *text, struct proto_mesh_options *out)
{
    struct pairs pairs;
    struct proto_problem problem;
    if (!split_pairs(text, &pairs)) return false;
    const struct proto_parameters parameters = {.get = pairs_get, .each = pairs_each, .user = &pairs};
    return proto_mesh_options_parse(&parameters, out, &problem) && out->format != GD_FORMAT_ANY;
}

/* --- life --------------------------------------------------------------------------------------------------------- */

static void make_etag(struct server_record *record)
{
    char options[OPTIONS_TEXT], text[SERVER_SHA256_HEX + OPTIONS_TEXT], hex[SERVER_SHA256_HEX];
    write_options(&record->options, options);
    int size = snprintf(text, sizeof text, "%s %s", record->sha256, options);
    server_sha256(text, (size_t)size, hex);
    snprintf(record->etag, sizeof record->etag, "%.*s", SERVER_ETAG - 1, hex);
}

struct server_record *server_record_create(const char *name, const char sha256[SERVER_SHA256_HEX], size_t size,
                                           const struct proto_mesh_options *options)
{
    struct server_record *record = calloc(1, sizeof *record);
    if (!record) return NULL;
    record->references = 1;
    snprintf(record->name, sizeof record->name, "%s", name);
    memcpy(record->sha256, sha256, SERVER_SHA256_HEX);
    record->options = *options;
    record->size = size;
    record->created = time(NULL);
    make_etag(record);
    return record;
}

struct server_record *server_record_retain(struct server_record *record)
{
    atomic_fetch_add(&record->references, 1);
    return record;
}

void server_record_release(struct server_record *record)
{
    if (!record || atomic_fetch_sub(&record->references, 1) != 1) return;
    server_catalogue_destroy(atomic_load(&record->catalogue));
    free(record->description);
    free(record);
}

struct server_catalogue *server_record_catalogue(struct server_record *record)
{
    struct server_catalogue *catalogue = atomic_load(&record->catalogue), *none = NULL;
    if (catalogue) return catalogue;
    catalogue = server_catalogue_create();
    if (!catalogue || atomic_compare_exchange_strong(&record->catalogue, &none, catalogue)) return catalogue;
    server_catalogue_destroy(catalogue);
    return none; /* another was quicker */
}

bool server_record_equal(const struct server_record *a, const struct server_record *b)
{
    return strcmp(a->name, b->name) == 0 && strcmp(a->etag, b->etag) == 0;
}

/* --- to text ------------------------------------------------------------------------------------------------------ */

char *server_record_write(const struct server_record *record, size_t *size)
{
    static const char format[] = TITLE VERSION "\nname %s\nsha256 %s\nsize %" PRIu64 "\ncreated %" PRId64
                                               "\nmemory %" PRIu64 "\noptions %s\ndescription %s\n";
    char options[OPTIONS_TEXT], checksum[SERVER_SHA256_HEX], *text;
    const char *description = record->description ? record->description : "{}";
    write_options(&record->options, options);
    int body = snprintf(NULL, 0, format, record->name, record->sha256, record->size, record->created, record->memory,
                        options, description);
    if (body < 0 || !(text = malloc((size_t)body + CHECKSUM_LINE + 1))) return NULL;
    snprintf(text, (size_t)body + 1, format, record->name, record->sha256, record->size, record->created,
             record->memory, options, description);
    server_sha256(text, (size_t)body, checksum);
    sprintf(text + body, "checksum %s\n", checksum);
    *size = (size_t)body + CHECKSUM_LINE;
    return text;
}

/* --- from text ---------------------------------------------------------------------------------------------------- */

static bool is_whole(const char *text, size_t size)
{
    char checksum[SERVER_SHA256_HEX], line[CHECKSUM_LINE + 1];
    if (size < CHECKSUM_LINE) return false;
    server_sha256(text, size - CHECKSUM_LINE, checksum);
    snprintf(line, sizeof line, "checksum %s\n", checksum);
    return memcmp(text + size - CHECKSUM_LINE, line, CHECKSUM_LINE) == 0;
}

/* Ends the line at `*rest`, advances past it, and returns what stands behind its key; NULL when it is another line. */
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

static bool read_lines(struct server_record *record, char *text)
{
    struct proto_problem problem;
    int64_t size, memory;
    (void)next_line(&text, TITLE);
    const char *name = next_line(&text, "name "), *sha256 = next_line(&text, "sha256 ");
    if (!name || !proto_mesh_name_check(name, strlen(name), &problem)) return false;
    if (!sha256 || strlen(sha256) != SERVER_SHA256_HEX - 1 || sha256[strspn(sha256, HEX_DIGITS)]) return false;
    if (!read_number(next_line(&text, "size "), &size)) return false;
    if (!read_number(next_line(&text, "created "), &record->created)) return false;
    if (!read_number(next_line(&text, "memory "), &memory)) return false;
    const char *options = next_line(&text, "options "), *description = next_line(&text, "description ");
    if (!options || !read_options(options, &record->options) || !description) return false;
    strcpy(record->name, name);
    strcpy(record->sha256, sha256);
    record->size = (uint64_t)size;
    record->memory = (uint64_t)memory;
    record->description = strdup(description);
    make_etag(record);
    return true;
}

enum server_record_reading server_record_read(const char *text, size_t size, struct server_record **out)
{
    static const char title[] = TITLE, version[] = TITLE VERSION "\n";
    if (size < sizeof version || strncmp(text, title, strlen(title)) != 0 || !is_whole(text, size))
        return SERVER_RECORD_DAMAGED;
    if (strncmp(text, version, strlen(version)) != 0) return SERVER_RECORD_NEWER;
    struct server_record *record = calloc(1, sizeof *record);
    char *copy = strndup(text, size);
    enum server_record_reading reading = SERVER_RECORD_NO_MEMORY;
    if (record) record->references = 1;
    if (record && copy) {
        reading = !read_lines(record, copy) ? SERVER_RECORD_DAMAGED
                  : record->description     ? SERVER_RECORD_READ
                                            : SERVER_RECORD_NO_MEMORY;
    }
    free(copy);
    if (reading == SERVER_RECORD_READ)
        *out = record;
    else
        server_record_release(record);
    return reading;
}

enum server_record_reading server_record_read_named(const char *name, const char *text, size_t size,
                                                    struct server_record **out)
{
    struct server_record *record = NULL;
    enum server_record_reading reading = server_record_read(text, size, &record);
    if (reading) return reading;
    if (strcmp(record->name, name) != 0) {
        server_record_release(record);
        return SERVER_RECORD_DAMAGED;
    }
    *out = record;
    return SERVER_RECORD_READ;
}
