/*
 * A disk that fails, for one program: loaded with LD_PRELOAD, it has the calls of that program that change files under one
 * folder fail or end the program.
 *
 * FAULTS_FOLDER   the folder; calls on other files are passed on.
 * FAULTS_SEED     seed of the random numbers.
 * FAULTS_RATE     one in so many calls fails, with ENOSPC or EIO; 0 or absent: none. A disk that is full stays so.
 * FAULTS_KILL_AT  the number of the call, from 1, at which the program is killed: one half before the call and one half
 *                 after half of it (a write of half the bytes), by the seed; 0 or absent: none.
 * FAULTS_COUNT    a file to which the number of calls is added at the end.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static uint64_t state;
static unsigned long calls, kill_at, rate;
static int full, halved;
static char folder[PATH_MAX];

__attribute__((constructor)) static void begin(void) {
    const char *value = getenv("FAULTS_FOLDER");
    if (value == NULL || realpath(value, folder) == NULL) folder[0] = '\0';
    value = getenv("FAULTS_SEED");
    state = value != NULL ? strtoull(value, NULL, 10) : 1;
    value = getenv("FAULTS_RATE");
    rate = value != NULL ? strtoul(value, NULL, 10) : 0;
    value = getenv("FAULTS_KILL_AT");
    kill_at = value != NULL ? strtoul(value, NULL, 10) : 0;
}

__attribute__((destructor)) static void end(void) {
    const char *path = getenv("FAULTS_COUNT");
    FILE *file = path != NULL && folder[0] != '\0' ? fopen(path, "w") : NULL;
    if (file == NULL) return;
    fprintf(file, "%lu\n", calls);
    fclose(file);
}

/* splitmix64 */
static uint64_t next(void) {
    uint64_t z = state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static int is_inside(const char *path) {
    size_t length = strlen(folder);
    return length > 0 && strncmp(path, folder, length) == 0 && (path[length] == '/' || path[length] == '\0');
}

static int is_watched_file(int fd) {
    char link[64], path[PATH_MAX];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t length = readlink(link, path, sizeof path - 1);
    if (length < 0) return 0;
    path[length] = '\0';
    return is_inside(path);
}

static int is_watched_path(const char *path) {
    char folder_of[PATH_MAX], whole[PATH_MAX];
    snprintf(folder_of, sizeof folder_of, "%s", path);
    char *slash = strrchr(folder_of, '/');
    if (slash == NULL) snprintf(folder_of, sizeof folder_of, ".");
    else *slash = '\0';
    return realpath(folder_of, whole) != NULL && is_inside(whole);
}

enum fate { PASS, FAIL, KILL, KILL_HALFWAY };

/* What becomes of a watched call; errno is set for one that fails. */
static enum fate decide(int takes_room) {
    enum fate fate = PASS;
    pthread_mutex_lock(&lock);
    calls++;
    if (kill_at != 0 && calls == kill_at) {
        fate = next() % 2 == 0 ? KILL : KILL_HALFWAY;
    } else if (full && takes_room) {
        errno = ENOSPC;
        fate = FAIL;
    } else if (rate != 0 && next() % rate == 0) {
        full = takes_room && next() % 2 == 0;
        errno = full ? ENOSPC : EIO;
        fate = FAIL;
    }
    pthread_mutex_unlock(&lock);
    if (fate == KILL) kill(getpid(), SIGKILL);
    return fate;
}

#define REAL(name) __typeof__(name) *real = (__typeof__(name) *)dlsym(RTLD_NEXT, #name)

ssize_t write(int fd, const void *bytes, size_t count) {
    REAL(write);
    if (!is_watched_file(fd)) return real(fd, bytes, count);
    switch (decide(1)) {
    case PASS: return real(fd, bytes, count);
    case FAIL:
        /* What fits into the last block still is written; the next call says that the disk is full. */
        if (full && !halved && count > 1 && next() % 2 == 0) {
            halved = 1;
            return real(fd, bytes, count / 2);
        }
        return -1;
    default:
        if (real(fd, bytes, count / 2) < 0) abort();
        kill(getpid(), SIGKILL);
        return -1;
    }
}

#define ON(name, is_watched, takes_room, parameters, arguments)                                                        \
    int name parameters {                                                                                              \
        REAL(name);                                                                                                    \
        if (!is_watched) return real arguments;                                                                        \
        enum fate fate = decide(takes_room);                                                                           \
        if (fate == FAIL) return -1;                                                                                   \
        int result = real arguments;                                                                                   \
        if (fate == KILL_HALFWAY) kill(getpid(), SIGKILL);                                                             \
        return result;                                                                                                 \
    }

ON(fsync, is_watched_file(fd), 1, (int fd), (fd))
ON(fdatasync, is_watched_file(fd), 1, (int fd), (fd))
ON(ftruncate64, is_watched_file(fd), 1, (int fd, off64_t length), (fd, length))
ON(rename, is_watched_path(to), 0, (const char *from, const char *to), (from, to))
ON(linkat, is_watched_path(to), 1, (int from_folder, const char *from, int to_folder, const char *to, int flags),
   (from_folder, from, to_folder, to, flags))
ON(unlink, is_watched_path(path), 0, (const char *path), (path))
