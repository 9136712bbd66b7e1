/* Version: the version that --version, GET /v1 and the metrics show. */
#ifndef SERVER_BASE_VERSION_H
#define SERVER_BASE_VERSION_H

#define SERVER_VERSION "0.1.0"

#endif
