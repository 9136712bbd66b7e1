/* Preloader: the registry's thread. After the start it loads the surfaces that were used most, as
 * far as memory has room; from then on it tells the store every minute how often surfaces were
 * used. */
#ifndef SERVER_SURFACES_PRELOADER_H
#define SERVER_SURFACES_PRELOADER_H

struct server;
struct server_preloader;

/* Starts the thread. NULL without memory or thread. The server is borrowed. */
struct server_preloader *server_preloader_create(struct server *server);

/* Stops the thread, once the workers were cancelled, and frees. NULL is harmless. */
void server_preloader_destroy(struct server_preloader *preloader);

#endif
