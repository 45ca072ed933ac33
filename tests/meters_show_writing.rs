//! `meters show`: what may be written, what is dangerous, and what a meter does when it is told to.

mod support {
    pub(crate) mod program;
}

use support::program::Program;

/// `meters show` of the meter that is written to.
fn writer(arguments: &str) -> Program {
    Program::new(&format!(
        "meters show tests/fixtures/bench_writing.toml {arguments}"
    ))
}

#[test]
fn a_meter_is_shown_with_its_operations_and_all_hazards() {
    writer("")
        .stdout(include_str!("fixtures/bench_writing_page.txt"))
        .run();
}

#[test]
fn json_has_every_key_of_writing() {
    writer("-f json")
        .stdout(include_str!("fixtures/bench_writing.json"))
        .run();
}

#[test]
fn points_come_with_their_hazards_but_quietly_without() {
    let table = "ADDRESS  NAME       TYPE  SCALE  ACCESS\n\
                 0x0010   clear_all  u16   1      w 1\n\
                 0x0012   period     u16   1      rw 1, 5\n";
    writer("clear_all period")
        .stdout(format!(
            "writer: Meter that is written to\n\n{table}\nhazards  forgets everything: clear_all\n"
        ))
        .run();
    writer("clear_all period -q").stdout(table).run();
}

#[test]
fn a_point_comes_with_all_there_is_to_know_before_it_is_written() {
    writer("delay")
        .stdout(
            "delay\n\n\
             registers  0x0011+1\n\
             type       u16\n\
             scale      0.1\n\
             unit       s\n\
             access     read-write\n\
             range      5 to 6000 raw, 0.5 to 600.0 s\n\
             step       5 raw\n\
             also       65535\n\
             written    with function 06\n\
             writable   with period = 1\n\
             verified   yes\n",
        )
        .run();
    writer("clear_all")
        .stdout(
            "clear_all\n\n\
             registers  0x0010+1\n\
             type       u16\n\
             scale      1\n\
             access     write\n\
             range      1 only\n\
             hazard     forgets everything\n\
             momentary  does something when it is written, keeps nothing\n\
             verified   yes\n",
        )
        .run();
    writer("interval")
        .stdout(
            "interval\n\n\
             registers  0x0013+1\n\
             type       u16\n\
             scale      1\n\
             access     read-write\n\
             allowed    1, 5, 10, 20, 30, 255\n\
             verified   yes\n",
        )
        .run();
    writer("set_time")
        .stdout(
            "set_time\n\n\
             registers  0x0030+2\n\
             type       time\n\
             access     write\n\
             broadcast  only, and to no meter by itself\n\
             shown by   clock_time\n\
             verified   yes\n",
        )
        .run();
}

#[test]
fn csv_tells_of_writing_in_its_last_columns() {
    writer("delay clear_all -f csv")
        .stdout(
            "name,address,registers,type,order,scale,unit,lowest,highest,access,function,alone,\
             no_value,only_with,verified,page,about,labels,step,allowed,also,hazard,momentary,\
             write_function,broadcast,writable_with,shown_by\n\
             delay,0x0011,1,u16,ABCD,0.1,s,5,6000,read-write,,no,,,yes,,,,5,,65535,,no,6,,\
             period = 1,\n\
             clear_all,0x0010,1,u16,ABCD,1,,1,1,write,,no,,,yes,,,,,,,forgets everything,yes,,,,\n",
        )
        .run();
}
