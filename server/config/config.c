#include "server/config/config.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/disk.h"
#include "server/base/version.h"

#define NAME_LIMIT 32  /* largest number of bytes of an option's name */
#define TEXT_LIMIT 512 /* largest number of bytes of a value's origin or of a list of words */
#define LIST_LIMIT (SERVER_CONFIG_NAMES * (SERVER_CONFIG_NAME + 2)) /* of names, with ", " */
#define LINE_LIMIT (2 * LIST_LIMIT) /* bytes of a line of a --config file */

/* --- the table of options --------------------------------------------------------------------- */

enum option_kind {
    COUNT,
    BYTES,
    ADDRESS,
    HOST,
    ORIGIN,
    ANCESTOR, /* the origin of a page that may frame the viewer */
    CHOICE,
    PATH,
    STORE,
    BOOLEAN,
    CONFIG_FILE, /* read before the others */
    SWITCH
};

struct option {
    const char *name, *argument;
    enum option_kind kind;
    size_t offset;        /* offset of the member in struct server_config */
    uint64_t least, most; /* limits of COUNT and BYTES */
    /* the default, as an operator would type it; NULL means none, or determined at run time */
    const char *standard;
    const char *const *words; /* of a CHOICE, NULL-terminated; the value is an index into them */
    const char *help;
};

const char *const server_config_cpus[] = {"auto", "baseline", "avx2", "avx512", NULL};
static const char *const sandbox_words[] = {
    [SERVER_SANDBOX_AUTO] = "auto", [SERVER_SANDBOX_OFF] = "off", NULL};

#define MEMBER(member) offsetof(struct server_config, member)
#define NUMBER(kind, member, least, most, standard)                                                \
    kind, MEMBER(member), least, most, standard, NULL
#define CHOSEN(member, standard, words) CHOICE, MEMBER(member), 0, 0, standard, words
#define VALUE(kind, member, standard)   kind, MEMBER(member), 0, 0, standard, NULL
#define WITHOUT_MEMBER(kind)            kind, 0, 0, 0, NULL, NULL

