/* geodesicd keygen: see credentials.h. */
#include "server/access/credentials.h"

#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

#define RANDOM_BYTES 32
#define TEXT_BYTES   44 /* of RANDOM_BYTES in base64url without padding, and the NUL */
#define DAY_S        86400
#define DAYS_MOST    36500

struct order {
    const char *name, *role, *tenant, *rate, *concurrent;
    char expires[64]; /* empty: never */
};

static const char usage[] =
    "usage: geodesicd keygen NAME [--role read|write|operator] [--tenant NAME] "
    "[--expires 2027-01-31|90d] [--rate N] [--concurrent N]\n";

static bool complain(FILE *error, const char *sentence)
{
    fprintf(error, "geodesicd keygen: %s\n%s", sentence, usage);
    return false;
}

/* "90d", or a time. */
static bool expiry_read(const char *text, char out[64])
{
    int64_t when;
    char *end;
    if (server_credentials_parse_time(text, &when)) return snprintf(out, 64, "%s", text) < 64;
    long days = strtol(text, &end, 10);
    if (end == text || strcmp(end, "d") != 0 || days < 1 || days > DAYS_MOST) return false;
    time_t then = time(NULL) + days * DAY_S;
    struct tm utc;
    return gmtime_r(&then, &utc) && strftime(out, 64, "%Y-%m-%dT%H:%M:%SZ", &utc) > 0;
}

static bool flag_read(const char *flag, const char *value, struct order *order, FILE *error)
{
    if (!value) return complain(error, "the last flag has no value");
    if (strcmp(flag, "--role") == 0) {
        enum server_role role;
        order->role = value;
        return server_credentials_parse_role(value, &role) ||
               complain(error,
                        "a role is read, write or operator, which sees the metrics of all tenants");
    }
    if (strcmp(flag, "--tenant") == 0) {
        order->tenant = value;
        return !*value || server_credentials_is_name(value) ||
               complain(error, "a tenant has the form of a name");
    }
    if (strcmp(flag, "--expires") == 0)
        return expiry_read(value, order->expires) ||
               complain(error, "--expires takes a time, as 2027-01-31 or 2027-01-31T12:00:00Z, or "
                               "days, as 90d");
    if (strcmp(flag, "--rate") != 0 && strcmp(flag, "--concurrent") != 0)
        return complain(error, "flags are --role, --tenant, --expires, --rate and --concurrent");
    *(strcmp(flag, "--rate") == 0 ? &order->rate : &order->concurrent) = value;
    size_t digits = strspn(value, "0123456789");
    return (digits > 0 && digits < 7 && !value[digits] && atoi(value) > 0) ||
           complain(error, "--rate and --concurrent take a number, 1 to 999999");
}

static bool order_read(int argc, char *const argv[], struct order *order, FILE *error)
{
    *order = (struct order){.role = "read"};
    if (argc < 1 || !server_credentials_is_name(argv[0]))
        return complain(
            error,
            "a key has a name of 1 to 64 letters, digits, '_' or, not at its start, '-' and '.'");
    order->name = argv[0];
    for (int at = 1; at < argc; at += 2)
        if (!flag_read(argv[at], at + 1 < argc ? argv[at + 1] : NULL, order, error)) return false;
    return true;
}

/* RFC 4648, 5, without padding. */
static void key_encode(const unsigned char bytes[RANDOM_BYTES], char text[TEXT_BYTES])
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    for (int i = 0; i < TEXT_BYTES - 1; i++) {
        int bit = 6 * i, byte = bit / 8;
        unsigned pair =
            (unsigned)bytes[byte] << 8 | (byte + 1 < RANDOM_BYTES ? bytes[byte + 1] : 0);
        text[i] = digits[pair >> (10 - bit % 8) & 63];
    }
    text[TEXT_BYTES - 1] = '\0';
}

bool server_keygen(int argc, char *const argv[], FILE *out, FILE *error)
{
    struct order order;
    unsigned char bytes[RANDOM_BYTES];
    char sha256[SERVER_SHA256_HEX],
        key[sizeof SERVER_CREDENTIAL_PREFIX + TEXT_BYTES] = SERVER_CREDENTIAL_PREFIX;
    if (argc == 1 && strcmp(argv[0], "--help") == 0) return fputs(usage, out) >= 0;
    if (!order_read(argc, argv, &order, error)) return false;
    if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
        return complain(error, "the system gives no random numbers");
    key_encode(bytes, key + strlen(SERVER_CREDENTIAL_PREFIX));
    fputs("The key, which is shown only now, and the line for the file that --keys names:\n",
          error);
    server_sha256(key, strlen(key), sha256);
    fprintf(out, "%s\n%s sha256:%s role=%s", key, order.name, sha256, order.role);
    if (order.tenant) fprintf(out, " tenant=%s", order.tenant);
    if (*order.expires) fprintf(out, " expires=%s", order.expires);
    if (order.rate) fprintf(out, " rate=%s", order.rate);
    if (order.concurrent) fprintf(out, " concurrent=%s", order.concurrent);
    fputc('\n', out);
    return fflush(out) == 0;
}
