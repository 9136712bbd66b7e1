/* Gauges: the state of the daemon's parts, as text for Prometheus (version 0.0.4). */
#ifndef SERVER_GAUGES_H
#define SERVER_GAUGES_H

#include "proto/writer.h"

/* Appends the numbers of a tenant: its keys and jobs. `tenant` NULL: the numbers of the whole
 * daemon. `user` is the struct server. */
void server_gauges_write(void *user, const char *tenant, struct proto_writer *writer);

#endif
