/* See prefer.h. */
#include "server/exchange/prefer.h"

#include <string.h>
#include <strings.h>

#define SPACE " \t"

/* End of the element of a list that begins at `text`: the next comma that is not within quotes, or
 * the end. */
static const char *element_end(const char *text)
{
    bool is_quoted = false;
    for (; *text && (is_quoted || *text != ','); text++) {
        if (*text == '"') is_quoted = !is_quoted;
        if (*text == '\\' && is_quoted && text[1]) text++;
    }
    return text;
}

/* The element is the preference, with or without parameters. */
static bool is_preference(const char *element, const char *preference)
{
    size_t size = strlen(preference);
    element += strspn(element, SPACE);
    if (strncasecmp(element, preference, size) != 0) return false;
    element += size + strspn(element + size, SPACE);
    if (*element == '=') {
        element += 1 + strspn(element + 1, SPACE);
        if (strncmp(element, "\"\"", 2) == 0) element += 2;
        element += strspn(element, SPACE);
    }
    return *element == '\0' || *element == ',' || *element == ';';
}

static bool preference_lists(const char *list, const char *preference)
{
    for (const char *element = list;; element++) {
        if (is_preference(element, preference)) return true;
        element = element_end(element);
        if (!*element) return false;
    }
}

bool server_prefers(const struct server_exchange *exchange, const char *preference)
{
    for (uint32_t i = 0; i < exchange->header_count; i++) {
        const struct server_named_value *header = &exchange->headers[i];
        if (strcasecmp(header->name, "Prefer") == 0 && preference_lists(header->value, preference))
            return true;
    }
    return false;
}
