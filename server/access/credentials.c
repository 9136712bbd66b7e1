/* See credentials.h. */
#include "server/access/credentials.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/base/disk.h"

#define LINE_MOST  512
#define BLANKS     " \t\r\n"
#define NAME_BYTES "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-"

/* --- the form of values ----------------------------------------------------------------------- */

bool server_credentials_is_name(const char *text)
{
    size_t size = strlen(text);
    return size > 0 && size < SERVER_CREDENTIAL_NAME && *text != '.' && *text != '-' &&
           strspn(text, NAME_BYTES) == size;
}

bool server_credentials_parse_time(const char *text, int64_t *out)
{
    static const char *const forms[] = {"%Y-%m-%d", "%Y-%m-%dT%H:%M:%SZ"};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        struct tm utc = {0};
        const char *end = strptime(text, forms[i], &utc);
        if (!end || *end) continue;
        struct tm given = utc;
        *out = timegm(&utc);
        return utc.tm_mday == given.tm_mday && *out > 0; /* no 31st of February */
    }
    return false;
}

static bool digest_parse(const char *text, char out[SERVER_SHA256_HEX])
{
    static const char prefix[] = "sha256:";
    if (strncmp(text, prefix, strlen(prefix)) != 0) return false;
    text += strlen(prefix);
    if (strlen(text) != SERVER_SHA256_HEX - 1 ||
        strspn(text, "0123456789abcdef") != SERVER_SHA256_HEX - 1)
        return false;
    memcpy(out, text, SERVER_SHA256_HEX);
    return true;
}

static bool count_parse(const char *text, uint32_t most, uint32_t *out)
{
    size_t digits = strspn(text, "0123456789");
    if (digits == 0 || digits > 9 || text[digits]) return false;
    *out = (uint32_t)strtoul(text, NULL, 10);
    return *out >= 1 && *out <= most;
}

bool server_credentials_parse_role(const char *text, enum server_role *out)
{
    static const char *const names[] = {"read", "write", "operator"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(text, names[i]) != 0) continue;
        *out = (enum server_role)i;
        return true;
    }
    return false;
}

/* --- the file --------------------------------------------------------------------------------- */

/* One reading of a file: the line, and the buffer for a complaint. */
struct reader {
    const char *path;
    unsigned line;
    char *error;
    size_t error_size;
};

__attribute__((format(printf, 2, 3))) static bool reader_complain(const struct reader *reader,
                                                                  const char *format, ...)
{
    int size = snprintf(reader->error, reader->error_size, "%s:%u: ", reader->path, reader->line);
    va_list arguments;
    if (size < 0 || (size_t)size >= reader->error_size) return false;
    va_start(arguments, format);
    vsnprintf(reader->error + size, reader->error_size - (size_t)size, format, arguments);
    va_end(arguments);
    return false;
}

/* "role=write" */
static bool setting_read(const struct reader *reader, char *word, struct server_credential *key)
{
    char *value = strchr(word, '=');
    if (!value)
        return reader_complain(
            reader,
            "'%s' is no setting; write role=, tenant=, expires=, rate= or concurrent=", word);
    *value++ = '\0';
    if (strcmp(word, "role") == 0)
        return server_credentials_parse_role(value, &key->role) ||
               reader_complain(reader, "a role is read, write or operator");
    if (strcmp(word, "tenant") == 0) {
        if (*value && !server_credentials_is_name(value))
            return reader_complain(reader, "a tenant has the form of a name");
        strcpy(key->tenant, value);
        return true;
    }
    if (strcmp(word, "expires") == 0)
        return server_credentials_parse_time(value, &key->expires) ||
               reader_complain(reader, "'%s' is no time; write 2027-01-31 or 2027-01-31T12:00:00Z",
                               value);
    if (strcmp(word, "rate") == 0)
        return count_parse(value, SERVER_LIMITS_RATE_MOST, &key->limits.rate) ||
               reader_complain(reader, "rate is a number of requests a second, 1 to %u",
                               SERVER_LIMITS_RATE_MOST);
    if (strcmp(word, "concurrent") == 0)
        return count_parse(value, SERVER_LIMITS_CONCURRENT_MOST, &key->limits.concurrent) ||
               reader_complain(reader, "concurrent is a number of requests at once, 1 to %u",
                               SERVER_LIMITS_CONCURRENT_MOST);
    return reader_complain(
        reader, "there is no setting '%s'; write role, tenant, expires, rate or concurrent", word);
}

/* A complaint never repeats a word that might be a key. */
static bool key_read(const struct reader *reader, char *line, struct server_credential *out)
{
    char *rest, *name = strtok_r(line, BLANKS, &rest), *digest = strtok_r(NULL, BLANKS, &rest);
    if (!server_credentials_is_name(name))
        return reader_complain(
            reader, "a name has 1 to %d letters, digits, '_' or, not at its start, '-' and '.'",
            SERVER_CREDENTIAL_NAME - 1);
    strcpy(out->name, name);
    strcpy(out->tenant, name);
    if (!digest || !digest_parse(digest, out->sha256))
        return reader_complain(
            reader,
            "after the name stands sha256: with 64 hexadecimal digits, as geodesicd keygen prints");
    for (char *word; (word = strtok_r(NULL, BLANKS, &rest));)
        if (!setting_read(reader, word, out)) return false;
    return true;
}

