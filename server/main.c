/* geodesicd: configuration, signals, and nothing else. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gd/cpu.h"
#include "server/config/config.h"
#include "server/access/credentials.h"
#include "server/base/log.h"
#include "server/access/sandbox.h"
#include "server/server.h"
#include "server/store/local/files.h"
#include "server/store/postgres/address.h"
#include "server/store/store.h"
#include "server/base/version.h"

#define EXIT_USAGE 2

/* Blocks the signals that end the daemon, or have it read keys and certificates again, before any
 * thread is started: they are waited for, not handled. */
static void block_signals(sigset_t *awaited)
{
    sigemptyset(awaited);
    sigaddset(awaited, SIGHUP);
    sigaddset(awaited, SIGTERM);
    sigaddset(awaited, SIGINT);
    pthread_sigmask(SIG_BLOCK, awaited, NULL);
    signal(SIGPIPE, SIG_IGN);
    /* a limit on the size of files (RLIMIT_FSIZE) is a write that fails */
    signal(SIGXFSZ, SIG_IGN);
}

/* Descriptors that are closed at the start become /dev/null: else the first file that is opened
 * would get the log. */
static void open_standard_descriptors(void)
{
    int descriptor;
    while ((descriptor = open("/dev/null", O_RDWR)) >= 0 && descriptor <= STDERR_FILENO) continue;
    if (descriptor >= 0) close(descriptor);
}

static void wait_for_end(struct server *server, const sigset_t *awaited)
{
    int number;
    for (;;) {
        while (sigwait(awaited, &number) != 0) continue;
        if (number != SIGHUP) break;
        server_reload(server);
    }
    server_log_message(SERVER_LOG_INFO, "signal", "%s", strsignal(number));
}

static void log_address(const struct server_config *config)
{
    char text[SERVER_ADDRESS_TEXT];
    struct server_log_line line;
    server_address_format(&config->listen, text);
    if (!server_log_begin(&line, SERVER_LOG_INFO, "listening")) return;
    server_log_text(&line, "address", text);
    server_log_text(&line, "protocol", *config->tls_cert ? "https" : "http");
    server_log_text(&line, "version", SERVER_VERSION);
    server_log_text(&line, "cpu", gd_cpu_name());
    server_log_end(&line);
}

static void warn_of_clear_keys(const struct server_config *config)
{
    if (!*config->keys || *config->tls_cert || server_address_is_local(&config->listen)) return;
    server_log_message(SERVER_LOG_WARN, "keys_in_clear",
                       "keys come unencrypted: give --tls-cert and --tls-key, or listen behind a "
                       "proxy that speaks TLS");
}

static bool check_store(const struct server_config *config)
{
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        return server_store_check_postgres(config->store_url, stdout);
    return server_store_check(config->data_dir, stdout);
}

/* Landlock's rules are for folders that exist: the data folder is made as the store would make it.
 * A failure is found again, and reported, when the store opens the folder. */
static void make_data_folder(const struct server_config *config)
{
    struct server_store_files files;
    char error[512];
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        (void)server_disk_make_folder(config->data_dir);
    else if (server_files_open(&files, config->data_dir, error, sizeof error))
        server_files_close(&files);
}

static struct server_sandbox enter_sandbox(const struct server_config *config)
{
    bool has_folder = *config->data_dir && config->store != SERVER_STORE_KIND_MEMORY;
    const struct server_sandbox_needs needs = {
        .folder = has_folder ? config->data_dir : NULL,
        .files = {config->keys, config->tls_cert, config->tls_key},
        .address = &config->listen,
        .database = config->store == SERVER_STORE_KIND_POSTGRES ? config->store_url : NULL,
        .each_port = server_postgres_each_port,
        .each_file = server_postgres_each_file};
    if (config->sandbox == SERVER_SANDBOX_OFF) return server_sandbox_enter(NULL);
    if (has_folder) make_data_folder(config);
    return server_sandbox_enter(&needs);
}

/* The sandbox takes the right to bind a port. */
static struct server *start(struct server_config *config, char *error, size_t error_size)
{
    int listening = server_address_bind(&config->listen, error, error_size);
    if (listening < 0) return NULL;
    struct server_sandbox sandbox = enter_sandbox(config);
    if (!server_log_start()) {
        snprintf(error, error_size, "no thread can be started for the log");
        return NULL;
    }
    server_log_flush_at_crash();
    struct server *server = server_start(config, listening, error, error_size);
    if (server) server_sandbox_seal(&sandbox);
    return server;
}

int main(int argc, char *argv[])
{
    struct server_config config;
    sigset_t awaited;
    char error[512];
    open_standard_descriptors();
    if (argc > 1 && strcmp(argv[1], "keygen") == 0)
        return server_keygen(argc - 2, argv + 2, stdout, stderr) ? EXIT_SUCCESS : EXIT_USAGE;
    switch (server_config_load(&config, argc, argv, stdout, stderr)) {
    case SERVER_CONFIG_DONE:
        return EXIT_SUCCESS;
    case SERVER_CONFIG_WRONG:
        return EXIT_USAGE;
    case SERVER_CONFIG_RUN:
        break;
    }
    /* files of the data folder, and copies of it, are private */
    config.listen.mode = 0777 & ~umask(077);
    server_log_set_level(config.log_level);
    if (config.check_store) return check_store(&config) ? EXIT_SUCCESS : EXIT_FAILURE;
    if (*config.backup)
        return server_store_backup(config.data_dir, config.backup, stdout) ? EXIT_SUCCESS
                                                                           : EXIT_FAILURE;
    if (*config.restore)
        return server_store_restore(config.data_dir, config.restore, stdout) ? EXIT_SUCCESS
                                                                             : EXIT_FAILURE;
    block_signals(&awaited);
    struct server *server = start(&config, error, sizeof error);
    if (!server) {
        server_log_message(SERVER_LOG_ERROR, "start_failed", "%s", error);
        server_log_stop();
        return EXIT_FAILURE;
    }
    log_address(&server->config);
    warn_of_clear_keys(&server->config);
    wait_for_end(server, &awaited);
    server_stop(server);
    server_log_stop();
    return EXIT_SUCCESS;
}
