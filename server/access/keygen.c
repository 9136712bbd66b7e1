/* geodesicd keygen: see credentials.h. */
#include "server/access/credentials.h"

#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

#define KEY_DIGITS   43 /* 6 bits each: 258 bits */
#define DAY_S        86400
#define DAYS_MOST    36500
#define SETTING_MOST 128 /* bytes of "expires=…" */

static const char usage[] =
    "usage: geodesicd keygen NAME [--role read|write|operator] [--tenant NAME] "
    "[--expires 2027-01-31|90d] [--rate N] [--concurrent N]\n";

static bool keygen_complain(FILE *error, const char *sentence)
{
    fprintf(error, "geodesicd keygen: %s\n%s", sentence, usage);
    return false;
}

/* Writes a flag as a setting: "--role write" becomes "role=write", and an expiry of "90d" becomes
 * the time 90 days from now. */
static bool setting_write(char *const pair[2], char out[SETTING_MOST])
{
    char *end = "";
    int size = snprintf(out, SETTING_MOST, "%s=%s", pair[0] + 2, pair[1]);
    long days = strncmp(out, "expires=", 8) == 0 ? strtol(pair[1], &end, 10) : 0;
    if (days < 1 || days > DAYS_MOST || strcmp(end, "d") != 0) return size < SETTING_MOST;
    time_t then = time(NULL) + days * DAY_S;
    struct tm utc;
    return gmtime_r(&then, &utc) && strftime(out, SETTING_MOST, "expires=%Y-%m-%dT%H:%M:%SZ", &utc);
}

/* Appends the flags to a line, as settings. */
static bool settings_write(int argc, char *const argv[], FILE *line, FILE *error)
{
    struct server_credential key = {.role = SERVER_ROLE_READ};
    char setting[SETTING_MOST], sentence[SERVER_ERROR];
    bool has_role = false;
    for (int at = 0; at < argc; at += 2) {
        has_role |= strcmp(argv[at], "--role") == 0;
        if (strncmp(argv[at], "--", 2) != 0 || at + 1 == argc || !setting_write(argv + at, setting))
            return keygen_complain(error, "after the name write flags, each with a value");
        fprintf(line, " %s", setting);
        if (!server_credentials_set(&key, setting, sentence))
            return keygen_complain(error, sentence);
    }
    return has_role || fputs(" role=read", line) >= 0;
}

bool server_keygen(int argc, char *const argv[], FILE *out, FILE *error)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    unsigned char bytes[KEY_DIGITS];
    char *settings = NULL, key[sizeof SERVER_CREDENTIAL_PREFIX + KEY_DIGITS] = "",
         sha256[SERVER_SHA256_HEX];
    size_t size;
    if (argc == 1 && strcmp(argv[0], "--help") == 0) return fputs(usage, out) >= 0;
    if (argc < 1 || !server_credentials_is_name(argv[0]))
        return keygen_complain(
            error,
            "a key has a name of 1 to 64 letters, digits, '_' or, not at its start, '-' and '.'");
    if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
        return keygen_complain(error, "the system has no random numbers; try again");
    strcpy(key, SERVER_CREDENTIAL_PREFIX);
    for (int i = 0; i < KEY_DIGITS; i++) key[strlen(key)] = digits[bytes[i] & 63];
    server_sha256(key, strlen(key), sha256);
    FILE *line = open_memstream(&settings, &size);
    bool is_done = line && settings_write(argc - 1, argv + 1, line, error);
    if (line && fclose(line) == 0 && is_done) {
        fputs("The key, which is shown only now, and the line for the file that --keys names:\n",
              error);
        fprintf(out, "%s\n%s sha256:%s%s\n", key, argv[0], sha256, settings);
        is_done = fflush(out) == 0;
    }
    free(settings);
    return is_done;
}
