//! Readings of a meter, played back as the values of a simulated one.

#![cfg(unix)]

mod support {
    pub(crate) mod program;
    pub(crate) mod simulation;
}

use std::fs;

use support::simulation::{Simulation, free_path};

/// All readings of a meter in long CSV, with the time left out.
#[track_caller]
fn readings(simulation: &Simulation, meter: &str, unit: u16) -> (String, Vec<String>) {
    let all = format!("-a {unit} --meter {meter} -f csv --layout long *");
    // A PM290 is busy for the first two seconds of an hour.
    let output = (0..1000)
        .map(|_| simulation.reading(&all).output())
        .find(|output| output.status.code() == Some(0))
        .expect("everything is read");
    let text = String::from_utf8(output.stdout).unwrap();
    let rows = text.lines().skip(1);
    let rows = rows.map(|row| row.split_once(',').unwrap().1.to_owned());
    (text.clone(), rows.collect())
}

#[track_caller]
fn plays_back(meter: &str, unit: u16) {
    let original = Simulation::new(&format!("--meter {meter}={unit}"));
    let (text, expected) = readings(&original, meter, unit);
    drop(original);
    let file = free_path(&format!("played-back-{meter}.csv"));
    fs::write(&file, text).unwrap();
    let values = file.display();
    let copy = Simulation::new(&format!(
        "--meter {meter}={unit} --seed 99 --values {values}"
    ));
    let (_, found) = readings(&copy, meter, unit);
    assert!(expected.len() > 20);
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(found, expected);
    }
    assert_eq!(found.len(), expected.len());
    fs::remove_file(file).unwrap();
}

#[test]
fn every_point_of_a_pqm_plays_back() {
    plays_back("pqm", 17);
}

#[test]
fn every_point_of_a_pm290_plays_back() {
    plays_back("pm290", 2);
}

#[test]
fn every_point_of_an_em21_plays_back() {
    plays_back("em21", 3);
}

#[test]
fn every_point_of_an_em24_plays_back() {
    plays_back("em24", 1);
}

#[test]
fn a_row_is_for_the_unit_it_names() {
    let file = free_path("units.csv");
    fs::write(
        &file,
        "unit_id,point,value\n17,current_a,1\n18,current_a,2\n,frequency,50.00\n",
    )
    .unwrap();
    let values = file.display();
    let simulation = Simulation::new(&format!("--meter pqm=17,18 --values {values}"));
    let output = simulation
        .reading("-a 17,18 --meter pqm current_a frequency -f csv")
        .output();
    let text = String::from_utf8(output.stdout).unwrap();
    let rows = text.lines().skip(1);
    let rows: Vec<&str> = rows
        .filter_map(|row| Some(row.split_once(',')?.1))
        .collect();
    assert_eq!(rows, ["pqm,17,ok,1,50.00", "pqm,18,ok,2,50.00"]);
    fs::remove_file(file).unwrap();
}
