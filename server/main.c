/* The program geodesicd: its commands, signals and sandbox. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gd/cpu.h"
#include "server/access/sandbox.h"
#include "server/base/thread.h"
#include "server/base/version.h"
#include "server/server.h"
#include "server/store/local/local.h"
#include "server/store/store.h"

#define EXIT_USAGE 2
/* the longest time from the end of --drain-ms to the end of the process */
#define END_MS 30000

/* Blocks, before any thread starts, the signals that main waits for. */
static void block_signals(sigset_t *awaited)
{
    sigemptyset(awaited);
    sigaddset(awaited, SIGHUP);
    sigaddset(awaited, SIGTERM);
    sigaddset(awaited, SIGINT);
    pthread_sigmask(SIG_BLOCK, awaited, NULL);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); /* a write beyond RLIMIT_FSIZE fails instead of ending the process */
}

/* Opens /dev/null for closed standard descriptors. Otherwise the next opened file could get the
 * descriptor of standard error, and the log would be written into that file. */
static void open_standard_descriptors(void)
{
    int descriptor;
    while ((descriptor = open("/dev/null", O_RDWR)) >= 0 && descriptor <= STDERR_FILENO) continue;
    if (descriptor >= 0) close(descriptor);
}

/* Ends the process if a stop takes too long, for example because a worker is in a system call on a
 * disk that does not answer. All answered changes are stored already. */
static void stop_limit(void *user, struct server_thread *thread)
{
    const struct server_config *config = user;
    uint64_t most_ms = config->drain_delay_ms + config->drain_ms + END_MS;
    if (!server_thread_pause(thread, SERVER_THREAD_FOREVER) || /* until the stop begins */
        !server_thread_sleep(thread, most_ms * 1000000))
        return;
    server_log_message(
        SERVER_LOG_ERROR, "stop_failed",
        "the daemon has not stopped %d s after --drain-ms, because a thread does not "
        "return, and ends now; every answered change is stored",
        END_MS / 1000);
    server_log_stop();
    _exit(EXIT_FAILURE);
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

static void log_start(const struct server_config *config)
{
    char text[SERVER_ADDRESS_TEXT];
    struct server_log_line line;
    server_address_format(&config->listen, text);
    if (server_log_begin(&line, SERVER_LOG_INFO, "listening")) {
        server_log_text(&line, "address", text);
        server_log_text(&line, "protocol", *config->tls_cert ? "https" : "http");
        server_log_text(&line, "version", SERVER_VERSION);
        server_log_text(&line, "cpu", gd_cpu_name());
        server_log_end(&line);
    }
    if (*config->keys && !*config->tls_cert && !server_address_is_local(&config->listen))
        server_log_message(SERVER_LOG_WARN, "keys_in_clear",
                           "keys are sent unencrypted: give --tls-cert and --tls-key, or listen "
                           "behind a proxy with TLS");
}

/* Runs --check-store, --backup or --restore. Returns false if none of them is given. */
static bool run_store_command(const struct server_config *config, bool *is_done)
{
    if (config->check_store)
        *is_done = config->store == SERVER_STORE_KIND_POSTGRES
                       ? server_store_check_postgres(config->store_url, stdout)
                       : server_store_check(config->data_dir, stdout);
    else if (*config->backup)
        *is_done = server_store_backup(config->data_dir, config->backup, stdout);
    else if (*config->restore)
        *is_done = server_store_restore(config->data_dir, config->restore, stdout);
    else
        return false;
    return true;
}

/* Creates the data folder, as the store would, because Landlock's rules need existing folders. The
 * store reports a failure when it opens the folder. */
static struct server_sandbox enter_sandbox(const struct server_config *config)
{
    bool is_shared = config->store == SERVER_STORE_KIND_POSTGRES,
         has_folder = *config->data_dir && config->store != SERVER_STORE_KIND_MEMORY;
    const struct server_sandbox_needs needs = {
        .folder = has_folder ? config->data_dir : NULL,
        .files = {config->keys, config->tls_cert, config->tls_key},
        .address = &config->listen,
        .database = is_shared ? config->store_url : NULL,
        .each_port = server_postgres_each_port,
        .each_file = server_postgres_each_file};
    struct server_files files;
    if (config->sandbox == SERVER_SANDBOX_OFF) return server_sandbox_enter(NULL);
    if (has_folder && is_shared)
        (void)server_disk_make_folder(config->data_dir);
    else if (has_folder && server_files_open(&files, config->data_dir))
        server_files_close(&files);
    return server_sandbox_enter(&needs);
}

/* Starts the daemon. Binds the port before the sandbox forbids that. */
static struct server *daemon_start(struct server_config *config, struct server_thread **limit,
                                   char error[SERVER_ERROR])
{
    int listening = server_address_bind(&config->listen, error);
    if (listening < 0) return NULL;
    struct server_sandbox sandbox = enter_sandbox(config);
    if (!server_log_start() || !(*limit = server_thread_start(stop_limit, config))) {
        snprintf(error, SERVER_ERROR, "can't start a thread: raise the limit of threads");
        return NULL;
    }
    server_log_flush_at_crash();
    struct server *server = server_start(config, listening, error);
    if (server) server_sandbox_seal(&sandbox);
    return server;
}

int main(int argc, char *argv[])
{
    struct server_config config;
    sigset_t awaited;
    char error[SERVER_ERROR];
    open_standard_descriptors();
    if (argc > 1 && strcmp(argv[1], "keygen") == 0)
        return server_keygen(argc - 2, argv + 2, stdout, stderr) ? EXIT_SUCCESS : EXIT_USAGE;
    enum server_config_outcome outcome = server_config_load(&config, argv, stdout, stderr);
    if (outcome != SERVER_CONFIG_RUN)
        return outcome == SERVER_CONFIG_DONE ? EXIT_SUCCESS : EXIT_USAGE;
    /* files of the data folder, and copies of it, are private */
    config.listen.mode = 0777 & ~umask(077);
    server_log_set_level(config.log_level);
    bool is_done;
    if (run_store_command(&config, &is_done)) return is_done ? EXIT_SUCCESS : EXIT_FAILURE;
    block_signals(&awaited);
    struct server_thread *limit;
    struct server *server = daemon_start(&config, &limit, error);
    if (!server) {
        server_log_message(SERVER_LOG_ERROR, "start_failed", "%s", error);
        server_log_stop();
        return EXIT_FAILURE;
    }
    log_start(&server->config);
    wait_for_end(server, &awaited);
    server_thread_wake(limit);
    server_stop(server);
    server_thread_stop(limit);
    server_log_stop();
    return EXIT_SUCCESS;
}
