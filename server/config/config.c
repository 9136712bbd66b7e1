/* See config.h. */
#include "server/config/config.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/config/config_value.h"
#include "server/base/disk.h"
#include "server/base/version.h"

#define NAME_LIMIT 32 /* of an option */

static const char *const levels[] = {
#define LEVEL_NAME(NAME, name) #name,
    SERVER_LOG_LEVELS(LEVEL_NAME)
#undef LEVEL_NAME
        NULL};
const char *const server_config_cpus[] = {"auto", "baseline", "avx2", "avx512", NULL};
static const char *const sandboxes[] = {
    [SERVER_SANDBOX_AUTO] = "auto", [SERVER_SANDBOX_OFF] = "off", NULL};

#define MEMBER(member) offsetof(struct server_config, member)

static const struct server_setting options[] = {
    {"listen", "ADDR:PORT|unix:PATH", "where to listen; port 0 takes a free one", KIND_ADDRESS,
     MEMBER(listen), 0, 0, "127.0.0.1:8080", NULL},
    {"allowed-host", "HOST", "also accept this Host header; may be repeated, or a list with commas",
     KIND_HOST, MEMBER(allowed_hosts), 0, 0, NULL, NULL},
    {"keys", "FILE",
     "the keys by which users are known, which geodesicd keygen makes; read again at SIGHUP "
     "(default: none, and then "
     "only "
     "this machine's own programs may speak to the daemon)",
     KIND_PATH, MEMBER(keys), 0, 0, NULL, NULL},
    {"cors-origin", "ORIGIN",
     "web pages of this origin (https://maps.example) may use the daemon; may be repeated, or a "
     "list with commas",
     KIND_ORIGIN, MEMBER(cors_origins), 0, 0, NULL, NULL},
    {"tls-cert", "FILE",
     "the certificate and those that it rests on, PEM: speak HTTPS only; read again at SIGHUP",
     KIND_PATH, MEMBER(tls_cert), 0, 0, NULL, NULL},
    {"tls-key", "FILE", "the certificate's private key, PEM", KIND_PATH, MEMBER(tls_key), 0, 0,
     NULL, NULL},
    {"max-connections", "N",
     "connections that are open at once; others wait, and those that keep the daemon waiting make "
     "room",
     KIND_COUNT, MEMBER(max_connections), 1, SERVER_CONFIG_CONNECTIONS, "8192", NULL},
    {"max-address-connections", "N",
     "connections of one address that are open at once, three quarters of all at most; others are "
     "closed; 0: no limit",
     KIND_COUNT, MEMBER(max_address_connections), 0, SERVER_CONFIG_CONNECTIONS, "2048", NULL},
    {"workers", "N",
     "threads that build meshes and propagate (default: the number of cores); as many spare ones "
     "begin work only for a "
     "tenant that has none under way, or for requests while jobs have the others",
     KIND_COUNT, MEMBER(workers), 1, 1024, NULL, NULL},
    {"http-threads", "N", "threads that speak HTTP (default: the number of cores)", KIND_COUNT,
     MEMBER(http_threads), 1, 256, NULL, NULL},
    {"queue-length", "N",
     "requests that may wait for a worker before others get 503, and as many jobs; with keys no "
     "tenant takes more "
     "places "
     "than it leaves free",
     KIND_COUNT, MEMBER(queue_length), 1, 1000000, "256", NULL},
    {"cpu", "NAME",
     "instructions of the kernels: auto (the best that the machine has), baseline, avx2 or avx512; "
     "answers are the "
     "same",
     KIND_CHOICE, MEMBER(cpu), 0, 0, "auto", server_config_cpus},
    {"memory-budget", "BYTES",
     "most memory for meshes, fields and work; a 16th of it, 256MiB at most, is set aside for the "
     "memory of released "
     "fields, which the next ones take",
     KIND_BYTES, MEMBER(memory_budget), 1 << 20, UINT64_C(1) << 50, "4GiB", NULL},
    {"max-body", "BYTES", "largest request body", KIND_BYTES, MEMBER(max_body), 1 << 10,
     UINT64_C(1) << 40, "256MiB", NULL},
    {"max-answer", "BYTES",
     "largest answer, which is held in the memory budget until its client has read it; half of "
     "--memory-budget at "
     "most",
     KIND_BYTES, MEMBER(max_answer), 64 << 10, UINT64_C(1) << 40, "1GiB", NULL},
    {"max-faces", "N", "most triangles of a mesh", KIND_COUNT, MEMBER(max_faces), 1, 1 << 30,
     "10000000", NULL},
    {"timeout-ms", "MS",
     "most time that a request may take; timeout_ms in a request can only shorten it", KIND_COUNT,
     MEMBER(timeout_ms), 1, 86400000, "60000", NULL},
    {"drain-ms", "MS", "most time that SIGTERM waits for requests under way", KIND_COUNT,
     MEMBER(drain_ms), 0, 86400000, "10000", NULL},
    {"drain-delay-ms", "MS",
     "how long SIGTERM goes on serving as before while /readyz says 503, so that load balancers "
     "turn elsewhere first",
     KIND_COUNT, MEMBER(drain_delay_ms), 0, 86400000, "0", NULL},
    {"job-ttl-s", "S", "how long a job and its answer are kept after its end", KIND_COUNT,
     MEMBER(job_ttl_s), 1, 31536000, "3600", NULL},
    {"max-jobs", "N",
     "most jobs; the oldest that have ended, of the key that has the most, make way for new ones, "
     "as they do when "
     "answers "
     "fill an eighth of the memory budget",
     KIND_COUNT, MEMBER(max_jobs), 1, 1000000, "10000", NULL},
    {"landmarks", "N",
     "landmark fields that a mesh gets in idle time once it is searched, to make later searches "
     "shorter; 0: none",
     KIND_COUNT, MEMBER(landmarks), 0, 16, "16", NULL},
    {"store", "KIND",
     "where meshes are kept: local (in --data-dir), memory (until the daemon ends), or a database "
     "that many daemons "
     "share, postgresql://user@host/database; its password is better in PGPASSFILE or the "
     "environment than here",
     KIND_STORE, 0, 0, 0, "local", NULL},
    {"data-dir", "DIR",
     "folder of the local store (default: /var/lib/geodesicd for root, else "
     "$XDG_DATA_HOME/geodesicd or "
     "~/.local/share/geodesicd); beside a database, where landmarks and fields are kept, if "
     "anywhere",
     KIND_PATH, MEMBER(data_dir), 0, 0, NULL, NULL},
    {"persist-fields", NULL, "keep cached fields in the data folder over a restart", KIND_BOOLEAN,
     MEMBER(persist_fields), 0, 0, NULL, NULL},
    {"check-store", NULL,
     "check every file of the data folder, or every row of the database, print what is found, and "
     "exit",
     KIND_BOOLEAN, MEMBER(check_store), 0, 0, NULL, NULL},
    {"backup", "DIR", "copy the data folder, in use or not, into a new one, and exit", KIND_PATH,
     MEMBER(backup), 0, 0, NULL, NULL},
    {"restore", "DIR", "make the data folder, where there is none, of the backup in DIR, and exit",
     KIND_PATH, MEMBER(restore), 0, 0, NULL, NULL},
    {"scrub-s", "S",
     "seconds from one look through the data folder for damaged files to the next; 0: none but "
     "--check-store",
     KIND_COUNT, MEMBER(scrub_s), 0, 31536000, "86400", NULL},
    {"scrub-rate", "BYTES", "most that such a look reads in a second", KIND_BYTES,
     MEMBER(scrub_rate), 1 << 10, UINT64_C(1) << 40, "16MiB", NULL},
    {"sandbox", "MODE",
     "auto: give up all rights that the daemon does not need, as far as the kernel can take them "
     "(Landlock, seccomp); "
     "or off",
     KIND_CHOICE, MEMBER(sandbox), 0, 0, "auto", sandboxes},
    {"slow-ms", "MS", "log requests that take so long as slow_request, with a warning; 0: none",
     KIND_COUNT, MEMBER(slow_ms), 0, 86400000, "0", NULL},
    {"log-level", "LEVEL", "debug, info, warn or error", KIND_CHOICE, MEMBER(log_level), 0, 0,
     "info", levels},
    {"config", "FILE", "read `name = value` lines from FILE; # begins a comment", KIND_FILE, 0, 0,
     0, NULL, NULL},
    {"version", NULL, "print the version and exit", KIND_SWITCH, 0, 0, 0, NULL, NULL},
    {"help", NULL, "print this and exit", KIND_SWITCH, 0, 0, 0, NULL, NULL},
};

