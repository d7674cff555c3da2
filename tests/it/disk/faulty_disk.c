/* A disk that fails at the n-th call. Preloaded into sculptd by the test `faulty_disk`: calls that
 * change a file whose path contains FAULTY_PATH are counted; call FAULTY_AT, and with FAULTY_FOR=ever
 * every later one, fails as FAULTY_KIND says: eio, enospc, short (half is written, then ENOSPC),
 * lies (a sync does nothing and says it did), rot (one bit of what is read is another; then reads
 * are counted and not changes, as they are with FAULTY_READS). The number of calls is written to
 * FAULTY_COUNT. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long calls;
enum verdict { GOOD, FAIL, SHORT, LIE };

static int watched_path(const char *path) {
    const char *part = getenv("FAULTY_PATH");
    return part && path && strstr(path, part) != NULL;
}

static int watched(int fd) {
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t n = readlink(link, path, sizeof path - 1);
    if (n <= 0) return 0;
    path[n] = 0;
    return watched_path(path);
}

static int counts_reads(void) {
    const char *kind = getenv("FAULTY_KIND");
    return getenv("FAULTY_READS") || (kind && !strcmp(kind, "rot"));
}

static enum verdict judge_call(int sync, int read) {
    if (read != counts_reads()) return GOOD;
    long n = atomic_fetch_add(&calls, 1) + 1;
    const char *at = getenv("FAULTY_AT"), *kind = getenv("FAULTY_KIND");
    const char *count = getenv("FAULTY_COUNT"), *ever = getenv("FAULTY_FOR");
    if (count) {
        int (*real_open)(const char *, int, ...) = dlsym(RTLD_NEXT, "open");
        ssize_t (*real_write)(int, const void *, size_t) = dlsym(RTLD_NEXT, "write");
        char text[32];
        int fd = real_open(count, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        int length = snprintf(text, sizeof text, "%ld", n);
        if (fd >= 0) {
            real_write(fd, text, (size_t)length);
            close(fd);
        }
    }
    if (!at || !kind) return GOOD;
    long first = atol(at);
    if (n < first || (n > first && !ever)) return GOOD;
    if (!strcmp(kind, "rot")) return FAIL;
    if (!strcmp(kind, "lies")) return sync ? LIE : GOOD;
    errno = !strcmp(kind, "eio") ? EIO : ENOSPC;
    return !strcmp(kind, "short") && !sync ? SHORT : FAIL;
}

static enum verdict judge(int sync) { return judge_call(sync, 0); }

#define REAL(name) __typeof__(&name) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

ssize_t write(int fd, const void *from, size_t n) {
    REAL(write);
    enum verdict v = watched(fd) ? judge(0) : GOOD;
    if (v == FAIL) return -1;
    return real(fd, from, v == SHORT ? (n + 1) / 2 : n);
}

static ssize_t rot(ssize_t n, void *to) {
    if (n > 0 && judge_call(0, 1) != GOOD) ((unsigned char *)to)[n / 3] ^= 4;
    return n;
}

ssize_t read(int fd, void *to, size_t n) {
    REAL(read);
    ssize_t got = real(fd, to, n);
    return watched(fd) ? rot(got, to) : got;
}

#define PREAD(name, offset)                            \
    ssize_t name(int fd, void *to, size_t n, offset at) { \
        REAL(name);                                    \
        ssize_t got = real(fd, to, n, at);             \
        return watched(fd) ? rot(got, to) : got;       \
    }
PREAD(pread, off_t)
PREAD(pread64, off64_t)

#define PWRITE(name, offset)                                        \
    ssize_t name(int fd, const void *from, size_t n, offset at) {   \
        REAL(name);                                                 \
        enum verdict v = watched(fd) ? judge(0) : GOOD;             \
        if (v == FAIL) return -1;                                   \
        return real(fd, from, v == SHORT ? (n + 1) / 2 : n, at);    \
    }
PWRITE(pwrite, off_t)
PWRITE(pwrite64, off64_t)

#define SYNC(name)                                   \
    int name(int fd) {                               \
        REAL(name);                                  \
        enum verdict v = watched(fd) ? judge(1) : GOOD; \
        if (v == LIE) return 0;                      \
        return v == GOOD ? real(fd) : -1;            \
    }
SYNC(fsync)
SYNC(fdatasync)

#define TRUNCATE(name, offset)                                      \
    int name(int fd, offset length) {                               \
        REAL(name);                                                 \
        return watched(fd) && judge(0) != GOOD ? -1 : real(fd, length); \
    }
TRUNCATE(ftruncate, off_t)
TRUNCATE(ftruncate64, off64_t)

int rename(const char *from, const char *to) {
    REAL(rename);
    return watched_path(to) && judge(0) != GOOD ? -1 : real(from, to);
}

int renameat2(int a, const char *from, int b, const char *to, unsigned flags) {
    int (*real)(int, const char *, int, const char *, unsigned) = dlsym(RTLD_NEXT, "renameat2");
    return watched_path(to) && judge(0) != GOOD ? -1 : real(a, from, b, to, flags);
}

#define OPEN(name)                                                        \
    int name(const char *path, int flags, ...) {                          \
        REAL(name);                                                       \
        mode_t mode = 0;                                                  \
        if (flags & O_CREAT) {                                            \
            va_list rest;                                                 \
            va_start(rest, flags);                                        \
            mode = (mode_t)va_arg(rest, int);                             \
            va_end(rest);                                                 \
        }                                                                 \
        int bad = (flags & O_CREAT) && watched_path(path) && judge(0) != GOOD; \
        return bad ? -1 : real(path, flags, mode);                        \
    }
OPEN(open)
OPEN(open64)
