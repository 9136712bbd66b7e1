/* See job_id.h. */
#include "server/jobs/job_id.h"

#include <stdatomic.h>
#include <stdio.h>
#include <sys/random.h>
#include <time.h>

int64_t server_job_id_create(char id[SERVER_JOB_ID])
{
    static atomic_uint_least64_t last_serial;
    const uint64_t digits = UINT64_C(0xffffffffffff);
    struct timespec now;
    uint64_t number = 0, serial, last = atomic_load(&last_serial);
    clock_gettime(CLOCK_REALTIME, &now);
    uint64_t now_ms = (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
    do serial = now_ms > last ? now_ms : last + 1;
    while (!atomic_compare_exchange_weak(&last_serial, &last, serial));
    if (getrandom(&number, sizeof number, 0) < 0) number = (uint64_t)now.tv_nsec;
    snprintf(id, SERVER_JOB_ID, "%012llx%012llx", (unsigned long long)(serial & digits),
             (unsigned long long)(number & digits));
    return now.tv_sec;
}
