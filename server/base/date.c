/* See date.h. */
#include "server/base/date.h"

#include <time.h>

const char *server_date(void)
{
    static _Thread_local time_t known = -1;
    static _Thread_local char text[32];
    time_t now = time(NULL);
    struct tm utc;
    if (now == known || !gmtime_r(&now, &utc)) return text;
    strftime(text, sizeof text, "%a, %d %b %Y %H:%M:%S GMT", &utc);
    known = now;
    return text;
}
