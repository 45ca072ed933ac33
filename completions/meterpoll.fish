# Print an optspec for argparse to handle cmd's options that are independent of any subcommand.
function __fish_meterpoll_global_optspecs
    string join \n q/quiet v/verbose h/help V/version
end

function __fish_meterpoll_needs_command
    # Figure out if the current invocation already has a command.
    set -l cmd (commandline -opc)
    set -e cmd[1]
    argparse -s (__fish_meterpoll_global_optspecs) -- $cmd 2>/dev/null
    or return
    if set -q argv[1]
        # Also print the command, so this can be used to figure out what it is.
        echo $argv[1]
        return 1
    end
    return 0
end

function __fish_meterpoll_using_subcommand
    set -l cmd (__fish_meterpoll_needs_command)
    test -z "$cmd"
    and return 1
    contains -- $cmd[1] $argv
end

complete -c meterpoll -n "__fish_meterpoll_needs_command" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -s h -l help -d 'Print help'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "read-registers" -d 'Read points of a meter by name, or raw registers by address'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "write-setpoint" -d 'Write points of a meter by name, or raw registers by address, and read them back'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "broadcast" -d 'Write to every meter on the line at once, without an answer'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "execute-operation" -d 'Have a meter do something: reset, clear energy, set its clock'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "read-status" -d 'Read the eight status bits of a meter, by name (function 07)'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "loopback" -d 'Send words to a unit and compare what comes back: is the line good?'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "poll" -d 'Read meters over and over, at a fixed rate, into files; or once, as from cron'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "meters" -d 'List known meters, show one, print its profile, check a profile, verify it on a live meter'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "ports" -d 'List serial ports, without opening any'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "simulate" -d 'Be a meter, or several, on a pty, a serial port or TCP, with faults on request'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "completions" -d 'Print a shell\'s completion script'
complete -c meterpoll -n "__fish_meterpoll_needs_command" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s a -l unit -d 'The units to read: 17, or 1,2,5-9; --unit-id and --slave mean the same' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l meter -d 'The meter: a name that `meters list` shows, or a profile file' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l function -d 'The function raw registers are read with; a meter\'s points as well where it takes both for one [default: what the meter wants, else 3]' -r -f -a "3\t'Read Holding Registers'
4\t'Read Input Registers'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l numbering -d 'How register numbers are written' -r -f -a "protocol\t'Addresses as on the wire, from 0'
modicon\t'30001 or 300001 for input registers, 40001 or 400001 for holding registers'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s f -l format -d 'How readings are printed [default: table; with --output csv]' -r -f -a "table\t'For people'
csv\t'Comma-separated values with a header'
json\t'One array of objects, one a reading'
jsonl\t'One object a line, one a reading'
influx\t'Influx line protocol, a line a row'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l layout -d 'Shape of CSV [default: wide]' -r -f -a "wide\t'A row a meter, a column a point'
long\t'A row a reading'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s o -l output -d 'Append the rows to this file and print none: as csv, or jsonl or influx with --format' -r -F
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l on-schema-change -d 'What to do about a file with other columns, or that holds something else' -r -f -a "refuse\t'Write nothing, and end with code 7'
new-file\t'Go on in name.2.csv, name.3.csv and on, the first that fits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s p -l port -d 'Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable `METERPOLL_PORT` serves as well' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s b -l baud -d 'Speed in bits a second [default: the meter\'s factory setting, else 9600]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s P -l parity -d 'Parity [default: the meter\'s factory setting, else none]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s s -l stop-bits -d 'Stop bits [default: the meter\'s factory setting, else 1]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s t -l timeout -d 'How long a meter may take to begin its answer, such as 500ms; a late one is waited for as long again and thrown away [default: the meter\'s longest answer time, else 1s]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l retries -d 'How often a read is repeated when the line fails, at most 100 times' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l pause -d 'Least time between the end of an answer and the next request [default: what the meter wants; 3.5 characters of silence are kept always]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l settle -d 'Time to wait after opening the port, for adapters that need it' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l wait -d 'How long to wait for a port that another program holds; after that the message names it where the system tells' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l echo -d 'Whether the line sends our own bytes back, as two-wire adapters may' -r -f -a "auto\t'Recognise an echo when one comes'
on\t'The line echoes'
off\t'The line does not echo'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l units -d 'Put units into the header of wide CSV'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l no-sync -d 'Leave it to the system when rows reach the disk: less wear of flash memory, and a power cut can take the last ones'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l dry-run -d 'Print the requests in hex and send nothing'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -l plan -d 'Print the requests with the registers, points and time of each, and send nothing'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-registers" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s a -l unit -d 'The units to write to, one after the other: 17, or 1,2,5-9; --unit-id and --slave mean the same' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l meter -d 'The meter: a name that `meters list` shows, or a profile file; it tells what may be written' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l function -d 'The function to write with [default: 6 for one register, 16 for several, as the meter takes them]' -r -f -a "6\t'Write Single Register'
16\t'Write Multiple Registers'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l numbering -d 'How register numbers are written' -r -f -a "protocol\t'Addresses as on the wire, from 0'
modicon\t'30001 or 300001 for input registers, 40001 or 400001 for holding registers'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s p -l port -d 'Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable `METERPOLL_PORT` serves as well' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s b -l baud -d 'Speed in bits a second [default: the meter\'s factory setting, else 9600]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s P -l parity -d 'Parity [default: the meter\'s factory setting, else none]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s s -l stop-bits -d 'Stop bits [default: the meter\'s factory setting, else 1]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s t -l timeout -d 'How long a meter may take to begin its answer, such as 500ms; a late one is waited for as long again and thrown away [default: the meter\'s longest answer time, else 1s]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l retries -d 'How often a read is repeated when the line fails, at most 100 times' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l pause -d 'Least time between the end of an answer and the next request [default: what the meter wants; 3.5 characters of silence are kept always]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l settle -d 'Time to wait after opening the port, for adapters that need it' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l wait -d 'How long to wait for a port that another program holds; after that the message names it where the system tells' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l echo -d 'Whether the line sends our own bytes back, as two-wire adapters may' -r -f -a "auto\t'Recognise an echo when one comes'
on\t'The line echoes'
off\t'The line does not echo'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s y -l yes -d 'Do what is hazardous without asking; needed where nobody can be asked'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l dry-run -d 'Print the requests in hex and send nothing'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -l no-verify -d 'Leave out reading back what was written'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand write-setpoint" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l meter -d 'The meter: a name that `meters list` shows, or a profile file; it tells what may be broadcast' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l function -d 'The function to write with [default: 6 for one register, 16 for several, as the meter obeys them]' -r -f -a "6\t'Write Single Register'
16\t'Write Multiple Registers'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l numbering -d 'How register numbers are written' -r -f -a "protocol\t'Addresses as on the wire, from 0'
modicon\t'30001 or 300001 for input registers, 40001 or 400001 for holding registers'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l turnaround -d 'How long the meters get to do it before anything else is sent, or the port is left' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l verify-units -d 'Read these units afterwards and tell which of them hold the values: 17, or 1,2,5-9' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s p -l port -d 'Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable `METERPOLL_PORT` serves as well' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s b -l baud -d 'Speed in bits a second [default: the meter\'s factory setting, else 9600]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s P -l parity -d 'Parity [default: the meter\'s factory setting, else none]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s s -l stop-bits -d 'Stop bits [default: the meter\'s factory setting, else 1]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s t -l timeout -d 'How long a meter may take to begin its answer, such as 500ms; a late one is waited for as long again and thrown away [default: the meter\'s longest answer time, else 1s]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l retries -d 'How often a read is repeated when the line fails, at most 100 times' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l pause -d 'Least time between the end of an answer and the next request [default: what the meter wants; 3.5 characters of silence are kept always]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l settle -d 'Time to wait after opening the port, for adapters that need it' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l wait -d 'How long to wait for a port that another program holds; after that the message names it where the system tells' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l echo -d 'Whether the line sends our own bytes back, as two-wire adapters may' -r -f -a "auto\t'Recognise an echo when one comes'
on\t'The line echoes'
off\t'The line does not echo'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l force -d 'Send also what the meter\'s manual does not say can be broadcast'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l one-by-one -d 'Send each point in a request of its own: the clock\'s time and date apart'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s y -l yes -d 'Do what is hazardous without asking; needed where nobody can be asked'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -l dry-run -d 'Print the requests in hex and send nothing'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand broadcast" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s a -l unit -d 'The units to tell, one after the other: 17, or 1,2,5-9; --unit-id and --slave mean the same' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l meter -d 'The meter: a name that `meters list` shows, or a profile file' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l function -d 'The function to tell it with, for operations that have a number [default: 5, or 16 where something goes with it]' -r -f -a "5\t'Write Single Coil: the number alone'
16\t'Write Multiple Registers: the meter\'s command registers'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s p -l port -d 'Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable `METERPOLL_PORT` serves as well' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s b -l baud -d 'Speed in bits a second [default: the meter\'s factory setting, else 9600]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s P -l parity -d 'Parity [default: the meter\'s factory setting, else none]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s s -l stop-bits -d 'Stop bits [default: the meter\'s factory setting, else 1]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s t -l timeout -d 'How long a meter may take to begin its answer, such as 500ms; a late one is waited for as long again and thrown away [default: the meter\'s longest answer time, else 1s]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l retries -d 'How often a read is repeated when the line fails, at most 100 times' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l pause -d 'Least time between the end of an answer and the next request [default: what the meter wants; 3.5 characters of silence are kept always]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l settle -d 'Time to wait after opening the port, for adapters that need it' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l wait -d 'How long to wait for a port that another program holds; after that the message names it where the system tells' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l echo -d 'Whether the line sends our own bytes back, as two-wire adapters may' -r -f -a "auto\t'Recognise an echo when one comes'
on\t'The line echoes'
off\t'The line does not echo'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l list -d 'List the meter\'s operations and what is hazardous about them'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s y -l yes -d 'Do what is hazardous without asking; needed where nobody can be asked'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -l dry-run -d 'Print the requests in hex and send nothing'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand execute-operation" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s a -l unit -d 'The units to read: 17, or 1,2,5-9; --unit-id and --slave mean the same' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -l meter -d 'The meter: a name that `meters list` shows, or a profile file; it tells what the bits mean' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s f -l format -d 'How the status is printed' -r -f -a "table\t'For people: a line a unit'
csv\t'Comma-separated values with a header, a row a unit'
json\t'One array of objects, one a unit'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s p -l port -d 'Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable `METERPOLL_PORT` serves as well' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s b -l baud -d 'Speed in bits a second [default: the meter\'s factory setting, else 9600]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s P -l parity -d 'Parity [default: the meter\'s factory setting, else none]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s s -l stop-bits -d 'Stop bits [default: the meter\'s factory setting, else 1]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s t -l timeout -d 'How long a meter may take to begin its answer, such as 500ms; a late one is waited for as long again and thrown away [default: the meter\'s longest answer time, else 1s]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -l retries -d 'How often a read is repeated when the line fails, at most 100 times' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -l pause -d 'Least time between the end of an answer and the next request [default: what the meter wants; 3.5 characters of silence are kept always]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -l settle -d 'Time to wait after opening the port, for adapters that need it' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -l wait -d 'How long to wait for a port that another program holds; after that the message names it where the system tells' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -l echo -d 'Whether the line sends our own bytes back, as two-wire adapters may' -r -f -a "auto\t'Recognise an echo when one comes'
on\t'The line echoes'
off\t'The line does not echo'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -l dry-run -d 'Print the requests in hex and send nothing'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand read-status" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s a -l unit -d 'The units to test, one after the other: 17, or 1,2,5-9; --unit-id and --slave mean the same' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l meter -d 'The meter: a name that `meters list` shows, or a profile file; it tells what the meter sends back [default: anything]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l count -d 'How many words each unit gets, one try each; at most 1000000' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l interval -d 'Least time from the start of one try to the start of the next, such as 100ms; with 0s as fast as line and meter allow' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s f -l format -d 'How tries are printed' -r -f -a "table\t'For people: a line a try and a summary'
csv\t'Comma-separated values with a header, a row a try; the summary goes to stderr'
json\t'One object with the settings, the tries and the summary'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s p -l port -d 'Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable `METERPOLL_PORT` serves as well' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s b -l baud -d 'Speed in bits a second [default: the meter\'s factory setting, else 9600]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s P -l parity -d 'Parity [default: the meter\'s factory setting, else none]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s s -l stop-bits -d 'Stop bits [default: the meter\'s factory setting, else 1]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s t -l timeout -d 'How long a meter may take to begin its answer, such as 500ms; a late one is waited for as long again and thrown away [default: the meter\'s longest answer time, else 1s]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l pause -d 'Least time between the end of an answer and the next request [default: what the meter wants; 3.5 characters of silence are kept always]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l settle -d 'Time to wait after opening the port, for adapters that need it' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l wait -d 'How long to wait for a port that another program holds; after that the message names it where the system tells' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l echo -d 'Whether the line sends our own bytes back, as two-wire adapters may' -r -f -a "auto\t'Recognise an echo when one comes'
on\t'The line echoes'
off\t'The line does not echo'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l retries -d 'How often a read is repeated when the line fails, at most 100 times' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l forever -d 'Go on until stopped; SIGINT, SIGTERM and SIGHUP let the summary be printed'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -l dry-run -d 'Print the requests in hex and send nothing'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand loopback" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l config -d 'A site file: lines, meters, intervals and outputs; a port that is given besides is not used' -r -F
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s a -l unit -d 'The units to read: 17, or 1,2,5-9; --unit-id and --slave mean the same' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l meter -d 'The meter: a name that `meters list` shows, or a profile file' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l every -d 'How often, from 10ms to 24h: on round times in UTC, so that 15m is at :00, :15, :30 and :45; what does not divide a day counts from 1970-01-01' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l deadline -d 'How long --once may take in all; what it does not come to is missing [default: the longest interval, where there is one]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s f -l format -d 'How rows are written [default: csv; on a terminal, a table of the last values in place of rows]' -r -f -a "csv\t'Comma-separated values with a header'
jsonl\t'One object a line, one a reading'
influx\t'Influx line protocol'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l layout -d 'Shape of CSV [default: wide]' -r -f -a "wide\t'A row a meter, a column a point'
long\t'A row a reading'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l on-schema-change -d 'What to do about a file with other columns, or that holds something else' -r -f -a "refuse\t'Write nothing, and end with code 7'
new-file\t'Go on in name.2.csv, name.3.csv and on, the first that fits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s p -l port -d 'Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable `METERPOLL_PORT` serves as well' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s b -l baud -d 'Speed in bits a second [default: the meter\'s factory setting, else 9600]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s P -l parity -d 'Parity [default: the meter\'s factory setting, else none]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s s -l stop-bits -d 'Stop bits [default: the meter\'s factory setting, else 1]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s t -l timeout -d 'How long a meter may take to begin its answer, such as 500ms; a late one is waited for as long again and thrown away [default: the meter\'s longest answer time, else 1s]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l retries -d 'How often a read is repeated when the line fails, at most 100 times' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l pause -d 'Least time between the end of an answer and the next request [default: what the meter wants; 3.5 characters of silence are kept always]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l settle -d 'Time to wait after opening the port, for adapters that need it' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l echo -d 'Whether the line sends our own bytes back, as two-wire adapters may' -r -f -a "auto\t'Recognise an echo when one comes'
on\t'The line echoes'
off\t'The line does not echo'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s o -l output -d 'Append the rows to this file and print none; {meter} and the fields of strftime, such as %Y-%m-%d, are filled in, in UTC' -r -F
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l wait -d 'How long to wait for a port that another program holds; after that the message names it where the system tells' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l once -d 'Read everything once and end, as from cron'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l check -d 'Check everything, print what would be read when and how long that takes, and open nothing'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l skip-failed -d 'Write no row where nothing could be read'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l units -d 'Put units into the header of wide CSV'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -l no-sync -d 'Leave it to the system when rows reach the disk: less wear of flash memory, and a power cut can take the last ones'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand poll" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -s h -l help -d 'Print help'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -f -a "list" -d 'List the meters inside the program and your own'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -f -a "show" -d 'Show a meter: its line, limits and groups, and its points'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -f -a "export" -d 'Print the profile of a meter as the TOML file that it is'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -f -a "check" -d 'Check profile files: whether they load, and what they may lack all the same'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -f -a "verify" -d 'Read a live meter and test what its profile says must hold: sums, powers, frequency'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and not __fish_seen_subcommand_from list show export check verify help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from list" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from list" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from list" -s h -l help -d 'Print help'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from list" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from show" -s f -l format -d 'How they are shown' -r -f -a "table\t'For people; a single point with all there is to say about it'
csv\t'Comma-separated values with a header, a row a point'
json\t'One object, with the points in an array'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from show" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from show" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from show" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from show" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from export" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from export" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from export" -s h -l help -d 'Print help'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from export" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from check" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from check" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from check" -s h -l help -d 'Print help'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from check" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s a -l unit -d 'The units to read: 17, or 1,2,5-9' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s p -l port -d 'Serial port such as /dev/ttyUSB0 or COM3, or `sim:` for the simulated line; the variable `METERPOLL_PORT` serves as well' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s b -l baud -d 'Speed in bits a second [default: the meter\'s factory setting, else 9600]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s P -l parity -d 'Parity [default: the meter\'s factory setting, else none]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s s -l stop-bits -d 'Stop bits [default: the meter\'s factory setting, else 1]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s t -l timeout -d 'How long a meter may take to begin its answer, such as 500ms; a late one is waited for as long again and thrown away [default: the meter\'s longest answer time, else 1s]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -l retries -d 'How often a read is repeated when the line fails, at most 100 times' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -l pause -d 'Least time between the end of an answer and the next request [default: what the meter wants; 3.5 characters of silence are kept always]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -l settle -d 'Time to wait after opening the port, for adapters that need it' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -l wait -d 'How long to wait for a port that another program holds; after that the message names it where the system tells' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -l echo -d 'Whether the line sends our own bytes back, as two-wire adapters may' -r -f -a "auto\t'Recognise an echo when one comes'
on\t'The line echoes'
off\t'The line does not echo'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from verify" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from help" -f -a "list" -d 'List the meters inside the program and your own'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from help" -f -a "show" -d 'Show a meter: its line, limits and groups, and its points'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from help" -f -a "export" -d 'Print the profile of a meter as the TOML file that it is'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from help" -f -a "check" -d 'Check profile files: whether they load, and what they may lack all the same'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from help" -f -a "verify" -d 'Read a live meter and test what its profile says must hold: sums, powers, frequency'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand meters; and __fish_seen_subcommand_from help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand ports" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand ports" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand ports" -s h -l help -d 'Print help'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand ports" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -s p -l port -d 'Where clients come from; its path or address is the first line on stdout [default: a new pty]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -l meter -d 'A meter and its units: a name that `meters list` shows or a profile file, and `=17`, `=1,2,5-9`; may be repeated [default: em24=1, pm290=2, em21=3, pqm=17]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -l values -d 'CSV with values that stay as they are, while all others move with the load' -r -F
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -l seed -d 'Which loads are measured: the same seed and time give the same values; `sim:` has 17' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -l answer-time -d 'How long the meters take before they answer' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -l fault -d 'What goes wrong, such as `late=1.1,rate=0.1`; may be repeated: the first rule that applies to a request decides' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -l fault-script -d 'A file of such rules, one a line; they come after those of --fault' -r -F
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -l count -d 'End after this many requests to the meters here, once what answers them is out, with exit code 0' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -s b -l baud -d 'Speed in bits a second, of a serial port [default: the first meter\'s factory setting]' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -s P -l parity -d 'Parity, of a serial port [default: the first meter\'s factory setting]' -r -f -a "none\t'No parity bit'
even\t'Even parity, the standard\'s default'
odd\t'Odd parity'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -s s -l stop-bits -d 'Stop bits, of a serial port [default: the first meter\'s factory setting]' -r -f -a "1\t'One stop bit'
2\t'Two stop bits'"
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -l wait -d 'How long to wait for a serial port that another program holds' -r
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand simulate" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand completions" -s q -l quiet -d 'Print readings and errors only: no headings, footnotes or hints'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand completions" -s v -l verbose -d 'Say what is being done; twice: show every frame in hex with times'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand completions" -s h -l help -d 'Print help'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand completions" -s V -l version -d 'Print version'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "read-registers" -d 'Read points of a meter by name, or raw registers by address'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "write-setpoint" -d 'Write points of a meter by name, or raw registers by address, and read them back'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "broadcast" -d 'Write to every meter on the line at once, without an answer'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "execute-operation" -d 'Have a meter do something: reset, clear energy, set its clock'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "read-status" -d 'Read the eight status bits of a meter, by name (function 07)'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "loopback" -d 'Send words to a unit and compare what comes back: is the line good?'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "poll" -d 'Read meters over and over, at a fixed rate, into files; or once, as from cron'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "meters" -d 'List known meters, show one, print its profile, check a profile, verify it on a live meter'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "ports" -d 'List serial ports, without opening any'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "simulate" -d 'Be a meter, or several, on a pty, a serial port or TCP, with faults on request'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "completions" -d 'Print a shell\'s completion script'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and not __fish_seen_subcommand_from read-registers write-setpoint broadcast execute-operation read-status loopback poll meters ports simulate completions help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and __fish_seen_subcommand_from meters" -f -a "list" -d 'List the meters inside the program and your own'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and __fish_seen_subcommand_from meters" -f -a "show" -d 'Show a meter: its line, limits and groups, and its points'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and __fish_seen_subcommand_from meters" -f -a "export" -d 'Print the profile of a meter as the TOML file that it is'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and __fish_seen_subcommand_from meters" -f -a "check" -d 'Check profile files: whether they load, and what they may lack all the same'
complete -c meterpoll -n "__fish_meterpoll_using_subcommand help; and __fish_seen_subcommand_from meters" -f -a "verify" -d 'Read a live meter and test what its profile says must hold: sums, powers, frequency'
