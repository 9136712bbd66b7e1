/* Seccomp: the part of the sandbox that is about system calls. See sandbox.h. */
#ifndef SERVER_ACCESS_SECCOMP_H
#define SERVER_ACCESS_SECCOMP_H

#include <stdbool.h>

/* Restricts all threads of the process to the system calls that a running daemon makes, for good.
 * No new privileges must have been set, by the thread that started all others. NULL: done; else why
 * not, a sentence: nothing is restricted then. `connects`: to a database, at any time. */
const char *server_seccomp_seal(bool connects);

#endif
