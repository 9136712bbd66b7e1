/* See config.h. */
#include "server/config.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/version.h"

#define TEXT_LIMIT 512
#define NAME_LIMIT 32 /* of an option */

enum kind {
    KIND_COUNT,
    KIND_BYTES,
    KIND_ADDRESS,
    KIND_HOST,
    KIND_CHOICE,
    KIND_PATH,
    KIND_BOOLEAN,
    KIND_FILE,
    KIND_SWITCH
};

struct option {
    const char *name, *argument, *help;
    enum kind kind;
    size_t offset;        /* of the member in struct server_config */
    uint64_t least, most; /* KIND_COUNT, KIND_BYTES */
    const char *standard; /* default, as it would be typed; NULL: none, or found at run time */
    const char *const *
        words; /* KIND_CHOICE: what may be typed, NULL-terminated; the member is an enum or unsigned that counts them */
};

static const char *const levels[] = {
#define LEVEL_NAME(NAME, name) #name,
    SERVER_LOG_LEVELS(LEVEL_NAME)
#undef LEVEL_NAME
        NULL};
const char *const server_config_cpus[] = {"auto", "baseline", "avx2", "avx512", NULL};
static const char *const stores[] = {[SERVER_STORE_KIND_LOCAL] = "local", [SERVER_STORE_KIND_MEMORY] = "memory", NULL};

#define MEMBER(member) offsetof(struct server_config, member)

static const struct option options[] = {
    {"listen", "ADDR:PORT|unix:PATH", "where to listen; port 0 takes a free one", KIND_ADDRESS, MEMBER(listen), 0, 0,
     "127.0.0.1:8080", NULL},
    {"allowed-host", "HOST", "also accept this Host header; may be repeated, or a list with commas", KIND_HOST,
     MEMBER(allowed_hosts), 0, 0, NULL, NULL},
    {"workers", "N", "threads that build meshes and propagate (default: the number of cores)", KIND_COUNT,
     MEMBER(workers), 1, 1024, NULL, NULL},
    {"http-threads", "N", "threads that speak HTTP (default: the number of cores)", KIND_COUNT, MEMBER(http_threads), 1,
     256, NULL, NULL},
    {"queue-length", "N", "requests that may wait for a worker before others get 503", KIND_COUNT, MEMBER(queue_length),
     1, 1000000, "256", NULL},
    {"cpu", "NAME",
     "instructions of the kernels: auto (the best that the machine has), baseline, avx2 or avx512; answers are the "
     "same",
     KIND_CHOICE, MEMBER(cpu), 0, 0, "auto", server_config_cpus},
    {"memory-budget", "BYTES",
     "most memory for meshes, fields and work; a 16th of it, 256MiB at most, is set aside for the memory of released "
     "fields, which the next ones take",
     KIND_BYTES, MEMBER(memory_budget), 1 << 20, UINT64_C(1) << 50, "4GiB", NULL},
    {"max-body", "BYTES", "largest request body", KIND_BYTES, MEMBER(max_body), 1 << 10, UINT64_C(1) << 40, "256MiB",
     NULL},
    {"max-faces", "N", "most triangles of a mesh", KIND_COUNT, MEMBER(max_faces), 1, 1 << 30, "10000000", NULL},
    {"timeout-ms", "MS", "most time that a request may take; timeout_ms in a request can only shorten it", KIND_COUNT,
     MEMBER(timeout_ms), 1, 86400000, "60000", NULL},
    {"drain-ms", "MS", "most time that SIGTERM waits for requests under way", KIND_COUNT, MEMBER(drain_ms), 0, 86400000,
     "10000", NULL},
    {"job-ttl-s", "S", "how long a job and its answer are kept after its end", KIND_COUNT, MEMBER(job_ttl_s), 1,
     31536000, "3600", NULL},
    {"max-jobs", "N",
     "most jobs; the oldest that have ended make way for new ones, as they do when answers fill an eighth of the "
     "memory budget",
     KIND_COUNT, MEMBER(max_jobs), 1, 1000000, "10000", NULL},
    {"landmarks", "N",
     "landmark fields that a mesh gets in idle time once it is searched, to make later searches shorter; 0: none",
     KIND_COUNT, MEMBER(landmarks), 0, 16, "16", NULL},
    {"store", "KIND", "where meshes are kept: local (in --data-dir) or memory (until the daemon ends)", KIND_CHOICE,
     MEMBER(store), 0, 0, "local", stores},
    {"data-dir", "DIR",
     "folder of the local store (default: /var/lib/geodesicd for root, else $XDG_DATA_HOME/geodesicd or "
     "~/.local/share/geodesicd)",
     KIND_PATH, MEMBER(data_dir), 0, 0, NULL, NULL},
    {"persist-fields", NULL, "keep cached fields in the data folder over a restart", KIND_BOOLEAN,
     MEMBER(persist_fields), 0, 0, NULL, NULL},
    {"check-store", NULL, "check every file of the data folder, print what is found, and exit", KIND_BOOLEAN,
     MEMBER(check_store), 0, 0, NULL, NULL},
    {"backup", "DIR", "copy the data folder, in use or not, into a new one, and exit", KIND_PATH, MEMBER(backup), 0, 0,
     NULL, NULL},
    {"log-level", "LEVEL", "debug, info, warn or error", KIND_CHOICE, MEMBER(log_level), 0, 0, "info", levels},
    {"config", "FILE", "read `name = value` lines from FILE; # begins a comment", KIND_FILE, 0, 0, 0, NULL, NULL},
    {"version", NULL, "print the version and exit", KIND_SWITCH, 0, 0, 0, NULL, NULL},
    {"help", NULL, "print this and exit", KIND_SWITCH, 0, 0, 0, NULL, NULL},
};

