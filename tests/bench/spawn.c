/* Runs a command and tells what it cost.
 *
 * usage: spawn OUTPUT COMMAND [ARGUMENT...]
 *
 * The command's stdout goes into the file OUTPUT. Prints wall time in ns from
 * before the fork to after the wait, peak resident memory in KiB, and the exit
 * code (-1 when a signal ended it).
 *
 * Small on purpose: on Linux a child's ru_maxrss starts at what its parent had
 * resident, since exec books the memory it replaces. Started from Python, no
 * child would ever seem to need less than Python.
 */
#define _GNU_SOURCE
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>

extern char **environ;

static long long now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000000000LL + now.tv_nsec;
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        fprintf(stderr, "usage: %s OUTPUT COMMAND [ARGUMENT...]\n", argv[0]);
        return 2;
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, argv[1], O_WRONLY | O_CREAT | O_TRUNC, 0600);

    pid_t child;
    int status;
    struct rusage usage;
    long long start = now_ns();
    int error = posix_spawnp(&child, argv[2], &actions, NULL, argv + 2, environ);
    if (error != 0) {
        fprintf(stderr, "%s: %s\n", argv[2], strerror(error));
        return 1;
    }
    if (wait4(child, &status, 0, &usage) == -1) {
        perror("wait4");
        return 1;
    }
    long long end = now_ns();
    printf("%lld %ld %d\n", end - start, usage.ru_maxrss, WIFEXITED(status) ? WEXITSTATUS(status) : -1);
    return 0;
}
