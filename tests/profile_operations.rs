//! Operations: what the loader makes of them, and those of the built-in meters.

use meterpoll::codec::RegisterAddress;
use meterpoll::profile::load::load;
use meterpoll::profile::writing::{Action, Broadcasting, CommandRegisters};
use meterpoll::profile::{Operation, Profile, builtin};

/// The operations of the PQM by number (F7: N253, O221), `!` behind those that are dangerous or lose
/// data.
const PQM: &str = "1 reset, 2 alarm_relay_on !, 3 alarm_relay_off !, 4 aux_1_on !, 5 aux_1_off !, \
                   6 aux_2_on !, 7 aux_2_off !, 8 aux_3_on !, 9 aux_3_off !, 10 set_clock_time, \
                   11 set_clock_date, 12 show_flash_message, 13 simulate_key !, 14 clear_energy !, \
                   15 clear_max_demand !, 16 clear_minmax_current !, 17 clear_minmax_voltage !, \
                   18 clear_minmax_power !, 19 clear_max_thd !, 20 clear_pulse_counts !, \
                   21 trigger_sampling, 22 upload_mode_step_2 !, 23 upload_mode_step_1 !, \
                   24 reload_factory_setpoints_step_2 !, 25 reload_factory_setpoints_step_1 !, \
                   26 test_relays_and_leds !, 27 trigger_waveform_capture, 28 start_data_logs, \
                   29 stop_data_logs !, 30 resize_data_logs !, 31 clear_event_record !, \
                   32 trigger_trace_memory, 33 rearm_trace_memory, 34 clear_all_demand !, \
                   35 clear_minmax_frequency !";

fn meter(name: &str) -> Profile {
    builtin::find(name).expect("it is built in").profile()
}

/// A profile of these lines from line 4 on, a register that clears and a mode.
fn profile(lines: &str) -> String {
    format!(
        "name = \"m\"\ntitle = \"Meter\"\nmanual = \"Manual\"\n{lines}\n\
         [[points]]\nname = \"clear\"\naddress = 0x10\ntype = \"u16\"\naccess = \"write\"\n\
         hazard = \"clears\"\n\
         [[points]]\nname = \"mode\"\naddress = 0x11\ntype = \"u16\"\n"
    )
}

/// A profile with one operation `x` of these keys in line 7; all functions that write.
fn operation(keys: &str) -> String {
    profile(&format!(
        "limits.functions = [3, 5, 6, 16]\ncommand_registers = {{ address = 0x80, code = 5 }}\n\
         operations = [\n  {{ name = \"x\", about = \"does\", {keys} }},\n]"
    ))
}