#define OPTION_COUNT (sizeof options / sizeof *options)

static const struct server_setting *find_option(const char *name, size_t size)
{
    for (size_t i = 0; i < OPTION_COUNT; i++)
        if (strlen(options[i].name) == size && strncmp(options[i].name, name, size) == 0)
            return &options[i];
    return NULL;
}

/* Levenshtein distance of two short names. */
static unsigned name_distance(const char *a, size_t a_size, const char *b)
{
    unsigned row[NAME_LIMIT + 1];
    size_t b_size = strlen(b);
    for (size_t j = 0; j <= b_size; j++) row[j] = (unsigned)j;
    for (size_t i = 0; i < a_size; i++) {
        unsigned diagonal = row[0];
        row[0] = (unsigned)i + 1;
        for (size_t j = 0; j < b_size; j++) {
            unsigned replaced = diagonal + (a[i] != b[j]);
            unsigned shifted = (row[j] < row[j + 1] ? row[j] : row[j + 1]) + 1;
            diagonal = row[j + 1];
            row[j + 1] = replaced < shifted ? replaced : shifted;
        }
    }
    return row[b_size];
}

static const char *nearest_name(const char *name, size_t size)
{
    const char *best = options[0].name;
    for (size_t i = 1; i < OPTION_COUNT; i++)
        if (name_distance(name, size, options[i].name) < name_distance(name, size, best))
            best = options[i].name;
    return best;
}

