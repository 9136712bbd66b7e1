/* geodesicd: configuration, signals, and nothing else. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/cpu.h"
#include "server/config.h"
#include "server/log.h"
#include "server/server.h"
#include "server/store_tools.h"
#include "server/version.h"

#define EXIT_USAGE 2

/* Blocks the signals that end the daemon, before any thread is started: they are waited for, not handled. */
static void block_signals(sigset_t *ending)
{
    sigemptyset(ending);
    sigaddset(ending, SIGTERM);
    sigaddset(ending, SIGINT);
    pthread_sigmask(SIG_BLOCK, ending, NULL);
    signal(SIGPIPE, SIG_IGN);
}

static void wait_for_end(const sigset_t *ending)
{
    int number;
    while (sigwait(ending, &number) != 0) continue;
    server_log_message(SERVER_LOG_INFO, "signal", "%s", strsignal(number));
}

static void log_address(const struct server_address *address)
{
    char text[SERVER_ADDRESS_TEXT];
    struct server_log_line line;
    server_address_format(address, text);
    if (!server_log_begin(&line, SERVER_LOG_INFO, "listening")) return;
    server_log_text(&line, "address", text);
    server_log_text(&line, "version", SERVER_VERSION);
    server_log_text(&line, "cpu", gd_cpu_name());
    server_log_end(&line);
}

int main(int argc, char *argv[])
{
    struct server_config config;
    sigset_t ending;
    char error[256];
    switch (server_config_load(&config, argc, argv, stdout, stderr)) {
    case SERVER_CONFIG_DONE:
        return EXIT_SUCCESS;
    case SERVER_CONFIG_WRONG:
        return EXIT_USAGE;
    case SERVER_CONFIG_RUN:
        break;
    }
    server_log_set_level(config.log_level);
    if (config.check_store) return server_store_check(config.data_dir, stdout) ? EXIT_SUCCESS : EXIT_FAILURE;
    if (*config.backup)
        return server_store_backup(config.data_dir, config.backup, stdout) ? EXIT_SUCCESS : EXIT_FAILURE;
    block_signals(&ending);
    server_log_start();
    struct server *server = server_start(&config, error, sizeof error);
    if (!server) {
        server_log_message(SERVER_LOG_ERROR, "start_failed", "%s", error);
        server_log_stop();
        return EXIT_FAILURE;
    }
    log_address(&server->config.listen);
    wait_for_end(&ending);
    server_stop(server);
    server_log_stop();
    return EXIT_SUCCESS;
}
