/* Timekeeper: what happens by the clock. Answers the requests whose deadline passes while they
 * wait, in the queue or for somebody else's field; drops the jobs that nobody came back for; keeps
 * the streams of events going. */
#ifndef SERVER_WORK_DEADLINES_H
#define SERVER_WORK_DEADLINES_H

struct server;
struct server_timekeeper;

/* Starts its thread. NULL without memory or thread. The server is borrowed. */
struct server_timekeeper *server_timekeeper_create(struct server *server);

/* To be called when the first exchange is deferred, and when there is a job or a stream: the thread
 * sleeps while there is none. */
void server_timekeeper_wake(struct server_timekeeper *timekeeper);

/* Stops the thread and frees. NULL is harmless. */
void server_timekeeper_destroy(struct server_timekeeper *timekeeper);

#endif