/* --- sources of values, weakest first --------------------------------------------------------- */

static bool load_defaults(struct server_setting_loader *loader)
{
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    loader->config->workers = loader->config->http_threads = cores > 0 ? (uint64_t)cores : 1;
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        snprintf(loader->origin, sizeof loader->origin, "default of --%s", options[i].name);
        if (options[i].standard && !server_config_set(loader, &options[i], options[i].standard))
            return false;
    }
    return true;
}

static char *trim(char *text)
{
    while (isspace((unsigned char)*text)) text++;
    size_t size = strlen(text);
    while (size && isspace((unsigned char)text[size - 1])) text[--size] = '\0';
    return text;
}

static bool load_line(struct server_setting_loader *loader, const char *path, unsigned number,
                      char *line)
{
    line[strcspn(line, "#")] = '\0';
    char *name = trim(line);
    if (!*name) return true;
    snprintf(loader->origin, sizeof loader->origin, "%s:%u", path, number);
    char *equals = strchr(name, '=');
    if (!equals) return server_config_complain(loader, "write `name = value`");
    *equals = '\0';
    char *value = trim(equals + 1);
    name = trim(name);
    const struct server_setting *option = find_option(name, strlen(name));
    if (!option || option->kind == KIND_SWITCH || option->kind == KIND_FILE)
        return server_config_complain(loader, "there is no setting '%s'; did you mean '%s'?", name,
                                      nearest_name(name, strlen(name)));
    return server_config_set(loader, option, value);
}

static bool load_file(struct server_setting_loader *loader, const char *path)
{
    int descriptor = server_disk_open(path);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "r");
    if (!file)
        return server_config_complain(loader, "can't read '%s': %s", path, server_disk_why());
    char line[1024];
    bool ok = true;
    for (unsigned number = 1; ok && fgets(line, sizeof line, file); number++)
        ok = load_line(loader, path, number, line);
    fclose(file);
    return ok;
}