#define OPTION_COUNT (sizeof options / sizeof *options)

/* One loading: where sentences go, and where the value at hand came from. */
struct loader {
    struct server_config *config;
    FILE *error;
    char origin[TEXT_LIMIT]; /* "--workers", "GEODESICD_WORKERS", "FILE:12: workers" */
};

__attribute__((format(printf, 2, 3))) static bool complain(const struct loader *loader, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(loader->error, "geodesicd: %s: ", loader->origin);
    vfprintf(loader->error, format, arguments);
    fputc('\n', loader->error);
    va_end(arguments);
    return false;
}

static const struct option *find_option(const char *name, size_t size)
{
    for (size_t i = 0; i < OPTION_COUNT; i++)
        if (strlen(options[i].name) == size && strncmp(options[i].name, name, size) == 0) return &options[i];
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
        if (name_distance(name, size, options[i].name) < name_distance(name, size, best)) best = options[i].name;
    return best;
}

/* --- values ------------------------------------------------------------------------------------------------------- */

static bool parse_unsigned(const char *text, uint64_t *out, const char **rest)
{
    char *end;
    if (!isdigit((unsigned char)*text)) return false;
    errno = 0;
    *out = strtoull(text, &end, 10);
    *rest = end;
    return errno == 0;
}

/* "4096", "64k", "512MiB", "4G", "4GiB": powers of 1024. */
static bool parse_bytes(const char *text, uint64_t *out)
{
    static const char units[] = "KMGT";
    const char *rest;
    if (!parse_unsigned(text, out, &rest)) return false;
    const char *unit = *rest ? strchr(units, toupper((unsigned char)*rest)) : NULL;
    if (unit) {
        unsigned shift = 10 * (unsigned)(unit - units + 1);
        if (*out > UINT64_MAX >> shift) return false;
        *out <<= shift;
        rest++;
        if (*rest == 'i')
            rest++;
        else if (*rest)
            return false;
    }
    return !*rest || (rest[0] == 'B' && !rest[1]);
}

static bool set_number(const struct loader *loader, const struct option *option, const char *value, uint64_t *member)
{
    uint64_t number;
    const char *rest = "";
    bool parsed =
        option->kind == KIND_BYTES ? parse_bytes(value, &number) : parse_unsigned(value, &number, &rest) && !*rest;
    if (!parsed)
        return complain(loader,
                        option->kind == KIND_BYTES ? "'%s' is no size; write a number of bytes or one like 512MiB, 4GiB"
                                                   : "'%s' is no whole number",
                        value);
    if (number < option->least || number > option->most)
        return complain(loader, "%s is outside %llu to %llu", value, (unsigned long long)option->least,
                        (unsigned long long)option->most);
    *member = number;
    return true;
}

static bool set_address(const struct loader *loader, const char *value, struct server_address *member)
{
    char sentence[TEXT_LIMIT];
    return server_address_parse(value, member, sentence, sizeof sentence) || complain(loader, "%s", sentence);
}

static bool add_host(const struct loader *loader, const char *value)
{
    struct server_config *config = loader->config;
    if (config->allowed_hosts.count == SERVER_CONFIG_HOSTS)
        return complain(loader, "at most %d hosts can be allowed", SERVER_CONFIG_HOSTS);
    if (!*value || strlen(value) >= SERVER_CONFIG_HOST || strpbrk(value, "/\t"))
        return complain(loader, "'%s' is no host name; write it as in a URL, without scheme and path", value);
    strcpy(config->allowed_hosts.name[config->allowed_hosts.count++], value);
    return true;
}

