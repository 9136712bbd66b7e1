/* See config_value.h. */
#include "server/config/config_value.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "server/config/config.h"

bool server_config_complain(const struct server_setting_loader *loader, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(loader->error, "geodesicd: %s: ", loader->origin);
    vfprintf(loader->error, format, arguments);
    fputc('\n', loader->error);
    va_end(arguments);
    return false;
}

static bool parse_unsigned(const char *text, uint64_t *out, const char **rest)
{
    char *end;
    if (!isdigit((unsigned char)*text)) return false;
    errno = 0;
    *out = strtoull(text, &end, 10);
    *rest = end;
    return errno == 0;
}

/* "4096", "64k", "512MiB", "4G", "4GiB": powers of 1024. */
static bool parse_bytes(const char *text, uint64_t *out)
{
    static const char units[] = "KMGT";
    const char *rest;
    if (!parse_unsigned(text, out, &rest)) return false;
    const char *unit = *rest ? strchr(units, toupper((unsigned char)*rest)) : NULL;
    if (unit) {
        unsigned shift = 10 * (unsigned)(unit - units + 1);
        if (*out > UINT64_MAX >> shift) return false;
        *out <<= shift;
        rest++;
        if (*rest == 'i')
            rest++;
        else if (*rest)
            return false;
    }
    return !*rest || (rest[0] == 'B' && !rest[1]);
}

static bool set_number(const struct server_setting_loader *loader,
                       const struct server_setting *option, const char *value, uint64_t *member)
{
    uint64_t number;
    const char *rest = "";
    bool parsed = option->kind == KIND_BYTES ? parse_bytes(value, &number)
                                             : parse_unsigned(value, &number, &rest) && !*rest;
    if (!parsed)
        return server_config_complain(
            loader,
            option->kind == KIND_BYTES
                ? "'%s' is no size; write a number of bytes or one like 512MiB, 4GiB"
                : "'%s' is no whole number",
            value);
    if (number < option->least || number > option->most)
        return server_config_complain(loader, "%s is outside %llu to %llu", value,
                                      (unsigned long long)option->least,
                                      (unsigned long long)option->most);
    *member = number;
    return true;
}

static bool set_address(const struct server_setting_loader *loader, const char *value,
                        struct server_address *member)
{
    char sentence[CONFIG_TEXT];
    return server_address_parse(value, member, sentence, sizeof sentence) ||
           server_config_complain(loader, "%s", sentence);
}

/* "https://maps.example:8443": what browsers send as Origin. */
static bool is_origin(const char *text)
{
    const char *authority = strstr(text, "://");
    if (!authority || (strncmp(text, "http://", 7) != 0 && strncmp(text, "https://", 8) != 0))
        return false;
    return authority[3] && !strpbrk(authority + 3, "/*@?#\t");
}

static bool check_name(const struct server_setting_loader *loader,
                       const struct server_setting *option, const char *name)
{
    if (strlen(name) >= SERVER_CONFIG_NAME)
        return server_config_complain(loader, "'%s' is too long", name);
    if (option->kind == KIND_ORIGIN)
        return is_origin(name) ||
               server_config_complain(
                   loader,
                   "'%s' is no origin; write scheme, host and port as in https://maps.example:8443",
                   name);
    return !strpbrk(name, "/\t") ||
           server_config_complain(
               loader, "'%s' is no host name; write it as in a URL, without scheme and path", name);
}

/* One name or several with commas between them. */
static bool add_names(const struct server_setting_loader *loader,
                      const struct server_setting *option, const char *value,
                      struct server_config_list *member)
{
    char list[CONFIG_TEXT], *rest;
    snprintf(list, sizeof list, "%s", value);
    for (char *name = strtok_r(list, ", ", &rest); name; name = strtok_r(NULL, ", ", &rest)) {
        if (!check_name(loader, option, name)) return false;
        if (member->count == SERVER_CONFIG_NAMES)
            return server_config_complain(loader, "at most %d can be listed", SERVER_CONFIG_NAMES);
        strcpy(member->name[member->count++], name);
    }
    return true;
}

static bool set_choice(const struct server_setting_loader *loader,
                       const struct server_setting *option, const char *value, unsigned *member)
{
    char list[CONFIG_TEXT] = "";
    for (unsigned i = 0; option->words[i]; i++) {
        if (strcmp(value, option->words[i]) == 0) {
            *member = i;
            return true;
        }
        const char *before = i == 0 ? "" : option->words[i + 1] ? ", " : " or ";
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", before, option->words[i]);
    }
    return server_config_complain(loader, "'%s' is none of the choices; write %s", value, list);
}

static bool set_path(const struct server_setting_loader *loader, const char *value, char *member)
{
    if (!*value || strlen(value) >= SERVER_CONFIG_PATH)
        return server_config_complain(loader, "a path has 1 to %d bytes", SERVER_CONFIG_PATH - 1);
    strcpy(member, value);
    for (size_t size = strlen(member); size > 1 && member[size - 1] == '/'; size--)
        member[size - 1] = '\0';
    return true;
}

/* What is no word is an address, and may hold a password: it is not repeated. */
static bool set_store(const struct server_setting_loader *loader, const char *value)
{
    struct server_config *config = loader->config;
    bool is_url =
        strncmp(value, "postgresql://", 13) == 0 || strncmp(value, "postgres://", 11) == 0;
    if (strlen(value) >= sizeof config->store_url)
        return server_config_complain(loader, "the address is too long");
    if (strcmp(value, "local") == 0)
        config->store = SERVER_STORE_KIND_LOCAL;
    else if (strcmp(value, "memory") == 0)
        config->store = SERVER_STORE_KIND_MEMORY;
    else if (is_url)
        config->store = SERVER_STORE_KIND_POSTGRES;
    else
        return server_config_complain(
            loader, "write local, memory, or an address postgresql://user@host/database");
    strcpy(config->store_url, is_url ? value : "");
    return true;
}

static bool set_boolean(const struct server_setting_loader *loader, const char *value, bool *member)
{
    *member = strcmp(value, "true") == 0;
    return *member || strcmp(value, "false") == 0 ||
           server_config_complain(loader, "write true or false");
}

bool server_config_set(const struct server_setting_loader *loader,
                       const struct server_setting *option, const char *value)
{
    void *member = (char *)loader->config + option->offset;
    switch (option->kind) {
    case KIND_COUNT:
    case KIND_BYTES:
        return set_number(loader, option, value, member);
    case KIND_ADDRESS:
        return set_address(loader, value, member);
    case KIND_HOST:
    case KIND_ORIGIN:
        return add_names(loader, option, value, member);
    case KIND_CHOICE:
        return set_choice(loader, option, value, member);
    case KIND_PATH:
        return set_path(loader, value, member);
    case KIND_STORE:
        return set_store(loader, value);
    case KIND_BOOLEAN:
        return set_boolean(loader, value, member);
    case KIND_FILE:
    case KIND_SWITCH:
        break; /* read before the others */
    }
    return true;
}
