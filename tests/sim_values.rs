//! Files of values that simulated meters hold.

mod support {
    pub(crate) mod simulated;
}

use std::fs;
use std::path::PathBuf;

use jiff::Timestamp;
use meterpoll::profile::{Setup, builtin};
use meterpoll::sim::{Meter, kinds, values};

use support::simulated::{at, read, unit, write};

fn now() -> Timestamp {
    at("2026-01-15T12:30:00Z")
}

/// A file with this text, gone when dropped.
struct Values(PathBuf);

impl Values {
    fn new(test: &str, content: impl AsRef<[u8]>) -> Self {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{test}-values.csv"));
        fs::write(&path, content).unwrap();
        Self(path)
    }

    fn apply(&self, meters: &mut [Meter]) -> Result<(), String> {
        let name = self.0.display().to_string();
        let result = values::apply(&self.0, meters, now());
        result.map_err(|error| error.to_string().replace(&name, "FILE"))
    }
}

impl Drop for Values {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

fn meter(name: &str, number: u16) -> Meter {
    let profile = builtin::find(name).unwrap().profile();
    kinds::meter(profile, unit(number), 17)
}

/// What a point of a meter reads as.
fn shown(meter: &mut Meter, point: &str) -> String {
    let profile = &meter.profile().clone();
    let mut registers = |name: &str| {
        let range = profile.point(name).unwrap().range;
        read(meter, range.start().get(), range.count(), now()).unwrap()
    };
    let point = profile.point(point).unwrap();
    let setup = Setup::of(std::slice::from_ref(point), Some(profile));
    let names = setup.points().iter().map(|point| &point.name);
    let scales = setup.scales(&names.map(|name| (name.clone(), registers(name))).collect());
    let value = point.interpret(&registers(&point.name), &scales);
    value.unwrap().to_string()
}

#[test]
fn what_is_given_stays_and_the_rest_moves_with_the_load() {
    let mut meters = [meter("pqm", 17)];
    let before = shown(&mut meters[0], "current_b");
    let file = Values::new(
        "stays",
        "point,value\ncurrent_a,1\nmeter_id,MAIN SWITCH\nfrequency,\nswitch_inputs,switch B\n",
    );
    assert_eq!(file.apply(&mut meters), Ok(()));
    assert_eq!(shown(&mut meters[0], "current_a"), "1");
    assert_eq!(shown(&mut meters[0], "meter_id"), "MAIN SWITCH");
    assert_eq!(shown(&mut meters[0], "switch_inputs"), "switch B");
    assert_eq!(shown(&mut meters[0], "current_b"), before);
    assert_eq!(shown(&mut meters[0], "frequency").len(), "60.00".len());
}

#[test]
fn a_row_is_for_its_unit_or_for_all() {
    let mut meters = [meter("pqm", 17), meter("pqm", 18), meter("em24", 1)];
    let text = "value,comment,unit_id,point\n1,x,17,current_a\n2,y,18,current_a\n3,,,current_b\n";
    assert_eq!(Values::new("units", text).apply(&mut meters), Ok(()));
    let currents = |meter: &mut Meter| ["current_a", "current_b"].map(|point| shown(meter, point));
    assert_eq!(currents(&mut meters[0]), ["1", "3"]);
    assert_eq!(currents(&mut meters[1]), ["2", "3"]);
}

#[test]
fn a_row_for_all_is_for_those_that_have_its_point() {
    for meters in [["em24", "pqm"], ["pqm", "em24"]] {
        let mut meters = meters.map(|name| meter(name, if name == "pqm" { 17 } else { 1 }));
        let text = "point,value\nhour_counter,12.5\ncurrent_a,7\n0x1018,99\n";
        assert_eq!(Values::new("those", text).apply(&mut meters), Ok(()));
        for meter in &mut meters {
            match meter.profile().name.clone().as_str() {
                "em24" => assert_eq!(shown(meter, "hour_counter"), "12.50"),
                _ => assert_eq!(
                    ["current_a", "modbus_address"].map(|point| shown(meter, point)),
                    ["7", "99"]
                ),
            }
        }
    }
}

#[test]
fn registers_by_address_hold_words_wherever_they_are_read() {
    let mut meters = [meter("pqm", 17)];
    let text = "point,value\n0x0240,0x1234\n0x0241,65535\n592,7\n0x0105,9\n";
    assert_eq!(Values::new("words", text).apply(&mut meters), Ok(()));
    let [meter] = &mut meters;
    assert_eq!(read(meter, 0x0240, 2, now()), Ok(vec![0x1234, 0xFFFF]));
    assert_eq!(read(meter, 0x0250, 1, now()), Ok(vec![7]));
    // No point names this one.
    assert_eq!(read(meter, 0x0105, 1, now()), Ok(vec![9]));
}

#[test]
fn the_last_row_of_a_point_counts() {
    let mut meters = [meter("em21", 3)];
    let text = "\u{feff}point,value\nvoltage_l1_n,230.1\nvoltage_l1_n,231.5\n";
    assert_eq!(Values::new("last", text).apply(&mut meters), Ok(()));
    assert_eq!(shown(&mut meters[0], "voltage_l1_n"), "231.5");
}

#[test]
fn scales_follow_from_the_setup_in_the_file_and_else_from_the_meters_own() {
    let mut meters = [meter("pm290", 2)];
    let own = Values::new("own", "point,value\ncurrent_a,240\nvoltage_a,660.00\n");
    assert_eq!(own.apply(&mut meters), Ok(()));
    assert_eq!(shown(&mut meters[0], "current_a"), "240.000");
    // Rows of the setup count first, wherever they stand.
    let text = "point,value\ncurrent_a,239.976\nct_primary_current,400\n";
    assert_eq!(Values::new("given", text).apply(&mut meters), Ok(()));
    assert_eq!(read(&mut meters[0], 0x0902, 1, now()), Ok(vec![400]));
    assert_eq!(read(&mut meters[0], 0x0103, 1, now()), Ok(vec![4999]));
}

#[test]
fn a_meter_without_a_model_holds_what_it_is_given() {
    let mut profile = builtin::find("pqm").unwrap().profile();
    "mine".clone_into(&mut profile.name);
    assert_eq!(kinds::usual_unit("mine"), 1);
    let mut meters = [kinds::meter(profile, unit(1), 17)];
    let text = "point,value\ncurrent_a,415\n";
    assert_eq!(Values::new("blank", text).apply(&mut meters), Ok(()));
    assert_eq!(shown(&mut meters[0], "current_a"), "415");
    assert_eq!(shown(&mut meters[0], "current_b"), "0");
}

#[test]
fn meters_of_the_usual_units_are_those_of_the_simulated_line() {
    for mut known in meterpoll::sim::SimulatedLine::meters(17) {
        let name = &known.profile().name.clone();
        assert_eq!(kinds::usual_unit(name), u16::from(known.unit().get()));
        let mut made = meter(name, known.unit().get().into());
        let points = known.profile().points.clone();
        for point in points.iter().filter(|point| point.access.readable()) {
            let [start, count] = [point.range.start().get(), point.range.count()];
            let registers = read(&mut known, start, count, now());
            assert_eq!(
                read(&mut made, start, count, now()),
                registers,
                "{name} {}",
                point.name
            );
        }
    }
}

#[test]
fn meters_of_other_units_have_loads_of_their_own() {
    let [mut one, mut other] = [17, 18].map(|unit| meter("pqm", unit));
    assert_ne!(
        shown(&mut one, "energy_real_pos"),
        shown(&mut other, "energy_real_pos")
    );
    assert_eq!(shown(&mut other, "modbus_address"), "18");
}

#[test]
fn what_is_wrong_is_told_with_file_and_line() {
    for (text, expected) in [
        (
            "",
            "FILE is empty: its first line names the columns, point,value",
        ),
        (
            "point\ncurrent_a\n",
            "FILE:1: there is no column 'value' in the header, which has point",
        ),
        (
            "point,value\ncurrent_x,1\n",
            "FILE:2: current_x: pqm has no such point; did you mean current_a, current_b, \
             current_c?",
        ),
        (
            "point,value\ncurrent_a,1\ncurrent_b,1.5\n",
            "FILE:3: current_b: 1.5 is between two steps: the nearest are 1 and 2",
        ),
        (
            "point,value\n0xFFF0,1\n",
            "FILE:2: 0xFFF0: pqm has no register there that can be read",
        ),
        (
            "point,value\n0x0240,65536\n",
            "FILE:2: 0x0240: '65536' is not a register: 0 to 65535, or 0x0000 to 0xFFFF",
        ),
        (
            "point,value,unit_id\ncurrent_a,1,18\n",
            "FILE:2: unit_id is '18', and the units here are 17",
        ),
        (
            "point,value\ncurrent_a,1,2\n",
            "FILE:2: has more cells or fewer than the header",
        ),
    ] {
        let found = Values::new("wrong", text).apply(&mut [meter("pqm", 17)]);
        assert_eq!(found, Err(expected.to_owned()), "{text}");
    }
    let latin = Values::new("latin", b"point,value\nmeter_id,\xE9\n");
    assert_eq!(
        latin.apply(&mut [meter("pqm", 17)]),
        Err("FILE:2: not UTF-8: save the file in that encoding".to_owned())
    );
}

#[test]
fn what_is_given_stays_until_it_is_written() {
    let mut meters = [meter("pm290", 2)];
    let text = "point,value\nct_primary_current,400\nenergy_active_import,1234\npulse_kvarh,7\n";
    assert_eq!(Values::new("written", text).apply(&mut meters), Ok(()));
    let [meter] = &mut meters;
    let now = at("2026-01-15T12:30:00Z");
    assert_eq!(read(meter, 0x011F, 2, now), Ok(vec![1234, 0]));
    assert_eq!(write(meter, 0x0902, 250, now), None);
    assert_eq!(write(meter, 0x0702, 8, now), None);
    assert_eq!(write(meter, 0x0120, 0, now), None);
    assert_eq!(shown(meter, "ct_primary_current"), "250");
    assert_eq!(shown(meter, "pulse_kvarh"), "8");
    assert_eq!(shown(meter, "energy_active_import"), "0");
}