/* One host or several with commas between them. */
static bool add_hosts(const struct loader *loader, const char *value)
{
    char list[TEXT_LIMIT], *rest;
    snprintf(list, sizeof list, "%s", value);
    for (char *host = strtok_r(list, ", ", &rest); host; host = strtok_r(NULL, ", ", &rest))
        if (!add_host(loader, host)) return false;
    return true;
}

static bool set_choice(const struct loader *loader, const struct option *option, const char *value, unsigned *member)
{
    char list[TEXT_LIMIT] = "";
    for (unsigned i = 0; option->words[i]; i++) {
        if (strcmp(value, option->words[i]) == 0) {
            *member = i;
            return true;
        }
        const char *before = i == 0 ? "" : option->words[i + 1] ? ", " : " or ";
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", before, option->words[i]);
    }
    return complain(loader, "'%s' is none of the choices; write %s", value, list);
}

static bool set_path(const struct loader *loader, const char *value, char *member)
{
    if (!*value || strlen(value) >= SERVER_CONFIG_PATH)
        return complain(loader, "a path has 1 to %d bytes", SERVER_CONFIG_PATH - 1);
    strcpy(member, value);
    for (size_t size = strlen(member); size > 1 && member[size - 1] == '/'; size--) member[size - 1] = '\0';
    return true;
}

static bool set_boolean(const struct loader *loader, const char *value, bool *member)
{
    *member = strcmp(value, "true") == 0;
    return *member || strcmp(value, "false") == 0 || complain(loader, "write true or false");
}

static bool set_option(const struct loader *loader, const struct option *option, const char *value)
{
    void *member = (char *)loader->config + option->offset;
    switch (option->kind) {
    case KIND_COUNT:
    case KIND_BYTES:
        return set_number(loader, option, value, member);
    case KIND_ADDRESS:
        return set_address(loader, value, member);
    case KIND_HOST:
        return add_hosts(loader, value);
    case KIND_CHOICE:
        return set_choice(loader, option, value, member);
    case KIND_PATH:
        return set_path(loader, value, member);
    case KIND_BOOLEAN:
        return set_boolean(loader, value, member);
    case KIND_FILE:
    case KIND_SWITCH:
        break; /* read before the others */
    }
    return true;
}

/* --- sources of values, weakest first ----------------------------------------------------------------------------- */

static bool load_defaults(struct loader *loader)
{
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    loader->config->workers = loader->config->http_threads = cores > 0 ? (uint64_t)cores : 1;
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        snprintf(loader->origin, sizeof loader->origin, "default of --%s", options[i].name);
        if (options[i].standard && !set_option(loader, &options[i], options[i].standard)) return false;
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

static bool load_line(struct loader *loader, const char *path, unsigned number, char *line)
{
    line[strcspn(line, "#")] = '\0';
    char *name = trim(line);
    if (!*name) return true;
    snprintf(loader->origin, sizeof loader->origin, "%s:%u", path, number);
    char *equals = strchr(name, '=');
    if (!equals) return complain(loader, "write `name = value`");
    *equals = '\0';
    char *value = trim(equals + 1);
    name = trim(name);
    const struct option *option = find_option(name, strlen(name));
    if (!option || option->kind == KIND_SWITCH || option->kind == KIND_FILE)
        return complain(loader, "there is no setting '%s'; did you mean '%s'?", name, nearest_name(name, strlen(name)));
    return set_option(loader, option, value);
}

static bool load_file(struct loader *loader, const char *path)
{
    FILE *file = fopen(path, "re");
    if (!file) return complain(loader, "can't read '%s': %s", path, strerror(errno));
    char line[1024];
    bool ok = true;
    for (unsigned number = 1; ok && fgets(line, sizeof line, file); number++)
        ok = load_line(loader, path, number, line);
    fclose(file);
    return ok;
}

/* GEODESICD_MAX_BODY for max-body. */
static const char *environment(const struct option *option, char name[TEXT_LIMIT])
{
    snprintf(name, TEXT_LIMIT, "GEODESICD_%s", option->name);
    for (char *c = name; *c; c++) *c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
    return getenv(name);
}

static bool load_environment(struct loader *loader)
{
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        const char *value = environment(&options[i], loader->origin);
        if (value && !set_option(loader, &options[i], value)) return false;
    }
    return true;
}

