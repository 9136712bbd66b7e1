/* Config: the operator's settings. One table defines the flags, the environment variables, the
 * settings of the file, the text of --help and the checks. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "server/base/log.h"
#include "server/config/address.h"

#define SERVER_CONFIG_NAMES       16
#define SERVER_CONFIG_NAME        128
#define SERVER_CONFIG_PATH        3000
#define SERVER_CONFIG_CONNECTIONS 65536 /* maximum of max_connections */

/* The values of --cpu, NULL-terminated: see gd/cpu.h. */
extern const char *const server_config_cpus[];

enum server_store_kind {
    SERVER_STORE_KIND_LOCAL,
    SERVER_STORE_KIND_MEMORY,
    SERVER_STORE_KIND_POSTGRES
};

enum server_sandbox_mode { SERVER_SANDBOX_AUTO, SERVER_SANDBOX_OFF };

struct server_config_list {
    char name[SERVER_CONFIG_NAMES][SERVER_CONFIG_NAME];
    uint32_t count;
};

/* Strings that are not set are empty. */
struct server_config {
    struct server_address listen;
    struct server_config_list allowed_hosts;   /* in addition to localhost and loopback addresses */
    struct server_config_list cors_origins;    /* "https://maps.example" */
    struct server_config_list frame_ancestors; /* origins whose pages may frame the viewer */
    char keys[SERVER_CONFIG_PATH];             /* see credentials.h */
    char tls_cert[SERVER_CONFIG_PATH], tls_key[SERVER_CONFIG_PATH]; /* both or none */
    uint64_t max_connections;                                       /* open at once */
    /* largest number of connections from one address; 0 means no limit */
    uint64_t max_address_connections;
    uint64_t workers, http_threads; /* threads */
    uint64_t queue_length;          /* limit on the requests that wait for a worker */
    unsigned cpu;                   /* index in server_config_cpus */
    uint64_t memory_budget;         /* bytes */
    uint64_t landmarks;             /* number of landmarks of a mesh; 0 means none */
    uint64_t max_body, max_answer;  /* bytes */
    uint64_t max_faces;             /* triangles */
    uint64_t timeout_ms;            /* limit of a request */
    uint64_t drain_ms;              /* time for running requests at a shutdown */
    /* time before a shutdown begins to drain; /readyz already answers 503 */
    uint64_t drain_delay_ms;
    uint64_t job_ttl_s; /* time for which an ended job is kept */
    uint64_t max_jobs;  /* limit on jobs, including ended ones */
    enum server_log_level log_level;
    enum server_store_kind store;
    /* address of PostgreSQL; may contain a password: never printed */
    char store_url[SERVER_CONFIG_PATH];
    char data_dir[SERVER_CONFIG_PATH];
    bool persist_fields;
    bool check_store;                                             /* check and exit */
    char backup[SERVER_CONFIG_PATH], restore[SERVER_CONFIG_PATH]; /* copy and exit */
    uint64_t scrub_s;    /* period of scrubs of the store; 0 means none */
    uint64_t scrub_rate; /* bytes a second */
    uint64_t slow_ms;    /* requests that take longer are logged as slow; 0 means none */
    enum server_sandbox_mode sandbox;
};

enum server_config_outcome {
    SERVER_CONFIG_RUN,
    SERVER_CONFIG_DONE, /* --help or --version was printed to `out` */
    SERVER_CONFIG_WRONG /* a sentence was printed to `error` */
};

/* Fills `*config` from the defaults, the file of --config or GEODESICD_CONFIG, the variables
 * GEODESICD_* and the flags (`argv`, NULL-terminated, after the program's name). A value of a later
 * source replaces that of an earlier source, but the values of a list (--allowed-host,
 * --cors-origin) are added to the earlier values. Validates the result. */
enum server_config_outcome server_config_load(struct server_config *config, char *const argv[],
                                              FILE *out, FILE *error);
