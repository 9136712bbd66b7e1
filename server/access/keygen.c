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
#define EXPIRY_TEXT  64

enum flag { ROLE, TENANT, EXPIRES, RATE, CONCURRENT, FLAGS };
static const char *const flags[FLAGS] = {"role", "tenant", "expires", "rate", "concurrent"};

static const char usage[] =
    "usage: geodesicd keygen NAME [--role read|write|operator] [--tenant NAME] "
    "[--expires 2027-01-31|90d] [--rate N] [--concurrent N]\n";

static bool keygen_complain(FILE *error, const char *sentence)
{
    fprintf(error, "geodesicd keygen: %s\n%s", sentence, usage);
    return false;
}

/* "90d", or a time. */
static bool expiry_read(const char *text, char out[EXPIRY_TEXT])
{
    int64_t when;
    char *end;
    if (server_credentials_parse_time(text, &when))
        return snprintf(out, EXPIRY_TEXT, "%s", text) < EXPIRY_TEXT;
    long days = strtol(text, &end, 10);
    if (end == text || strcmp(end, "d") != 0 || days < 1 || days > DAYS_MOST) return false;
    time_t then = time(NULL) + days * DAY_S;
    struct tm utc;
    return gmtime_r(&then, &utc) && strftime(out, EXPIRY_TEXT, "%Y-%m-%dT%H:%M:%SZ", &utc) > 0;
}

static bool is_count(const char *text)
{
    size_t digits = strspn(text, "0123456789");
    return digits > 0 && digits < 7 && !text[digits] && atoi(text) > 0;
}

/* Checks the values of the flags, NULL where one is missing, and replaces that of --expires. */
static bool values_check(const char *values[FLAGS], char expires[EXPIRY_TEXT], FILE *error)
{
    enum server_role role;
    if (!server_credentials_parse_role(values[ROLE], &role))
        return keygen_complain(
            error, "a role is read, write or operator, which sees the metrics of all tenants");
    if (values[TENANT] && *values[TENANT] && !server_credentials_is_name(values[TENANT]))
        return keygen_complain(error, "a tenant has the form of a name");
    if (values[EXPIRES] && !expiry_read(values[EXPIRES], expires))
        return keygen_complain(error,
                               "--expires takes a time, as 2027-01-31 or 2027-01-31T12:00:00Z, or "
                               "days, as 90d");
    if (values[EXPIRES]) values[EXPIRES] = expires;
    for (int flag = RATE; flag <= CONCURRENT; flag++)
        if (values[flag] && !is_count(values[flag]))
            return keygen_complain(error, "--rate and --concurrent take a number, 1 to 999999");
    return true;
}

static bool flags_read(int argc, char *const argv[], const char *values[FLAGS], FILE *error)
{
    for (int at = 1; at < argc; at += 2) {
        int flag = 0;
        while (flag < FLAGS &&
               (strncmp(argv[at], "--", 2) != 0 || strcmp(argv[at] + 2, flags[flag]) != 0))
            flag++;
        if (flag == FLAGS)
            return keygen_complain(
                error, "flags are --role, --tenant, --expires, --rate and --concurrent");
        if (at + 1 == argc) return keygen_complain(error, "the last flag has no value");
        values[flag] = argv[at + 1];
    }
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
    const char *values[FLAGS] = {"read"};
    unsigned char bytes[RANDOM_BYTES];
    char expires[EXPIRY_TEXT], sha256[SERVER_SHA256_HEX],
        key[sizeof SERVER_CREDENTIAL_PREFIX + TEXT_BYTES] = SERVER_CREDENTIAL_PREFIX;
    if (argc == 1 && strcmp(argv[0], "--help") == 0) return fputs(usage, out) >= 0;
    if (argc < 1 || !server_credentials_is_name(argv[0]))
        return keygen_complain(
            error,
            "a key has a name of 1 to 64 letters, digits, '_' or, not at its start, '-' and '.'");
    if (!flags_read(argc, argv, values, error) || !values_check(values, expires, error))
        return false;
    if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
        return keygen_complain(error, "the system gives no random numbers");
    key_encode(bytes, key + strlen(SERVER_CREDENTIAL_PREFIX));
    server_sha256(key, strlen(key), sha256);
    fputs("The key, which is shown only now, and the line for the file that --keys names:\n",
          error);
    fprintf(out, "%s\n%s sha256:%s", key, argv[0], sha256);
    for (int flag = 0; flag < FLAGS; flag++)
        if (values[flag]) fprintf(out, " %s=%s", flags[flag], values[flag]);
    fputc('\n', out);
    return fflush(out) == 0;
}
