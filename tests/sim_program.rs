//! The simulated line as the program shows it.

mod support {
    pub(crate) mod program;
}

use meterpoll::profile::builtin;

use support::program::Program;

/// The points of a row each that a read gives, without a word about any of them.
fn points(arguments: &str) -> Vec<String> {
    let output = Program::new(&format!("read-registers -p sim: {arguments}"))
        .argument("-f")
        .argument("csv")
        .argument("--layout")
        .argument("long")
        .output();
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    assert_eq!(text(output.stderr), "", "{arguments}");
    assert_eq!(output.status.code(), Some(0), "{arguments}");
    let stdout = text(output.stdout);
    let (header, rows) = stdout.split_once('\n').expect("a header");
    let column = header.split(',').position(|name| name == "point");
    rows.lines()
        .filter_map(|row| Some(row.split(',').nth(column?)?.to_owned()))
        .collect()
}

#[test]
fn every_point_of_a_simulated_meter_is_read() {
    // The PM290 is left out: at a full hour it is busy.
    for (unit, meter) in [(1, "em24"), (3, "em21"), (17, "pqm")] {
        let profile = builtin::find(meter).expect("it is built in").profile();
        let readable: Vec<_> = profile
            .points
            .iter()
            .filter(|point| point.access.readable())
            .map(|point| point.name.clone())
            .collect();
        assert_eq!(points(&format!("-a {unit} --meter {meter} *")), readable);
    }
}

#[test]
fn energies_of_the_pm290_are_read_whoever_is_at_its_keys() {
    assert_eq!(points("-a 2 --meter pm290 @energy").len(), 4);
}