static const struct option options[] = {
    {"listen", "ADDR:PORT|unix:PATH", VALUE(ADDRESS, listen, "127.0.0.1:8080"),
     "address to listen on; port 0 chooses a free port"},
    {"allowed-host", "HOST", VALUE(HOST, allowed_hosts, NULL),
     "also accept this Host header; may be repeated, or a list with commas"},
    {"keys", "FILE", VALUE(PATH, keys, NULL),
     "the users' keys, made by geodesicd keygen; reread at SIGHUP (default: none, and then "
     "only programs of this machine may use the daemon)"},
    {"cors-origin", "ORIGIN", VALUE(ORIGIN, cors_origins, NULL),
     "web pages of this origin (https://maps.example) may use the daemon; may be repeated, or a "
     "list with commas"},
    {"frame-ancestors", "ORIGIN", VALUE(ANCESTOR, frame_ancestors, NULL),
     "web pages of this origin may show the viewer in a frame; at most two origins of 63 "
     "characters, with a comma between them"},
    {"tls-cert", "FILE", VALUE(PATH, tls_cert, NULL),
     "the chain of certificates, PEM; with it the daemon serves HTTPS only; reread at SIGHUP"},
    {"tls-key", "FILE", VALUE(PATH, tls_key, NULL), "the certificate's private key, PEM"},
    {"max-connections", "N", NUMBER(COUNT, max_connections, 1, SERVER_CONFIG_CONNECTIONS, "8192"),
     "most open connections; further ones wait, and idle ones are closed to make room"},
    {"max-address-connections", "N",
     NUMBER(COUNT, max_address_connections, 0, SERVER_CONFIG_CONNECTIONS, "2048"),
     "most open connections from one address, at most three quarters of all; further ones are "
     "closed; 0: no limit"},
    {"workers", "N", NUMBER(COUNT, workers, 1, 1024, NULL),
     "threads that build meshes and run queries (default: the number of cores); as many spare ones "
     "work only for a tenant that has no worker, or for requests while jobs have all workers"},
    {"http-threads", "N", NUMBER(COUNT, http_threads, 1, 256, NULL),
     "threads that serve HTTP connections (default: the number of cores)"},
    {"queue-length", "N", NUMBER(COUNT, queue_length, 1, 1000000, "256"),
     "most requests that wait for a worker, and most jobs that wait; further ones get 503; with "
     "keys a tenant takes at most as many places as it leaves free"},
    {"cpu", "NAME", CHOSEN(cpu, "auto", server_config_cpus),
     "CPU instructions that computations use: auto (the best of this machine), baseline, avx2 or "
     "avx512; answers are the same"},
    {"memory-budget", "BYTES", NUMBER(BYTES, memory_budget, 1 << 20, UINT64_C(1) << 50, "4GiB"),
     "most memory for meshes, fields and computations; a 16th of it, at most 256MiB, is set aside "
     "for the memory of released fields, which later fields reuse"},
    {"max-body", "BYTES", NUMBER(BYTES, max_body, 1 << 10, UINT64_C(1) << 40, "256MiB"),
     "largest request body"},
    {"max-answer", "BYTES", NUMBER(BYTES, max_answer, 64 << 10, UINT64_C(1) << 40, "1GiB"),
     "largest answer, which is held in the memory budget until its client has read it; half of "
     "--memory-budget at most"},
    {"max-faces", "N", NUMBER(COUNT, max_faces, 1, 1 << 30, "10000000"),
     "most triangles of a mesh"},
    {"timeout-ms", "MS", NUMBER(COUNT, timeout_ms, 1, 86400000, "60000"),
     "most time that a request may take; timeout_ms in a request can only shorten it"},
    {"drain-ms", "MS", NUMBER(COUNT, drain_ms, 0, 86400000, "10000"),
     "most time that SIGTERM waits for running requests"},
    {"drain-delay-ms", "MS", NUMBER(COUNT, drain_delay_ms, 0, 86400000, "0"),
     "time after SIGTERM during which the daemon still serves, while /readyz answers 503, so that "
     "load balancers choose another daemon"},
    {"job-ttl-s", "S", NUMBER(COUNT, job_ttl_s, 1, 31536000, "3600"),
     "how long a job and its answer are kept after its end"},
    {"max-jobs", "N", NUMBER(COUNT, max_jobs, 1, 1000000, "10000"),
     "most jobs; beyond that, or when their answers fill an eighth of the memory budget, the "
     "oldest ended jobs of the key with the most jobs are dropped"},
    {"landmarks", "N", NUMBER(COUNT, landmarks, 0, 32, "32"),
     "landmark fields for a mesh, computed in idle time after its first search; they make later "
     "searches shorter; 0: none"},
    {"store", "KIND", VALUE(STORE, store, "local"),
     "where meshes are kept: local (in --data-dir), memory (until the daemon ends), or a database "
     "that many daemons share, postgresql://user@host/database; put its password into PGPASSFILE "
     "or the environment"},
    {"data-dir", "DIR", VALUE(PATH, data_dir, NULL),
     "folder of the local store (default: /var/lib/geodesicd for root, else "
     "$XDG_DATA_HOME/geodesicd or ~/.local/share/geodesicd); with a database it is optional, for "
     "landmarks and fields"},
    {"persist-fields", NULL, VALUE(BOOLEAN, persist_fields, NULL),
     "keep cached fields in the data folder over a restart"},
    {"check-store", NULL, VALUE(BOOLEAN, check_store, NULL),
     "check every file of the data folder, or every row of the database, print the findings, and "
     "exit"},
    {"backup", "DIR", VALUE(PATH, backup, NULL),
     "copy the data folder, in use or not, into a new one, and exit"},
    {"restore", "DIR", VALUE(PATH, restore, NULL),
     "create the data folder from the backup in DIR, and exit"},
    {"scrub-s", "S", NUMBER(COUNT, scrub_s, 0, 31536000, "86400"),
     "seconds from one scan of the stored files for damage to the next; 0: no scans"},
    {"scrub-rate", "BYTES", NUMBER(BYTES, scrub_rate, 1 << 10, UINT64_C(1) << 40, "16MiB"),
     "most bytes that such a scan reads in a second"},
    {"sandbox", "MODE", CHOSEN(sandbox, "auto", sandbox_words),
     "auto: drop all rights that the daemon does not need, as far as the kernel supports that "
     "(Landlock, seccomp); or off"},
    {"slow-ms", "MS", NUMBER(COUNT, slow_ms, 0, 86400000, "0"),
     "time after which a request is logged as slow_request, with a warning; 0: none"},
    {"log-level", "LEVEL", CHOSEN(log_level, "info", server_log_levels),
     "debug, info, warn or error"},
    {"config", "FILE", WITHOUT_MEMBER(CONFIG_FILE),
     "read `name = value` lines from FILE; # begins a comment"},
    {"version", NULL, WITHOUT_MEMBER(SWITCH), "print the version and exit"},
    {"help", NULL, WITHOUT_MEMBER(SWITCH), "print this and exit"},
};

