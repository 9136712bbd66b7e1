/* Version: the version that --version, GET /v1 and the metrics show. */
#pragma once

#define SERVER_VERSION "0.1.0"
