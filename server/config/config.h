/* Config: what the operator decides. One table drives flags, environment, file, --help and
 * validation. */
#ifndef SERVER_CONFIG_CONFIG_H
#define SERVER_CONFIG_CONFIG_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "server/config/address.h"
#include "server/base/log.h"
#include "server/access/sandbox.h"

#define SERVER_CONFIG_NAMES 16
#define SERVER_CONFIG_NAME  128

#define SERVER_CONFIG_PATH 3000

#define SERVER_CONFIG_CONNECTIONS 65536 /* most that max_connections can be */

/* What --cpu may name, NULL-terminated: see gd/cpu.h. */
extern const char *const server_config_cpus[];

enum server_store_kind {
    SERVER_STORE_KIND_LOCAL,
    SERVER_STORE_KIND_MEMORY,
    SERVER_STORE_KIND_POSTGRES
};

struct server_config_list {
    char name[SERVER_CONFIG_NAMES][SERVER_CONFIG_NAME];
    uint32_t count;
};

struct server_config {
    struct server_address listen;
    struct server_config_list allowed_hosts; /* besides localhost and loopback addresses */
    /* whose pages may use the daemon: "https://maps.example" */
    struct server_config_list cors_origins;
    char keys[SERVER_CONFIG_PATH]; /* see credentials.h; empty: there are none */
    char tls_cert[SERVER_CONFIG_PATH], tls_key[SERVER_CONFIG_PATH]; /* empty, both: no TLS */
    uint64_t max_connections;                                       /* open at once */
    /* of one address; 0: no limit */
    uint64_t max_address_connections;
    /* threads that parse, build and propagate */
    uint64_t workers;
    uint64_t http_threads; /* threads that speak HTTP */
    /* requests that may wait for a worker */
    uint64_t queue_length;
    /* index of server_config_cpus */
    unsigned cpu;
    uint64_t memory_budget; /* bytes */
    uint64_t landmarks;     /* of a mesh; 0: none */
    uint64_t max_body;      /* bytes */
    uint64_t max_answer;    /* bytes */
    uint64_t max_faces;     /* triangles */
    /* most time that a request may take */
    uint64_t timeout_ms;
    /* most time that a shutdown waits for requests */
    uint64_t drain_ms;
    /* how long a shutdown serves on before it begins to drain, /readyz saying 503 */
    uint64_t drain_delay_ms;
    uint64_t job_ttl_s; /* how long an ended job is kept */
    uint64_t max_jobs;  /* most jobs, ended ones included */
    enum server_log_level log_level;
    enum server_store_kind store;
    /* of a PostgreSQL store; may hold a password: never printed */
    char store_url[SERVER_CONFIG_PATH];
    char data_dir[SERVER_CONFIG_PATH];
    bool persist_fields;
    bool check_store;                 /* check the store and end */
    char backup[SERVER_CONFIG_PATH];  /* copy the store there and end; empty: don't */
    char restore[SERVER_CONFIG_PATH]; /* make the store of that backup and end; empty: don't */
    /* between the beginnings of two looks through the store; 0: none */
    uint64_t scrub_s;
    uint64_t scrub_rate; /* bytes a second */
    uint64_t slow_ms;    /* requests that take as long are warned of; 0: none */
    enum server_sandbox_mode sandbox;
};

enum server_config_outcome {
    SERVER_CONFIG_RUN,  /* go on */
    SERVER_CONFIG_DONE, /* --help or --version was printed to `out` */
    SERVER_CONFIG_WRONG /* a sentence was printed to `error` */
};

/* Fills `*config` from the defaults, the file that --config or GEODESICD_CONFIG names, GEODESICD_*
 * in the environment and the flags, each over those before it (--allowed-host and --cors-origin add
 * up), then validates the whole. */
enum server_config_outcome server_config_load(struct server_config *config, int argc,
                                              char *const argv[], FILE *out, FILE *error);

#endif
