/* See store.h: what all back-ends share. */
#include "server/store.h"

#include <string.h>

/* A list of quoted tags, or "*". Tags here hold no commas or quotes, so a search for the quoted tag is exact. */
static bool names(const char *list, const char *etag)
{
    char quoted[SERVER_ETAG + 2] = "\"";
    if (strcmp(list, "*") == 0) return true;
    strncat(quoted, etag, SERVER_ETAG - 1);
    strcat(quoted, "\"");
    return strstr(list, quoted) != NULL;
}

bool server_precondition_holds(const struct server_precondition *precondition, const char *etag)
{
    if (precondition->if_match && !(etag && names(precondition->if_match, etag))) return false;
    return !(precondition->if_none_match && etag && names(precondition->if_none_match, etag));
}
