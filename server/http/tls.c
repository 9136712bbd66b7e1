/* See tls.h.
 *
 * DESIGN. An identity is a certificate with its private key. A handshake borrows the identity that
 * is in use when the handshake begins. A reload replaces this identity and marks it as retired. A
 * later reload frees a retired identity when no handshake can still use it (connections.h limits
 * the time of handshakes). */
#include "server/http/tls.h"

#include <gnutls/abstract.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <limits.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gd/control.h"
#include "server/base/disk.h"
#include "server/base/log.h"
#include "server/base/thread.h"

#define CHAIN_MOST 8
#define RETIRED_NS UINT64_C(600000000000)

struct identity {
    gnutls_pcert_st chain[CHAIN_MOST];
    unsigned count;
    gnutls_privkey_t key;
    uint64_t retired_ns;
    struct identity *next; /* the identity that was retired before this one */
};

struct server_tls {
    char *certificate, *key; /* paths */
    struct identity *retired;
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* protects `in_force` */
static struct identity *in_force;

/* --- an identity ------------------------------------------------------------------------------ */

static void identity_free(struct identity *identity)
{
    if (!identity) return;
    for (unsigned i = 0; i < identity->count; i++) gnutls_pcert_deinit(&identity->chain[i]);
    if (identity->key) gnutls_privkey_deinit(identity->key);
    free(identity);
}

static bool identity_load_file(struct identity *identity, const char *path, bool is_key,
                               char error[SERVER_ERROR])
{
    void *bytes;
    size_t size;
    int code;
    if (server_disk_read(path, &bytes, &size) != SERVER_STORE_DONE || size > UINT_MAX)
        return server_refuse(error, "'%s' can't be used for TLS: %s", path, server_disk_why());
    const gnutls_datum_t text = {bytes, (unsigned)size};
    if (is_key) {
        code = gnutls_privkey_init(&identity->key);
        if (code == 0)
            code =
                gnutls_privkey_import_x509_raw(identity->key, &text, GNUTLS_X509_FMT_PEM, NULL, 0);
    } else {
        unsigned count = CHAIN_MOST;
        code = gnutls_pcert_list_import_x509_raw(identity->chain, &count, &text,
                                                 GNUTLS_X509_FMT_PEM, 0);
        if (code >= 0) identity->count = count;
    }
    gnutls_memset(bytes, 0, size);
    free(bytes);
    return code >= 0 ||
           server_refuse(error, "'%s' can't be used for TLS: %s", path, gnutls_strerror(code));
}

static bool identity_is_pair(const struct identity *identity)
{
    unsigned char certificate[64], key[64];
    size_t certificate_size = sizeof certificate, key_size = sizeof key;
    gnutls_pubkey_t public = NULL;
    bool same = gnutls_pubkey_init(&public) == 0 &&
                gnutls_pubkey_import_privkey(public, identity->key, 0, 0) == 0 &&
                gnutls_pubkey_get_key_id(public, 0, key, &key_size) == 0 &&
                gnutls_pubkey_get_key_id(identity->chain[0].pubkey, 0, certificate,
                                         &certificate_size) == 0 &&
                key_size == certificate_size && memcmp(key, certificate, key_size) == 0;
    if (public) gnutls_pubkey_deinit(public);
    return same;
}

/* Logs a certificate that clients reject because of its time. The certificate is used nevertheless:
 * the clock may be wrong, and a daemon that does not start helps nobody. */
static void certificate_check_time(const gnutls_pcert_st *certificate, const char *path)
{
    gnutls_x509_crt_t x509;
    char date[32];
    if (gnutls_pcert_export_x509((gnutls_pcert_st *)certificate, &x509) != 0) return;
    time_t now = time(NULL), from = gnutls_x509_crt_get_activation_time(x509),
           until = gnutls_x509_crt_get_expiration_time(x509);
    gnutls_x509_crt_deinit(x509);
    if (now >= from && now <= until) return;
    struct tm utc;
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(now < from ? &from : &until, &utc));
    server_log_message(SERVER_LOG_WARN, "certificate",
                       "a certificate of '%s' %s %s, so clients reject it: check the clock, or "
                       "replace the file and send SIGHUP",
                       path, now < from ? "is valid only from" : "has expired at", date);
}

static struct identity *identity_load(const struct server_tls *tls, char error[SERVER_ERROR])
{
    struct identity *identity = calloc(1, sizeof *identity);
    if (!identity) return NULL;
    if (identity_load_file(identity, tls->certificate, false, error) &&
        identity_load_file(identity, tls->key, true, error) &&
        (identity_is_pair(identity) ||
         server_refuse(error, "the key of '%s' is not that of the certificate of '%s'", tls->key,
                       tls->certificate)))
        return identity;
    identity_free(identity);
    return NULL;
}

/* --- for the library -------------------------------------------------------------------------- */

static int certificate_retrieve(gnutls_session_t session, const gnutls_datum_t *authorities,
                                int authority_count, const gnutls_pk_algorithm_t *algorithms,
                                int algorithm_count, gnutls_pcert_st **chain, unsigned *count,
                                gnutls_privkey_t *key)
{
    (void)session, (void)authorities, (void)authority_count, (void)algorithms,
        (void)algorithm_count;
    pthread_mutex_lock(&lock);
    struct identity *identity = in_force;
    pthread_mutex_unlock(&lock);
    if (!identity) return -1;
    *chain = identity->chain;
    *count = identity->count;
    *key = identity->key;
    return 0;
}

void *server_tls_retrieve(void)
{
    gnutls_certificate_retrieve_function2 *function = certificate_retrieve;
    return (void *)function;
}

/* --- life ------------------------------------------------------------------------------------- */

static struct identity *identity_swap(struct identity *identity)
{
    SERVER_LOCK(&lock);
    struct identity *before = in_force;
    in_force = identity;
    return before;
}

static void retired_free(struct server_tls *tls, uint64_t before_ns)
{
    struct identity **at = &tls->retired;
    while (*at && (*at)->retired_ns > before_ns) at = &(*at)->next;
    for (struct identity *old = *at, *next; old; old = next) {
        next = old->next;
        identity_free(old);
    }
    *at = NULL;
}

static void identity_retire(struct server_tls *tls, struct identity *identity)
{
    uint64_t now = gd_now_ns();
    if (now > RETIRED_NS) retired_free(tls, now - RETIRED_NS);
    if (!identity) return;
    identity->retired_ns = now;
    identity->next = tls->retired;
    tls->retired = identity;
}

bool server_tls_reload(struct server_tls *tls, char error[SERVER_ERROR])
{
    struct identity *identity = identity_load(tls, error);
    if (!identity) return false;
    for (unsigned i = 0; i < identity->count; i++)
        certificate_check_time(&identity->chain[i], tls->certificate);
    identity_retire(tls, identity_swap(identity));
    return true;
}

struct server_tls *server_tls_open(const char *certificate, const char *key,
                                   char error[SERVER_ERROR])
{
    struct server_tls *tls = calloc(1, sizeof *tls);
    if (!tls) return NULL;
    tls->certificate = strdup(certificate);
    tls->key = strdup(key);
    if (tls->certificate && tls->key && server_tls_reload(tls, error)) return tls;
    server_tls_close(tls);
    return NULL;
}

void server_tls_close(struct server_tls *tls)
{
    if (!tls) return;
    identity_free(identity_swap(NULL));
    retired_free(tls, UINT64_MAX);
    free(tls->certificate);
    free(tls->key);
    free(tls);
}