#[track_caller]
fn good(text: &str) -> Profile {
    load("m.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn refused(text: &str, message: &str) {
    match load("m.toml", text) {
        Ok(_) => panic!("it loads:\n{text}"),
        Err(error) => assert_eq!(error.to_string(), message),
    }
}

fn name_and_danger(operation: &Operation) -> String {
    let danger = if operation.hazard.is_some() { " !" } else { "" };
    match &operation.action {
        Action::Number { number, .. } => format!("{number} {}{danger}", operation.name),
        Action::Register { address, value } => {
            format!("{address}={value} {}{danger}", operation.name)
        }
    }
}

fn told(profile: &Profile) -> String {
    let operations: Vec<String> = profile.operations.iter().map(name_and_danger).collect();
    operations.join(", ")
}

#[test]
fn the_pqm_has_the_operations_of_its_manual() {
    let pqm = meter("pqm");
    assert_eq!(told(&pqm), PQM);
    let expected = CommandRegisters {
        address: RegisterAddress(0x0080),
        code: 5,
    };
    assert_eq!(pqm.command_registers, Some(expected));
    let broadcast = pqm
        .operations
        .iter()
        .filter(|operation| operation.broadcast != Broadcasting::Unmarked);
    let broadcast: Vec<&str> = broadcast.map(|operation| operation.name.as_str()).collect();
    assert_eq!(broadcast, ["clear_all_demand"]);
    assert!(pqm.limits.broadcasts_marked_only);
    let data = pqm.operations.iter().filter_map(Operation::data);
    let data: Vec<String> = data
        .map(|point| format!("{} {} {}", point.name, point.kind, point.range))
        .collect();
    assert_eq!(
        data,
        [
            "set_clock_time time 0x0082+2",
            "set_clock_date date 0x0082+2",
            "show_flash_message ascii/40 0x0082+20",
            "simulate_key u16 0x0082+1",
            "test_relays_and_leds bits 0x0082+1",
        ]
    );
}

#[test]
fn the_other_meters_are_told_by_registers() {
    assert_eq!(
        told(&meter("pm290")),
        "0x0118=0 clear_demands !, 0x011F=0 clear_energy_import !, 0x0121=0 clear_energy_export !, \
         0x0123=0 clear_energy_reactive !, 0x0A00=65535 restart !"
    );
    assert_eq!(told(&meter("em21")), "0x3000=1 reset_all_meters !");
    assert_eq!(
        told(&meter("em24")),
        "0x3000=1 reset_all_meters !, 0x3001=1 reset_total_meters !, \
         0x3002=1 reset_partial_meters !, 0x3003=1 reset_hour_counter !, \
         0x3004=1 reset_counters !, 0x3005=1 reset_demand_max !"
    );
    let pm290 = meter("pm290");
    for operation in &pm290.operations {
        let with = operation.only_with.as_ref();
        let with = with.map(|with| (with.point.as_str(), with.codes.as_deref()));
        let expected = (operation.name != "restart").then_some(("reset_mode", Some(&[0][..])));
        assert_eq!(with, expected, "{}", operation.name);
    }
}

#[test]
fn each_operation_says_what_it_does_and_a_verified_one_on_which_page() {
    for meter in builtin::all() {
        for operation in &meter.profile().operations {
            assert!(!operation.about.is_empty(), "{}", operation.name);
            assert!(!operation.page.is_empty(), "{}", operation.name);
        }
    }
}

#[test]
fn function_07_of_the_pqm_answers_six_bits() {
    let pqm = meter("pqm");
    let bits: Vec<(u8, &str)> = pqm
        .status_bits
        .iter()
        .map(|(mask, name)| (*mask, name.as_str()))
        .collect();
    // N190; bits 6 and 7 are not used.
    let expected = [
        (0x01, "alarm"),
        (0x02, "self-test failure"),
        (0x04, "alarm relay"),
        (0x08, "aux 1 relay"),
        (0x10, "aux 2 relay"),
        (0x20, "aux 3 relay"),
    ];
    assert_eq!(bits, expected);
}

#[test]
fn the_clock_of_the_pqm_is_set_on_all_meters_alone_and_shows_elsewhere() {
    let pqm = meter("pqm");
    let clock = pqm.clock.as_ref().expect("a clock");
    for (name, shown) in [(&clock.time, "clock_time"), (&clock.date, "clock_date")] {
        let writing = pqm.point(name).expect("a point").writing();
        assert_eq!(writing.broadcast, Broadcasting::Only);
        assert_eq!(writing.shown_by.as_deref(), Some(shown));
    }
}

#[test]
fn no_setting_restarts_the_pm290_by_accident() {
    let pm290 = meter("pm290");
    let flags = pm290.point("state_flags").expect("a point");
    assert!(!flags.access.writable());
}

#[test]
fn an_operation_by_register_has_the_hazard_of_the_point_there_unless_it_has_its_own() {
    let hazard = |keys: &str| good(&operation(keys)).operations[0].hazard.clone();
    assert_eq!(
        hazard("register = 0x10, value = 1").as_deref(),
        Some("clears")
    );
    assert_eq!(
        hazard("register = 0x10, value = 2, hazard = \"halts\"").as_deref(),
        Some("halts")
    );
    assert_eq!(hazard("register = 0x12, value = 1"), None);
    assert_eq!(hazard("number = 16"), None);
}

#[test]
fn operations_come_by_number_then_as_they_stand() {
    let text = profile(
        "limits.functions = [3, 5, 6]\noperations = [\n\
         { name = \"z\", register = 2, value = 1, about = \"z\" },\n\
         { name = \"b\", number = 9, about = \"b\" },\n\
         { name = \"y\", register = 1, value = 1, about = \"y\" },\n\
         { name = \"a\", number = 3, about = \"a\" },\n]",
    );
    let names: Vec<String> = good(&text)
        .operations
        .into_iter()
        .map(|op| op.name)
        .collect();
    assert_eq!(names, ["a", "b", "z", "y"]);
}

#[test]
fn an_operation_is_a_number_or_a_value_in_a_register() {
    let message =
        "m.toml:7: operations.x: give number, with data or without, or register and value";
    for keys in [
        "verified = true",
        "number = 1, register = 2, value = 3",
        "number = 1, value = 3",
        "register = 2",
        "register = 2, value = 3, data = { type = \"u16\" }",
    ] {
        refused(&operation(keys), message);
    }
}

#[test]
fn slips_in_an_operation_are_told_with_its_name() {
    refused(
        &operation("numbr = 1"),
        "m.toml:7: operations.x.numbr: unknown key, expected name, about, number, register, value, \
         data, hazard, broadcast, only_with, verified, page",
    );
    refused(
        &operation("number = 70000"),
        "m.toml:7: operations.x.number: 70000 is not a whole number from 0 to 65535",
    );
    refused(
        &operation("number = 1, hazard = \"\""),
        "m.toml:7: operations.x.hazard: \"\" is not a few words that complete \"this ...\"",
    );
    refused(
        &operation("number = 1, broadcast = \"allowed\""),
        "m.toml:7: operations.x.broadcast: \"allowed\" is not of use without 5 or 16 in \
         limits.broadcast_functions",
    );
    refused(
        &operation("number = 1, only_with = { point = \"mood\", codes = [0] }"),
        "m.toml:7: operations.x.only_with.point: there is no point 'mood'",
    );
    refused(
        &operation("number = 1").replace("\"x\"", "\"X\""),
        "m.toml:7: operations.name: 'X' is no name: small letters, digits and '_', a letter first",
    );
}

#[test]
fn data_goes_with_a_number_and_fits_behind_it() {
    refused(
        &operation("number = 1, data = { type = \"u17\" }"),
        "m.toml:7: operations.x.data.type: unknown type 'u17', expected u16, i16, u32, i32, u64, \
         i64, f32, f64, hex, bits, mod10000, letter, time, date or ascii/N with N characters, 1 to \
         250",
    );
    refused(
        &operation("number = 1, data = { type = \"u16\", labels = \"on\" }"),
        "m.toml:7: operations.x.data.labels: there is no label table 'on'",
    );
    refused(
        &operation("number = 1, data = { type = \"u16\", range = [5] }"),
        "m.toml:7: operations.x.data.range: [5] is not [lowest, highest] within 0 to 65535, what \
         u16 holds",
    );
    refused(
        &operation("number = 1, data = { type = \"ascii/40\" }")
            .replace("16]", "16]\nlimits.write_registers = 21"),
        "m.toml:8: operations.x.data.type: \"ascii/40\" is not a type of at most 19 registers, that \
         fit behind the number",
    );
    refused(
        &profile(
            "limits.functions = [3, 5]\noperations = [\n  { name = \"x\", about = \"\", number = 1, \
             data = { type = \"u16\" } },\n]",
        ),
        "m.toml:6: operations.x.data: without command_registers there is no place for it",
    );
}

#[test]
fn no_two_operations_have_one_name_or_do_the_same() {
    let two =
        |second: &str| operation(&format!("number = 1 }},\n  {{ about = \"again\", {second}"));
    refused(
        &two("name = \"x\", number = 2"),
        "m.toml:8: operations.x: there is an operation of this name in line 7 already",
    );
    refused(
        &two("name = \"y\", number = 1, data = { type = \"u16\" }"),
        "m.toml:8: operations.y: there is an operation of this effect in line 7 already",
    );
}

#[test]
fn a_meter_that_cannot_be_told_has_no_operations() {
    refused(
        &profile("operations = [{ name = \"x\", about = \"\", number = 1 }]"),
        "m.toml:4: operations.x.number: 1 is not of use without 5 in limits.functions or \
         command_registers",
    );
    refused(
        &profile("operations = [{ name = \"x\", about = \"\", register = 1, value = 2 }]"),
        "m.toml:4: operations.x.register: 1 is not of use without 6 or 16 in limits.functions",
    );
    refused(
        &profile("command_registers = { address = 0x80, code = 5 }"),
        "m.toml:4: command_registers: of no use without 16 in limits.functions",
    );
    refused(
        &profile("limits.functions = [3, 16]\ncommand_registers = { address = 0xFFFF, code = 5 }"),
        "m.toml:5: command_registers.address: 0xFFFF is not an address with another behind it, for \
         the number",
    );
}
