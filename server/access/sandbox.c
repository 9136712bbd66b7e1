/* See sandbox.h. */
#include "server/access/sandbox.h"

#include <errno.h>
#include <linux/capability.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/config/config.h"
#include "server/access/landlock.h"
#include "server/base/log.h"
#include "server/work/thread_affinity.h"
#include "server/access/seccomp.h"

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

/* Without CAP_SYS_NICE a thread comes before others by this limit. Where the limit can't be raised
 * (CAP_SYS_RESOURCE), all threads inherit the priority, and workers lower theirs. */
static void keep_priorities(void)
{
    const rlim_t most = 20 - SERVER_PLACE_NICE;
    struct rlimit limit;
    if (getrlimit(RLIMIT_NICE, &limit) != 0 || limit.rlim_cur >= most) return;
    limit = (struct rlimit){most, limit.rlim_max > most ? limit.rlim_max : most};
    if (setrlimit(RLIMIT_NICE, &limit) != 0) (void)setpriority(PRIO_PROCESS, 0, SERVER_PLACE_NICE);
}

static const char *drop_capabilities(void)
{
    struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
    const struct __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3] = {0};
    struct __user_cap_data_struct held[_LINUX_CAPABILITY_U32S_3] = {0};
    if (syscall(SYS_capget, &header, held) == 0 && memcmp(held, none, sizeof none) == 0)
        return NULL;
    for (unsigned capability = 0; prctl(PR_CAPBSET_READ, capability, 0, 0, 0) >= 0; capability++)
        (void)prctl(PR_CAPBSET_DROP, capability, 0, 0, 0); /* takes CAP_SETPCAP */
    (void)prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
    return syscall(SYS_capset, &header, none) == 0 ? NULL : strerror(errno);
}

struct server_sandbox server_sandbox_enter(const struct server_config *config)
{
    struct server_sandbox sandbox = {.is_wanted =
                                         config->sandbox == SERVER_SANDBOX_AUTO && !IS_SANITIZED};
    if (!sandbox.is_wanted) return sandbox;
    sandbox.new_privileges = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 ? NULL : strerror(errno);
    sandbox.landlock = server_landlock_enter(config);
    keep_priorities();
    sandbox.capabilities = drop_capabilities();
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
    bool is_whole = !sandbox->new_privileges && !sandbox->capabilities && !sandbox->landlock &&
                    !sandbox->seccomp;
    if (!server_log_begin(&line, is_whole ? SERVER_LOG_INFO : SERVER_LOG_WARN, "sandbox")) return;
    server_log_text(&line, "no_new_privileges", state(sandbox->new_privileges));
    server_log_text(&line, "no_capabilities", state(sandbox->capabilities));
    server_log_text(&line, "landlock", state(sandbox->landlock));
    server_log_text(&line, "seccomp", state(sandbox->seccomp));
    server_log_end(&line);
}
