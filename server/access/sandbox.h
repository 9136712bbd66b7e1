/* Sandbox: limits the harm of an attacker who controls the daemon. The daemon permanently drops, in
 * all its threads, each right that it does not need. Dropping rights needs no privilege.
 *
 * DESIGN. The sandbox has two steps, because the daemon needs more rights until it listens.
 *
 * server_sandbox_enter runs before the first thread and after the TCP port is bound.
 * - No new privileges: setuid bits have no effect when a program is executed.
 * - No capabilities: a daemon that runs as root reads only files whose mode lets root read them.
 * - Landlock (Linux 5.19) restricts each thread to these actions:
 *   - in the data folder: all actions except making devices, sockets, FIFOs and symbolic links, and
 *     except running programs;
 *   - in the folders of files that SIGHUP reads again: reading. If such a file is a symbolic link,
 *     this includes the folder of its target;
 *   - in the folder of a unix socket: making and removing sockets;
 *   - in files that connections to a database need (certificates, passwords, files by which names
 *     are resolved): reading;
 *   - by TCP (Linux 6.7): connecting to the ports of a database, but not listening on more ports;
 *   - by signals and abstract sockets (Linux 6.12): reaching the process itself, but no other.
 *
 * server_sandbox_seal runs once the daemon listens. Seccomp allows the system calls of a running
 * daemon, some of them with certain arguments only. Other calls fail with ENOSYS. A library that
 * tries a newer call then uses an older one instead. Calls that only an attacker makes (exec,
 * ptrace, mount, modules) end the process. The daemon then can't create a thread, a process or
 * (without a database) a socket. It can't map executable memory, set a setuid bit, or change a
 * file's mode, owner or times. It can't change signals, priority or limits of another process. The
 * filter can't check paths, so stat(2) still shows whether a file exists. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "server/config/address.h"

/* The rights that the daemon keeps. NULL or "" means none. */
struct server_sandbox_needs {
    const char *folder;                   /* read and written; must exist */
    const char *files[3];                 /* SIGHUP rereads them; must exist */
    const struct server_address *address; /* where the daemon will listen */
    const char *database;                 /* address of a PostgreSQL database */
    /* Visit each port, or each file, that a connection to the database uses. Return false on
       failure. */
    bool (*each_port)(const char *database, bool (*visit)(void *user, uint16_t port), void *user);
    bool (*each_file)(const char *database, void (*visit)(void *user, const char *file),
                      void *user);
};

/* State of the sandbox. The strings are NULL, or static texts with the reason why that part is
 * off. */
struct server_sandbox {
    bool is_wanted; /* false if no part of the sandbox is on */
    bool connects;  /* the daemon may connect to a database at any time */
    const char *new_privileges, *capabilities, *landlock, *seccomp;
};

/* The first step. There is no sandbox if `needs` is NULL. There is none in builds with
 * AddressSanitizer or ThreadSanitizer either, because these read /proc. */
struct server_sandbox server_sandbox_enter(const struct server_sandbox_needs *needs);

/* The second step. Logs the parts that are on, and the reasons why others are off. */
void server_sandbox_seal(struct server_sandbox *sandbox);
