/* A Modbus RTU server made of libmodbus, to read and write with our client.
 *
 * usage: libmodbus_server DEVICE BAUD none|even|odd UNIT
 *
 * 300 holding and 300 input registers from address 0, with the values that
 * `run` computes; libmodbus answers exception 02 beyond them. Other units
 * are not answered. Serves until it is killed or the line hangs up.
 */
#include <errno.h>
#include <modbus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REGISTERS 300

int main(int argc, char **argv)
{
    if (argc != 5) {
        fprintf(stderr, "usage: %s DEVICE BAUD none|even|odd UNIT\n", argv[0]);
        return 2;
    }
    const char *device = argv[1];
    int baud = atoi(argv[2]);
    char parity = strcmp(argv[3], "even") == 0 ? 'E' : strcmp(argv[3], "odd") == 0 ? 'O' : 'N';
    int unit = atoi(argv[4]);

    modbus_t *line = modbus_new_rtu(device, baud, parity, 8, 1);
    modbus_mapping_t *bank = modbus_mapping_new(0, 0, REGISTERS, REGISTERS);
    if (line == NULL || bank == NULL || modbus_set_slave(line, unit) == -1 ||
        modbus_connect(line) == -1) {
        fprintf(stderr, "%s: %s\n", device, modbus_strerror(errno));
        return 1;
    }
    for (int address = 0; address < REGISTERS; address++) {
        int holding = unit == 1 ? address * 7 + 3 : address * 13 + 1001;
        int input = unit == 1 ? address * 11 + 5 : address * 17 + 2003;
        bank->tab_registers[address] = (uint16_t)holding;
        bank->tab_input_registers[address] = (uint16_t)input;
    }

    /* After a request to another unit libmodbus takes the next frame for that
     * unit's answer, for as long as this time-out (0.5 s unless told). On a
     * line without other units the next frame is a request to us. */
    modbus_set_response_timeout(line, 0, 50 * 1000);

    for (;;) {
        uint8_t request[MODBUS_RTU_MAX_ADU_LENGTH];
        int length = modbus_receive(line, request);
        if (length > 0) {
            modbus_reply(line, request, length, bank);
        } else if (length == -1 && (errno == EIO || errno == ECONNRESET || errno == EBADF)) {
            return 0;
        }
    }
}
