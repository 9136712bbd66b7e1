/* Error: a sentence for the operator or the client with the reason for a failure. */
#pragma once

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

#define SERVER_ERROR 512 /* bytes, with the NUL */

/* Writes the sentence, truncated to fit. Returns false. */
__attribute__((format(printf, 2, 3))) static inline bool server_refuse(char error[SERVER_ERROR],
                                                                       const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error, SERVER_ERROR, format, arguments);
    va_end(arguments);
    return false;
}
