/* Ids of jobs and batches: 12 hexadecimal digits that grow with time and 12 random ones. */
#ifndef SERVER_JOBS_JOB_ID_H
#define SERVER_JOBS_JOB_ID_H

#include <stdint.h>

#define SERVER_JOB_ID 25 /* with the NUL */

/* Writes an id above all earlier ones of this process; returns the time, in seconds since 1970.
 * Thread-safe. */
int64_t server_job_id_create(char id[SERVER_JOB_ID]);

#endif
