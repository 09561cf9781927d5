/* Preloaded into a process, notes every change of files below $RECORDED in the log $RECORDING.

   A record is "operation path-length other-length offset data-length\n", the path, the other path
   and the data. `power_cut.py` reads it. Changes by other calls than these it finds by comparison.
*/
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static pthread_mutex_t busy = PTHREAD_MUTEX_INITIALIZER;

#define REAL(name, type) \
    static __typeof__(type) real; \
    if (!real) real = (type)dlsym(RTLD_NEXT, name)

static ssize_t real_write(int file, const void *data, size_t count) {
    REAL("write", ssize_t (*)(int, const void *, size_t));
    return real(file, data, count);
}

static int is_recorded(const char *path) {
    const char *below = getenv("RECORDED");
    size_t length = below ? strlen(below) : 0;
    return length && !strncmp(path, below, length) && (path[length] == '/' || !path[length]);
}

static void note(const char *operation, const char *path, const char *other, long offset,
                 const void *data, size_t count) {
    static int log = -1;
    char head[128];
    if (log < 0) {
        REAL("open", int (*)(const char *, int, ...));
        log = real(getenv("RECORDING"), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    }
    int length = snprintf(head, sizeof head, "%s %zu %zu %ld %zu\n", operation, strlen(path),
                          strlen(other), offset, count);
    real_write(log, head, length);
    real_write(log, path, strlen(path));
    real_write(log, other, strlen(other));
    if (count) real_write(log, data, count);
}

/* The path of an open file, if it is recorded. */
static int found(int file, char *path) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = readlink(link, path, PATH_MAX - 1);
    path[length > 0 ? length : 0] = 0;
    return length > 0 && is_recorded(path);
}

/* The whole path of a name in a folder, whose own links are followed, but not the name's. */
static int named(int folder, const char *name, char *path) {
    char whole[2 * PATH_MAX], base[PATH_MAX] = "";
    if (name[0] != '/') {
        if (folder == AT_FDCWD) {
            if (!getcwd(base, sizeof base)) return 0;
        } else {
            char link[64];
            snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
            ssize_t length = readlink(link, base, sizeof base - 1);
            if (length < 0) return 0;
            base[length] = 0;
        }
    }
    snprintf(whole, sizeof whole, "%s/%s", base, name);
    char *last = strrchr(whole, '/');
    *last = 0;
    if (!realpath(whole[0] ? whole : "/", path)) return 0;
    strncat(path, "/", PATH_MAX - strlen(path) - 1);
    strncat(path, last + 1, PATH_MAX - strlen(path) - 1);
    return is_recorded(path);
}

static int opened(int folder, const char *name, int flags, mode_t mode) {
    REAL("openat", int (*)(int, const char *, int, ...));
    char path[PATH_MAX];
    struct stat before;
    int existed = fstatat(folder, name, &before, 0) == 0;
    pthread_mutex_lock(&busy);
    int file = real(folder, name, flags, mode);
    if (file >= 0 && (flags & (O_CREAT | O_TRUNC)) && found(file, path)) {
        if (!existed) note("create", path, "", 0, NULL, 0);
        else if (flags & O_TRUNC) note("truncate", path, "", 0, NULL, 0);
    }
    pthread_mutex_unlock(&busy);
    return file;
}

#define MODE \
    mode_t mode = 0; \
    if (flags & (O_CREAT | O_TMPFILE)) { \
        va_list rest; \
        va_start(rest, flags); \
        mode = va_arg(rest, mode_t); \
        va_end(rest); \
    }
int open(const char *name, int flags, ...) { MODE return opened(AT_FDCWD, name, flags, mode); }
int open64(const char *name, int flags, ...) { MODE return opened(AT_FDCWD, name, flags, mode); }
int openat(int at, const char *name, int flags, ...) { MODE return opened(at, name, flags, mode); }
int openat64(int at, const char *name, int flags, ...) { MODE return opened(at, name, flags, mode); }

#define RECORDED_CALL(call, operation, offset, data, count) \
    char path[PATH_MAX]; \
    int wanted = found(file, path); \
    if (wanted) pthread_mutex_lock(&busy); \
    ssize_t result = call; \
    if (wanted) { \
        if (result >= 0) note(operation, path, "", offset, data, count); \
        pthread_mutex_unlock(&busy); \
    } \
    return result

ssize_t pwrite64(int file, const void *data, size_t size, off64_t place) {
    REAL("pwrite64", ssize_t (*)(int, const void *, size_t, off64_t));
    RECORDED_CALL(real(file, data, size, place), "write", place, data, result);
}
ssize_t pwrite(int file, const void *data, size_t size, off_t place) {
    return pwrite64(file, data, size, place);
}
ssize_t write(int file, const void *data, size_t size) {
    off_t place = lseek(file, 0, SEEK_CUR);
    struct stat now;
    if (place >= 0 && (fcntl(file, F_GETFL) & O_APPEND) && !fstat(file, &now)) place = now.st_size;
    RECORDED_CALL(real_write(file, data, size), "write", place, data, result);
}
int ftruncate64(int file, off64_t length) {
    REAL("ftruncate64", int (*)(int, off64_t));
    RECORDED_CALL(real(file, length), "truncate", length, NULL, 0);
}
int ftruncate(int file, off_t length) { return ftruncate64(file, length); }
int fsync(int file) {
    REAL("fsync", int (*)(int));
    RECORDED_CALL(real(file), "sync", 0, NULL, 0);
}
int fdatasync(int file) {
    REAL("fdatasync", int (*)(int));
    RECORDED_CALL(real(file), "sync", 0, NULL, 0);
}

static int renamed(const char *operation, int result, int wanted, const char *from, const char *to) {
    if (wanted && !result) note(operation, from, to, 0, NULL, 0);
    return result;
}
int linkat(int at, const char *name, int new_at, const char *new_name, int flags) {
    REAL("linkat", int (*)(int, const char *, int, const char *, int));
    char from[PATH_MAX], to[PATH_MAX];
    int wanted = named(at, name, from) | named(new_at, new_name, to);
    return renamed("link", real(at, name, new_at, new_name, flags), wanted, from, to);
}
int link(const char *name, const char *other) { return linkat(AT_FDCWD, name, AT_FDCWD, other, 0); }
int renameat(int at, const char *name, int new_at, const char *new_name) {
    REAL("renameat", int (*)(int, const char *, int, const char *));
    char from[PATH_MAX], to[PATH_MAX];
    int wanted = named(at, name, from) | named(new_at, new_name, to);
    return renamed("rename", real(at, name, new_at, new_name), wanted, from, to);
}
int rename(const char *from, const char *to) { return renameat(AT_FDCWD, from, AT_FDCWD, to); }
int unlinkat(int at, const char *name, int flags) {
    REAL("unlinkat", int (*)(int, const char *, int));
    char path[PATH_MAX];
    int wanted = named(at, name, path);
    return renamed("unlink", real(at, name, flags), wanted, path, "");
}
int unlink(const char *name) { return unlinkat(AT_FDCWD, name, 0); }
int rmdir(const char *name) { return unlinkat(AT_FDCWD, name, AT_REMOVEDIR); }
int mkdirat(int at, const char *name, mode_t mode) {
    REAL("mkdirat", int (*)(int, const char *, mode_t));
    char path[PATH_MAX];
    int wanted = named(at, name, path);
    return renamed("mkdir", real(at, name, mode), wanted, path, "");
}
int mkdir(const char *name, mode_t mode) { return mkdirat(AT_FDCWD, name, mode); }
