/* Preloader: a thread that loads the most used surfaces after the start, as far as memory has room,
 * and then stores every minute how often surfaces were used. */
#ifndef SERVER_SURFACES_PRELOADER_H
#define SERVER_SURFACES_PRELOADER_H

struct server_loader;
struct server_pending_loads;
struct server_preloader;

/* Starts the thread; both are borrowed. NULL without memory or thread. */
struct server_preloader *server_preloader_create(const struct server_loader *loader,
                                                 struct server_pending_loads *pending_loads);

/* Stops the thread, after the workers were cancelled. NULL is harmless. */
void server_preloader_destroy(struct server_preloader *preloader);

#endif
