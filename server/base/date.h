/* Date: the time as answers name it (RFC 9110, 5.6.7). */
#ifndef SERVER_BASE_DATE_H
#define SERVER_BASE_DATE_H

/* "Sun, 06 Nov 1994 08:49:37 GMT", now. The thread's own, valid until it asks again; taken apart
 * once a second. */
const char *server_date(void);

#endif
