#include "server/access/credentials.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/base/disk.h"

#define SECOND_NS     UINT64_C(1000000000)
#define LINE_MOST     512
#define BLANKS        " \t\r\n"
#define DIGITS        "0123456789"
#define NAME_BYTES    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz" DIGITS "._-"
#define DIGEST_PREFIX "sha256:"

/* --- a line ----------------------------------------------------------------------------------- */

bool server_credentials_is_name(const char *text)
{
    size_t size = strlen(text);
    return size > 0 && size < SERVER_CREDENTIAL_NAME && *text != '.' && *text != '-' &&
           strspn(text, NAME_BYTES) == size;
}

static bool time_parse(const char *text, int64_t *out)
{
    static const char *const forms[] = {"%Y-%m-%d", "%Y-%m-%dT%H:%M:%SZ"};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        struct tm utc = {0};
        const char *end = strptime(text, forms[i], &utc);
        if (!end || *end) continue;
        struct tm given = utc;
        *out = timegm(&utc);
        return utc.tm_mday == given.tm_mday && *out > 0; /* rejects days like 31 February */
    }
    return false;
}

static bool role_parse(const char *text, enum server_role *out)
{
    static const char *const names[] = {"read", "write", "operator"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(text, names[i]) == 0) {
            *out = (enum server_role)i;
            return true;
        }
    return false;
}

/* Marks a setting as given. Rejects unknown settings, and settings that are given twice. */
static bool setting_mark(struct server_credential *key, const char *setting,
                         char error[SERVER_ERROR])
{
    static const char *const names[] = {"role", "tenant", "expires", "rate", "concurrent"};
    unsigned bit = 1;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++, bit <<= 1) {
        if (strcmp(setting, names[i]) != 0) continue;
        if (key->given & bit)
            return server_refuse(error, "%s stands twice; write it once", setting);
        key->given |= bit;
        return true;
    }
    return server_refuse(
        error, "there is no setting '%s'; write role, tenant, expires, rate or concurrent",
        setting);
}

bool server_credentials_set(struct server_credential *key, char *setting, char error[SERVER_ERROR])
{
    char *value = strchr(setting, '=');
    if (!value)
        return server_refuse(
            error,
            "'%s' is not a setting; write role=, tenant=, expires=, rate= or concurrent=", setting);
    *value++ = '\0';
    if (!setting_mark(key, setting, error)) return false;
    if (strcmp(setting, "role") == 0)
        return role_parse(value, &key->role) ||
               server_refuse(error, "a role is read, write or operator");
    if (strcmp(setting, "tenant") == 0) {
        if (*value && !server_credentials_is_name(value))
            return server_refuse(
                error, "a tenant has 1 to 64 letters, digits, '_', '-' and '.', as a name");
        strcpy(key->tenant, value);
        return true;
    }
    if (strcmp(setting, "expires") == 0)
        return time_parse(value, &key->expires) ||
               server_refuse(error, "'%s' is not a time; write 2027-01-31 or 2027-01-31T12:00:00Z",
                             value);
    bool is_rate = strcmp(setting, "rate") == 0;
    uint32_t number = strlen(value) < 10 ? (uint32_t)strtoul(value, NULL, 10) : 0;
    *(is_rate ? &key->limits.rate : &key->limits.concurrent) = number;
    return (number >= 1 && number <= SERVER_LIMITS_MOST && !value[strspn(value, DIGITS)]) ||
           server_refuse(error, "%s is a number of requests %s, 1 to %u", setting,
                         is_rate ? "a second" : "at once", SERVER_LIMITS_MOST);
}

/* Parses a line. Messages never repeat a word of the line, because the word might be a key. */
static bool key_read(char *line, struct server_credential *out, char error[SERVER_ERROR])
{
    char *rest, *name = strtok_r(line, BLANKS, &rest), *digest = strtok_r(NULL, BLANKS, &rest);
    const size_t prefix = strlen(DIGEST_PREFIX);
    if (!server_credentials_is_name(name))
        return server_refuse(
            error, "a name has 1 to %d letters, digits, '_' or, not at its start, '-' and '.'",
            SERVER_CREDENTIAL_NAME - 1);
    strcpy(out->name, name);
    strcpy(out->tenant, name);
    if (!digest || strncmp(digest, DIGEST_PREFIX, prefix) != 0 ||
        !server_sha256_check(digest + prefix) || digest[prefix + SERVER_SHA256_HEX - 1])
        return server_refuse(
            error,
            "after the name write sha256: and 64 hexadecimal digits, as geodesicd keygen prints");
    strcpy(out->sha256, digest + prefix);
    for (char *word; (word = strtok_r(NULL, BLANKS, &rest));)
        if (!server_credentials_set(out, word, error)) return false;
    return true;
}

/* --- the file --------------------------------------------------------------------------------- */

static const struct server_credential *key_named(const struct server_credentials *keys,
                                                 const char *name)
{
    for (uint32_t i = 0; keys && i < keys->count; i++)
        if (strcmp(keys->keys[i].name, name) == 0) return &keys->keys[i];
    return NULL;
}

