/* See etag.h. */
#include "server/etag.h"

#include <string.h>

/* One tag of a list: `W/"text"` or `"text"`. */
struct tag {
    const char *text;
    size_t size;
    bool is_weak;
};

/* Reads the tag at the beginning of `*list` and advances past it; false where none can be read. */
static bool next_tag(const char **list, struct tag *out)
{
    const char *at = *list + strspn(*list, " \t,");
    out->is_weak = strncmp(at, "W/", 2) == 0;
    if (out->is_weak) at += 2;
    if (*at != '"') return false;
    const char *end = strchr(at + 1, '"');
    if (!end) return false;
    out->text = at + 1;
    out->size = (size_t)(end - out->text);
    *list = end + 1;
    return true;
}

bool server_etag_listed(const char *list, const char *tag, size_t size, enum server_etag_comparison comparison)
{
    struct tag listed;
    if (strcmp(list, "*") == 0) return true;
    while (next_tag(&list, &listed)) {
        if (listed.is_weak && comparison == SERVER_ETAG_STRONG) continue;
        if (listed.size == size && memcmp(listed.text, tag, size) == 0) return true;
    }
    return false;
}

static bool is_listed(const char *list, const char *etag, enum server_etag_comparison comparison)
{
    return etag && server_etag_listed(list, etag, strlen(etag), comparison);
}

bool server_precondition_holds(const struct server_precondition *precondition, const char *etag)
{
    if (precondition->if_match && !is_listed(precondition->if_match, etag, SERVER_ETAG_STRONG)) return false;
    return !(precondition->if_none_match && is_listed(precondition->if_none_match, etag, SERVER_ETAG_WEAK));
}