#define OPTION_COUNT (sizeof options / sizeof *options)

static const struct option *option_find(const char *name, size_t size)
{
    for (size_t i = 0; i < OPTION_COUNT; i++)
        if (strlen(options[i].name) == size && strncmp(options[i].name, name, size) == 0)
            return &options[i];
    return NULL;
}

/* Returns the Levenshtein distance of two short names. */
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

static const char *name_nearest(const char *name, size_t size)
{
    const char *best = options[0].name;
    for (size_t i = 1; i < OPTION_COUNT; i++)
        if (name_distance(name, size, options[i].name) < name_distance(name, size, best))
            best = options[i].name;
    return best;
}

/* --- values ----------------------------------------------------------------------------------- */

struct loader {
    struct server_config *config;
    FILE *error;
    char origin[TEXT_LIMIT]; /* "--workers", "GEODESICD_WORKERS", "FILE:12" */
};

/* Prints the origin of the current value and a sentence. Returns false. */
__attribute__((format(printf, 2, 3))) static bool loader_complain(const struct loader *loader,
                                                                  const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(loader->error, "geodesicd: %s: ", loader->origin);
    vfprintf(loader->error, format, arguments);
    fputc('\n', loader->error);
    va_end(arguments);
    return false;
}

/* Parses "4096", and with units also "64k", "512MiB", "4G", "4GiB", in powers of 1024. */
static bool number_parse(const char *text, bool has_units, uint64_t *out)
{
    static const char units[] = "KMGT";
    char *rest;
    if (!isdigit((unsigned char)*text)) return false;
    errno = 0;
    *out = strtoull(text, &rest, 10);
    if (errno) return false;
    const char *unit = has_units && *rest ? strchr(units, toupper((unsigned char)*rest)) : NULL;
    if (unit) {
        unsigned shift = 10 * (unsigned)(unit - units + 1);
        if (*out > UINT64_MAX >> shift || (rest[1] && rest[1] != 'i')) return false;
        *out <<= shift;
        rest += rest[1] ? 2 : 1;
    }
    return !*rest || (has_units && strcmp(rest, "B") == 0);
}

static bool number_set(const struct loader *loader, const struct option *option, const char *value,
                       uint64_t *member)
{
    bool is_size = option->kind == BYTES;
    if (!number_parse(value, is_size, member))
        return loader_complain(
            loader,
            is_size ? "'%s' is not a size; write a number of bytes or one like 512MiB, 4GiB"
                    : "'%s' is not a whole number",
            value);
    return (*member >= option->least && *member <= option->most) ||
           loader_complain(loader, "%s is outside %llu to %llu", value,
                           (unsigned long long)option->least, (unsigned long long)option->most);
}

/* Returns whether the text has the form of an origin: "https://maps.example:8443". */
static bool is_origin(const char *text)
{
    const char *authority = strstr(text, "://");
    if (!authority || (strncmp(text, "http://", 7) != 0 && strncmp(text, "https://", 8) != 0))
        return false;
    return authority[3] && !strpbrk(authority + 3, "/*@?#;'\t");
}

