/* See key.h. */
#include "server/store/key.h"

#include <stdio.h>
#include <string.h>

#include "server/surfaces/kind.h"

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

/* Is this a part of a key, of at most `most` bytes? */
static bool is_part(const char *text, size_t size, size_t most)
{
    struct proto_problem problem;
    return size <= most && proto_mesh_name_check(text, size, &problem);
}

/* Cuts what stands before the mark off the text; false: it is no part of a key. */
static bool cut_part(const char **text, size_t *size, char mark, size_t most)
{
    const char *end = memchr(*text, mark, *size);
    if (!end) return true;
    size_t part = (size_t)(end - *text);
    if (!is_part(*text, part, most)) return false;
    *text += part + 1;
    *size -= part + 1;
    return true;
}

bool server_key_check(const char *text, size_t size)
{
    return cut_part(&text, &size, '@', SERVER_TENANT) &&
           cut_part(&text, &size, '+', SERVER_KEY_WORD) && is_part(text, size, PROTO_MESH_NAME);
}

bool server_key_read(char text[SERVER_KEY_TEXT], struct server_key *out)
{
    if (!server_key_check(text, strlen(text))) return false;
    char *tenant_end = strchr(text, '@'), *kind_end = strchr(text, '+');
    if (tenant_end) *tenant_end = '\0';
    if (kind_end) *kind_end = '\0';
    const char *word = kind_end ? (tenant_end ? tenant_end + 1 : text) : server_kind_mesh.word;
    out->tenant = tenant_end ? text : "";
    out->kind = server_kind_by_word(word);
    out->name = kind_end ? kind_end + 1 : tenant_end ? tenant_end + 1 : text;
    return out->kind != NULL;
}

bool server_tenant_check(const char *tenant)
{
    return is_part(tenant, strlen(tenant), SERVER_TENANT);
}
