/* A meter made of libmodbus, with the registers of a file, to read with our client.
 *
 * usage: meter_server DEVICE UNIT MOST < REGISTERS
 *
 * Each line of REGISTERS is an address and a value. Holding and input registers are the same ones;
 * a read of more than MOST of them is answered with exception 03, one that touches any other with
 * exception 02. Prints "START COUNT" for each read. 9600 8N1. Serves until it is killed or the line
 * hangs up.
 */
#include <errno.h>
#include <modbus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned char known[65536];

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: %s DEVICE UNIT MOST < REGISTERS\n", argv[0]);
        return 2;
    }
    int unit = atoi(argv[2]);
    int most = atoi(argv[3]);
    modbus_t *line = modbus_new_rtu(argv[1], 9600, 'N', 8, 1);
    modbus_mapping_t *bank = modbus_mapping_new(0, 0, 65536, 65536);
    if (line == NULL || bank == NULL || modbus_set_slave(line, unit) == -1 ||
        modbus_connect(line) == -1) {
        fprintf(stderr, "%s: %s\n", argv[1], modbus_strerror(errno));
        return 1;
    }
    int address, value;
    while (scanf("%i %i", &address, &value) == 2) {
        known[address] = 1;
        bank->tab_registers[address] = bank->tab_input_registers[address] = (uint16_t)value;
    }
    /* See libmodbus_server.c. */
    modbus_set_response_timeout(line, 0, 50 * 1000);

    for (;;) {
        uint8_t request[MODBUS_RTU_MAX_ADU_LENGTH];
        int length = modbus_receive(line, request);
        if (length == -1 && (errno == EIO || errno == ECONNRESET || errno == EBADF)) {
            return 0;
        }
        if (length <= 0 || request[0] != unit) {
            continue;
        }
        int is_read = request[1] == 3 || request[1] == 4;
        int start = request[2] << 8 | request[3];
        int count = request[4] << 8 | request[5];
        if (is_read) {
            printf("%d %d\n", start, count);
            fflush(stdout);
        }
        if (is_read && count > most) {
            modbus_reply_exception(line, request, MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE);
            continue;
        }
        int all_known = start + count <= 65536;
        for (int next = start; is_read && all_known && next < start + count; next++) {
            all_known = known[next];
        }
        if (is_read && !all_known) {
            modbus_reply_exception(line, request, MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS);
        } else {
            modbus_reply(line, request, length, bank);
        }
    }
}