static bool names_add(const struct loader *loader, const struct option *option, const char *value,
                      struct server_config_list *member)
{
    char list[LIST_LIMIT], *rest;
    if (snprintf(list, sizeof list, "%s", value) >= (int)sizeof list)
        return loader_complain(loader, "the list has more than %d bytes", LIST_LIMIT - 1);
    for (char *name = strtok_r(list, ", ", &rest); name; name = strtok_r(NULL, ", ", &rest)) {
        if (strlen(name) >= SERVER_CONFIG_NAME)
            return loader_complain(loader, "'%s' is too long", name);
        bool is_ancestor = option->kind == ANCESTOR;
        if (is_ancestor && (member->count == 2 || strlen(name) > 63))
            return loader_complain(loader, "at most two origins of 63 characters can be listed");
        if ((is_ancestor || option->kind == ORIGIN) && !is_origin(name))
            return loader_complain(loader,
                                   "'%s' is not an origin; write scheme, host and port as in "
                                   "https://maps.example:8443",
                                   name);
        if (option->kind == HOST && strpbrk(name, "/\t"))
            return loader_complain(
                loader, "'%s' is not a host name; write it as in a URL, without scheme and path",
                name);
        if (member->count == SERVER_CONFIG_NAMES)
            return loader_complain(loader, "at most %d names can be listed", SERVER_CONFIG_NAMES);
        strcpy(member->name[member->count++], name);
    }
    return true;
}

static bool choice_set(const struct loader *loader, const struct option *option, const char *value,
                       unsigned *member)
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
    return loader_complain(loader, "'%s' is not possible here; write %s", value, list);
}

static bool path_set(const struct loader *loader, const char *value, char *member)
{
    if (!*value || strlen(value) >= SERVER_CONFIG_PATH)
        return loader_complain(loader, "a path has 1 to %d bytes", SERVER_CONFIG_PATH - 1);
    strcpy(member, value);
    for (size_t size = strlen(member); size > 1 && member[size - 1] == '/'; size--)
        member[size - 1] = '\0';
    return true;
}

/* Sets the store. Messages do not repeat the value, because it may be an address with a
 * password. */
static bool store_set(const struct loader *loader, const char *value)
{
    struct server_config *config = loader->config;
    bool is_url =
        strncmp(value, "postgresql://", 13) == 0 || strncmp(value, "postgres://", 11) == 0;
    if (strlen(value) >= sizeof config->store_url)
        return loader_complain(loader, "the address is too long");
    if (!is_url && strcmp(value, "local") != 0 && strcmp(value, "memory") != 0)
        return loader_complain(
            loader, "write local, memory, or an address postgresql://user@host/database");
    config->store = is_url          ? SERVER_STORE_KIND_POSTGRES
                    : *value == 'l' ? SERVER_STORE_KIND_LOCAL
                                    : SERVER_STORE_KIND_MEMORY;
    strcpy(config->store_url, is_url ? value : "");
    return true;
}

static bool option_set(const struct loader *loader, const struct option *option, const char *value)
{
    void *member = (char *)loader->config + option->offset;
    char sentence[SERVER_ERROR];
    switch (option->kind) {
    case COUNT:
    case BYTES:
        return number_set(loader, option, value, member);
    case ADDRESS:
        return server_address_parse(value, member, sentence) ||
               loader_complain(loader, "%s", sentence);
    case HOST:
    case ORIGIN:
    case ANCESTOR:
        return names_add(loader, option, value, member);
    case CHOICE:
        return choice_set(loader, option, value, member);
    case PATH:
        return path_set(loader, value, member);
    case STORE:
        return store_set(loader, value);
    case BOOLEAN:
        *(bool *)member = strcmp(value, "true") == 0;
        return *(bool *)member || strcmp(value, "false") == 0 ||
               loader_complain(loader, "write true or false");
    case CONFIG_FILE:
    case SWITCH:
        break;
    }
    return true;
}

/* --- sources of values, weakest first --------------------------------------------------------- */

static bool load_defaults(struct loader *loader)
{
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    loader->config->workers = loader->config->http_threads = cores > 0 ? (uint64_t)cores : 1;
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        snprintf(loader->origin, sizeof loader->origin, "default of --%s", options[i].name);
        if (options[i].standard && !option_set(loader, &options[i], options[i].standard))
            return false;
    }
    return true;
}

