#include "proto/http/accept.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

/* Part of the header. */
struct span {
    const char *text;
    size_t size;
};

static struct span trimmed(struct span span)
{
    while (span.size > 0 && strchr(" \t", span.text[0])) span.text++, span.size--;
    while (span.size > 0 && strchr(" \t", span.text[span.size - 1])) span.size--;
    return span;
}

/* Removes the part before the first `separator`, and the separator, from the front of `*rest`.
 * Returns the part. */
static struct span next_part(struct span *rest, char separator)
{
    const char *found = memchr(rest->text, separator, rest->size);
    size_t size = found ? (size_t)(found - rest->text) : rest->size;
    struct span part = {rest->text, size};
    size_t taken = found ? size + 1 : size;
    rest->text += taken;
    rest->size -= taken;
    return trimmed(part);
}

static bool is_text(struct span span, const char *text, size_t size)
{
    return span.size == size && strncasecmp(span.text, text, size) == 0;
}

/* Returns how closely a range matches the type: 0 not at all, 1 for any type, 2 for any subtype, 3
 * exactly. */
static int closeness(struct span range, const char *media_type)
{
    size_t slash = strcspn(media_type, "/");
    if (is_text(range, "*/*", 3)) return 1;
    if (is_text(range, media_type, strlen(media_type))) return 3;
    bool any_subtype =
        range.size == slash + 2 && range.text[slash] == '/' && range.text[slash + 1] == '*';
    return any_subtype && strncasecmp(range.text, media_type, slash) == 0 ? 2 : 0;
}

/* Returns a weight in thousandths: 500 for "0.5". Malformed text gives 0, which means a refusal. */
static unsigned weight(struct span text)
{
    unsigned value = 0, digit = 1000;
    for (size_t i = 0; i < text.size && i < 5; i++) {
        if (i == 1 && text.text[i] == '.') continue;
        if (text.text[i] < '0' || text.text[i] > '9') return 0;
        value += digit * (unsigned)(text.text[i] - '0');
        digit /= 10;
    }
    return value < 1000 ? value : 1000;
}

static unsigned weight_among(struct span parameters)
{
    while (parameters.size > 0) {
        struct span parameter = next_part(&parameters, ';');
        if (parameter.size > 2 && strncasecmp(parameter.text, "q=", 2) == 0)
            return weight((struct span){parameter.text + 2, parameter.size - 2});
    }
    return 1000;
}

unsigned proto_accept_quality(const char *accept, const char *media_type)
{
    struct span rest = {accept, accept ? strlen(accept) : 0};
    if (trimmed(rest).size == 0) return 1000;
    int closest = 0;
    unsigned quality = 0;
    while (rest.size > 0) {
        struct span entry = next_part(&rest, ',');
        struct span range = next_part(&entry, ';');
        int close = closeness(range, media_type);
        if (close <= closest) continue;
        closest = close;
        quality = weight_among(entry);
    }
    return quality;
}

bool proto_accept_lists_coding(const char *accept, const char *coding)
{
    struct span rest = {accept, accept ? strlen(accept) : 0};
    while (rest.size > 0) {
        struct span entry = next_part(&rest, ',');
        struct span name = next_part(&entry, ';');
        if (is_text(name, coding, strlen(coding))) return weight_among(entry) > 0;
    }
    return false;
}