/* One flag of the command line. */
struct flag {
    const struct option *option;
    const char *value; /* NULL for switches */
};

/* Reads argv[*at], and argv[*at + 1] when the value stands there; advances `*at` past both. */
static bool next_flag(struct loader *loader, char *const argv[], int argc, int *at, struct flag *out)
{
    const char *text = argv[(*at)++];
    snprintf(loader->origin, sizeof loader->origin, "%s", text);
    if (strncmp(text, "--", 2) != 0) return complain(loader, "flags begin with --; try --help");
    size_t size = strcspn(text + 2, "=");
    const char *inline_value = text[2 + size] ? text + 3 + size : NULL;
    out->option = find_option(text + 2, size);
    if (!out->option)
        return complain(loader, "there is no such flag; did you mean --%s?", nearest_name(text + 2, size));
    out->value = NULL;
    if (out->option->kind == KIND_SWITCH) return !inline_value || complain(loader, "this flag takes no value");
    if (out->option->kind == KIND_BOOLEAN) {
        out->value = inline_value ? inline_value : "true";
        return true;
    }
    out->value = inline_value ? inline_value : *at < argc ? argv[(*at)++] : NULL;
    return out->value || complain(loader, "a value is missing: %s", out->option->argument);
}

static bool load_flags(struct loader *loader, int argc, char *const argv[])
{
    struct flag flag;
    for (int at = 1; at < argc;)
        if (!next_flag(loader, argv, argc, &at, &flag) || !set_option(loader, flag.option, flag.value)) return false;
    return true;
}

/* --- what is asked before any value counts ------------------------------------------------------------------------ */

static void print_help(FILE *out)
{
    fprintf(out, "geodesicd: exact geodesics on surfaces, as a network service\n\nusage: geodesicd [--flag value | "
                 "--flag=value]...\n\n");
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        char usage[64];
        snprintf(usage, sizeof usage, "--%s %s", options[i].name, options[i].argument ? options[i].argument : "");
        fprintf(out, "  %-30s %s", usage, options[i].help);
        fprintf(out, options[i].standard ? " (default: %s)\n" : "\n", options[i].standard);
    }
    fprintf(out,
            "\nEach is also read from the environment (GEODESICD_MAX_BODY for --max-body) and from the --config file;\n"
            "flags win over the environment, the environment over the file.\n");
}

/* Looks for --help and --version, which win over everything, and for the file to read. */
static enum server_config_outcome look_ahead(struct loader *loader, int argc, char *const argv[], FILE *out,
                                             const char **file)
{
    char name[TEXT_LIMIT];
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
static bool find_data_dir(struct loader *loader)
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
           complain(loader, "there is no home folder to keep meshes in: name a folder, or use --store memory");
}

static bool validate_store(struct loader *loader)
{
    const struct server_config *config = loader->config;
    if (config->store == SERVER_STORE_KIND_LOCAL) return true;
    snprintf(loader->origin, sizeof loader->origin, "--store memory");
    return (!config->persist_fields && !config->check_store && !*config->backup) ||
           complain(loader, "a store in memory keeps nothing: leave out --persist-fields, --check-store and --backup");
}

static bool validate(struct loader *loader)
{
    const struct server_config *config = loader->config;
    if (!find_data_dir(loader) || !validate_store(loader)) return false;
    snprintf(loader->origin, sizeof loader->origin, "--listen");
    if (!server_address_is_local(&config->listen)) {
        char address[SERVER_ADDRESS_TEXT];
        server_address_format(&config->listen, address);
        return complain(
            loader,
            "refusing to listen on %s: without keys everyone who reaches the address could read and delete every "
            "mesh; listen on a loopback address or a unix socket",
            address);
    }
    snprintf(loader->origin, sizeof loader->origin, "--max-body");
    return config->max_body <= config->memory_budget || complain(loader, "it can't be larger than --memory-budget");
}

enum server_config_outcome server_config_load(struct server_config *config, int argc, char *const argv[], FILE *out,
                                              FILE *error)
{
    struct loader loader = {.config = config, .error = error};
    const char *file;
    *config = (struct server_config){0};
    enum server_config_outcome outcome = look_ahead(&loader, argc, argv, out, &file);
    if (outcome != SERVER_CONFIG_RUN) return outcome;
    snprintf(loader.origin, sizeof loader.origin, "--config");
    bool ok = load_defaults(&loader) && (!file || load_file(&loader, file)) && load_environment(&loader) &&
              load_flags(&loader, argc, argv) && validate(&loader);
    return ok ? SERVER_CONFIG_RUN : SERVER_CONFIG_WRONG;
}