static char *text_trim(char *text)
{
    while (isspace((unsigned char)*text)) text++;
    size_t size = strlen(text);
    while (size && isspace((unsigned char)text[size - 1])) text[--size] = '\0';
    return text;
}

static bool load_line(struct loader *loader, char *line)
{
    line[strcspn(line, "#")] = '\0';
    char *name = text_trim(line);
    if (!*name) return true;
    char *equals = strchr(name, '=');
    if (!equals) return loader_complain(loader, "write `name = value`");
    *equals = '\0';
    name = text_trim(name);
    const struct option *option = option_find(name, strlen(name));
    if (option && (option->kind == SWITCH || option->kind == CONFIG_FILE))
        return loader_complain(loader, "'%s' can't be set in a file", name);
    if (!option)
        return loader_complain(loader, "there is no setting '%s'; did you mean '%s'?", name,
                               name_nearest(name, strlen(name)));
    return option_set(loader, option, text_trim(equals + 1));
}

static bool load_file(struct loader *loader, const char *path)
{
    FILE *file = server_disk_stream(path);
    snprintf(loader->origin, sizeof loader->origin, "--config");
    if (!file) return loader_complain(loader, "can't read '%s': %s", path, server_disk_why());
    char line[LINE_LIMIT];
    bool ok = true;
    for (unsigned number = 1; ok && fgets(line, sizeof line, file); number++) {
        snprintf(loader->origin, sizeof loader->origin, "%s:%u", path, number);
        ok = (strchr(line, '\n') || feof(file) ||
              loader_complain(loader, "a line has at most %d bytes", LINE_LIMIT - 2)) &&
             load_line(loader, line);
    }
    fclose(file);
    return ok;
}

/* Returns the value of the option's variable, and writes the variable's name (such as
 * GEODESICD_MAX_BODY) to `name`. */
static const char *environment_get(const struct option *option, char name[TEXT_LIMIT])
{
    snprintf(name, TEXT_LIMIT, "GEODESICD_%s", option->name);
    for (char *c = name; *c; c++) *c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
    return getenv(name);
}

static bool load_environment(struct loader *loader)
{
    for (size_t i = 0; i < OPTION_COUNT; i++) {
        const char *value = environment_get(&options[i], loader->origin);
        if (value && !option_set(loader, &options[i], value)) return false;
    }
    return true;
}

struct flag {
    const struct option *option;
    const char *value; /* NULL for a switch */
};

/* Reads the flag argv[*at], and its value if that is argv[*at + 1]. Advances `*at`. `argv` ends
 * with NULL. */
static bool flag_read(struct loader *loader, char *const argv[], int *at, struct flag *out)
{
    const char *text = argv[(*at)++];
    snprintf(loader->origin, sizeof loader->origin, "%s", text);
    if (strncmp(text, "--", 2) != 0)
        return loader_complain(loader, "flags begin with --; try --help");
    size_t size = strcspn(text + 2, "=");
    out->option = option_find(text + 2, size);
    if (!out->option)
        return loader_complain(loader, "there is no such flag; did you mean --%s?",
                               name_nearest(text + 2, size));
    out->value = text[2 + size] ? text + 3 + size : NULL;
    if (out->option->kind == SWITCH)
        return !out->value || loader_complain(loader, "this flag takes no value");
    if (out->value) return true;
    if (out->option->kind == BOOLEAN)
        out->value = "true";
    else if (argv[*at])
        out->value = argv[(*at)++];
    return out->value || loader_complain(loader, "a value is missing: %s", out->option->argument);
}

