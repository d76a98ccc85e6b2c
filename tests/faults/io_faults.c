/* Faults of the file system, for tests: loaded before the C library by LD_PRELOAD.
 *
 * Counts the calls that change files whose path contains FAULT_PATH, and at the call number
 * FAULT_AT does what FAULT_DO says:
 *   kill-before, kill-half, kill-after   SIGKILL before the call, after half of its bytes, after it
 *   short                                writes half of the bytes and returns that number
 *   a number                             fails with this errno, for FAULT_TIMES calls (default 1)
 * FAULT_CALLS names the calls that count, as a list with commas around each name, default all:
 *   ,write,sync,truncate,rename,exchange,link,unlink,open,
 * FAULT_LOG is a file that gets the number of calls at the end of the program.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(name) *)dlsym(RTLD_NEXT, #name))

enum action { PASS, KILL_HALF, KILL_AFTER, SHORT, FAIL };

static long n_calls = 0;

static const char *setting(const char *name)
{
    const char *value = getenv(name);
    return value ? value : "";
}

__attribute__((noreturn)) static void die(void)
{
    kill(getpid(), SIGKILL);
    for (;;) pause();
}

/* What is to happen at this call. */
static enum action next_action(const char *call, const char *path)
{
    char name[32];
    const char *which = setting("FAULT_CALLS"), *what = setting("FAULT_DO");
    long at = atol(setting("FAULT_AT")), times = atol(setting("FAULT_TIMES"));

    snprintf(name, sizeof name, ",%s,", call);
    if (!*setting("FAULT_PATH") || !path || !strstr(path, setting("FAULT_PATH"))) return PASS;
    if (*which && !strstr(which, name)) return PASS;
    n_calls++;
    if (at <= 0 || n_calls < at) return PASS;
    if (times <= 0) times = 1;
    if (n_calls >= at + times) return PASS;
    if (!strcmp(what, "kill-before")) die();
    if (!strcmp(what, "kill-half")) return KILL_HALF;
    if (!strcmp(what, "kill-after")) return KILL_AFTER;
    if (!strcmp(what, "short")) return SHORT;
    errno = atoi(what);
    return FAIL;
}

/* The same for a file that is open. */
static enum action next_action_on(const char *call, int fd)
{
    char link[64], path[4096];
    ssize_t n;

    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    n = readlink(link, path, sizeof path - 1);
    if (n < 0) return PASS;
    path[n] = '\0';
    return next_action(call, path);
}

__attribute__((destructor)) static void tell_count(void)
{
    FILE *log;

    if (!*setting("FAULT_LOG")) return;
    log = REAL(fopen)(setting("FAULT_LOG"), "w");
    if (!log) return;
    fprintf(log, "%ld\n", n_calls);
    fclose(log);
}

/* A call that writes n bytes: FULL does all of it, HALF the first half. */
#define WRITING(fd, n, FULL, HALF)                     \
    switch (next_action_on("write", fd)) {             \
    case FAIL: return -1;                              \
    case SHORT: return (n) > 1 ? HALF : FULL;          \
    case KILL_HALF: if ((n) > 1) (void)!HALF; die();   \
    case KILL_AFTER: (void)!FULL; die();               \
    default: return FULL;                              \
    }

ssize_t write(int fd, const void *bytes, size_t n)
{
    WRITING(fd, n, REAL(write)(fd, bytes, n), REAL(write)(fd, bytes, n / 2))
}

ssize_t pwrite(int fd, const void *bytes, size_t n, off_t at)
{
    WRITING(fd, n, REAL(pwrite)(fd, bytes, n, at), REAL(pwrite)(fd, bytes, n / 2, at))
}

ssize_t pwrite64(int fd, const void *bytes, size_t n, off64_t at)
{
    WRITING(fd, n, REAL(pwrite64)(fd, bytes, n, at), REAL(pwrite64)(fd, bytes, n / 2, at))
}

ssize_t writev(int fd, const struct iovec *parts, int n)
{
    WRITING(fd, n, REAL(writev)(fd, parts, n), REAL(writev)(fd, parts, n / 2))
}

/* A call that is done or not. */
#define DOING(action, failed, CALL)                    \
    switch (action) {                                  \
    case FAIL: return failed;                          \
    case KILL_HALF: die();                             \
    case KILL_AFTER: (void)!CALL; die();               \
    default: return CALL;                              \
    }

int fsync(int fd)
{
    DOING(next_action_on("sync", fd), -1, REAL(fsync)(fd))
}

int ftruncate(int fd, off_t length)
{
    DOING(next_action_on("truncate", fd), -1, REAL(ftruncate)(fd, length))
}

int ftruncate64(int fd, off64_t length)
{
    DOING(next_action_on("truncate", fd), -1, REAL(ftruncate64)(fd, length))
}

int rename(const char *from, const char *to)
{
    DOING(next_action("rename", to), -1, REAL(rename)(from, to))
}

int renameat2(int from_folder, const char *from, int to_folder, const char *to, unsigned flags)
{
    DOING(next_action("exchange", to), -1, REAL(renameat2)(from_folder, from, to_folder, to, flags))
}

int link(const char *from, const char *to)
{
    DOING(next_action("link", to), -1, REAL(link)(from, to))
}

int unlink(const char *path)
{
    DOING(next_action("unlink", path), -1, REAL(unlink)(path))
}

int open(const char *path, int flags, ...)
{
    mode_t mode;
    va_list more;

    va_start(more, flags);
    mode = va_arg(more, mode_t);
    va_end(more);
    if ((flags & O_ACCMODE) == O_RDONLY) return REAL(open)(path, flags, mode);
    DOING(next_action("open", path), -1, REAL(open)(path, flags, mode))
}

int open64(const char *path, int flags, ...)
{
    mode_t mode;
    va_list more;

    va_start(more, flags);
    mode = va_arg(more, mode_t);
    va_end(more);
    if ((flags & O_ACCMODE) == O_RDONLY) return REAL(open64)(path, flags, mode);
    DOING(next_action("open", path), -1, REAL(open64)(path, flags, mode))
}

FILE *fopen(const char *path, const char *mode)
{
    if (*mode == 'r') return REAL(fopen)(path, mode);
    DOING(next_action("open", path), NULL, REAL(fopen)(path, mode))
}
