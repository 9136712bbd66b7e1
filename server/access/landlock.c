/* See landlock.h. The kernel's interface is in its Documentation/userspace-api/landlock.rst; what
 * headers of Debian 12 lack is defined here. */
#include "server/access/landlock.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include "server/config/config.h"
#include "server/store/postgres/address.h"
#include "server/store/local/files.h"

/* Numbers of the system calls: the same on all machines. */
#define CREATE_RULESET 444
#define ADD_RULE       445
#define RESTRICT_SELF  446

#define WANT_VERSION 1u
#define RULE_PATH    1
#define RULE_PORT    2

/* Rights to files, each with the version of the interface that brought it. */
#define WRITE_FILE  (UINT64_C(1) << 1)
#define READ_FILE   (UINT64_C(1) << 2)
#define READ_FOLDER (UINT64_C(1) << 3)
#define REMOVE_DIR  (UINT64_C(1) << 4)
#define REMOVE_FILE (UINT64_C(1) << 5)
#define MAKE_DIR    (UINT64_C(1) << 7)
#define MAKE_FILE   (UINT64_C(1) << 8)
#define MAKE_SOCKET (UINT64_C(1) << 9)
/* 2: links and renames from folder to folder, which the store lives by */
#define REFER    (UINT64_C(1) << 13)
#define TRUNCATE (UINT64_C(1) << 14) /* 3 */
#define ALL_OF_2 ((UINT64_C(1) << 14) - 1)
#define ALL_OF_3 ((UINT64_C(1) << 15) - 1)
#define ALL_OF_5 ((UINT64_C(1) << 16) - 1)

#define READING (READ_FILE | READ_FOLDER)
#define STORING                                                                                    \
    (READING | WRITE_FILE | REMOVE_DIR | REMOVE_FILE | MAKE_DIR | MAKE_FILE | REFER | TRUNCATE)

#define BIND_TCP    UINT64_C(1) /* 4, as the next; never allowed, since the port is bound before */
#define CONNECT_TCP UINT64_C(2)
#define ALL_SCOPES  UINT64_C(3) /* 6: abstract unix sockets, signals */

struct ruleset {
    uint64_t files, ports, scopes; /* what is forbidden unless a rule allows it */
};

struct path_rule {
    uint64_t allowed;
    int32_t folder;
} __attribute__((packed));

struct port_rule {
    uint64_t allowed, port;
};

/* What the kernel knows of, by its version of the interface. */
static size_t describe(long version, struct ruleset *ruleset)
{
    *ruleset = (struct ruleset){.files = version >= 5   ? ALL_OF_5
                                         : version >= 3 ? ALL_OF_3
                                                        : ALL_OF_2};
    if (version < 4) return offsetof(struct ruleset, ports);
    ruleset->ports = BIND_TCP | CONNECT_TCP;
    if (version < 6) return offsetof(struct ruleset, scopes);
    ruleset->scopes = ALL_SCOPES;
    return sizeof *ruleset;
}

struct rules {
    int descriptor;
    struct ruleset ruleset;
};

/* --- rules ------------------------------------------------------------------------------------ */

static bool allow_folder(const struct rules *rules, const char *folder, uint64_t rights)
{
    int descriptor = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const struct path_rule rule = {.allowed = rights & rules->ruleset.files, .folder = descriptor};
    bool is_added = syscall(ADD_RULE, rules->descriptor, RULE_PATH, &rule, 0) == 0;
    close(descriptor);
    return is_added;
}

static bool allow_folder_of(const struct rules *rules, const char *file, uint64_t rights)
{
    char path[SERVER_DISK_PATH];
    if (strlen(file) >= sizeof path) return false;
    strcpy(path, file);
    return allow_folder(rules, dirname(path), rights);
}

/* Where the file's name is, and where the file is. "": there is none. */
static bool allow_reading(const struct rules *rules, const char *file)
{
    if (!*file) return true;
    char *real = realpath(file, NULL);
    bool is_allowed =
        real && allow_folder_of(rules, file, READING) && allow_folder_of(rules, real, READING);
    free(real);
    return is_allowed;
}

