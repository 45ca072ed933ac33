//! What the simulated PQM keeps beside its measured values: distortion, pulses, records, setpoints.

#[path = "support/simulated.rs"]
mod simulated;

use meterpoll::sim::Pqm;

use simulated::{at, float, raw, seconds};

#[test]
fn a_derating_factor_is_the_crest_factor_of_a_sine_by_that_of_the_current() {
    let pqm = Pqm::new(1);
    let now = at("2026-05-04T08:00:00Z");
    for phase in ["a", "b", "c"] {
        let crest_factor = float(raw(&pqm, &format!("crest_factor_{phase}"), now)) / 1000.0;
        let derating = float(raw(&pqm, &format!("thdf_{phase}"), now)) / 100.0;
        assert!((crest_factor * derating - 2_f64.sqrt()).abs() < 0.01);
    }
}

#[test]
fn mean_distortions_are_those_of_the_phases() {
    let pqm = Pqm::new(1);
    let now = at("2026-05-04T08:00:00Z");
    let thd = |end: &str| float(raw(&pqm, &format!("thd_{end}"), now));
    let currents = (thd("current_a") + thd("current_b") + thd("current_c")) / 3.0;
    let voltages = (thd("van") + thd("vbn") + thd("vcn")) / 3.0;
    assert!((thd("current_avg") - currents).abs() <= 1.0);
    assert!((thd("voltage_avg") - voltages).abs() <= 1.0);
}

#[test]
fn the_pulse_total_is_the_sum_of_the_inputs() {
    let pqm = Pqm::new(1);
    let now = at("2026-05-04T08:00:00Z");
    let inputs = (1..=4).map(|input| raw(&pqm, &format!("pulse_input_{input}"), now));
    assert_eq!(raw(&pqm, "pulse_input_total", now), inputs.sum());
    let risen = raw(&pqm, "pulse_input_1", now + seconds(60)) - raw(&pqm, "pulse_input_1", now);
    assert_eq!(risen, 3);
}

#[test]
fn the_event_record_holds_what_was_measured_then() {
    let pqm = Pqm::new(1);
    let (event, now) = (at("2020-01-06T07:30:00Z"), at("2026-05-04T08:00:00Z"));
    for point in [
        "current_a",
        "voltage_ca",
        "power_factor_total",
        "energy_apparent",
        "demand_real",
        "thd_vbc",
        "analog_input",
    ] {
        let recorded = raw(&pqm, &format!("event_{point}"), now);
        assert_eq!(recorded, raw(&pqm, point, event), "{point}");
        assert_ne!(recorded, 0, "{point}");
    }
}

#[test]
fn data_log_1_takes_a_record_an_hour_and_then_circulates() {
    let pqm = Pqm::new(1);
    let log = |end: &str, now| raw(&pqm, &format!("log1_{end}"), at(now));
    let third_hour = "2020-01-01T02:20:00Z";
    assert_eq!(log("records_used", third_hour), 2);
    assert_eq!(log("first_record", third_hour), 0);
    assert_eq!(log("next_record", third_hour), 2);
    assert_eq!(log("next_reading", third_hour), 40 * 60);
    let later = "2026-05-04T08:00:00Z";
    let room = log("total_records", later);
    assert_eq!(log("records_used", later), room);
    assert_eq!(log("first_record", later), log("next_record", later));
    assert!((0..room).contains(&log("next_record", later)));
    assert!(room * log("record_size", later) <= 65_536);
}

#[test]
fn setpoints_fit_what_is_measured() {
    let pqm = Pqm::new(1);
    let now = at("2026-05-04T08:00:00Z");
    let get = |point: &str| raw(&pqm, point, now);
    assert!(get("current_a_max") < get("ct_primary"));
    assert!((get("frequency") - 100 * get("nominal_frequency")).abs() < 10);
    // Hundredths of a cent.
    let price = get("energy_cost") / 100;
    assert_eq!(get("energy_cost_total") / price, get("energy_real_pos"));
    assert_eq!(get("log1_interval_set"), get("log1_interval"));
    for name in ["p3", "q3", "s3", "thd_van"] {
        let assigned = get(&format!("log_assign_{name}"));
        assert_eq!(assigned, get(&format!("log_number_{name}")), "{name}");
    }
}
