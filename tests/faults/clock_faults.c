/* A clock for tests: loaded before the C library by LD_PRELOAD.
 *
 * It stands still until the run looks for JOB.stop for the first time, which it does after its first
 * increment; from then on it stands a thousand seconds later.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(name) *)dlsym(RTLD_NEXT, #name))

static volatile time_t seconds = 1000;

int clock_gettime(clockid_t clock, struct timespec *now)
{
    if (clock != CLOCK_MONOTONIC) return REAL(clock_gettime)(clock, now);
    now->tv_sec = seconds;
    now->tv_nsec = 0;
    return 0;
}

int access(const char *path, int mode)
{
    const char *end = strrchr(path, '.');

    if (end && !strcmp(end, ".stop")) seconds = 2000;
    return REAL(access)(path, mode);
}