static bool allow_unix_socket(const struct rules *rules, const struct server_address *address)
{
    const struct sockaddr_storage *socket = &address->socket;
    return socket->ss_family != AF_UNIX ||
           allow_folder_of(rules, ((const struct sockaddr_un *)socket)->sun_path,
                           MAKE_SOCKET | REMOVE_FILE);
}

static bool allow_store(const struct rules *rules, const struct server_config *config)
{
    return !*config->data_dir || config->store == SERVER_STORE_KIND_MEMORY ||
           allow_folder(rules, config->data_dir, STORING);
}

/* --- a database ------------------------------------------------------------------------------- */

/* What is not there need not be read. */
static void allow_file(void *user, const char *file)
{
    const struct rules *rules = user;
    int descriptor = open(file, O_PATH | O_CLOEXEC);
    if (descriptor < 0) return;
    const struct path_rule rule = {.allowed = READ_FILE & rules->ruleset.files,
                                   .folder = descriptor};
    (void)syscall(ADD_RULE, rules->descriptor, RULE_PATH, &rule, 0);
    close(descriptor);
}

static bool allow_connecting(void *user, uint16_t port)
{
    const struct rules *rules = user;
    const struct port_rule rule = {.allowed = CONNECT_TCP, .port = port};
    return !rules->ruleset.ports || syscall(ADD_RULE, rules->descriptor, RULE_PORT, &rule, 0) == 0;
}

/* Connecting, also in an hour: its ports, libpq's files, and what names of hosts and users are
 * looked up in. */
static bool allow_database(struct rules *rules, const struct server_config *config)
{
    static const char *const lookups[] = {
        "/etc/hosts",    "/etc/resolv.conf", "/etc/nsswitch.conf", "/etc/host.conf",
        "/etc/gai.conf", "/etc/services",    "/etc/passwd",        "/etc/ssl/openssl.cnf"};
    if (config->store != SERVER_STORE_KIND_POSTGRES) return true;
    for (size_t i = 0; i < sizeof lookups / sizeof *lookups; i++) allow_file(rules, lookups[i]);
    return server_postgres_each_port(config->store_url, allow_connecting, rules) &&
           server_postgres_each_file(config->store_url, allow_file, rules);
}

/* --- the whole -------------------------------------------------------------------------------- */

/* The folder as the store will open it, durable names and all: which the store can't make so any
 * more once the folders above are out of reach. */
static bool make_data_folder(const struct server_config *config)
{
    struct server_store_files files;
    char error[512];
    if (!*config->data_dir || config->store == SERVER_STORE_KIND_MEMORY) return true;
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        return server_disk_make_folder(config->data_dir) == SERVER_DISK_DONE;
    if (!server_files_open(&files, config->data_dir, error, sizeof error)) return false;
    server_files_close(&files);
    return true;
}

static const char *restrict_self(struct rules *rules, const struct server_config *config)
{
    bool is_allowed =
        allow_store(rules, config) && allow_database(rules, config) &&
        allow_reading(rules, config->keys) && allow_reading(rules, config->tls_cert) &&
        allow_reading(rules, config->tls_key) && allow_unix_socket(rules, &config->listen);
    if (!is_allowed) return "a file or folder that the daemon needs is not there";
    return syscall(RESTRICT_SELF, rules->descriptor, 0) == 0 ? NULL : strerror(errno);
}

const char *server_landlock_enter(const struct server_config *config)
{
    struct rules rules;
    long version = syscall(CREATE_RULESET, NULL, 0, WANT_VERSION);
    if (version < 0) return "this kernel has no Landlock, or it is not enabled";
    if (version < 2)
        return "this kernel's Landlock forbids renames from folder to folder: it wants Linux 5.19";
    if (!make_data_folder(config)) return "the data folder can't be used";
    size_t size = describe(version, &rules.ruleset);
    rules.descriptor = (int)syscall(CREATE_RULESET, &rules.ruleset, size, 0);
    if (rules.descriptor < 0) return strerror(errno);
    const char *missing = restrict_self(&rules, config);
    close(rules.descriptor);
    return missing;
}