/* Makes room for one more key. */
static bool keys_reserve(struct server_credentials *keys)
{
    if (keys->count < keys->capacity) return true;
    uint32_t capacity = keys->capacity ? 2 * keys->capacity : 16;
    struct server_credential *more = realloc(keys->keys, capacity * sizeof *more);
    if (!more) return false;
    keys->keys = more;
    keys->capacity = capacity;
    return true;
}

static bool key_add(const struct reader *reader, struct server_credentials *keys,
                    const struct server_credential *key, const struct server_credentials *before)
{
    struct server_quota *quota = NULL;
    for (uint32_t i = 0; i < keys->count; i++) {
        if (strcmp(keys->keys[i].name, key->name) == 0)
            return reader_complain(reader, "the name '%s' stands twice", key->name);
        if (strcmp(keys->keys[i].sha256, key->sha256) == 0)
            return reader_complain(reader, "'%s' and '%s' are the same key", keys->keys[i].name,
                                   key->name);
    }
    if (keys->count == SERVER_CREDENTIALS_MOST)
        return reader_complain(reader, "there are more than %d keys", SERVER_CREDENTIALS_MOST);
    for (uint32_t i = 0; before && !quota && i < before->count; i++)
        if (strcmp(before->keys[i].name, key->name) == 0)
            quota = server_quota_retain(before->keys[i].quota);
    if (!quota) quota = server_quota_create();
    if (!quota || !keys_reserve(keys)) {
        server_quota_release(quota);
        return reader_complain(reader, "the system is out of memory");
    }
    keys->keys[keys->count] = *key;
    keys->keys[keys->count++].quota = quota;
    return true;
}

static bool keys_read(struct reader *reader, FILE *file, struct server_credentials *keys,
                      const struct server_credentials *before)
{
    char line[LINE_MOST];
    while (fgets(line, sizeof line, file)) {
        struct server_credential key = {.role = SERVER_ROLE_READ};
        reader->line++;
        if (!strchr(line, '\n') && !feof(file))
            return reader_complain(reader, "the line is too long");
        line[strcspn(line, "#")] = '\0';
        if (!line[strspn(line, BLANKS)]) continue;
        if (!key_read(reader, line, &key) || !key_add(reader, keys, &key, before)) return false;
    }
    if (ferror(file)) return reader_complain(reader, "it can't be read: %s", strerror(errno));
    return keys->count > 0 ||
           reader_complain(reader, "the file holds no key; geodesicd keygen makes one");
}

struct server_credentials *server_credentials_load(const char *path,
                                                   const struct server_credentials *before,
                                                   char *error, size_t error_size)
{
    struct reader reader = {.path = path, .error = error, .error_size = error_size};
    struct server_credentials *keys = calloc(1, sizeof *keys);
    int descriptor = keys ? server_disk_open(path) : -1;
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "r");
    if (!file) {
        snprintf(error, error_size, "the keys of '%s' can't be read: %s", path, server_disk_why());
        if (descriptor >= 0) close(descriptor);
        free(keys);
        return NULL;
    }
    atomic_init(&keys->references, 1);
    bool ok = keys_read(&reader, file, keys, before);
    fclose(file);
    if (ok) return keys;
    server_credentials_release(keys);
    return NULL;
}

/* --- the set ---------------------------------------------------------------------------------- */

struct server_credentials *server_credentials_retain(struct server_credentials *keys)
{
    atomic_fetch_add_explicit(&keys->references, 1, memory_order_relaxed);
    return keys;
}

void server_credentials_release(struct server_credentials *keys)
{
    if (!keys || atomic_fetch_sub(&keys->references, 1) != 1) return;
    for (uint32_t i = 0; i < keys->count; i++) server_quota_release(keys->keys[i].quota);
    free(keys->keys);
    free(keys);
}

/* Compares all bytes, whatever the first difference. */
static bool digests_match(const char a[SERVER_SHA256_HEX], const char b[SERVER_SHA256_HEX])
{
    volatile unsigned char difference = 0;
    for (int i = 0; i < SERVER_SHA256_HEX; i++) difference |= (unsigned char)(a[i] ^ b[i]);
    return difference == 0;
}

const struct server_credential *server_credentials_find(const struct server_credentials *keys,
                                                        const char *text, size_t size)
{
    char sha256[SERVER_SHA256_HEX];
    const struct server_credential *found = NULL;
    server_sha256(text, size, sha256);
    for (uint32_t i = 0; i < keys->count; i++)
        if (digests_match(keys->keys[i].sha256, sha256)) found = &keys->keys[i];
    return found;
}