static void print_help(FILE *out)
{
    fprintf(out, "geodesicd: exact geodesics on surfaces, as a network service\n\n"
                 "usage: geodesicd [--flag value | --flag=value]...\n"
                 "       geodesicd keygen NAME [--role read|write|operator] [--tenant NAME]\n"
                 "           [--expires TIME|DAYSd] [--rate N] [--concurrent N]\n\n");
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

/* Sets the values of the flags. With `file`, only handles --help and --version, and finds
 * --config. */
static enum server_config_outcome load_flags(struct loader *loader, char *const argv[], FILE *out,
                                             const char **file)
{
    struct flag flag = {0};
    for (int at = 1; argv[at];) {
        if (!flag_read(loader, argv, &at, &flag)) return SERVER_CONFIG_WRONG;
        if (!file && !option_set(loader, flag.option, flag.value)) return SERVER_CONFIG_WRONG;
        if (file && flag.option->kind == CONFIG_FILE) *file = flag.value;
        if (flag.option->kind != SWITCH) continue;
        if (strcmp(flag.option->name, "help") == 0)
            print_help(out);
        else
            fprintf(out, "geodesicd " SERVER_VERSION "\n");
        return SERVER_CONFIG_DONE;
    }
    return SERVER_CONFIG_RUN;
}

/* --- the result ------------------------------------------------------------------------------- */

/* Sets the default data folder: for root a folder of the system, otherwise a folder of the user. */
static bool find_data_dir(struct server_config *config)
{
    const char *data_home = getenv("XDG_DATA_HOME"), *home = getenv("HOME");
    bool has_data_home = data_home && *data_home == '/', has_home = home && *home == '/';
    if (geteuid() != 0 && !has_data_home && !has_home) return false;
    return snprintf(config->data_dir, SERVER_CONFIG_PATH, "%s%s/geodesicd",
                    geteuid() == 0  ? "/var/lib"
                    : has_data_home ? data_home
                                    : home,
                    geteuid() == 0 || has_data_home ? "" : "/.local/share") < SERVER_CONFIG_PATH;
}

static bool config_validate(struct loader *loader)
{
    struct server_config *config = loader->config;
    bool is_shared = config->store == SERVER_STORE_KIND_POSTGRES,
         is_memory = config->store == SERVER_STORE_KIND_MEMORY,
         copies = *config->backup || *config->restore;
    int commands = config->check_store + !!*config->backup + !!*config->restore;
    char listen[sizeof "--listen " + SERVER_ADDRESS_TEXT] = "--listen ";
    server_address_format(&config->listen, listen + strlen(listen));
    const struct {
        bool is_wrong;
        const char *flag, *sentence;
    } rules[] = {
        {config->store == SERVER_STORE_KIND_LOCAL && !*config->data_dir && !find_data_dir(config),
         "--data-dir",
         "there is no home folder to keep meshes in: name a folder, or use --store memory"},
        {commands > 1, *config->backup ? "--backup" : "--restore",
         "give only one of --check-store, --backup and --restore"},
        {is_shared && copies, "--store",
         "copy a database with pg_dump: omit --backup and --restore"},
        {is_shared && config->persist_fields && !*config->data_dir, "--store",
         "--persist-fields needs a folder: give --data-dir"},
        {is_memory && (config->persist_fields || config->check_store || copies), "--store",
         "a store in memory keeps nothing: omit --persist-fields, --check-store, --backup and "
         "--restore"},
        {!*config->tls_cert != !*config->tls_key, "--tls-cert",
         "--tls-cert and --tls-key belong together: give both or none"},
        {!*config->keys && !server_address_is_local(&config->listen), listen,
         "refusing to listen: without keys everyone who reaches the address could read and delete "
         "every mesh; give --keys, or listen on a loopback address or a unix socket"},
        {config->max_body > config->memory_budget, "--max-body",
         "it can't be larger than --memory-budget"}};
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (rules[i].is_wrong) {
            snprintf(loader->origin, sizeof loader->origin, "%s", rules[i].flag);
            return loader_complain(loader, "%s", rules[i].sentence);
        }
    return true;
}

enum server_config_outcome server_config_load(struct server_config *config, char *const argv[],
                                              FILE *out, FILE *error)
{
    struct loader loader = {.config = config, .error = error};
    *config = (struct server_config){0};
    const char *file = environment_get(option_find("config", strlen("config")), loader.origin);
    enum server_config_outcome outcome = load_flags(&loader, argv, out, &file);
    if (outcome != SERVER_CONFIG_RUN) return outcome;
    if (!load_defaults(&loader) || (file && !load_file(&loader, file)) ||
        !load_environment(&loader))
        return SERVER_CONFIG_WRONG;
    outcome = load_flags(&loader, argv, out, NULL);
    return outcome || config_validate(&loader) ? outcome : SERVER_CONFIG_WRONG;
}
