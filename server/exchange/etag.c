/* See etag.h. */
#include "server/exchange/etag.h"

#include <string.h>
#include <strings.h>

#include "server/exchange/exchange.h"

#define BLANKS " \t"

_Static_assert(SERVER_ETAG_LINES >= SERVER_EXCHANGE_HEADERS,
               "all headers of a request may be of one name");

enum comparison { STRONG, WEAK };

/* One tag of a list: `W/"text"` or `"text"`. */
struct tag {
    const char *text;
    size_t size;
    bool is_weak;
};

/* Reads the tag at the beginning of `*list` and advances past it; false where none can be read. */
static bool next_tag(const char **list, struct tag *out)
{
    const char *at = *list + strspn(*list, BLANKS ",");
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

static enum server_etag_form compare(const struct tag *listed, const char *etag)
{
    size_t size = strlen(etag);
    if (listed->size < size || memcmp(listed->text, etag, size) != 0) return SERVER_ETAG_NONE;
    if (listed->size == size) return SERVER_ETAG_PLAIN;
    bool is_packed =
        listed->size - size == strlen(SERVER_ETAG_PACKED_SUFFIX) &&
        memcmp(listed->text + size, SERVER_ETAG_PACKED_SUFFIX, listed->size - size) == 0;
    return is_packed ? SERVER_ETAG_PACKED : SERVER_ETAG_NONE;
}

/* Is the line "*", which any resource is like? */
static bool is_any(const char *line)
{
    line += strspn(line, BLANKS);
    return *line == '*' && line[1 + strspn(line + 1, BLANKS)] == '\0';
}

/* What can't be read ends a line. */
static enum server_etag_form find_in_line(const char *line, const char *etag,
                                          enum comparison comparison)
{
    struct tag listed;
    enum server_etag_form form = is_any(line) ? SERVER_ETAG_PLAIN : SERVER_ETAG_NONE;
    while (!form && next_tag(&line, &listed)) {
        if (!listed.is_weak || comparison == WEAK) form = compare(&listed, etag);
    }
    return form;
}

static enum server_etag_form find(const char *const *lines, const char *etag,
                                  enum comparison comparison)
{
    enum server_etag_form form = SERVER_ETAG_NONE;
    for (; etag && *lines && !form; lines++) form = find_in_line(*lines, etag, comparison);
    return form;
}

bool server_precondition_matches(const struct server_precondition *precondition, const char *etag)
{
    return !precondition->if_match[0] || find(precondition->if_match, etag, STRONG);
}

enum server_etag_form server_precondition_known(const struct server_precondition *precondition,
                                                const char *etag)
{
    return find(precondition->if_none_match, etag, WEAK);
}

bool server_precondition_holds(const struct server_precondition *precondition, const char *etag)
{
    return server_precondition_matches(precondition, etag) &&
           !server_precondition_known(precondition, etag);
}

static void collect(const struct server_exchange *exchange, const char *name, const char **lines)
{
    for (uint32_t i = 0; i < exchange->header_count; i++)
        if (strcasecmp(exchange->headers[i].name, name) == 0) *lines++ = exchange->headers[i].value;
}

struct server_precondition server_precondition_read(const struct server_exchange *exchange)
{
    struct server_precondition precondition = {0};
    collect(exchange, "If-Match", precondition.if_match);
    collect(exchange, "If-None-Match", precondition.if_none_match);
    return precondition;
}
