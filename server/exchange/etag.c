#include "server/exchange/etag.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "server/base/sha256.h"
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

/* Reads the tag at the beginning of `*list` and advances past it. Returns false if there is no
 * valid tag. */
static bool tag_next(const char **list, struct tag *out)
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

static bool text_ends_with(const char *text, size_t size, const char *suffix)
{
    size_t length = strlen(suffix);
    return size > length && memcmp(text + size - length, suffix, length) == 0;
}

/* Returns whether the text has the form "-csv.1". */
static bool suffix_is_form(const char *text, size_t size)
{
    if (!text_ends_with(text, size, FORMAT_SUFFIX) || *text != '-') return false;
    size_t letters = size - 1 - strlen(FORMAT_SUFFIX);
    return letters && strspn(text + 1, FORM_CHARACTERS) == letters;
}

/* Returns whether the text has the form "-d0123456789abcdef.1". */
static bool suffix_is_caption(const char *text, size_t size)
{
    return suffix_is_form(text, size) && text[1] == 'd' &&
           size == 1 + SERVER_ETAG_CAPTION - 1 + strlen(FORMAT_SUFFIX);
}

/* Compares `etag` with a tag that the client listed. With `with_all`, the tag of any representation
 * of the resource matches. With `with_all`, if `etag` ends with "-" or with the form of a
 * description, tags of other descriptions do not match. */
static enum server_etag_form tag_compare(const struct tag *listed, const char *etag, bool with_all)
{
    bool is_packed = text_ends_with(listed->text, listed->size, SERVER_ETAG_PACKED_SUFFIX);
    size_t size = listed->size - (is_packed ? strlen(SERVER_ETAG_PACKED_SUFFIX) : 0);
    size_t expected = with_all ? strcspn(etag, "-") : strlen(etag);
    if (size < expected || memcmp(listed->text, etag, expected) != 0) return SERVER_ETAG_NONE;
    const char *form = listed->text + expected, *own = etag + expected;
    if (size > expected && !(with_all && suffix_is_form(form, size - expected)))
        return SERVER_ETAG_NONE;
    bool is_strict = strcmp(own, "-") == 0 || suffix_is_caption(own, strlen(own));
    if (with_all && is_strict && suffix_is_caption(form, size - expected) &&
        (strlen(etag) != size || memcmp(etag, listed->text, size) != 0))
        return SERVER_ETAG_NONE;
    return is_packed ? SERVER_ETAG_PACKED : SERVER_ETAG_PLAIN;
}

/* Returns whether the line is "*", which matches every existing resource. */
static bool line_is_any(const char *line)
{
    line += strspn(line, BLANKS);
    return *line == '*' && line[1 + strspn(line + 1, BLANKS)] == '\0';
}

/* Finds the first listed tag that matches the representation or, with `with_all`, the resource. The
 * comparison is strong or weak. A syntax error ends a line. */
static enum server_etag_form tags_find(const char *const *lines, const char *etag, bool is_weak,
                                       bool with_all)
{
    enum server_etag_form form = SERVER_ETAG_NONE;
    for (; etag && *lines && !form; lines++) {
        const char *line = *lines;
        struct tag listed;
        if (line_is_any(line)) form = SERVER_ETAG_PLAIN;
        while (!form && tag_next(&line, &listed))
            if (!listed.is_weak || is_weak) form = tag_compare(&listed, etag, with_all);
    }
    return form;
}

bool server_precondition_matches(const struct server_precondition *precondition, const char *etag)
{
    return !precondition->if_match[0] || tags_find(precondition->if_match, etag, false, true);
}

enum server_etag_form server_precondition_known(const struct server_precondition *precondition,
                                                const char *etag)
{
    return tags_find(precondition->if_none_match, etag, true, false);
}

bool server_precondition_holds(const struct server_precondition *precondition, const char *etag)
{
    return server_precondition_matches(precondition, etag) &&
           !tags_find(precondition->if_none_match, etag, true, true);
}

bool server_precondition_allows(const struct server_precondition *precondition, const char *etag,
                                const char *text)
{
    char tag[SERVER_ETAG_TEXT], caption[SERVER_ETAG_CAPTION];
    if (!etag) return server_precondition_holds(precondition, NULL);
    const char *form = server_etag_caption(caption, text);
    server_etag_write(tag, etag, form);
    if (!form) strcat(tag, "-");
    return server_precondition_holds(precondition, tag);
}

const char *server_etag_caption(char out[SERVER_ETAG_CAPTION], const char *text)
{
    char hex[SERVER_SHA256_HEX];
    if (!*text) return NULL;
    server_sha256(text, strlen(text), hex);
    snprintf(out, SERVER_ETAG_CAPTION, "d%.16s", hex);
    return out;
}

void server_etag_write(char out[SERVER_ETAG_TEXT], const char *etag, const char *form)
{
    const char *const parts[] = {etag, "-", form, FORMAT_SUFFIX};
    char *end = out + SERVER_ETAG_TEXT - 1;
    for (int i = 0; i < (form ? 4 : 1); i++) {
        size_t size = strnlen(parts[i], (size_t)(end - out));
        out = mempcpy(out, parts[i], size);
    }
    *out = '\0';
}

static void lines_collect(const struct server_exchange *exchange, const char *name,
                          const char **lines)
{
    for (uint32_t i = 0; i < exchange->header_count; i++)
        if (strcasecmp(exchange->headers[i].name, name) == 0) *lines++ = exchange->headers[i].value;
}

struct server_precondition server_precondition_read(const struct server_exchange *exchange)
{
    struct server_precondition precondition = {0};
    lines_collect(exchange, "If-Match", precondition.if_match);
    lines_collect(exchange, "If-None-Match", precondition.if_none_match);
    return precondition;
}
