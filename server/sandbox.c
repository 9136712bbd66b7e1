/* See sandbox.h. */
#include "server/sandbox.h"

#include <errno.h>
#include <string.h>
#include <sys/prctl.h>

#include "server/config.h"
#include "server/landlock.h"
#include "server/log.h"
#include "server/seccomp.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define IS_SANITIZED true
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IS_SANITIZED true
#endif
#ifndef IS_SANITIZED
#define IS_SANITIZED false
#endif

struct server_sandbox server_sandbox_enter(const struct server_config *config)
{
    struct server_sandbox sandbox = {.is_wanted = config->sandbox == SERVER_SANDBOX_AUTO && !IS_SANITIZED};
    if (!sandbox.is_wanted) return sandbox;
    sandbox.new_privileges = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 ? NULL : strerror(errno);
    sandbox.landlock = server_landlock_enter(config);
    sandbox.connects = config->store == SERVER_STORE_KIND_POSTGRES;
    return sandbox;
}

static const char *state(const char *missing)
{
    return missing ? missing : "on";
}

void server_sandbox_seal(struct server_sandbox *sandbox)
{
    struct server_log_line line;
    if (!sandbox->is_wanted) return;
    sandbox->seccomp = server_seccomp_seal(sandbox->connects);
    bool is_whole = !sandbox->new_privileges && !sandbox->landlock && !sandbox->seccomp;
    if (!server_log_begin(&line, is_whole ? SERVER_LOG_INFO : SERVER_LOG_WARN, "sandbox")) return;
    server_log_text(&line, "no_new_privileges", state(sandbox->new_privileges));
    server_log_text(&line, "landlock", state(sandbox->landlock));
    server_log_text(&line, "seccomp", state(sandbox->seccomp));
    server_log_end(&line);
}