/* GEODESICD_MAX_BODY for max-body. */
static const char *environment(const struct server_setting *option, char name[CONFIG_TEXT])
{
    snprintf(name, CONFIG_TEXT, "GEODESICD_%s", option->name);
    for (char *c = name; *c; c++) *c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
    return getenv(name);
}

static bool load_environment(struct server_setting_loader *loader)
{
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        const char *value = environment(&options[i], loader->origin);
        if (value && !server_config_set(loader, &options[i], value)) return false;
    }
    return true;
}

/* One flag of the command line. */
struct flag {
    const struct server_setting *option;
    const char *value; /* NULL for switches */
};

/* Reads argv[*at], and argv[*at + 1] when the value stands there; advances `*at` past both. */
static bool next_flag(struct server_setting_loader *loader, char *const argv[], int argc, int *at,
                      struct flag *out)
{
    const char *text = argv[(*at)++];
    snprintf(loader->origin, sizeof loader->origin, "%s", text);
    if (strncmp(text, "--", 2) != 0)
        return server_config_complain(loader, "flags begin with --; try --help");
    size_t size = strcspn(text + 2, "=");
    const char *inline_value = text[2 + size] ? text + 3 + size : NULL;
    out->option = find_option(text + 2, size);
    if (!out->option)
        return server_config_complain(loader, "there is no such flag; did you mean --%s?",
                                      nearest_name(text + 2, size));
    out->value = NULL;
    if (out->option->kind == KIND_SWITCH)
        return !inline_value || server_config_complain(loader, "this flag takes no value");
    if (out->option->kind == KIND_BOOLEAN) {
        out->value = inline_value ? inline_value : "true";
        return true;
    }
    out->value = inline_value ? inline_value : *at < argc ? argv[(*at)++] : NULL;
    return out->value ||
           server_config_complain(loader, "a value is missing: %s", out->option->argument);
}

static bool load_flags(struct server_setting_loader *loader, int argc, char *const argv[])
{
    struct flag flag;
    for (int at = 1; at < argc;)
        if (!next_flag(loader, argv, argc, &at, &flag) ||
            !server_config_set(loader, flag.option, flag.value))
            return false;
    return true;
}

/* --- what is asked before any value counts ---------------------------------------------------- */

static void print_help(FILE *out)
{
    fprintf(out, "geodesicd: exact geodesics on surfaces, as a network service\n\n"
                 "usage: geodesicd [--flag value | --flag=value]...\n"
                 "       geodesicd keygen NAME [--role read|write] [--expires TIME|DAYSd] [--rate "
                 "N] [--concurrent N]\n\n");
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        char usage[64];
        snprintf(usage, sizeof usage, "--%s %s", options[i].name,
                 options[i].argument ? options[i].argument : "");
        fprintf(out, "  %-30s %s", usage, options[i].help);
        fprintf(out, options[i].standard ? " (default: %s)\n" : "\n", options[i].standard);
    }
    fprintf(out, "\nEach is also read from the environment (GEODESICD_MAX_BODY for --max-body) and "
                 "from the --config file;\n"
                 "flags win over the environment, the environment over the file.\n");
}

/* Looks for --help and --version, which win over everything, and for the file to read. */
static enum server_config_outcome look_ahead(struct server_setting_loader *loader, int argc,
                                             char *const argv[], FILE *out, const char **file)
{
    char name[CONFIG_TEXT];
    struct flag flag;
    *file = environment(find_option("config", strlen("config")), name);
    for (int at = 1; at < argc;) {
        if (!next_flag(loader, argv, argc, &at, &flag)) return SERVER_CONFIG_WRONG;
        if (flag.option->kind == KIND_FILE) *file = flag.value;
        if (flag.option->kind != KIND_SWITCH) continue;
        if (strcmp(flag.option->name, "help") == 0)
            print_help(out);
        else
            fprintf(out, "geodesicd " SERVER_VERSION "\n");
        return SERVER_CONFIG_DONE;
    }
    return SERVER_CONFIG_RUN;
}

