/* Sandbox: limits what a daemon that was taken over can do. The daemon needs its data folder, the
 * files of keys and certificates, and the connections that come. All threads give up all else for
 * good, where the kernel has the means. No privilege is needed.
 *
 * DESIGN. Two steps, since the daemon needs more until it listens.
 *
 * server_sandbox_enter, before there is any thread and after the TCP port is bound: no new
 * privileges (an exec gains none by setuid), no capabilities (the daemon of root reads only files
 * that root may read by their mode), and Landlock (Linux 5.19; each thread inherits it): the data
 * folder                            all but what makes devices, sockets or links by name, or runs
 * programs folders of --keys, --tls-cert, --tls-key   reading, since SIGHUP reads them again, after
 * an exchange perhaps. Where a link stands, its folder and the one that it leads to folder of a
 * unix: socket                   making and removing sockets TCP (Linux 6.7) no further port; no
 * connection to anywhere, but to the ports of a database that --store names files of such a
 * database                   reading: certificates, passwords, what names are looked up in signals,
 * abstract sockets (Linux 6.12)     none to other processes
 *
 * server_sandbox_seal, once it listens: seccomp. The system calls of a daemon that runs are
 * allowed, some for some arguments only; others fail with ENOSYS, so that a library that tries a
 * new one falls back; those that only an intruder would make (exec, ptrace, mount, modules) end the
 * process. No new thread, process or, unless there is a database, socket; no memory that is
 * executable; no setuid bit; no change of mode, owner or times of a file; no signal, priority or
 * limit of another process. The filter can't see paths: stat(2) still finds out whether a file
 * exists. */
#ifndef SERVER_ACCESS_SANDBOX_H
#define SERVER_ACCESS_SANDBOX_H

#include <stdbool.h>

enum server_sandbox_mode { SERVER_SANDBOX_AUTO, SERVER_SANDBOX_OFF };

struct server_config;

struct server_sandbox {         /* why a part is off, a sentence; NULL: it is on */
    bool is_wanted;             /* false: nothing is on */
    bool connects;              /* to a database, now and later */
    const char *new_privileges; /* that none can be gained */
    const char *capabilities;   /* that there are none */
    const char *landlock, *seccomp;
};

/* Does nothing under --sandbox off, or in a build with AddressSanitizer or ThreadSanitizer, which
 * look about in /proc. Makes the data folder, if it can, since Landlock's rules are for what is
 * there. */
struct server_sandbox server_sandbox_enter(const struct server_config *config);

/* The second step; logs what is on, and why what is off is off. */
void server_sandbox_seal(struct server_sandbox *sandbox);

#endif