/* Adds a key, with the quota that its name had in the replaced set. */
static bool key_add(struct server_credentials *keys, const struct server_credential *key,
                    const struct server_credentials *before, char error[SERVER_ERROR])
{
    const struct server_credential *earlier = key_named(before, key->name);
    if (key_named(keys, key->name))
        return server_refuse(error, "the name '%s' stands twice; give each key its own name",
                             key->name);
    for (uint32_t i = 0; i < keys->count; i++)
        if (strcmp(keys->keys[i].sha256, key->sha256) == 0)
            return server_refuse(error, "'%s' and '%s' are the same key; remove one",
                                 keys->keys[i].name, key->name);
    if (keys->count == SERVER_CREDENTIALS_MOST)
        return server_refuse(error, "there are more than %d keys", SERVER_CREDENTIALS_MOST);
    struct server_credential *more = reallocarray(keys->keys, keys->count + 1, sizeof *more);
    if (more) keys->keys = more;
    struct server_quota *quota =
        earlier ? server_quota_retain(earlier->quota) : server_quota_create();
    if (!quota || !more) {
        server_quota_release(quota);
        return server_refuse(error, "the system is out of memory");
    }
    more[keys->count] = *key;
    more[keys->count++].quota = quota;
    return true;
}

static bool line_read(FILE *file, char line[LINE_MOST], struct server_credentials *keys,
                      const struct server_credentials *before, char error[SERVER_ERROR])
{
    struct server_credential key = {.role = SERVER_ROLE_READ};
    if (!strchr(line, '\n') && !feof(file)) return server_refuse(error, "the line is too long");
    line[strcspn(line, "#")] = '\0';
    return !line[strspn(line, BLANKS)] ||
           (key_read(line, &key, error) && key_add(keys, &key, before, error));
}

struct server_credentials *server_credentials_load(const char *path,
                                                   const struct server_credentials *before,
                                                   char error[SERVER_ERROR])
{
    struct server_credentials *keys = calloc(1, sizeof *keys);
    FILE *file = keys ? server_disk_stream(path) : NULL;
    char line[LINE_MOST], sentence[SERVER_ERROR];
    unsigned number = 0;
    bool is_read = true;
    if (!file) {
        snprintf(error, SERVER_ERROR, "the keys of '%s' can't be read: %s", path,
                 server_disk_why());
        free(keys);
        return NULL;
    }
    atomic_init(&keys->references, 1);
    while (is_read && fgets(line, sizeof line, file)) {
        number++;
        is_read = line_read(file, line, keys, before, sentence);
    }
    if (is_read && ferror(file))
        is_read = server_refuse(sentence, "it can't be read: %s", strerror(errno));
    if (is_read && keys->count == 0)
        is_read = server_refuse(sentence, "the file holds no key; geodesicd keygen makes one");
    fclose(file);
    if (is_read) return keys;
    (void)server_refuse(error, "%s:%u: %.256s", path, number, sentence);
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

/* Compares two digests. The time does not depend on the position where they differ. */
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

/* --- quotas ----------------------------------------------------------------------------------- */

struct server_quota *server_quota_create(void)
{
    struct server_quota *quota = calloc(1, sizeof *quota);
    if (quota) atomic_init(&quota->references, 1);
    return quota;
}

struct server_quota *server_quota_retain(struct server_quota *quota)
{
    atomic_fetch_add_explicit(&quota->references, 1, memory_order_relaxed);
    return quota;
}

void server_quota_release(struct server_quota *quota)
{
    if (quota && atomic_fetch_sub(&quota->references, 1) == 1) free(quota);
}

static bool place_take(struct server_quota *quota, uint32_t most)
{
    uint_least64_t entered = atomic_load(&quota->entered);
    do {
        if (most && entered >= most) return false;
    } while (!atomic_compare_exchange_weak(&quota->entered, &entered, entered + 1));
    return true;
}

/* Takes a token from the bucket. If the bucket is empty, returns false with the time to wait. */
static bool token_take(struct server_quota *quota, uint32_t rate, uint64_t now_ns,
                       uint64_t *wait_ns)
{
    const uint64_t interval = SECOND_NS / rate, depth = interval * rate;
    uint64_t full = atomic_load(&quota->full_ns), next;
    do {
        next = (full > now_ns ? full : now_ns) + interval;
        if (next - now_ns > depth) {
            *wait_ns = next - now_ns - depth;
            return false;
        }
    } while (!atomic_compare_exchange_weak(&quota->full_ns, &full, next));
    return true;
}

static enum server_quota_outcome quota_refuse(struct server_quota *quota,
                                              enum server_quota_outcome outcome)
{
    atomic_fetch_add_explicit(&quota->refusals[outcome], 1, memory_order_relaxed);
    return outcome;
}

enum server_quota_outcome server_quota_pass(struct server_quota *quota,
                                            const struct server_limits *limits, uint64_t now_ns,
                                            uint64_t *wait_ns)
{
    *wait_ns = 0;
    atomic_fetch_add_explicit(&quota->requests, 1, memory_order_relaxed);
    if (!limits->rate || token_take(quota, limits->rate, now_ns, wait_ns))
        return SERVER_QUOTA_ENTERED;
    return quota_refuse(quota, SERVER_QUOTA_RATE);
}

enum server_quota_outcome server_quota_enter(struct server_quota *quota,
                                             const struct server_limits *limits, uint64_t now_ns,
                                             uint64_t *wait_ns)
{
    *wait_ns = 0;
    /* checked first, so that a refused request uses no token */
    if (!place_take(quota, limits->concurrent)) {
        atomic_fetch_add_explicit(&quota->requests, 1, memory_order_relaxed);
        return quota_refuse(quota, SERVER_QUOTA_CONCURRENT);
    }
    enum server_quota_outcome outcome = server_quota_pass(quota, limits, now_ns, wait_ns);
    if (outcome != SERVER_QUOTA_ENTERED) server_quota_leave(quota);
    return outcome;
}

void server_quota_leave(struct server_quota *quota)
{
    atomic_fetch_sub(&quota->entered, 1);
}
