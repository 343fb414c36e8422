// Preloaded: what is below READ_ONLY_FOLDER can only be read while the file READ_ONLY_WHILE is there.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int below(const char* path) {
  const char *folder = getenv("READ_ONLY_FOLDER"), *file = getenv("READ_ONLY_WHILE");
  const int saved = errno;
  const int is = folder && file && strncmp(path, folder, strlen(folder)) == 0 && access(file, F_OK) == 0;
  errno = saved;
  return is;
}

static int open_below(int descriptor) {
  char link[32], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const int saved = errno;
  const ssize_t length = readlink(link, path, sizeof path - 1);
  errno = saved;
  if (length < 0) return 0;
  path[length] = 0;
  return below(path);
}

static int refuse(void) {
  errno = EROFS;
  return -1;
}

#define REAL(type, name, ...) ((type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, name))

#define OPEN(name)                                                                         \
  int name(const char* path, int flags, ...) {                                             \
    va_list list;                                                                          \
    va_start(list, flags);                                                                 \
    const mode_t mode = flags & O_CREAT ? va_arg(list, mode_t) : 0;                        \
    va_end(list);                                                                          \
    if ((flags & (O_WRONLY | O_RDWR | O_CREAT | O_TRUNC)) && below(path)) return refuse(); \
    return REAL(int, #name, const char*, int, mode_t)(path, flags, mode);                  \
  }
OPEN(open)
OPEN(open64)

#define FOPEN(name)                                                  \
  FILE* name(const char* path, const char* mode) {                   \
    if (strpbrk(mode, "wa+") && below(path)) return refuse(), NULL;  \
    return REAL(FILE*, #name, const char*, const char*)(path, mode); \
  }
FOPEN(fopen)
FOPEN(fopen64)

#define PWRITE(name)                                                                    \
  ssize_t name(int file, const void* from, size_t size, off_t at) {                     \
    if (open_below(file)) return refuse();                                              \
    return REAL(ssize_t, #name, int, const void*, size_t, off_t)(file, from, size, at); \
  }
PWRITE(pwrite)
PWRITE(pwrite64)

ssize_t write(int file, const void* from, size_t size) {
  if (open_below(file)) return refuse();
  return REAL(ssize_t, "write", int, const void*, size_t)(file, from, size);
}

#define TRUNCATE(name)                               \
  int name(int file, off_t size) {                   \
    if (open_below(file)) return refuse();           \
    return REAL(int, #name, int, off_t)(file, size); \
  }
TRUNCATE(ftruncate)
TRUNCATE(ftruncate64)

#define ALLOCATE(name)                                                     \
  int name(int file, int mode, off_t at, off_t size) {                     \
    if (open_below(file)) return refuse();                                 \
    return REAL(int, #name, int, int, off_t, off_t)(file, mode, at, size); \
  }
ALLOCATE(fallocate)
ALLOCATE(fallocate64)

#define CHANGE(name)                            \
  int name(const char* path) {                  \
    if (below(path)) return refuse();           \
    return REAL(int, #name, const char*)(path); \
  }
CHANGE(unlink)
CHANGE(remove)
CHANGE(rmdir)

int mkdir(const char* path, mode_t mode) {
  if (below(path)) return refuse();
  return REAL(int, "mkdir", const char*, mode_t)(path, mode);
}

int rename(const char* from, const char* to) {
  if (below(from) || below(to)) return refuse();
  return REAL(int, "rename", const char*, const char*)(from, to);
}
