/* What config.c and config_value.c share: an option, and the loading of its value. */
#ifndef SERVER_CONFIG_CONFIG_VALUE_H
#define SERVER_CONFIG_CONFIG_VALUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define CONFIG_TEXT 512

struct server_config;

enum server_setting_kind {
    KIND_COUNT,
    KIND_BYTES,
    KIND_ADDRESS,
    KIND_HOST,
    KIND_ORIGIN,
    KIND_CHOICE,
    KIND_PATH,
    KIND_STORE,
    KIND_BOOLEAN,
    KIND_FILE,
    KIND_SWITCH
};

struct server_setting {
    const char *name, *argument, *help;
    enum server_setting_kind kind;
    size_t offset;        /* of the member in struct server_config */
    uint64_t least, most; /* KIND_COUNT, KIND_BYTES */
    const char *standard; /* default, as it would be typed; NULL: none, or found at run time */
    const char *const *
        /* KIND_CHOICE: what may be typed, NULL-terminated; the member is an enum or unsigned that
           counts them */
        words;
};

/* One loading: where sentences go, and where the value at hand came from. */
struct server_setting_loader {
    struct server_config *config;
    FILE *error;
    char origin[CONFIG_TEXT]; /* "--workers", "GEODESICD_WORKERS", "FILE:12: workers" */
};

/* Prints a sentence after the value's origin. False. */
bool server_config_complain(const struct server_setting_loader *loader, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Gives the option's member the value, or adds to it; false: complained. KIND_FILE and KIND_SWITCH
 * have none. */
bool server_config_set(const struct server_setting_loader *loader,
                       const struct server_setting *option, const char *value);

#endif
