/* See etag.h. */
#include "server/exchange/etag.h"

#include <string.h>
#include <strings.h>

#include "server/exchange/exchange.h"

#define BLANKS          " \t"
#define FORM_CHARACTERS "abcdefghijklmnopqrstuvwxyz0123456789"
#define FORMAT_SUFFIX   "." SERVER_FORMAT_VERSION

_Static_assert(SERVER_ETAG_LINES >= SERVER_EXCHANGE_HEADERS,
               "all headers of a request may be of one name");

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

static bool ends_with(const char *text, size_t size, const char *suffix)
{
    size_t length = strlen(suffix);
    return size > length && memcmp(text + size - length, suffix, length) == 0;
}

/* True for "-csv.1". */
static bool is_form(const char *text, size_t size)
{
    if (!ends_with(text, size, FORMAT_SUFFIX) || *text != '-') return false;
    size_t letters = size - 1 - strlen(FORMAT_SUFFIX);
    return letters && strspn(text + 1, FORM_CHARACTERS) == letters;
}

static enum server_etag_form compare(const struct tag *listed, const char *etag, bool with_all)
{
    bool is_packed = ends_with(listed->text, listed->size, SERVER_ETAG_PACKED_SUFFIX);
    size_t size = listed->size - (is_packed ? strlen(SERVER_ETAG_PACKED_SUFFIX) : 0);
    size_t expected = with_all ? strcspn(etag, "-") : strlen(etag);
    if (size < expected || memcmp(listed->text, etag, expected) != 0) return SERVER_ETAG_NONE;
    if (size > expected && !(with_all && is_form(listed->text + expected, size - expected)))
        return SERVER_ETAG_NONE;
    return is_packed ? SERVER_ETAG_PACKED : SERVER_ETAG_PLAIN;
}

/* True for a line "*", which matches every existing resource. */
static bool is_any(const char *line)
{
    line += strspn(line, BLANKS);
    return *line == '*' && line[1 + strspn(line + 1, BLANKS)] == '\0';
}

/* Finds the first tag of the representation, or with `with_all` of the resource, by strong or weak
 * comparison. A syntax error ends a line. */
static enum server_etag_form find(const char *const *lines, const char *etag, bool is_weak,
                                  bool with_all)
{
    enum server_etag_form form = SERVER_ETAG_NONE;
    for (; etag && *lines && !form; lines++) {
        const char *line = *lines;
        struct tag listed;
        if (is_any(line)) form = SERVER_ETAG_PLAIN;
        while (!form && next_tag(&line, &listed))
            if (!listed.is_weak || is_weak) form = compare(&listed, etag, with_all);
    }
    return form;
}

bool server_precondition_matches(const struct server_precondition *precondition, const char *etag)
{
    return !precondition->if_match[0] || find(precondition->if_match, etag, false, true);
}

enum server_etag_form server_precondition_known(const struct server_precondition *precondition,
                                                const char *etag)
{
    return find(precondition->if_none_match, etag, true, false);
}

bool server_precondition_holds(const struct server_precondition *precondition, const char *etag)
{
    return server_precondition_matches(precondition, etag) &&
           !find(precondition->if_none_match, etag, true, true);
}

void server_etag_write(char out[SERVER_ETAG_TEXT], const char *etag, const char *form)
{
    const char *const parts[] = {etag, "-", form, FORMAT_SUFFIX, NULL};
    const char *end = out + SERVER_ETAG_TEXT - 1;
    for (int i = 0; parts[i] && (i == 0 || form); i++)
        for (const char *c = parts[i]; *c && out < end;) *out++ = *c++;
    *out = '\0';
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
