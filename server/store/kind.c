#include "server/store/kind.h"

#include <stdio.h>
#include <string.h>

const struct server_kind *server_kind_by_word(const char *word)
{
    for (size_t i = 0; server_kinds[i]; i++)
        if (strcmp(server_kinds[i]->word, word) == 0) return server_kinds[i];
    return NULL;
}

const struct server_kind *server_kind_by_plural(const char *plural)
{
    for (size_t i = 0; server_kinds[i]; i++)
        if (strcmp(server_kinds[i]->plural, plural) == 0) return server_kinds[i];
    return NULL;
}

bool server_options_split(const char *text, struct server_options *out)
{
    uint32_t count = 0;
    if (strlen(text) >= sizeof out->text) return false;
    strcpy(out->text, text);
    for (char *rest = out->text, *pair; (pair = strsep(&rest, "&"));) {
        char *equals = strchr(pair, '=');
        if (!equals || count == SERVER_OPTIONS_MOST) return false;
        *equals = '\0';
        out->pairs[count++] = (struct proto_parameter){pair, equals + 1};
    }
    out->parameters = (struct proto_parameters){out->pairs, count};
    return true;
}

/* --- keys ------------------------------------------------------------------------------------- */

int server_key_compare(const struct server_key *a, const struct server_key *b)
{
    int order = strcmp(a->tenant, b->tenant);
    if (!order && a->kind != b->kind) order = strcmp(a->kind->word, b->kind->word);
    return order ? order : strcmp(a->name, b->name);
}

void server_key_write(const struct server_key *key, char text[SERVER_KEY_TEXT])
{
    bool is_mesh = key->kind == &server_kind_mesh;
    snprintf(text, SERVER_KEY_TEXT, "%s%s%s%s%s", key->tenant, key->tenant[0] ? "@" : "",
             is_mesh ? "" : key->kind->word, is_mesh ? "" : "+", key->name);
}

static bool part_check(const char *text, size_t size, size_t most)
{
    struct proto_problem problem;
    return size <= most && proto_mesh_name_check(text, size, &problem);
}

/* Skips the part before `mark`, if there is one. Returns false if the part is malformed. */
static bool part_skip(const char **text, size_t *size, char mark, size_t most)
{
    const char *end = memchr(*text, mark, *size);
    if (!end) return true;
    size_t part = (size_t)(end - *text);
    if (!part_check(*text, part, most)) return false;
    *text += part + 1;
    *size -= part + 1;
    return true;
}

bool server_key_check(const char *text, size_t size)
{
    return part_skip(&text, &size, '@', SERVER_TENANT) &&
           part_skip(&text, &size, '+', SERVER_KEY_WORD) && part_check(text, size, PROTO_MESH_NAME);
}

bool server_key_read(char text[SERVER_KEY_TEXT], struct server_key *out)
{
    if (!server_key_check(text, strlen(text))) return false;
    char *name = text;
    out->tenant = strchr(text, '@') ? strsep(&name, "@") : "";
    out->kind = strchr(name, '+') ? server_kind_by_word(strsep(&name, "+")) : &server_kind_mesh;
    out->name = name;
    return out->kind != NULL;
}

bool server_tenant_check(const char *tenant)
{
    return part_check(tenant, strlen(tenant), SERVER_TENANT);
}
