/* Keeper: the registry's thread. After the start it loads the surfaces that were used most, as far
 * as memory has room; from then on it tells the store every minute how often surfaces were used. */
#ifndef SERVER_SURFACES_PRELOADER_H
#define SERVER_SURFACES_PRELOADER_H

struct server;
struct server_keeper;

/* Starts the thread. NULL without memory or thread. The server is borrowed. */
struct server_keeper *server_keeper_create(struct server *server);

/* Stops the thread, once the workers were cancelled, and frees. NULL is harmless. */
void server_keeper_destroy(struct server_keeper *keeper);

#endif
