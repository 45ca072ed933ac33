/* A meter that answers at once, on a pty of its own, for measuring clients.
 *
 * usage: responder [BAUD]
 *
 * With BAUD, up to 19200, it keeps the pace of a line of that speed at 8N1: the last byte of an
 * answer comes when request, 3.5 characters of silence and answer have had their time.
 *
 * Prints the path of the pty's slave and serves until it is killed: function
 * 03 of unit 1, register a holds a * 7 + 3 (16 bits). The answer to a request
 * is built once and sent again, in one write, as long as the same request
 * comes. It holds the slave open, raw: no hang-up between two clients.
 */
#define _GNU_SOURCE
#include <fcntl.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define REQUEST_LENGTH 8
#define MAX_REGISTERS 125
/* Pieces of one request follow each other within this; else they are noise. */
#define GAP_MS 50

static uint16_t crc(const uint8_t *bytes, size_t length)
{
    uint16_t remainder = 0xFFFF;
    for (size_t i = 0; i < length; i++) {
        remainder ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            remainder = remainder & 1 ? remainder >> 1 ^ 0xA001 : remainder >> 1;
    }
    return remainder;
}

/* The answer's length, or 0 when the request gets none. */
static size_t build_answer(const uint8_t *request, uint8_t *answer)
{
    uint16_t first = (uint16_t)(request[2] << 8 | request[3]);
    uint16_t count = (uint16_t)(request[4] << 8 | request[5]);
    if (crc(request, REQUEST_LENGTH) != 0 || request[0] != 1 || request[1] != 3 || count == 0 ||
        count > MAX_REGISTERS)
        return 0;
    size_t length = 0;
    answer[length++] = request[0];
    answer[length++] = request[1];
    answer[length++] = (uint8_t)(2 * count);
    for (int i = 0; i < count; i++) {
        uint16_t value = (uint16_t)((first + i) * 7 + 3);
        answer[length++] = (uint8_t)(value >> 8);
        answer[length++] = (uint8_t)value;
    }
    uint16_t check = crc(answer, length);
    answer[length++] = (uint8_t)check;
    answer[length++] = (uint8_t)(check >> 8);
    return length;
}

/* Sleeps until this many bits at `baud` after `since`. */
static void pace(struct timespec since, long bits, long baud)
{
    long long nanoseconds = since.tv_nsec + bits * 1000000000LL / baud;
    since.tv_sec += nanoseconds / 1000000000LL;
    since.tv_nsec = nanoseconds % 1000000000LL;
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &since, NULL) != 0)
        ;
}

int main(int argc, char **argv)
{
    long baud = argc > 1 ? atol(argv[1]) : 0;
    int master = posix_openpt(O_RDWR | O_NOCTTY);
    if (master == -1 || grantpt(master) == -1 || unlockpt(master) == -1) {
        perror("posix_openpt");
        return 1;
    }
    const char *path = ptsname(master);
    int slave = open(path, O_RDWR | O_NOCTTY);
    struct termios settings;
    if (slave == -1 || tcgetattr(slave, &settings) == -1) {
        perror(path);
        return 1;
    }
    cfmakeraw(&settings);
    if (tcsetattr(slave, TCSANOW, &settings) == -1) {
        perror(path);
        return 1;
    }
    puts(path);
    fflush(stdout);

    uint8_t known[REQUEST_LENGTH] = {0}, request[REQUEST_LENGTH], answer[5 + 2 * MAX_REGISTERS];
    size_t answer_length = 0, received = 0;
    for (;;) {
        if (received > 0) {
            struct pollfd more = {.fd = master, .events = POLLIN};
            if (poll(&more, 1, GAP_MS) == 0)
                received = 0;
        }
        ssize_t got = read(master, request + received, REQUEST_LENGTH - received);
        if (got <= 0) {
            perror("read");
            return 1;
        }
        received += (size_t)got;
        if (received < REQUEST_LENGTH)
            continue;
        received = 0;
        struct timespec heard;
        clock_gettime(CLOCK_MONOTONIC, &heard);
        if (memcmp(request, known, REQUEST_LENGTH) != 0) {
            memcpy(known, request, REQUEST_LENGTH);
            answer_length = build_answer(request, answer);
        }
        /* 10 bits a character, 35 of silence. */
        if (answer_length > 0 && baud > 0)
            pace(heard, 10 * (REQUEST_LENGTH + (long)answer_length) + 35, baud);
        if (answer_length > 0 && write(master, answer, answer_length) != (ssize_t)answer_length) {
            perror("write");
            return 1;
        }
    }
}
