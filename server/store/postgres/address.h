/* Address: what the sandbox has to leave open so that a PostgreSQL database can be connected to. */
#ifndef SERVER_STORE_POSTGRES_ADDRESS_H
#define SERVER_STORE_POSTGRES_ADDRESS_H

#include <stdbool.h>
#include <stdint.h>

/* Tells of each port that the address, or the environment, names; 5432 where they name none. False:
 * it can't be read. */
bool server_postgres_each_port(const char *url, bool (*visit)(void *user, uint16_t port),
                               void *user);

/* Tells of each file that libpq may read: certificates and keys, the file of passwords. False: the
 * address can't be read. */
bool server_postgres_each_file(const char *url, void (*visit)(void *user, const char *file),
                               void *user);

#endif
