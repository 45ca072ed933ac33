//! A line whose port is away at the start, or goes and comes back.

mod support {
    pub(crate) mod clock;
    pub(crate) mod polled;
    pub(crate) mod script;
}

use std::cell::Cell;
use std::time::Duration;

use meterpoll::polling::PortError;
use meterpoll::readings::Fault;
use meterpoll::transport::{Clock, LineSettings, OpenError};

use support::polled::{client, job, noon, polled, seconds, switched, told};
use support::script::{ScriptedLine, true_reply};

fn not_there() -> OpenError {
    OpenError::NotThere {
        port: "/dev/ttyUSB0".to_owned(),
    }
}

#[test]
fn a_port_that_is_not_there_at_the_start_is_tried_once_a_slot_until_it_is() {
    let clock = noon();
    let jobs = [
        job("em24", 1, &["frequency"], seconds(10)),
        job("pqm", 17, &["frequency"], seconds(10)),
    ];
    let tries = Cell::new(0);
    let mut open = || {
        tries.set(tries.get() + 1);
        if clock.now() < seconds(25) {
            return Err(PortError::Open(not_there()));
        }
        Ok(switched(&clock, vec![]))
    };
    let cycles = polled(&jobs, &*clock, &mut open, seconds(50));
    let away = (Some(Fault::Port), "spared: port");
    let here = [(None, "once"), (None, "asked")];
    let expected = [[away; 3].as_slice(), &here].concat();
    assert_eq!(told(&cycles, 0), expected);
    assert_eq!(told(&cycles, 1)[..3], [away; 3]);
    assert_eq!(tries.get(), 4);
}

#[test]
fn a_port_that_is_lost_and_comes_back_costs_the_rows_meanwhile_and_no_more() {
    let clock = noon();
    let line = ScriptedLine::new(clock.clone(), LineSettings::default());
    line.meter(|frame| vec![(Duration::from_millis(40), true_reply(frame))]);
    line.hang_up(seconds(15));
    line.come_back(seconds(45));
    let jobs = [
        job("em24", 1, &["0x0000"], seconds(10)),
        job("pqm", 17, &["0x0000"], seconds(10)),
    ];
    let mut open = || Ok(client(line.clone(), &clock));
    let cycles = polled(&jobs, &*clock, &mut open, seconds(80));
    let port = Some(Fault::Port);
    let rows = told(&cycles, 0);
    assert_eq!(
        rows.iter().map(|row| row.0).collect::<Vec<_>>(),
        [None, None, port, port, port, None, None, None]
    );
    // In a slot in which it is away nobody else looks for it.
    let rows = told(&cycles, 1);
    assert_eq!(rows[3], (port, "spared: port"));
    assert_eq!(rows[4], (port, "spared: port"));
    assert_eq!(
        rows.iter().map(|row| row.0).collect::<Vec<_>>(),
        [None, None, port, port, port, None, None, None]
    );
    // After a meanwhile that was short every slot is on time.
    assert!(cycles.iter().all(|cycle| cycle.slot.missed == 0));
}