/* Where a data folder is expected: for root the system's, else the user's. */
static bool find_data_dir(struct server_setting_loader *loader)
{
    const char *data_home = getenv("XDG_DATA_HOME"), *home = getenv("HOME");
    char *path = loader->config->data_dir;
    int size = 0;
    if (*path || loader->config->store != SERVER_STORE_KIND_LOCAL) return true;
    if (geteuid() == 0)
        size = snprintf(path, SERVER_CONFIG_PATH, "/var/lib/geodesicd");
    else if (data_home && *data_home == '/')
        size = snprintf(path, SERVER_CONFIG_PATH, "%s/geodesicd", data_home);
    else if (home && *home == '/')
        size = snprintf(path, SERVER_CONFIG_PATH, "%s/.local/share/geodesicd", home);
    snprintf(loader->origin, sizeof loader->origin, "--data-dir");
    return (size > 0 && size < SERVER_CONFIG_PATH) ||
           server_config_complain(
               loader,
               "there is no home folder to keep meshes in: name a folder, or use --store memory");
}

static bool validate_shared_store(struct server_setting_loader *loader)
{
    const struct server_config *config = loader->config;
    if (*config->backup || *config->restore)
        return server_config_complain(
            loader, "a database is copied by its own means (pg_dump): leave out --backup and "
                    "--restore");
    return !config->persist_fields || *config->data_dir ||
           server_config_complain(
               loader, "--persist-fields wants a folder beside the database: give --data-dir");
}

static bool validate_store(struct server_setting_loader *loader)
{
    const struct server_config *config = loader->config;
    if (config->store == SERVER_STORE_KIND_LOCAL) return true;
    snprintf(loader->origin, sizeof loader->origin, "--store");
    if (config->store == SERVER_STORE_KIND_POSTGRES) return validate_shared_store(loader);
    return (!config->persist_fields && !config->check_store && !*config->backup &&
            !*config->restore) ||
           server_config_complain(loader,
                                  "a store in memory keeps nothing: leave out --persist-fields, "
                                  "--check-store, --backup and --restore");
}

static bool validate_access(struct server_setting_loader *loader)
{
    const struct server_config *config = loader->config;
    snprintf(loader->origin, sizeof loader->origin, "--tls-cert");
    if (!*config->tls_cert != !*config->tls_key)
        return server_config_complain(
            loader, "--tls-cert and --tls-key belong together: give both or none");
    snprintf(loader->origin, sizeof loader->origin, "--listen");
    if (*config->keys || server_address_is_local(&config->listen)) return true;
    char address[SERVER_ADDRESS_TEXT];
    server_address_format(&config->listen, address);
    return server_config_complain(
        loader,
        "refusing to listen on %s: without keys everyone who reaches the address could read and "
        "delete "
        "every mesh; give --keys, or listen on a loopback address or a unix socket",
        address);
}

static bool validate(struct server_setting_loader *loader)
{
    const struct server_config *config = loader->config;
    if (!find_data_dir(loader) || !validate_store(loader)) return false;
    if (!validate_access(loader)) return false;
    snprintf(loader->origin, sizeof loader->origin, "--max-body");
    return config->max_body <= config->memory_budget ||
           server_config_complain(loader, "it can't be larger than --memory-budget");
}

enum server_config_outcome server_config_load(struct server_config *config, int argc,
                                              char *const argv[], FILE *out, FILE *error)
{
    struct server_setting_loader loader = {.config = config, .error = error};
    const char *file;
    *config = (struct server_config){0};
    enum server_config_outcome outcome = look_ahead(&loader, argc, argv, out, &file);
    if (outcome != SERVER_CONFIG_RUN) return outcome;
    snprintf(loader.origin, sizeof loader.origin, "--config");
    bool ok = load_defaults(&loader) && (!file || load_file(&loader, file)) &&
              load_environment(&loader) && load_flags(&loader, argc, argv) && validate(&loader);
    return ok ? SERVER_CONFIG_RUN : SERVER_CONFIG_WRONG;
}
