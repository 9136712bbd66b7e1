/* Address of a PostgreSQL database: what the sandbox has to allow for a connection. */
#ifndef SERVER_STORE_POSTGRES_ADDRESS_H
#define SERVER_STORE_POSTGRES_ADDRESS_H

#include <stdbool.h>
#include <stdint.h>

/* Visits each port that the address or the environment names, or 5432. `visit` returns false to end
 * it. False: it was ended, or the address is malformed. */
bool server_postgres_each_port(const char *url, bool (*visit)(void *user, uint16_t port),
                               void *user);

/* Visits each file that libpq may read: certificates, keys, passwords. False: the address is
 * malformed. */
bool server_postgres_each_file(const char *url, void (*visit)(void *user, const char *file),
                               void *user);

#endif
